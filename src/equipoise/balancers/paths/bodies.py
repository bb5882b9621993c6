"""Building paths into a MuJoCo model: sites, shafts that follow joints, cranks, sliders and pins."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths.mount import Mount
from equipoise.errors import InputError
from equipoise.mechanism import Point, compile_spec
from equipoise.models.parts import Inertial, add_body, add_joint, add_pin
from equipoise.states import States

NOTHING = Inertial(0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
SLIDING = (1.0, 0.0, 0.0)


def add_site(spec: mujoco.MjSpec, point: Point, name: str) -> mujoco.MjsSite:
    """Add a named site at a point of a body."""
    site = spec.body(point.body).add_site(name=name)
    site.pos = [float(value) for value in point.at]
    return site


def outline(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """The compiled model of a spec that may still lack the positions of joints just added."""
    bare = spec.copy()
    bare.modelfiledir = spec.modelfiledir
    for key in list(bare.keys):
        bare.delete(key)
    return compile_spec(bare, spec.modelname)


def zero_length(spec: mujoco.MjSpec, tendon: str) -> float:
    """A tendon's length at the zero posture, from which MuJoCo's equalities count."""
    model = outline(spec)
    return float(model.tendon_length0[model.tendon(tendon).id])


def add_frame(spec: mujoco.MjSpec, mount: Mount, name: str) -> Any:
    """A body fixed at a mount: x where the crank points at zero, -y the axis, so that the mount's plane is x-z."""
    e, f, a = mount.frame
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, np.stack([e, -a, f], axis=1).ravel())
    body = spec.body(mount.at.body).add_body(name=name, pos=[float(v) for v in mount.at.at], quat=quat.tolist())
    body.explicitinertial = True
    body.ipos = [0.0, 0.0, 0.0]
    return body


def add_shaft(
    spec: mujoco.MjSpec, frame: Any, name: str, terms: tuple[Mapping[str, Any], Any], length: float, states: States
) -> Any:
    """A crank in a frame whose hinge `name` reads sum_j c_j q_j + c over the model's joints (a belt or gears)."""
    crank = add_body(frame, name, NOTHING, length=length)
    add_joint(crank, name)
    coefficients, constant = terms
    model = states.mechanism.model
    belt = spec.add_tendon(name=f"{name}_drive")
    belt.wrap_joint(name, 1.0)
    for joint, coefficient in coefficients.items():
        belt.wrap_joint(joint, -float(coefficient))
    law = spec.add_equality(
        name=f"{name}_drive",
        type=mujoco.mjtEq.mjEQ_TENDON,
        objtype=mujoco.mjtObj.mjOBJ_TENDON,
        name1=belt.name,
    )
    # MuJoCo counts from the tendon's length at the zero posture, where this joint stands at 0.
    zero = sum(float(c) * float(model.qpos0[model.joint(joint).qposadr[0]]) for joint, c in coefficients.items())
    law.data[0] = float(constant) + zero
    return crank


def mass(value: Any) -> Inertial:
    """A point mass at a body's origin."""
    return Inertial(float(value), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def weigh(body: Any, value: float) -> None:
    """Make a body a point mass, possibly of none."""
    body.mass, body.inertia = value, [0.0, 0.0, 0.0]
    body.ipos = [0.0, 0.0, 0.0]  # said, else the saved file lacks it and MuJoCo refuses to read it back
    body.explicitinertial = True


def add_point_mass(
    spec: mujoco.MjSpec, name: str, body: str, at: Any, value: float, inertia: Array | None = None
) -> None:
    """Add a mass as a body welded at a point of another; none for zero mass or the world.

    inertia (3, 3) is that about the point along the carrier's axes, kg m^2, None for a point mass.
    """
    if value == 0.0 or body == "world":
        return
    added = spec.body(body).add_body(name=name, pos=[float(v) for v in at])
    weigh(added, value)
    if inertia is not None and np.abs(inertia).max() > 0:
        values, axes = np.linalg.eigh(inertia)
        axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, axes.ravel())
        added.inertia, added.iquat = np.maximum(values, 0.0).tolist(), quat.tolist()


def positive_length(value: Any, what: str, name: str) -> None:
    """Raise InputError for a length of a path that is not above zero."""
    if value is None:
        raise InputError(
            f"{what} of spring {name} is open",
            where=f"spring {name}",
            hint=f"give it, free it in `shape` as {name}.path.{what}, or derive it by `start`",
        )
    if np.ndim(value) == 0 and not np.real(value) > 0:
        raise InputError(f"{what} of spring {name} is {value:g} m, it must be above 0", where=f"spring {name}")


def read_joint(spec: mujoco.MjSpec, name: str, joint: str) -> mujoco.MjsTendon:
    """A tendon whose length is a joint's position."""
    tendon = spec.add_tendon(name=name)
    tendon.wrap_joint(joint, 1.0)
    return tendon


__all__ = [
    "NOTHING",
    "SLIDING",
    "add_body",
    "add_frame",
    "add_joint",
    "add_pin",
    "add_point_mass",
    "add_shaft",
    "add_site",
    "mass",
    "positive_length",
    "read_joint",
    "weigh",
    "zero_length",
]
