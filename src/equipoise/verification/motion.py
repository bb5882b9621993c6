"""The motion in MuJoCo: inverse dynamics on explicit bodies, forward simulation, a base that floats."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.errors import DisagreementError, EquipoiseError
from equipoise.models.notices import listen
from equipoise.momentum import body_wrenches
from equipoise.objective import pole_of
from equipoise.sweep import Sweep
from equipoise.verification.findings import FreeBase, JointError, MotionCheck
from equipoise.verification.rehearsal import Rehearsal, floating, prepared, rehearse, stepping
from equipoise.verification.saved import reload

INSTANTS = 64
COARSE = 500
FINER = 4
LONGEST = 1e-3
MOST = 4000
SETTLING = 40
"""Coarse steps at the start that are left out: loops that start in motion need some to find their forces."""
HEAVY = 5.0
SEED = 1


def check_motion(design: Design, path: Path) -> MotionCheck | str:
    """Inverse and forward dynamics of the saved machine over the motion, or why there are none.

    *Inverse*: at instants between the samples MuJoCo's recursive Newton-Euler on the explicit bodies must give the
    motors' efforts and the wrench of the base. *Forward*: the machine starts where the motion does, its motors give
    the design's efforts with a weak feedback; what the base feels differs by an error of integration that falls with
    the time step. *Free base*: without weight, on a floating base of five times the machine's mass.
    """
    instants = design.sweep.instants
    if instants is None:
        return "the states are no motion in time, which is not simulated"
    first = design.states.take(slice(0, 1))
    if any(isinstance(b, Spring) and b.path.laws(first, b.name) for b in design.balancers):
        return "the motion is not simulated: a spring's path follows a law that changes from pose to pose"
    sweep = _heaviest(design.sweep)
    start, end = instants.motion.start, instants.motion.end
    steps = int(np.clip(np.ceil((end - start) / (FINER * LONGEST)), COARSE, MOST))
    time = np.linspace(start, end, FINER * steps + 1)
    try:
        with listen():
            spec = reload(path)
            fine = rehearse(design, spec, sweep, time)
            plans = (fine.take(slice(None, None, FINER)), fine)
            some = np.random.default_rng(SEED).choice(len(time), INSTANTS, replace=False)
            errors = _inverse(design, fine.take(np.sort(some)), sweep)
            found = [_forward(design, plan, sweep, SETTLING * plans[0].step) for plan in plans]
            base = _free_base(design, plans, sweep)
    except DisagreementError:
        raise
    except EquipoiseError as error:
        return f"the motion is not simulated: {error.message}"
    return MotionCheck(
        instants=INSTANTS,
        errors=errors,
        steps=(plans[0].step, plans[1].step),
        differences={row: (found[0][row], found[1][row]) for row in found[0]},
        base=base,
    )


def _heaviest(sweep: Sweep) -> Sweep:
    """The motion with its heaviest payload alone."""
    return replace(sweep, scenarios=sweep.scenarios[[int(sweep.scenarios.sum(axis=1).argmax())]])


def _rows(design: Design, time: Array, sweep: Sweep) -> tuple[dict[str, Array], dict[str, float]]:
    """The design's rows over time, and the largest load of each: what is balanced, what balances it, any body's own."""
    states = design.mechanism.states(sweep.at(time[:, None]))
    rows, bare = design.account(states), design.account(states, bare=True)
    loads = {name: float(np.maximum(np.abs(bare[name]), np.abs(rows[name])).max()) for name in rows}
    own = np.abs(body_wrenches(states))
    loads["force"] = max(loads["force"], float(own[..., :3].max()))
    loads["moment"] = max(loads["moment"], float(own[..., 3:].max()))
    return rows, loads


def _inverse(design: Design, plan: Rehearsal, sweep: Sweep) -> dict[str, JointError]:
    """Largest difference of every row from MuJoCo's inverse dynamics on the explicit bodies, beside its load."""
    model = prepared(plan, design)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data, pole = mujoco.MjData(model), np.array(pole_of(design.objective))
    efforts, felt = np.zeros_like(plan.target), BaseWrench(model)
    tendons = {model.actuator(f"{name}_force").id: (model.tendon(name).id, law) for name, law in plan.forces.items()}
    for row in range(len(plan.time)):
        data.qpos[:], data.qvel[:] = plan.states.kin.q[row], plan.states.moving.velocity[row]
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        for actuator, (tendon, law) in tendons.items():
            data.ctrl[actuator] = -float(law(np.array([data.ten_length[tendon]]))[0])
        mujoco.mj_fwdActuation(model, data)
        data.qacc[:] = plan.acceleration[row]
        mujoco.mj_inverse(model, data)
        wanted = data.qfrc_inverse - data.qfrc_actuator
        efforts[row] = wanted @ plan.states.D[row % len(plan.states.D)]
        felt.note(data)
    wrenches = felt.about(pole)
    rows, loads = _rows(design, plan.time, sweep)
    found = dict(zip(design.mechanism.driven, efforts.T[..., None], strict=True))
    found |= {"force": wrenches[:, :3], "moment": wrenches[:, 3:]}
    return {
        name: JointError(float(np.abs(found[name] - rows[name]).max()), loads[name], design.after[name].unit)
        for name in found
        if name in rows
    }


class BaseWrench:
    """Collects what MuJoCo's bodies feel, and answers what the base gives the machine."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model
        self._seen: list[tuple[Array, Array, Array, Array]] = []

    def note(self, data: mujoco.MjData) -> None:
        """Remember the forces of one instant, accelerations and constraint forces known."""
        mujoco.mj_rnePostConstraint(self.model, data)
        fields = (data.cfrc_int, data.cfrc_ext, data.subtree_com, data.xipos)
        self._seen.append(tuple(np.array(field) for field in fields))  # type: ignore[arg-type]

    def about(self, pole: Array) -> Array:
        """Force and moment (N, 6) about the pole, weight left out.

        The reactions of all bodies on the base, and what loops that end on the base pull.
        """
        inner, outer, com, places = (np.stack(field) for field in zip(*self._seen, strict=True))
        roots = np.where(self.model.body_parentid == 0, 1.0, 0.0)
        roots[0], model = 0.0, self.model
        both = inner * roots[:, None] + outer
        both[:, 0] = 0.0
        arm = com[:, model.body_rootid] - pole
        force, moment = both[..., 3:], both[..., :3] + np.cross(arm, both[..., 3:])
        mass = model.body_mass
        weight = mass.sum() * model.opt.gravity
        centre = mass @ places / mass.sum()
        lift = np.cross(centre - pole, np.broadcast_to(weight, centre.shape))
        return np.concatenate([force.sum(axis=1) + weight, moment.sum(axis=1) + lift], axis=1)


def _forward(design: Design, plan: Rehearsal, sweep: Sweep, settling: float) -> dict[str, JointError]:
    """Largest difference of force and moment from the design's over a simulation, beside their loads before."""
    model, pole = prepared(plan, design), np.array(pole_of(design.objective))
    felt = BaseWrench(model)
    for _, data in stepping(plan, model):
        felt.note(data)
    wrench = felt.about(pole)
    rows, loads = _rows(design, plan.time, sweep)
    settled = plan.time >= plan.time[0] + settling
    parts: Mapping[str, Array] = {"force": wrench[:, :3], "moment": wrench[:, 3:]}
    found = {}
    for name, part in parts.items():
        error = np.linalg.norm(part - rows[name], axis=1)[settled]
        found[name] = JointError(float(error.max()), loads[name], design.after[name].unit)
    return found


def _free_base(design: Design, plans: tuple[Rehearsal, Rehearsal], sweep: Sweep) -> FreeBase:
    """How far a floating base moves without the parts and, at both time steps, with them."""
    pole = np.array(pole_of(design.objective))
    bare = replace(design, balancers=(), values={})
    mass = HEAVY * float(plans[1].machine.model.body_mass.sum())
    radius = float(np.linalg.norm(plans[1].states.kin.xpos[0, 1:] - pole, axis=1).max()) or 1.0

    def moved(owner: Design, plan: Rehearsal) -> tuple[float, float]:
        shift = turn = 0.0
        plan = plan.weightless()
        for _, data in stepping(plan, floating(plan, owner, mass, radius, pole), free=6):
            shift = max(shift, float(np.linalg.norm(data.xipos[1] - pole)))
            turn = max(turn, 2.0 * float(np.arctan2(np.linalg.norm(data.qpos[4:7]), abs(data.qpos[3]))))
        return shift, turn

    before = moved(bare, rehearse(bare, design.mechanism.spec, sweep, plans[0].time))
    return FreeBase(mass, radius, before, (moved(design, plans[0]), moved(design, plans[1])))
