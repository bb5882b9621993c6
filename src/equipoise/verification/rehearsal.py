"""A motion rehearsed in MuJoCo: the machine with all its parts as bodies, its motors giving the design's efforts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.balancers.flywheel import Flywheel
from equipoise.balancers.paths.bodies import add_point_mass
from equipoise.balancers.spring import actuator_name
from equipoise.design import Design
from equipoise.errors import DisagreementError
from equipoise.loops.constraints import equalities, residual
from equipoise.loops.posture import Evaluator, integrate
from equipoise.machinery.drive import effort_parts
from equipoise.mechanism import Mechanism, compile_spec
from equipoise.states import States
from equipoise.sweep import Sweep
from equipoise.verification.postures import by_name
from equipoise.verification.saved import KEY
from equipoise.verification.simulate import drive_tendon, quieten, unstored

EAGER = 60.0
"""How many radians per motion the feedback settles at: weak beside the time step, quick beside the motion."""
ROWS = ("time", "torque", "weight", "acceleration", "target", "pace")
PREFIX = "machine/"
ROUNDS = 4
"""Newton's iterations for the forces of loops, which equalities alone need one of."""
HARD = (0.9999, 0.9999, 0.001, 0.5, 2.0)


@dataclass(frozen=True, eq=False)
class Rehearsal:
    """A machine, the instants (N,) it is stepped at, and what is known of them.

    states are those of the machine as a mechanism of its own, added joints included; torque (N, nv) is what motors
    and flywheels give, weight (N, nv) the part of it that holds weights; target and pace (N, nd) are the driven
    joints' positions and velocities, stiffness and damping (nd,) those of the feedback; acceleration (N, nv) includes
    the flywheels'; forces {tendon: f(l)} act in the place of what the file cannot hold.
    """

    machine: Mechanism
    time: Array
    states: States
    torque: Array
    weight: Array
    acceleration: Array
    target: Array
    pace: Array
    stiffness: Array
    damping: Array
    forces: Mapping[str, Callable[[Array], Array]]

    @property
    def step(self) -> float:
        """The time step, s."""
        return float(self.time[1] - self.time[0])

    @property
    def dofs(self) -> NDArray[np.int_]:
        """Degrees of freedom of the driven joints (nd,)."""
        return np.asarray(self.machine.model.jnt_dofadr[self.machine.driven_ids])

    def take(self, rows: Any) -> Rehearsal:
        """Some of the instants."""
        parts = {name: getattr(self, name)[rows] for name in ROWS}
        return replace(self, states=self.states.take(rows), **parts)

    def weightless(self) -> Rehearsal:
        """The same motion where nothing weighs."""
        return replace(self, torque=self.torque - self.weight, weight=np.zeros_like(self.weight))


def rehearse(design: Design, spec: mujoco.MjSpec, sweep: Sweep, time: Array) -> Rehearsal:
    """What a machine with the design's parts in its spec is to do at instants (N,).

    Raises InputError where the loops that parts add have no accelerations here.
    """
    at = sweep.at(time[:, None])
    own = design.mechanism.states(at)
    machine, forces = _machine(design, spec, sweep, own.kin.q[0]), unstored(design)
    states = machine.states(replace(at, payloads=(), scenarios=np.zeros((1, 0))))
    parts = effort_parts(own, design.balancers, design.values)
    inertia = _inertia(machine, states)
    torque, weight = np.zeros((2, len(time), machine.model.nv))
    dofs, acceleration = machine.model.jnt_dofadr[machine.driven_ids], states.moving.acceleration.copy()
    torque[:, dofs], weight[:, dofs] = sum(parts.values()), parts["gravity"]
    for joint, (moment, pace) in _wheels(design, at, own).items():
        dof = int(machine.model.joint(joint).dofadr[0])
        torque[:, dof], acceleration[:, dof] = moment, pace
    eager = EAGER / float(time[-1] - time[0])
    return Rehearsal(
        machine=machine,
        time=time,
        states=states,
        torque=torque,
        weight=weight,
        acceleration=acceleration,
        target=own.driven,
        pace=own.moving.driven_velocity,
        stiffness=inertia * eager**2,
        damping=2.0 * inertia * eager,
        forces=forces,
    )


def _machine(design: Design, spec: mujoco.MjSpec, sweep: Sweep, start: Array) -> Mechanism:
    """The machine as a mechanism with the design's driven joints and payloads, at a posture near closed loops.

    start (nq,) is how the mechanism itself stands as the motion begins; linkages of added parts have a keyframe.
    """
    own, spec = design.mechanism, spec.copy()
    for index, (payload, mass) in enumerate(zip(sweep.payloads, sweep.scenarios[0], strict=True)):
        point = payload.point
        add_point_mass(spec, f"payload {index + 1} of the verification", point.body, point.at, float(mass))
    for name in unstored(design):
        drive_tendon(spec, name)
    model = compile_spec(spec, own.name)
    keys = [model.key(index).name for index in range(model.nkey)]
    if KEY in keys:
        home = model.key_qpos[keys.index(KEY)].copy()
    else:
        home = model.qpos0.copy()
        home[by_name(model, own.model)[0]] = start
    return replace(own, spec=spec, model=model, reference=_meshed(model, own.model, home), _batches={})


def _meshed(model: mujoco.MjModel, original: mujoco.MjModel, home: Array) -> Array:
    """A posture (nq,) with the added joints brought where gears and belts want them, those of the mechanism held."""
    found, evaluate = equalities(model), Evaluator(model)
    added = np.setdiff1d(np.arange(model.nv), by_name(model, original)[1])
    if not found or not added.size:
        return home
    for _ in range(3):
        gap, jacobian = residual(found, evaluate(home[None]))
        step = np.zeros((1, model.nv))
        step[0, added] = -np.linalg.lstsq(jacobian[0][:, added], gap[0], rcond=1e-9)[0]
        home = integrate(model, home[None], step)[0]
    return home


def _wheels(design: Design, sweep: Sweep, states: States) -> dict[str, tuple[Array, Array]]:
    """Motor torque, N m, and acceleration, rad/s^2, of every flywheel's joint."""
    found = {}
    moved = replace(design, sweep=sweep, states=states)
    for balancer in design.balancers:
        whole = design.flywheel_law(balancer) if isinstance(balancer, Flywheel) else None
        if isinstance(balancer, Flywheel) and whole is not None:
            law = moved.flywheel_law(replace(balancer, inertia=whole.inertia))
            assert law is not None
            found[f"{balancer.name}_joint"] = (law.torque, law.acceleration)
    return found


def _inertia(machine: Mechanism, states: States) -> Array:
    """Inertia (nd,) that each driven joint moves at the first instant, loops included."""
    model, data = machine.model, mujoco.MjData(machine.model)
    data.qpos[:] = states.kin.q[0]
    mujoco.mj_fwdPosition(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return np.einsum("ij,ik,kj->j", states.D[0], mass, states.D[0])


def stepping(plan: Rehearsal, model: mujoco.MjModel, *, free: int = 0) -> Iterator[tuple[int, mujoco.MjData]]:
    """Step a model through the plan; yields every instant with all forces and accelerations known, before the step.

    free is the number of degrees of freedom that come before the machine's own (a floating base: 7 positions, 6).
    Constraints settle within two steps, so their error falls with the step. Raises DisagreementError where the
    simulation leaves the numbers.
    """
    ahead = 7 if free else 0
    model.opt.timestep = plan.step
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.opt.solver = mujoco.mjtSolver.mjSOL_NEWTON
    model.opt.iterations = ROUNDS
    model.eq_solref[:] = (2.0 * plan.step, 1.0)
    model.eq_solimp[:] = HARD
    data = mujoco.MjData(model)
    data.qpos[ahead:], data.qvel[free:] = plan.states.kin.q[0], plan.states.moving.velocity[0]
    mujoco.mj_fwdPosition(model, data)
    dofs = plan.dofs
    places = ahead + plan.machine.model.jnt_qposadr[plan.machine.driven_ids]
    tendons = [(model.actuator(at(name, free)).id, model.tendon(at(name.removesuffix("_force"), free)).id, force)
               for name, force in ((actuator_name(key), law) for key, law in plan.forces.items())]  # fmt: skip
    for index in range(len(plan.time)):
        data.qfrc_applied[free:] = plan.torque[index]
        late = plan.target[index] - data.qpos[places]
        data.qfrc_applied[free + dofs] += plan.stiffness * late
        data.qfrc_applied[free + dofs] += plan.damping * (plan.pace[index] - data.qvel[free + dofs])
        for actuator, tendon, force in tendons:
            data.ctrl[actuator] = -float(force(np.array([data.ten_length[tendon]]))[0])
        mujoco.mj_forward(model, data)
        if not np.isfinite(data.qacc).all():
            raise DisagreementError(f"the simulation breaks down at t = {plan.time[index]:.6g} s")
        yield index, data
        mujoco.mj_Euler(model, data)


def at(name: str, free: int) -> str:
    """The name of an element in a model that floats."""
    return PREFIX + name if free else name


def prepared(plan: Rehearsal, design: Design) -> mujoco.MjModel:
    """The machine's own model with springs, dampers and loops only."""
    model = compile_spec(plan.machine.spec, plan.machine.name)
    return silent(model, design)


def silent(model: mujoco.MjModel, design: Design, prefix: str = "") -> mujoco.MjModel:
    """No motors, gravity compensation, friction, limits or contacts; loops stay."""
    flags = model.opt.disableflags
    quieten(model, design.mechanism.model, prefix)
    bits = mujoco.mjtDisableBit
    model.opt.disableflags = flags | int(bits.mjDSBL_CONTACT) | int(bits.mjDSBL_LIMIT) | int(bits.mjDSBL_FRICTIONLOSS)
    model.body_gravcomp[:] = 0.0
    return model


def floating(plan: Rehearsal, design: Design, mass: float, radius: float, pole: Array) -> mujoco.MjModel:
    """The machine without weight on a free base of a mass (kg) and radius of gyration (m) about the pole."""
    spec, machine = mujoco.MjSpec(), plan.machine.spec.copy()
    for key in list(machine.keys):
        machine.delete(key)
    base = spec.worldbody.add_body(name="base of the verification")
    base.add_freejoint()
    base.explicitinertial, base.mass, base.ipos = True, mass, pole.tolist()
    base.inertia = [mass * radius**2] * 3
    spec.attach(machine, prefix=PREFIX, frame=base.add_frame())
    spec.option.gravity = [0.0, 0.0, 0.0]
    model = silent(compile_spec(spec, plan.machine.name), design, PREFIX)
    # loops that end on the world itself end on the base, which stands in the world's place
    on_bodies = np.isin(model.eq_type, [int(kind) for kind in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD)])
    on_bodies &= model.eq_objtype == int(mujoco.mjtObj.mjOBJ_BODY)
    for ends in (model.eq_obj1id, model.eq_obj2id):
        ends[on_bodies & (ends == 0)] = model.body("base of the verification").id
    return model
