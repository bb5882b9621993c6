"""Counter-rotors: inertias that a gear or belt turns against a body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import mujoco
import numpy as np

from equipoise.affine import Affine, Array, Block, Unknown
from equipoise.balancers.gearing import SLIGHT, Mesh, meshing, teeth
from equipoise.balancers.paths.bodies import add_point_mass
from equipoise.balancers.spring import STORAGE
from equipoise.errors import InputError, nearest
from equipoise.loops import ancestors
from equipoise.mechanism import ANSWERED, Mechanism, Point
from equipoise.momentum import FORCE, MASS, MOMENT
from equipoise.states import States
from equipoise.units import Angle, Inertia, Length, Mass, Number

BASE = Point("world")
PRESSURE = float(np.radians(20.0))
FIT = 1e-6
"""Share of the centre distance within which pitch circles meet."""


@dataclass(frozen=True)
class CounterRotor:
    """An inertia that turns at -ratio times a body's rate, on a shaft that its carrier holds.

        Omega = w_c - ratio (w_b - w_c),   M = J dOmega/dt n,   effort = J dOmega/dt dOmega/dqdot

    body turns at w_b about the axis n, the carrier at w_c; a positive ratio counter-rotates (a gear mesh, teeth of
    body's gear over rotor's, as in [arakelian_smith_2008]), a negative one turns along (a belt). `at` is the shaft's
    place on the carrier; left out it stands anywhere on the base. inertia J in kg m^2, None where unknown; gear_inertia
    is that of the gear or pulley which turns with the body itself on the same shaft's carrier (a planetary pair: belt
    to the base, then the mesh). The rotor's mass is `mass`, or follows from a disc of `radius`: m = 2 J / radius^2.
    Every joint between carrier, body and base must turn about n or slide. Unknown name.J.

    Where the carrier holds the body's own hinge beside a given place `at` (and there is no pair), gears of a positive
    ratio keep their centres at a distance a: the pitch radius is a / (1 + ratio), or the given one, which must agree,
    and the force on the teeth, at pressure_angle, loads the body's bearing. Belts, internal gears, pairs, whose two
    shafts one carrier holds, and rotors without a place load it with torques alone; a pitch_radius still tells the
    force on the teeth.
    """

    name: str
    body: str
    ratio: Number = 1.0
    inertia: Inertia | None = None
    gear_inertia: Inertia = 0.0
    at: Point | None = None
    radius: Length | None = None
    mass: Mass = 0.0
    pitch_radius: Length | None = None
    pressure_angle: Angle = PRESSURE
    like: str | None = None
    sources: ClassVar[tuple[str, ...]] = ("arakelian_smith_2008",)

    @property
    def shaft(self) -> Point:
        """Where the shaft stands: any place on the base weighs and moves alike."""
        return self.at or BASE

    @property
    def owner(self) -> str:
        """The name that the unknown carries."""
        return self.like or self.name

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The inertia, where it is not given."""
        return () if self.inertia is not None else (Unknown(f"{self.owner}.J", "kg m^2", lower=0.0),)

    def check(self, mechanism: Mechanism) -> None:
        """Raise InputError for bodies that do not turn about one common axis, or numbers no rotor has."""
        where = f"counter-rotor {self.name}"
        if not ancestors(mechanism.model, mechanism.body_id(self.body)):
            raise InputError(f"nothing turns {self.body}", where=where, hint="name a moving body")
        if self.ratio == 0:
            raise InputError("the ratio is 0: the rotor would not turn", where=where, hint="ratio: 1")
        sizes = (("radius", self.radius), ("inertia", self.inertia), ("pitch_radius", self.pitch_radius))
        for what, value in sizes:
            if value is not None and not value > 0:
                raise InputError(f"the {what} is {value:g}, it must be positive", where=where)
        if self.gear_inertia < 0 or self.mass < 0:
            raise InputError("mass and gear_inertia must not be negative", where=where)
        if self.radius is not None and self.mass:
            raise InputError("both mass and radius are given", where=where, hint="the radius already tells the mass")
        if not turning(mechanism, self.body):
            raise InputError(f"{self.body} only slides: there is no rotation to counter", where=where)
        turning(mechanism, self.shaft.body)
        self._check_teeth(mechanism, where)

    def _check_teeth(self, mechanism: Mechanism, where: str) -> None:
        if not 0 <= self.pressure_angle < np.pi / 4:
            raise InputError(
                f"the pressure angle is {np.degrees(self.pressure_angle):g} deg", where=where, hint="0 to 45 deg"
            )
        if self.pitch_radius is None:
            return
        if self.ratio < 0:
            raise InputError(
                "a negative ratio is a belt or an internal gear: it has no pitch_radius here",
                where=where,
                hint="leave pitch_radius out; the mesh then counts as a pure torque",
            )
        gears, needed = self._gears(mechanism), self.pitch_radius * (1.0 + self.ratio)
        if gears is not None and abs(gears[1] - needed) > FIT * needed:
            circles = f"{self.pitch_radius * 1e3:g} mm and {self.pitch_radius * self.ratio * 1e3:g} mm"
            raise InputError(
                f"the gears do not meet: pitch circles of {circles} need their axes {needed * 1e3:g} mm apart, they "
                f"are {gears[1] * 1e3:g} mm",
                where=where,
                hint="move the shaft (`at`), or leave pitch_radius out: it follows from the distance",
            )

    def _gears(self, mechanism: Mechanism) -> tuple[int, float] | None:
        """The body's hinge and the distance of the two axes, m, where two gears of constant centre distance mesh."""
        model, carrier = mechanism.model, mechanism.body_id(self.shaft.body)
        joint = meshing(model, mechanism.body_id(self.body), carrier)
        if joint is None or self.at is None or self.ratio < 0 or self.gear_inertia:
            return None
        data = mujoco.MjData(model)
        data.qpos[:] = mechanism.reference
        mujoco.mj_kinematics(model, data)
        shaft = data.xpos[carrier] + data.xmat[carrier].reshape(3, 3) @ np.array(self.shaft.at, dtype=float)
        return joint, float(np.linalg.norm(np.cross(data.xaxis[joint], shaft - data.xanchor[joint])))

    def circle(self, mechanism: Mechanism) -> float | None:
        """Pitch radius of the rotor's gear, m; None where no teeth are known, or both axes are one."""
        gears = self._gears(mechanism)
        if gears is None:
            return self.pitch_radius
        return gears[1] / (1.0 + self.ratio) if gears[1] > SLIGHT else None

    def pushed(self, states: States, values: Mapping[str, float]) -> tuple[int, Array] | None:
        """The body (number) whose bearing the teeth load, and the force (N, 3) of its gear on the rotor, N.

        None where the mesh loads bearings with torques alone.
        """
        mechanism, model = states.mechanism, states.mechanism.model
        gears, radius = self._gears(mechanism), self.circle(mechanism)
        if gears is None or radius is None:
            return None
        held, normal = int(model.jnt_bodyid[gears[0]]), _normal(mechanism, self.body)
        x, y, z = model.jnt_pos[gears[0]].tolist()
        centres = states.point(self.shaft)[0] - states.point(Point(model.body(held).name, (x, y, z)))[0]
        centres = centres - np.outer(centres @ normal, normal)
        torque = self.meshes(states, values)[0].torque
        return held, teeth(torque, radius, self.pressure_angle, centres, normal)

    def effort(self, states: States, goal: str) -> Affine:
        """The rotor's share of a goal: `hold`, `drive`, `force`, `moment`, `mass`, `energy` or `storage`."""
        count = len(states)
        if goal == "mass":
            return self._affine((MASS,), np.full((1, 1), self._heft), np.full((1, 1), self.mass))
        if goal == "storage":
            # It stores no elastic energy: what it costs is counted as J (rad/s)^2.
            return self._affine((STORAGE,), np.ones((count, 1)), np.zeros((count, 1)))
        if goal in ("hold", "energy"):
            blocks = states.mechanism.driven_blocks if goal == "hold" else (Block("energy", "J"),)
            column = np.asarray((states.weight_effort if goal == "hold" else states.weight_energy)(self.shaft, 1.0))
            column = column if goal == "hold" else column[:, None]
            return self._affine(blocks, self._heft * column, self.mass * column)
        if goal == "force":
            column = self._carried(states)[:, :3]
            return self._affine((FORCE,), self._heft * column, self.mass * column)
        normal, rotor, gear = self._spin(states)
        if goal == "moment":
            column = self._carried(states)[:, 3:]
            turning = rotor[0][:, None] * normal
            own = self.gear_inertia * gear[0][:, None] * normal
            return self._affine((MOMENT,), self._heft * column + turning, self.mass * column + own)
        if goal == "drive":
            column = states.weight_effort(self.shaft, 1.0) + states.point_inertia(self.shaft, 1.0)
            turning = rotor[0][:, None] * rotor[1]
            own = self.gear_inertia * gear[0][:, None] * gear[1]
            return self._affine(states.mechanism.driven_blocks, self._heft * column + turning, self.mass * column + own)
        raise InputError(f"there is no goal {goal!r}", hint=nearest(goal, ANSWERED))

    @property
    def _heft(self) -> float:
        """Mass per unit of inertia, 1/m^2."""
        return 0.0 if self.radius is None else 2.0 / self.radius**2

    def _affine(self, blocks: tuple[Block, ...], per_inertia: Array, known: Array) -> Affine:
        if self.inertia is None:
            return Affine(blocks, known + 0.0, self.unknowns, per_inertia[..., None])
        return Affine.known(blocks, known + self.inertia * per_inertia)

    def _carried(self, states: States) -> Array:
        if self.shaft.body == "world":
            return np.zeros((len(states), 6))
        return states.point_wrench(self.shaft, 1.0)

    def _spin(self, states: States) -> tuple[Array, tuple[Array, Array], tuple[Array, Array]]:
        """Axis (3,); angular acceleration (N,) and slope (N, nd) of the rotor and of the body's own gear."""
        normal = _normal(states.mechanism, self.body)
        body, carrier = (self._turn(states, name, normal) for name in (self.body, self.shaft.body))
        rotor = tuple((1.0 + self.ratio) * c - self.ratio * b for b, c in zip(body, carrier, strict=True))
        return normal, (rotor[0], rotor[1]), body

    def _turn(self, states: States, body: str, normal: Array) -> tuple[Array, Array]:
        return states.placement(body).push @ normal, np.einsum("i,nij->nj", normal, states.rotation(body)[1])

    def meshes(self, states: States, values: Mapping[str, float]) -> tuple[Mesh, ...]:
        """The rotor's own mesh, J dOmega/dt; of a planetary pair also the belt that turns the pair's first gear.

        T_mesh = J dOmega/dt,   T_belt = J_gear dw_b/dt - ratio T_mesh
        """
        _, rotor, gear = self._spin(states)
        radius = self.circle(states.mechanism)
        driven = Mesh(f"{self.name}", self.found(values) * rotor[0], radius, self.pressure_angle)
        if not self.gear_inertia:
            return (driven,)
        return driven, Mesh(f"{self.name} belt", self.gear_inertia * gear[0] - self.ratio * driven.torque)

    def found(self, values: Mapping[str, float]) -> float:
        """The rotor's inertia, kg m^2."""
        return float(values[f"{self.owner}.J"] if self.inertia is None else self.inertia)

    def own_mass(self, values: Mapping[str, float]) -> float:
        """The rotor's mass, kg."""
        return self.mass + self._heft * self.found(values)

    def install(self, spec: mujoco.MjSpec, values: Mapping[str, float], states: States) -> None:  # noqa: ARG002
        """Add the rotor as a body on a hinge, geared by a tendon over the joints that turn the body."""
        inertia, mass = self.found(values), self.own_mass(values)
        model = spec.compile()
        normal = _normal_of(model, self.body)
        carrier = spec.worldbody if self.shaft.body == "world" else spec.body(self.shaft.body)
        for suffix, moment in (("", inertia), ("_gear", self.gear_inertia)):
            if moment <= 0:
                continue
            rotor = carrier.add_body(name=f"{self.name}{suffix}", pos=[float(v) for v in self.shaft.at])
            data = mujoco.MjData(model)
            mujoco.mj_kinematics(model, data)
            local = data.xmat[model.body(self.shaft.body).id].reshape(3, 3).T @ normal
            rotor.mass = max(mass if not suffix else 0.0, 1e-9 * moment)
            rotor.ipos, rotor.explicitinertial = [0.0, 0.0, 0.0], True
            rotor.inertia, rotor.iquat = _about(moment, local)
            hinge = rotor.add_joint(name=f"{self.name}{suffix}_joint", axis=local.tolist())
            hinge.limited = mujoco.mjtLimited.mjLIMITED_FALSE
            tendon = spec.add_tendon(name=f"{self.name}{suffix}_mesh")
            tendon.wrap_joint(f"{self.name}{suffix}_joint", 1.0)
            factor = self.ratio if not suffix else -1.0
            weights = _chain(model, self.body, normal)
            for joint, sign in _chain(model, self.shaft.body, normal).items():
                weights[joint] = weights.get(joint, 0.0) - sign
            for joint, sign in weights.items():
                if sign:
                    tendon.wrap_joint(joint, factor * sign)
            equality = spec.add_equality(name=f"{self.name}{suffix}_mesh")
            equality.type, equality.objtype = mujoco.mjtEq.mjEQ_TENDON, mujoco.mjtObj.mjOBJ_TENDON
            equality.name1 = tendon.name
            equality.data = np.zeros_like(equality.data)
        if mass and self.shaft.body != "world" and inertia <= 0:
            add_point_mass(spec, f"{self.name}_mass", self.shaft.body, self.shaft.at, mass)


def turning(mechanism: Mechanism, body: str) -> dict[str, float]:
    """The hinges that turn a body with their sense about its axis; raises InputError where the axes differ."""
    return _chain(mechanism.model, body, _normal(mechanism, body))


def _normal(mechanism: Mechanism, body: str) -> Array:
    return _normal_of(mechanism.model, body)


def _normal_of(model: mujoco.MjModel, body: str) -> Array:
    """World axis (3,) of the first hinge that moves a body; the planar one where none does."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    for joint in _joints(model, body):
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
            return np.array(data.xaxis[joint])
    return np.array([0.0, -1.0, 0.0])


def _joints(model: mujoco.MjModel, body: str) -> list[int]:
    dofs = ancestors(model, model.body(body).id)
    return list(dict.fromkeys(int(model.dof_jntid[dof]) for dof in dofs))


def _chain(model: mujoco.MjModel, body: str, normal: Array) -> dict[str, float]:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    found: dict[str, float] = {}
    for joint in _joints(model, body):
        kind = model.jnt_type[joint]
        if kind == mujoco.mjtJoint.mjJNT_SLIDE:
            continue
        along = float(data.xaxis[joint] @ normal)
        if kind != mujoco.mjtJoint.mjJNT_HINGE or abs(along) < 1 - 1e-9:
            raise InputError(
                f"{body} turns about more than one axis: {model.joint(joint).name} is not parallel",
                hint="a counter-rotor needs all joints up to its body to turn about one axis",
            )
        found[model.joint(joint).name] = float(np.sign(along))
    return found


def _about(moment: float, axis: Array) -> tuple[Any, Any]:
    """Principal inertia and orientation of a thin disc about an axis."""
    quat = np.empty(4)
    mujoco.mju_quatZ2Vec(quat, np.asarray(axis, dtype=float))
    return [0.5 * moment, 0.5 * moment, moment], quat.tolist()
