"""The mass audit: what a robot file says that cannot be, or that statics leaves out."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np

from equipoise.errors import ModelError
from equipoise.models.inertia import TOKEN_MASS
from equipoise.models.notices import some

HEAVY = 1000.0
"""kg: the heaviest industrial arms weigh about this; a file with more is a file with placeholders."""

_LIGHT = 1e-9
_FAR = 1e6
_HUGE = 1e9


def refuse_nonsense(model: mujoco.MjModel, where: str) -> None:
    """Raise ModelError for compiled numbers that are not finite, masses below zero or bodies a million metres away."""
    for body in range(model.nbody):
        name = model.body(body).name
        shape = np.concatenate([model.body_pos[body], model.body_quat[body], model.body_ipos[body]])
        mass = np.concatenate([[model.body_mass[body]], model.body_inertia[body]])
        if not (np.all(np.isfinite(shape)) and np.abs(shape).max() < _FAR):
            raise ModelError(f"body {name!r} has a position or orientation that is not usable", where=where,
                             hint="look for NaN or wrong exponents")  # fmt: skip
        if not (np.all(np.isfinite(mass)) and mass.min() >= 0.0 and mass.max() < 1e12):
            raise ModelError(f"body {name!r} has the mass {mass[0]:g} kg or inertia that cannot be", where=where,
                             hint="give positive numbers")  # fmt: skip
    for joint in range(model.njnt):
        values = np.concatenate([model.jnt_axis[joint], model.jnt_pos[joint], model.jnt_range[joint]])
        if not np.all(np.isfinite(values)):
            raise ModelError(f"joint {model.joint(joint).name!r} has an axis, place or range that is not finite",
                             where=where)  # fmt: skip
    rest = {
        "the zero posture": model.qpos0,
        "a keyframe": model.key_qpos,
        "an equality": model.eq_data,
        "gravity": model.opt.gravity,
    }
    for what, values in rest.items():
        if not np.all(np.abs(values) < _HUGE):  # also false for NaN
            raise ModelError(f"{what} holds a number that is not finite or beyond {_HUGE:g}", where=where)


def mass_remarks(model: mujoco.MjModel) -> Iterator[str]:
    """Sentences about masses (kg) that a reader of results must know."""
    masses = model.body_mass
    total = float(masses.sum())
    heaviest = int(np.argmax(masses))
    if total > HEAVY:
        yield (
            f"total mass {total:,.0f} kg: a robot does not weigh that; the heaviest body is "
            f"{model.body(heaviest).name} with {masses[heaviest]:,.0f} kg; put it right before trusting any torque"
        )
    moving = model.body_weldid != 0
    if not masses[moving].sum() > 1e-6:
        yield "nothing that moves has a mass: there is no weight to balance"
        return
    # A token mass that a reader put there has been remarked on already.
    by_group = np.bincount(model.body_weldid, weights=masses, minlength=model.nbody)
    empty = [b for b in range(1, model.nbody) if model.body_jntnum[b] and TOKEN_MASS < by_group[b] < _LIGHT]
    # Several bodies at one place make a joint of several axes; only the last of them needs a mass.
    ends = set(range(model.nbody)) - {int(model.body_parentid[b]) for b in range(1, model.nbody)}
    bare = [model.body(b).name for b in empty if b in ends]
    if bare:
        yield f"less than {_LIGHT:g} kg at the end of a chain: {some(bare)}; check that their weight is not missing"


def feature_remarks(model: mujoco.MjModel, gravity_given: bool) -> Iterator[str]:
    """Sentences about features of the file that count, or that are left out."""
    if np.any(model.body_gravcomp):
        lifted = [model.body(b).name for b in np.flatnonzero(model.body_gravcomp)]
        yield f"gravcomp is ignored, the weight counts in full: {some(lifted)}"
    stiff = [model.joint(j).name for j in range(model.njnt) if np.any(model.jnt_stiffness[j])]
    cords = [model.tendon(t).name or f"tendon {t}" for t in range(model.ntendon) if np.any(model.tendon_stiffness[t])]
    if stiff or cords:
        yield f"springs of the file count as part of the mechanism: {some([*stiff, *cords])}"
    if np.any(model.actuator_dyntype == mujoco.mjtDyn.mjDYN_MUSCLE):
        yield "muscles of the file do not act"
    if model.nmocap:
        yield "mocap bodies stay where the file puts them"
    if not gravity_given and not np.any(model.opt.gravity):
        yield "gravity is zero in the file: nothing to hold unless `gravity` is given"
    elif model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY):
        yield "gravity is switched off in the file"
