"""From a robot file to a Mechanism: the reader, the reference posture, the driven joints, the audit."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, ModelError, nearest
from equipoise.mechanism import Mechanism, compile_spec
from equipoise.models.audit import feature_remarks, mass_remarks, refuse_nonsense
from equipoise.models.driven import choose_driven
from equipoise.models.mjcf import read_mjcf
from equipoise.models.notices import listen
from equipoise.models.packages import resolve
from equipoise.models.urdf import read_urdf
from equipoise.models.xmlfile import read_xml

_UNNAMED = ("", "MuJoCo Model")


def load(
    model: str | Path,
    *,
    driven: Sequence[str] | None = None,
    gravity: Sequence[float] | None = None,
    branch: str | None = None,
    search: tuple[str | Path, ...] = (),
) -> Mechanism:
    """Read a URDF or MJCF robot; see `Mechanism.load` for the arguments.

    Raises ModelError for a file that cannot be read, InputError for an unknown joint or keyframe.
    """
    path = resolve(model, search)
    where = path.name
    with listen() as said:
        root = read_xml(path, where)
        if root.tag == "robot":
            spec, remarks = read_urdf(root, where)
        elif root.tag in ("mujoco", "mujocoinclude"):
            spec, remarks = read_mjcf(path, root, where)
        else:
            raise ModelError(f"the root element is <{root.tag[:40]}>: neither URDF nor MJCF", where=where,
                             hint="a URDF begins with <robot>, an MJCF file with <mujoco>")  # fmt: skip
        if gravity is not None:
            _set_gravity(spec, gravity, where)
        # MuJoCo's default prints six digits when the model is saved.
        spec.compiler.savecompiled = False
        # For muscles the compiler would simulate until their length settles, which a bad file never does.
        spec.compiler.LRopt.mode = int(mujoco.mjtLRMode.mjLRMODE_NONE)
        compiled = compile_spec(spec, where)
        refuse_nonsense(compiled, where)
        if _take_motor_limits(spec, compiled):
            compiled = compile_spec(spec, where)
        reference = _reference(compiled, branch, where)
        choice = choose_driven(compiled, reference, driven, where)
        if choice.loose:
            _lock(spec, compiled, choice.loose, reference)
            compiled = compile_spec(spec, where)
    audit = [*mass_remarks(compiled), *remarks, *feature_remarks(compiled, gravity is not None)]
    if not choice.driven:
        why = "; ".join([*remarks, *choice.remarks(compiled, reference)]) or "the file has no hinge and no slide"
        hint = "give joints a range (lower < upper) or the type continuous, or name them in `driven`"
        raise ModelError(f"nothing is driven: {why}", where=where, hint=hint)
    name = spec.modelname if spec.modelname not in _UNNAMED else path.stem
    audit += choice.remarks(compiled, reference)
    return Mechanism(
        spec=spec,
        model=compiled,
        driven=choice.driven,
        reference=reference,
        name=name,
        remarks=tuple(dict.fromkeys([*audit, *(f"MuJoCo: {line}" for line in said)])),
        source=path.absolute(),
    )


def _set_gravity(spec: mujoco.MjSpec, gravity: Sequence[float], where: str) -> None:
    try:
        vector = np.array([float(value) for value in gravity])
    except (TypeError, ValueError):
        vector = np.zeros(0)
    if vector.shape != (3,) or not np.all(np.abs(vector) < 1e6):
        raise InputError(f"gravity is {gravity!r}", where=where, hint="give three numbers in m/s^2: [0, 0, -9.81]")
    spec.option.gravity = vector
    spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)


def _lock(spec: mujoco.MjSpec, model: mujoco.MjModel, joints: tuple[str, ...], reference: Array) -> None:
    """Hold joints of a loop by an equality: else the loop would have more freedom than driven joints."""
    for name in joints:
        place = model.jnt_qposadr[model.joint(name).id]
        lock = spec.add_equality()
        lock.type = mujoco.mjtEq.mjEQ_JOINT
        lock.objtype = mujoco.mjtObj.mjOBJ_JOINT
        lock.name1 = name
        data = np.zeros_like(lock.data)
        data[0] = reference[place] - model.qpos0[place]
        lock.data = data


def _reference(model: mujoco.MjModel, branch: str | None, where: str) -> Array:
    if branch is None:
        return np.array(model.qpos0)
    names = [model.key(index).name for index in range(model.nkey)]
    if not branch or branch not in names:
        raise InputError(f"there is no keyframe {branch!r}", where=where, hint=nearest(branch, [n for n in names if n]))
    return np.array(model.key_qpos[names.index(branch)])


def _take_motor_limits(spec: mujoco.MjSpec, model: mujoco.MjModel) -> bool:
    """Put what the file's actuators can give at most on joints that state no limit; whether any did."""
    limits: dict[int, float] = {}
    kinds = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    for index in range(model.nu):
        if model.actuator_trntype[index] in kinds:
            joint = int(model.actuator_trnid[index, 0])
            limits[joint] = limits.get(joint, 0.0) + _strongest(model, index)
    taken = False
    for joint, limit in limits.items():
        item = spec.joint(model.joint(joint).name)
        if item is not None and 0.0 < limit < 1e9 and not model.jnt_actfrclimited[joint]:
            item.actfrclimited = mujoco.mjtLimited.mjLIMITED_TRUE
            item.actfrcrange = [-limit, limit]
            taken = True
    return taken


def _strongest(model: mujoco.MjModel, index: int) -> float:
    """The largest force (N m or N) of an actuator at its joint; infinite where nothing bounds it."""
    gear = abs(float(model.actuator_gear[index, 0]))
    bounds = [np.inf]
    if model.actuator_forcelimited[index]:
        bounds.append(float(np.abs(model.actuator_forcerange[index]).max()))
    plain = (
        model.actuator_gaintype[index] == mujoco.mjtGain.mjGAIN_FIXED
        and model.actuator_biastype[index] == mujoco.mjtBias.mjBIAS_NONE
        and model.actuator_dyntype[index] == mujoco.mjtDyn.mjDYN_NONE
    )
    if plain and model.actuator_ctrllimited[index]:
        span = float(np.abs(model.actuator_ctrlrange[index]).max())
        bounds.append(span * abs(float(model.actuator_gainprm[index, 0])))
    return gear * min(bounds)
