"""The one place that lists what a problem file may name: every tag and the constructor that it mirrors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from equipoise.balancers.counter_rotor import CounterRotor
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.flywheel import Flywheel
from equipoise.balancers.laws import (
    BSpline,
    Coil,
    Constant,
    ConstantPressure,
    Gas,
    HydroPneumatic,
    Law,
    Linear,
    Nitrogen,
    Polynomial,
    Torsion,
    Weight,
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
    ConstantTorque,
    Drum,
    FourBar,
    Gear,
    InvertedSliderCrank,
    Lift,
    Line,
    Path,
    Pinion,
    Profile,
    Pulley,
    Reel,
    ScotchYoke,
    Shaft,
    SliderCrank,
    Swivel,
    Turn,
    Winding,
)
from equipoise.balancers.shapes import Disc, Plate, PointMass, Solid
from equipoise.balancers.spring import Spring
from equipoise.balancers.synthesis import Prescribed
from equipoise.discovery.kinds import (
    CableSprings,
    Coils,
    CompressionCoils,
    ConstantForce,
    Counterweights,
    GasStruts,
    Ideal,
    Kind,
    TorsionSprings,
)
from equipoise.forms import Family, Form
from equipoise.limits import (
    Avoid,
    Balanced,
    Convex,
    Curvature,
    Elongation,
    ExactAt,
    Extension,
    Force,
    Length,
    MassCap,
    Slack,
    Slope,
    SpringIndex,
    Stiffness,
    Stroke,
    Tension,
    Transmission,
    WindUp,
    Wrap,
)
from equipoise.make.requests import MakeArmCam, MakeCam, MakeConstantForceCam, MakeDrum
from equipoise.mechanism import Mechanism, Point
from equipoise.models.cable_platform import cable_platform
from equipoise.models.caspr import caspr
from equipoise.models.chain import chain
from equipoise.models.delta import delta
from equipoise.models.five_bar import five_bar
from equipoise.models.four_bar import four_bar
from equipoise.models.human_leg import human_leg
from equipoise.models.parallelogram_arm import parallelogram_arm
from equipoise.models.parallelogram_robot import parallelogram_robot
from equipoise.models.rrr3 import rrr3
from equipoise.models.slider_crank import slider_crank
from equipoise.motion.drivers import Cycloidal, Driver, Expression, TimePolynomial, TimeSpline
from equipoise.parts import PARTS, WindableSpring
from equipoise.sweep import Sweep
from equipoise.units import Length as Metres

BUILDERS: dict[str, Callable[..., Any]] = {
    "chain": chain,
    "parallelogram_arm": parallelogram_arm,
    "parallelogram_robot": parallelogram_robot,
    "human_leg": human_leg,
    "four_bar": four_bar,
    "five_bar": five_bar,
    "rrr3": rrr3,
    "delta": delta,
    "slider_crank": slider_crank,
    "cable_platform": cable_platform,
    "caspr": caspr,
}
MECHANISMS: dict[str, Callable[..., Any]] = {"model": Mechanism.load, **BUILDERS}
SWEEPS: dict[str, Callable[..., Any]] = {
    "sobol": Sweep.sobol,
    "grid": Sweep.grid,
    "quadrature": Sweep.quadrature,
    "triangle": Sweep.triangle,
    "polygon": Sweep.polygon,
    "box": Sweep.region,
    "poses": Sweep.of_poses,
    "motion": Sweep.motion,
    "any_motion": Sweep.any_motion,
    "reactionless": Sweep.reactionless,
}
BALANCERS: dict[str, Callable[..., Any]] = {
    "spring": Spring,
    "counterweight": Counterweight,
    "counter_rotor": CounterRotor,
    "flywheel": Flywheel,
}
TURNS: dict[str, Callable[..., Any]] = {"angle": Angle, "absolute": Absolute, "gear": Gear, "pinion": Pinion}
SHAFTS: dict[str, Callable[..., Any]] = {**TURNS, "winding": Winding}
PATHS: dict[str, Callable[..., Any]] = {
    "line": Line,
    "cable": Cable,
    **SHAFTS,
    "drum": Drum,
    "scotch_yoke": ScotchYoke,
    "slider_crank": SliderCrank,
    "inverted_slider_crank": InvertedSliderCrank,
    "cam": Cam,
    "four_bar": FourBar,
    "reel": Reel,
}
PROFILES: dict[str, Callable[..., Any]] = {
    "table": Profile,
    "csv": Profile.csv,
    "pitch": Profile.pitch,
    "constant_energy": ConstantEnergy,
    "constant_torque": ConstantTorque,
}
STARTS: dict[str, Callable[..., Any]] = {"prescribed": Prescribed}
PULLEYS: dict[str, Callable[..., Any]] = {"pulley": Pulley, "swivel": Swivel}
LAWS: dict[str, Callable[..., Any]] = {
    "zero_free_length": ZeroFreeLength,
    "linear": Linear,
    "coil": Coil,
    "constant": Constant,
    "weight": Weight,
    "constant_pressure": ConstantPressure,
    "gas": Gas,
    "gas_cylinder": gas_cylinder,
    "hydro_pneumatic": HydroPneumatic,
    "torsion": Torsion,
    "polynomial": Polynomial,
    "bspline": BSpline,
    **PARTS,
    "windable_spring": WindableSpring,
}
EXPONENTS: dict[str, Callable[..., Any]] = {"nitrogen": Nitrogen}
MASSES: dict[str, Callable[..., Any]] = {"wire_mass": WireMass}
SHAPES: dict[str, Callable[..., Any]] = {"point": PointMass, "disc": Disc, "plate": Plate, "solid": Solid}
DRIVERS: dict[str, Callable[..., Any]] = {
    "expression": Expression,
    "cycloidal": Cycloidal,
    "polynomial": TimePolynomial,
    "spline": TimeSpline,
}
LIMITS: dict[str, Callable[..., Any]] = {
    "stroke": Stroke,
    "avoid": Avoid,
    "elongation": Elongation,
    "spring_index": SpringIndex,
    "extension": Extension,
    "force": Force,
    "slack": Slack,
    "length": Length,
    "stiffness": Stiffness,
    "mass": MassCap,
    "exact_at": ExactAt,
    "balanced": Balanced,
    "slope": Slope,
    "curvature": Curvature,
    "convex": Convex,
    "tension": Tension,
    "wind_up": WindUp,
    "transmission": Transmission,
    "wrap": Wrap,
}
KINDS: dict[str, Callable[..., Any]] = {
    "zero_free_length": Ideal,
    "coil": Coils,
    "compression": CompressionCoils,
    "cable": CableSprings,
    "constant": ConstantForce,
    "gas": GasStruts,
    "torsion": TorsionSprings,
    "counterweight": Counterweights,
}
MAKES: dict[str, Callable[..., Any]] = {
    "drum": MakeDrum,
    "cam": MakeCam,
    "constant_force_cam": MakeConstantForceCam,
    "arm_cam": MakeArmCam,
}


def _members(table: Mapping[str, Callable[..., Any]]) -> Callable[[], Mapping[str, Callable[..., Any]]]:
    return lambda: table


def point(body: str, x: Metres = 0.0, y: Metres = 0.0, z: Metres = 0.0) -> Point:
    """A point of a body: [body, x, y, z] in the body's own (URDF link) frame, m; `world` is the base."""
    return Point(body, (x, y, z))


MECHANISM = Family("mechanism", _members(MECHANISMS), leading=True, nested=tuple(BUILDERS), later=True)
SWEEP = Family("sweep", _members(SWEEPS), leading=True, later=True)
BALANCER = Family("balancer", _members(BALANCERS))
LIMIT = Family("limit", _members(LIMITS), leading=True)
PATH = Family("path", _members(PATHS))
LAW = Family("law", _members(LAWS))
TURN = Family("angle", _members(TURNS))
SHAFT = Family("angle", _members(SHAFTS))
PROFILE = Family("profile", _members(PROFILES))
START = Family("start", _members(STARTS))
PULLEY = Family("pulley", _members(PULLEYS))
MASS = Family("mass", _members(MASSES))
SHAPE = Family("shape", _members(SHAPES))
DRIVER = Family("driver", _members(DRIVERS))
MAKE = Family("part to make", _members(MAKES))
KIND = Family("kind of candidate", _members(KINDS))
EXPONENT = Family("exponent", _members(EXPONENTS))


def family_of(hint: Any) -> Family | Form | None:
    """The family that a parameter's type stands for, and how points are written; None for other types."""
    if hint is Point:
        return Form(point)
    for family, table in (
        (LAW, {"any": Law, **LAWS}),
        (TURN, {"any": Turn, **TURNS}),
        (SHAFT, {"any": Shaft}),
        (PATH, {"any": Path, **PATHS}),
        (PROFILE, {"any": Lift, **PROFILES}),
        (PULLEY, PULLEYS),
        (MASS, MASSES),
        (SHAPE, SHAPES),
        (DRIVER, {"any": Driver, **DRIVERS}),
        (EXPONENT, EXPONENTS),
        (KIND, {"any": Kind, **KINDS}),
    ):
        if isinstance(hint, type) and hint in table.values():
            return family
    return None
