"""equipoise designs balanced mechanisms: springs and counterweights that take the weight off motors.

The public names are imported on first use, so that `import equipoise` stays quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "Mechanism": "mechanism",
    "Point": "mechanism",
    "Platform": "mechanism",
    "Sweep": "sweep",
    "Payload": "sweep",
    "States": "states",
    "Affine": "affine",
    "Block": "affine",
    "Unknown": "affine",
    "Spring": "balancers.spring",
    "Prescribed": "balancers.synthesis",
    "Line": "balancers.paths",
    "Cable": "balancers.paths",
    "Pulley": "balancers.paths",
    "Angle": "balancers.paths",
    "Absolute": "balancers.paths",
    "FourBar": "balancers.paths",
    "Gear": "balancers.paths",
    "Winding": "balancers.paths",
    "Drum": "balancers.paths",
    "ScotchYoke": "balancers.paths",
    "SliderCrank": "balancers.paths",
    "InvertedSliderCrank": "balancers.paths",
    "Cam": "balancers.paths",
    "ConstantEnergy": "balancers.paths",
    "Reel": "balancers.paths",
    "Profile": "balancers.paths",
    "Mount": "balancers.paths",
    "Linear": "balancers.laws",
    "ZeroFreeLength": "balancers.laws",
    "Coil": "balancers.laws",
    "Constant": "balancers.laws",
    "Gas": "balancers.laws",
    "gas_cylinder": "balancers.laws",
    "HydroPneumatic": "balancers.laws",
    "Nitrogen": "balancers.laws",
    "Torsion": "balancers.laws",
    "Polynomial": "balancers.laws",
    "BSpline": "balancers.laws",
    "WireMass": "balancers.laws",
    "Counterweight": "balancers.counterweight",
    "PointMass": "balancers.shapes",
    "Disc": "balancers.shapes",
    "Plate": "balancers.shapes",
    "Solid": "balancers.shapes",
    "CounterRotor": "balancers.counter_rotor",
    "Flywheel": "balancers.flywheel",
    "FlywheelLaw": "balancers.flywheel",
    "Motion": "motion.motion",
    "Expression": "motion.drivers",
    "Cycloidal": "motion.drivers",
    "TimePolynomial": "motion.drivers",
    "TimeSpline": "motion.drivers",
    "exact_rate": "balancers.heavy",
    "exact_rate_zero_free_length": "balancers.heavy",
    "iterated_rates": "balancers.heavy",
    "exact_mean": "variation",
    "payload_rule": "balancers.payload",
    "Adjustment": "balancers.payload",
    "Force": "limits",
    "Slack": "limits",
    "Slope": "limits",
    "Tension": "limits",
    "WindUp": "limits",
    "Transmission": "limits",
    "Curvature": "limits",
    "Convex": "limits",
    "Length": "limits",
    "Stroke": "limits",
    "Stiffness": "limits",
    "MassCap": "limits",
    "ExactAt": "limits",
    "Aim": "objective",
    "Design": "design",
    "chain": "models.chain",
    "DrumWithTorsion": "make",
    "CamWithSpring": "make",
    "ConstantForceCam": "make",
    "law_curve": "make",
    "arm_curve": "make",
    "make_part": "make",
    "make_spring": "make",
    "arm_cam": "make",
    "wrench_matrix": "cables",
    "closure": "cables",
    "feasible": "cables",
    "sag_tension": "cables",
    "distribute": "cables",
    "clearance": "cables",
    "stiffness": "cables",
    "equilibria": "cables",
    "Link": "models.chain",
    "parallelogram_arm": "models.parallelogram_arm",
    "parallelogram_robot": "models.parallelogram_robot",
    "four_bar": "models.four_bar",
    "human_leg": "models.human_leg",
    "rrr3": "models.rrr3",
    "platform_measure": "models.rrr3",
    "slider_crank": "models.slider_crank",
    "cable_platform": "models.cable_platform",
    "caspr": "models.caspr",
    "analyze": "verbs.analyze",
    "balance": "verbs.balance",
    "adjust": "verbs.adjust",
    "Adjusted": "verbs.adjust",
    "Adjuster": "cases",
    "Case": "cases",
    "by_payload": "cases",
    "shape": "verbs.shape",
    "verify": "verbs.verify",
    "report": "verbs.report",
    "geometry_map": "verbs.geometry_map",
    "reproduce": "verbs.reproduce",
    "Claim": "claim",
    "Problem": "problem",
    "load_problem": "problem",
    "EquipoiseError": "errors",
    "InputError": "errors",
    "ModelError": "errors",
    "ProblemError": "errors",
    "LoopError": "errors",
    "InfeasibleError": "errors",
    "DisagreementError": "errors",
}

__all__ = [
    "Absolute",
    "Adjusted",
    "Adjuster",
    "Adjustment",
    "Affine",
    "Aim",
    "Angle",
    "BSpline",
    "Block",
    "Cable",
    "Cam",
    "CamWithSpring",
    "Case",
    "Claim",
    "Coil",
    "Constant",
    "ConstantEnergy",
    "ConstantForceCam",
    "Convex",
    "CounterRotor",
    "Counterweight",
    "Curvature",
    "Cycloidal",
    "Design",
    "DisagreementError",
    "Disc",
    "Drum",
    "DrumWithTorsion",
    "EquipoiseError",
    "ExactAt",
    "Expression",
    "Flywheel",
    "FlywheelLaw",
    "Force",
    "FourBar",
    "Gas",
    "Gear",
    "HydroPneumatic",
    "InfeasibleError",
    "InputError",
    "InvertedSliderCrank",
    "Length",
    "Line",
    "Linear",
    "Link",
    "LoopError",
    "MassCap",
    "Mechanism",
    "ModelError",
    "Motion",
    "Mount",
    "Nitrogen",
    "Payload",
    "Plate",
    "Platform",
    "Point",
    "PointMass",
    "Polynomial",
    "Prescribed",
    "Problem",
    "ProblemError",
    "Profile",
    "Pulley",
    "Reel",
    "ScotchYoke",
    "Slack",
    "SliderCrank",
    "Slope",
    "Solid",
    "Spring",
    "States",
    "Stiffness",
    "Stroke",
    "Sweep",
    "Tension",
    "TimePolynomial",
    "TimeSpline",
    "Torsion",
    "Transmission",
    "Unknown",
    "WindUp",
    "Winding",
    "WireMass",
    "ZeroFreeLength",
    "__version__",
    "adjust",
    "analyze",
    "arm_cam",
    "arm_curve",
    "balance",
    "by_payload",
    "cable_platform",
    "caspr",
    "chain",
    "clearance",
    "closure",
    "distribute",
    "equilibria",
    "exact_mean",
    "exact_rate",
    "exact_rate_zero_free_length",
    "feasible",
    "four_bar",
    "gas_cylinder",
    "geometry_map",
    "human_leg",
    "iterated_rates",
    "law_curve",
    "load_problem",
    "make_part",
    "make_spring",
    "parallelogram_arm",
    "parallelogram_robot",
    "payload_rule",
    "platform_measure",
    "report",
    "reproduce",
    "rrr3",
    "sag_tension",
    "shape",
    "slider_crank",
    "stiffness",
    "verify",
    "wrench_matrix",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'equipoise' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"equipoise.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)


if TYPE_CHECKING:
    from equipoise.affine import Affine, Block, Unknown
    from equipoise.balancers.counter_rotor import CounterRotor
    from equipoise.balancers.counterweight import Counterweight
    from equipoise.balancers.flywheel import Flywheel, FlywheelLaw
    from equipoise.balancers.heavy import exact_rate, exact_rate_zero_free_length, iterated_rates
    from equipoise.balancers.laws import (
        BSpline,
        Coil,
        Constant,
        Gas,
        HydroPneumatic,
        Linear,
        Nitrogen,
        Polynomial,
        Torsion,
        WireMass,
        ZeroFreeLength,
        gas_cylinder,
    )
    from equipoise.balancers.paths import (
        Absolute,
        Angle,
        Cable,
        Cam,
        ConstantEnergy,
        Drum,
        FourBar,
        Gear,
        InvertedSliderCrank,
        Line,
        Mount,
        Profile,
        Pulley,
        Reel,
        ScotchYoke,
        SliderCrank,
        Winding,
    )
    from equipoise.balancers.payload import Adjustment, payload_rule
    from equipoise.balancers.shapes import Disc, Plate, PointMass, Solid
    from equipoise.balancers.spring import Spring
    from equipoise.balancers.synthesis import Prescribed
    from equipoise.cables import (
        clearance,
        closure,
        distribute,
        equilibria,
        feasible,
        sag_tension,
        stiffness,
        wrench_matrix,
    )
    from equipoise.cases import Adjuster, Case, by_payload
    from equipoise.claim import Claim
    from equipoise.design import Design
    from equipoise.errors import (
        DisagreementError,
        EquipoiseError,
        InfeasibleError,
        InputError,
        LoopError,
        ModelError,
        ProblemError,
    )
    from equipoise.limits import (
        Convex,
        Curvature,
        ExactAt,
        Force,
        Length,
        MassCap,
        Slack,
        Slope,
        Stiffness,
        Stroke,
        Tension,
        Transmission,
        WindUp,
    )
    from equipoise.make import (
        CamWithSpring,
        ConstantForceCam,
        DrumWithTorsion,
        arm_cam,
        arm_curve,
        law_curve,
        make_part,
        make_spring,
    )
    from equipoise.mechanism import Mechanism, Platform, Point
    from equipoise.models.cable_platform import cable_platform
    from equipoise.models.caspr import caspr
    from equipoise.models.chain import Link, chain
    from equipoise.models.four_bar import four_bar
    from equipoise.models.human_leg import human_leg
    from equipoise.models.parallelogram_arm import parallelogram_arm
    from equipoise.models.parallelogram_robot import parallelogram_robot
    from equipoise.models.rrr3 import platform_measure, rrr3
    from equipoise.models.slider_crank import slider_crank
    from equipoise.motion.drivers import Cycloidal, Expression, TimePolynomial, TimeSpline
    from equipoise.motion.motion import Motion
    from equipoise.objective import Aim
    from equipoise.problem import Problem, load_problem
    from equipoise.states import States
    from equipoise.sweep import Payload, Sweep
    from equipoise.variation import exact_mean
    from equipoise.verbs.adjust import Adjusted, adjust
    from equipoise.verbs.analyze import analyze
    from equipoise.verbs.balance import balance
    from equipoise.verbs.geometry_map import geometry_map
    from equipoise.verbs.report import report
    from equipoise.verbs.reproduce import reproduce
    from equipoise.verbs.shape import shape
    from equipoise.verbs.verify import verify
