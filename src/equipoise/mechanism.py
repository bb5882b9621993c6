"""A mechanism: a MuJoCo model and the names of its driven joints."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from mujoco.batch import Batch

from equipoise.affine import Affine, Array, Block
from equipoise.errors import InputError, nearest
from equipoise.models.notices import errors, refusals
from equipoise.units import Acceleration, Joint

if TYPE_CHECKING:
    from equipoise.states import States
    from equipoise.sweep import Sweep

BATCH = 65_536
"""Postures that MuJoCo holds in memory together."""
MASSLESS = 1e-12
"""kg, more than the trace that MuJoCo wants of a body without mass."""
ANSWERED = ("hold", "drive", "force", "moment", "mass", "energy", "storage")
"""What mechanism and balancers answer of a state."""


@dataclass(frozen=True)
class Point:
    """A point fixed in a body: `at` holds its coordinates in the body's own (URDF link) frame, m."""

    body: str
    at: tuple[Any, Any, Any] = (0.0, 0.0, 0.0)

    @classmethod
    def of(cls, body: str, place: Iterable[Any]) -> Point:
        """A point from its three coordinates, however they are kept."""
        x, y, z = place
        return cls(body, (x, y, z))

    @classmethod
    def many(cls, body: str, places: Array) -> Point:
        """Places (C, 3) of a body as one point, on an axis of candidates before the states'."""
        return cls.of(body, places.T[:, :, None])


@dataclass(frozen=True)
class Platform:
    """What cables hold: its reference point, the rows of its wrench, the length that makes moments comparable.

    rows S (n, 6) pick the wrench from (F, M) in world axes at the point, n the number of driven joints; length in
    m divides the moments of the resultant; cables are the names of the tendons that hold it; t_min and t_max, N, are
    the tensions that each of them may have.
    """

    point: Point
    rows: tuple[tuple[float, ...], ...]
    length: float
    cables: tuple[str, ...] = ()
    t_min: tuple[float, ...] = ()
    t_max: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A MuJoCo model, its driven joints and the reference posture that names the assembly branch.

    spec is the editable source of the file that a user takes away and model the compiled one;
    reference (nq,) is the posture of joints that are held and the branch of those that loops drive;
    singularity is the least admissible singular value of the loop Jacobian (lengths over their
    characteristic length); remarks are what the mass audit has to say; platform is what a `wrench` acts on; sources are
    keys in references.bib of what a builder took from the literature.
    """

    spec: mujoco.MjSpec
    model: mujoco.MjModel
    driven: tuple[str, ...]
    reference: Array
    name: str
    remarks: tuple[str, ...] = ()
    singularity: float = 1e-3
    source: Path | None = None
    platform: Platform | None = None
    sources: tuple[str, ...] = ()
    _batches: dict[str, Any] = field(default_factory=dict, repr=False)

    @staticmethod
    def load(
        model: str | Path,
        *,
        driven: tuple[str, ...] | list[str] | None = None,
        gravity: tuple[Acceleration, Acceleration, Acceleration] | list[Acceleration] | None = None,
        branch: str | None = None,
        search: tuple[str | Path, ...] | list[str | Path] = (),
    ) -> Mechanism:
        """Read a URDF or MJCF robot from a path or a `package://` address.

        driven names the actuated joints (default: every hinge and slide that nothing else determines),
        gravity (3,) in m/s^2 replaces the file's, branch names the keyframe that closes loops (default:
        the model's zero posture), search lists folders for `package://`.
        Raises ModelError naming the fault of the file, InputError for an unknown joint or keyframe.
        """
        from equipoise.models.load import load

        return load(model, driven=driven, gravity=gravity, branch=branch, search=tuple(search))

    def on_branch(self, branch: str, at: Mapping[str, Joint] | Array | None = None) -> Mechanism:
        """The mechanism in one of the assemblies that its loops allow at positions of the driven joints.

        at holds {joint: position} or all of them (nd,), rad or m (default and for joints left out: the reference's).
        Branches are named after the dependent joint that tells them apart: `platform_x-`, `platform_x+`. Raises
        LoopError naming the choices for any other name, or where nothing regular closes.
        """
        from equipoise.loops import on_branch
        from equipoise.ranges import pose_vector

        driven = at if isinstance(at, np.ndarray) else pose_vector(self, at or {})
        return on_branch(self, np.asarray(driven, dtype=float), branch)

    def at(self, body: str, x: Any = 0.0, y: Any = 0.0, z: Any = 0.0) -> Point:
        """A point of a body in its own frame, m; raises InputError for a body that does not exist."""
        self.body_id(body)
        return Point(body, (x, y, z))

    def body_id(self, body: str) -> int:
        """The number of a body in the compiled model; `world` is the base."""
        index = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, body)
        if index < 0:
            raise InputError(f"there is no body {body!r} in {self.name}", hint=nearest(body, self.bodies))
        return index

    def joint_id(self, joint: str) -> int:
        """The number of a joint in the compiled model."""
        index = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, joint)
        if index < 0:
            raise InputError(f"there is no joint {joint!r} in {self.name}", hint=nearest(joint, self.joints))
        return index

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of all bodies, the world first."""
        return tuple(self.model.body(i).name for i in range(self.model.nbody))

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of all joints."""
        return tuple(self.model.joint(i).name for i in range(self.model.njnt))

    def cable(self, name: str) -> tuple[Point, Point]:
        """The two ends of a cable: a tendon between two sites; raises InputError for any other name."""
        return cable_ends(self.model, name)

    @cached_property
    def driven_ids(self) -> Array:
        """Joint numbers of the driven joints (nd,)."""
        return np.array([self.joint_id(name) for name in self.driven], dtype=int)

    @cached_property
    def driven_units(self) -> tuple[str, ...]:
        """Unit of the holding effort per driven joint: N m for a hinge, N for a slide."""
        slide = mujoco.mjtJoint.mjJNT_SLIDE
        return tuple("N" if self.model.jnt_type[i] == slide else "N m" for i in self.driven_ids)

    @cached_property
    def driven_blocks(self) -> tuple[Block, ...]:
        """One block per driven joint."""
        return tuple(Block(name, unit) for name, unit in zip(self.driven, self.driven_units, strict=True))

    @property
    def box(self) -> Array:
        """Joint limits of the driven joints (nd, 2), rad or m; an unlimited hinge runs from -pi to pi."""
        limits = np.empty((len(self.driven), 2))
        for row, joint in enumerate(self.driven_ids):
            if self.model.jnt_limited[joint]:
                limits[row] = self.model.jnt_range[joint]
            elif self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
                limits[row] = (np.nan, np.nan)
            else:
                limits[row] = (-np.pi, np.pi)
        return limits

    @property
    def motor_limits(self) -> Array:
        """Motor limit of each driven joint (nd,), N m or N; infinite where the file states none."""
        limits = np.full(len(self.driven), np.inf)
        for row, joint in enumerate(self.driven_ids):
            if self.model.jnt_actfrclimited[joint]:
                limits[row] = np.abs(self.model.jnt_actfrcrange[joint]).max()
        return limits

    @property
    def gravity(self) -> Array:
        """Gravity (3,), m/s^2, world axes."""
        return np.array(self.model.opt.gravity)

    @property
    def mass(self) -> float:
        """Total mass, kg, without the traces that bodies of no mass carry."""
        return float(self.model.body_mass[self.model.body_mass > MASSLESS].sum())

    @cached_property
    def size(self) -> float:
        """The longest way from the base along the bodies, m; 1 where all sit on the base."""
        reach = np.zeros(self.model.nbody)
        for body, (parent, place) in enumerate(zip(self.model.body_parentid, self.model.body_pos, strict=True)):
            reach[body] = reach[parent] + np.linalg.norm(place)
        return float(reach[self.model.body_weldid != 0].max(initial=0.0)) or 1.0

    def forward(self, q: Array, velocity: Array | None, names: Sequence[str]) -> list[Array]:
        """Fields (N, ...) that MuJoCo computes of postures q (N, nq) at velocities (N, nv), on all cores.

        None is at rest. Constraints and contacts are off, potential energy is on. The batch is kept and grows with
        the largest request, since building one costs a millisecond, up to BATCH postures at a time.
        """
        parts = [slice(start, start + BATCH) for start in range(0, max(len(q), 1), BATCH)]
        if len(parts) > 1:
            found: list[Array] = []
            for part in parts:
                some = self.forward(q[part], None if velocity is None else velocity[part], names)
                found = found or [np.empty((len(q), *one.shape[1:])) for one in some]
                for whole, one in zip(found, some, strict=True):
                    whole[part] = one
            return found
        count, kept = len(q), self._batches
        if kept.get("size", 0) < count:
            bare = copy.copy(self.model)
            bare.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
            bare.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
            size = max(64, count)
            kept.clear()
            kept.update(size=size, batch=Batch(bare, size))
        for name in ("qpos", "qvel", *names):
            if name not in kept:
                kept[name] = kept["batch"].bind(name)
        kept["qpos"][:count] = q
        kept["qvel"][:count] = 0.0 if velocity is None else velocity
        stage = int(mujoco.mjtStage.mjSTAGE_VEL)
        with errors(self.name):
            kept["batch"].forward(ids=np.arange(count, dtype=np.int32), stage=stage)
        return [np.array(kept[name][:count]) for name in names]

    def states(self, sweep: Sweep) -> States:
        """Close the loops and do the kinematics of a sweep once."""
        from equipoise.states import States

        return States.of(self, sweep)

    def effort(self, states: States, goal: str) -> Affine:
        """The mechanism's own share of a goal, without unknowns.

        `hold`: tau = D^T (qfrc_bias - qfrc_spring) - sum m g . J, per driven joint (N, nd), N m or N;
        `drive`: what the motors supply over a motion, inertia, weight, springs and dampers of the file (N, nd);
        `force`, `moment`: F = dp/dt and M = dL/dt about the world origin (N, 3), the wrench of the base on the
        mechanism, weight left out; `mass`: what is added, kg;
        `energy`: the potential of all weights and of springs already in the file (N, 1), J.
        """
        from equipoise.momentum import FORCE, MASS, MOMENT, bare_drive, bare_wrench

        if goal == "hold":
            return Affine.known(self.driven_blocks, states.holding)
        if goal == "drive":
            return Affine.known(self.driven_blocks, sum(bare_drive(states), start=np.zeros(1)))
        if goal in ("force", "moment"):
            first, block = (0, FORCE) if goal == "force" else (3, MOMENT)
            return Affine.known((block,), bare_wrench(states)[:, first : first + 3])
        if goal == "mass":
            return Affine.known((MASS,), np.zeros((1, 1)))
        if goal == "energy":
            return Affine.known((Block("energy", "J"),), states.potential[:, None])
        raise InputError(f"there is no goal {goal!r}", hint=nearest(goal, ANSWERED))

    def with_model(self, spec: mujoco.MjSpec) -> Mechanism:
        """The same mechanism over an edited spec whose joints are the same."""
        return replace(self, spec=spec, model=compile_spec(spec, self.name), _batches={})


def compile_spec(spec: mujoco.MjSpec, name: str) -> mujoco.MjModel:
    """Compile a spec; MuJoCo's own message becomes a ModelError, its warnings never a log file."""
    with refusals(name):
        return spec.compile()


def cable_ends(model: mujoco.MjModel, name: str) -> tuple[Point, Point]:
    """The two ends of a cable: a tendon between two sites; raises InputError for any other name."""
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TENDON, name)
    known = [model.tendon(i).name for i in range(model.ntendon)]
    if index < 0:
        raise InputError(f"there is no cable {name!r} in the mechanism", hint=nearest(name, known))
    first, count = model.tendon_adr[index], model.tendon_num[index]
    wraps = slice(first, first + count)
    if count != 2 or (model.wrap_type[wraps] != mujoco.mjtWrap.mjWRAP_SITE).any():
        raise InputError(f"tendon {name!r} is no straight cable", hint="a cable joins two sites")
    ends = []
    for site in (model.site(int(site)) for site in model.wrap_objid[wraps]):
        x, y, z = (float(value) for value in site.pos)
        ends.append(Point(model.body(int(site.bodyid[0])).name, (x, y, z)))
    return ends[0], ends[1]
