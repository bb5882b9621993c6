"""The saved model at poses the design never saw: holding efforts as MuJoCo computes them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from mujoco.batch import Batch

from equipoise.affine import Array
from equipoise.balancers.paths.bodies import add_point_mass
from equipoise.balancers.spring import Spring, actuator_name
from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism, compile_spec
from equipoise.models.notices import listen
from equipoise.seeding import generator
from equipoise.states import States
from equipoise.verification.findings import Disagreement, JointError
from equipoise.verification.postures import postures
from equipoise.verification.saved import reload

ENGINE = f"MuJoCo {mujoco.__version__}"
CHUNK = 16384
FEW = 200
"""Poses at which a cam without a table of few points is judged."""
JITTER = 0.02


@dataclass(frozen=True, eq=False)
class Comparison:
    """Efforts (N, nd) of design and MuJoCo at the same states, how the poses were chosen, what to know besides."""

    states: States
    where: str
    design: Array
    simulated: Array
    load: Array
    notes: tuple[str, ...]

    def errors(self) -> dict[str, JointError]:
        """Per driven joint the largest difference, and the largest load of its unit."""
        mechanism = self.states.mechanism
        error = np.abs(self.simulated - self.design).max(axis=0)
        units = np.array(mechanism.driven_units)
        return {
            joint: JointError(float(error[i]), float(self.load[units == units[i]].max()), str(units[i]))
            for i, joint in enumerate(mechanism.driven)
        }

    def worst(self) -> Disagreement:
        """The state of the largest difference."""
        mechanism, states = self.states.mechanism, self.states
        difference = np.nan_to_num(np.abs(self.simulated - self.design), nan=np.inf)
        row, column = np.unravel_index(int(difference.argmax()), difference.shape)
        carried = zip(states.payload_points, states.payload_mass[row], strict=True)
        return Disagreement(
            joint=mechanism.driven[column],
            pose=dict(zip(mechanism.driven, states.driven[row].tolist(), strict=True)),
            payload={point.body: float(mass) for point, mass in carried},
            design=float(self.design[row, column]),
            simulated=float(self.simulated[row, column]),
            unit=mechanism.driven_units[column],
        )


def compare(design: Design, path: Path, poses: int, seed: int) -> Comparison:
    """Place the saved model at unseen poses and compare its holding efforts with the design's own."""
    states, where = unseen(design, _affordable(design, poses), seed)
    with listen() as said:
        spec = reload(path)
        simulated = holding(spec, states, unstored(design), *_joined(design, states))
    ours = design.residual(states)
    bare = states.holding
    # A spring may lift more than gravity loads: both sides of the sum set the scale of rounding.
    load = np.maximum(np.abs(bare), np.abs(ours - bare)).max(axis=0)
    springs = [balancer for balancer in design.balancers if isinstance(balancer, Spring)]
    told = [note for spring in springs for note in spring.path.notes(design.states, spring.name)]
    notes = (*told, *_clamped(spec, design.mechanism), *(f"MuJoCo: {line}" for line in dict.fromkeys(said)))
    return Comparison(states, where, ours, simulated, load, notes)


def _affordable(design: Design, poses: int) -> int:
    """Fewer poses where added joints follow another polynomial in nearly each: every one is a model of its own."""
    laws = _joined(design, design.states)[1]
    if not laws:
        return poses
    kinds = np.unique(np.concatenate([np.asarray(law) for law in laws.values()], axis=1), axis=0)
    return min(poses, FEW) if len(kinds) > FEW // 2 else poses


def unseen(design: Design, count: int, seed: int) -> tuple[States, str]:
    """States at poses that the program did not see, in all its payload scenarios, and how they were chosen."""
    mechanism, sweep = design.mechanism, design.sweep
    rng = generator(seed)
    tries = []
    if sweep.box is not None:
        poses = sweep.box[:, 0] + rng.random((count, len(sweep.box))) * (sweep.box[:, 1] - sweep.box[:, 0])
        tries.append((poses, f"{count} random poses in the sweep's box"))
    if sweep.finer is not None and (sweep.outline is not None or sweep.box is None):
        inside = sweep.finer()
        poses = inside.poses[inside.weight > 0]
        poses = poses[rng.permutation(len(poses))[:count]]
        tries.insert(0, (poses, f"{len(poses)} other poses of the sweep's region"))
    limits = np.where(np.isnan(mechanism.box), [-np.inf, np.inf], mechanism.box)
    near = sweep.poses[rng.integers(len(sweep.poses), size=count)]
    near = near + JITTER * np.ptp(sweep.poses, axis=0) * rng.standard_normal(near.shape)
    tries.append((np.clip(near, limits[:, 0], limits[:, 1]), f"{count} random poses near the sweep's"))
    if sweep.instants is not None and sweep.domain is not None:
        time = sweep.domain[0, 0] + rng.random((count, 1)) * np.ptp(sweep.domain)
        return mechanism.states(sweep.at(time)), f"{count} random instants of the motion, at rest"
    for poses, where in tries:
        try:
            states = mechanism.states(sweep.at_poses(poses))
            reach(design, states)
        except InputError:  # a linkage may not reach all of a box or all around a listed pose
            continue
        return states, where
    return mechanism.states(sweep), f"the sweep's own {len(sweep.poses)} poses, for the loops do not close elsewhere"


def reach(design: Design, states: States) -> None:
    """Raise InputError where a path cannot follow the mechanism."""
    for balancer in design.balancers:
        if isinstance(balancer, Spring):
            balancer.path.deform(states)


def unstored(design: Design) -> dict[str, Callable[[Array], Array]]:
    """Forces f(l) of the springs whose law no tendon can hold {spring: N from m}."""

    def force(spring: Spring) -> Callable[[Array], Array]:
        return lambda length: spring.law.force_at(length, spring.own(design.values))

    springs = [balancer for balancer in design.balancers if isinstance(balancer, Spring)]
    return {s.name: force(s) for s in springs if not s.stored(design.values, design.states).exact}


def _joined(design: Design, states: States) -> tuple[dict[str, Array], dict[str, Array]]:
    """Where the joints of added parts start, and laws of joint equalities that change from state to state."""
    positions: dict[str, Array] = {}
    laws: dict[str, Array] = {}
    for balancer in design.balancers:
        if isinstance(balancer, Spring):
            positions |= balancer.path.positions(states, balancer.name)
            laws |= balancer.path.laws(states, balancer.name)
    return positions, laws


def holding(
    spec: mujoco.MjSpec,
    states: States,
    forces: Mapping[str, Callable[[Array], Array]] | None = None,
    positions: Mapping[str, Array] | None = None,
    laws: Mapping[str, Array] | None = None,
) -> Array:
    """Holding efforts (N, nd) of a model with the parts in it, as MuJoCo computes them at the states' postures.

        tau = D^T (qfrc_bias - qfrc_spring - qfrc_actuator)

    Payloads are added as point masses; the model's joints are found by name, their order may differ. Of the
    actuators only those that the mechanism lacks count: they are springs, the others are the motors. forces
    {tendon: f(l)} act in the place of what these tendons hold, as ctrl = -f at MuJoCo's own tendon length. Loops that
    added parts make are closed in this model, from positions and with laws as `postures` reads them.
    """
    forces, mechanism = forces or {}, states.mechanism
    q, transmission = None, None
    result = np.empty_like(states.driven)
    for masses in np.unique(states.payload_mass, axis=0):
        rows = np.flatnonzero((states.payload_mass == masses).all(axis=1))
        loaded = spec.copy()
        loaded.modelfiledir = spec.modelfiledir
        for index, (point, mass) in enumerate(zip(states.payload_points, masses, strict=True)):
            add_point_mass(loaded, f"payload {index + 1} of the verification", point.body, point.at, float(mass))
        for name in forces:
            drive_tendon(loaded, name)
        model = compile_spec(loaded, mechanism.name)
        if q is None or transmission is None:
            q, transmission = postures(model, states, positions or {}, laws or {})
        springs = quieten(model, mechanism.model)
        for start in range(0, len(rows), CHUNK):
            part = rows[start : start + CHUNK]
            force = _forces(model, q[part], springs, forces)
            lead = transmission if len(transmission) == 1 else transmission[part]
            result[part] = np.squeeze(force[:, None, :] @ lead, axis=1)
    return result


def drive_tendon(spec: mujoco.MjSpec, name: str) -> None:
    """Put a motor in the place of a tendon's own spring."""
    tendon = spec.tendon(name)
    tendon.stiffness = [0.0, 0.0, 0.0]
    actuator = spec.actuator(actuator_name(name)) or spec.add_actuator(name=actuator_name(name), target=name)
    actuator.trntype = mujoco.mjtTrn.mjTRN_TENDON
    actuator.gaintype = mujoco.mjtGain.mjGAIN_FIXED
    actuator.gainprm[0] = 1.0
    actuator.biastype = mujoco.mjtBias.mjBIAS_NONE


def quieten(model: mujoco.MjModel, original: mujoco.MjModel, prefix: str = "") -> bool:
    """Leave gravity and springs only: no constraints, motors, motor limits; whether actuators stand for springs.

    The original's names carry a prefix in the model.
    """
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    motors = {prefix + original.actuator(index).name for index in range(original.nu)}
    springs = np.array([model.actuator(index).name not in motors for index in range(model.nu)], dtype=bool)
    model.actuator_gaintype[~springs] = mujoco.mjtGain.mjGAIN_FIXED
    model.actuator_biastype[~springs] = mujoco.mjtBias.mjBIAS_NONE
    model.actuator_gainprm[~springs] = 0.0
    # MuJoCo counts all actuators against a joint's motor limit and may hide gravity among them.
    model.jnt_actfrclimited[:] = 0
    model.jnt_actgravcomp[:] = 0
    return bool(springs.any())


def _forces(
    model: mujoco.MjModel,
    q: Array,
    springs: bool,
    forces: Mapping[str, Callable[[Array], Array]],
) -> Array:
    """bias - spring - actuator (N, nv) of all degrees of freedom."""
    batch = Batch(model, len(q))
    batch.bind("qpos")[:] = q
    bias, spring = batch.bind("qfrc_bias"), batch.bind("qfrc_spring")
    actuator = batch.bind("qfrc_actuator")
    if forces:
        length, control = batch.bind("ten_length"), batch.bind("ctrl")
        batch.forward(stage=int(mujoco.mjtStage.mjSTAGE_VEL))
        for name, force in forces.items():
            control[:, model.actuator(actuator_name(name)).id] = -force(np.array(length[:, model.tendon(name).id]))
    stage = mujoco.mjtStage.mjSTAGE_ACC if springs else mujoco.mjtStage.mjSTAGE_VEL
    batch.forward(stage=int(stage))
    return np.array(bias) - spring - (actuator if springs else 0.0)


def _clamped(spec: mujoco.MjSpec, mechanism: Mechanism) -> tuple[str, ...]:
    """A warning where MuJoCo would count a spring against the motors' limits."""
    motors = {mechanism.model.actuator(index).name for index in range(mechanism.model.nu)}
    springs = [actuator.name for actuator in spec.actuators if actuator.name not in motors]
    if not springs or not mechanism.model.jnt_actfrclimited.any():
        return ()
    return (
        f"in the saved model {', '.join(springs)} is an actuator: a simulation clamps it together with the motors "
        "at the joints' actuatorfrcrange",
    )
