"""The file a user takes away: the mechanism with its parts as MJCF, all digits kept, its meshes beside it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.flywheel import Flywheel
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.errors import EquipoiseError, InputError
from equipoise.kinematics import kinematics
from equipoise.mechanism import Mechanism, compile_spec
from equipoise.models.notices import listen, refusals
from equipoise.states import States
from equipoise.verification.postures import by_name

KEY = "balanced"
"""The keyframe in which the loops of the added parts are closed."""


def installed(design: Design) -> mujoco.MjSpec:
    """A copy of the mechanism's spec with every part of the design in it; the mechanism stays as it is."""
    spec = design.mechanism.spec.copy()
    for balancer in design.balancers:
        where = f"{balancer.name} in {design.mechanism.name}"
        with refusals(where, "a part's name must not occur in the model: rename the part"):
            if isinstance(balancer, Flywheel):
                _add_wheel(spec, design, balancer)
            balancer.install(spec, design.values, design.states)
    _close_keys(spec, design)
    return spec


def _add_wheel(spec: mujoco.MjSpec, design: Design, wheel: Flywheel) -> None:
    """The flywheel as a body on a hinge `<name>_joint` at the world's origin, with the inertia that its law found."""
    law = design.flywheel_law(wheel)
    inertia = law.inertia if law is not None else wheel.inertia
    if inertia is None:
        return
    quat = np.empty(4)
    mujoco.mju_quatZ2Vec(quat, wheel.normal)
    body = spec.worldbody.add_body(name=wheel.name)
    body.explicitinertial, body.mass = True, max(wheel.mass, 1e-9 * inertia)
    body.ipos, body.inertia, body.iquat = [0.0, 0.0, 0.0], [inertia / 2, inertia / 2, inertia], quat.tolist()
    joint = body.add_joint(name=f"{wheel.name}_joint", axis=wheel.normal.tolist())
    joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE


def _close_keys(spec: mujoco.MjSpec, design: Design) -> None:
    """Give the model's keyframes the positions of the joints that were added, and one of its own that is closed.

    Where the parts do not close at a keyframe of the mechanism, its added joints stay at zero.
    """
    mechanism, original = design.mechanism, design.mechanism.model
    middle = int(np.abs(design.sweep.poses - design.sweep.poses.mean(axis=0)).sum(axis=1).argmin())
    poses = {key.name: original.key_qpos[index] for index, key in enumerate(mechanism.spec.keys)}
    first = mechanism.states(design.sweep.at(design.sweep.coordinates[[middle]]))
    added = _positions(design, first)
    if not added:
        return
    for key in list(spec.keys):
        spec.delete(key)
    model = compile_spec(spec, mechanism.name)
    places, _ = by_name(model, original)
    standing = {KEY: first.kin.q[0]} | {name: q for name, q in poses.items() if name != KEY}
    for name, own in standing.items():
        q = model.qpos0.copy()
        q[places] = own
        try:
            for joint, value in _positions(design, _standing(mechanism, own)).items():
                q[model.joint(joint).qposadr[0]] = value[0]
        except InputError:
            pass
        spec.add_key(name=name, qpos=q.tolist())


def _positions(design: Design, states: States) -> dict[str, Array]:
    found: dict[str, Array] = {}
    for balancer in design.balancers:
        if isinstance(balancer, Spring):
            found |= balancer.path.positions(states, balancer.name)
    return found


def _standing(mechanism: Mechanism, q: Array) -> States:
    """The states of one posture (nq,), closed or not."""
    driven = q[None, mechanism.model.jnt_qposadr[mechanism.driven_ids]]
    still = np.zeros((1, mechanism.model.nv, len(mechanism.driven)))
    return States(mechanism, driven, np.ones(1), (), np.zeros((1, 0)), kinematics(mechanism, q[None]), still)


def save(design: Design, folder: Path) -> Path:
    """Write `<mechanism>_balanced.xml` and the meshes it needs to a folder; returns the file.

    Raises ModelError where MuJoCo refuses the model, InputError where the folder cannot be written.
    """
    path = Path(folder) / f"{file_name(design.mechanism.name)}_balanced.xml"
    spec = installed(design)
    # MuJoCo's default prints six digits: wrong by 5e-4 N m on a UR10.
    spec.compiler.savecompiled = False
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _bring_assets(spec, design.mechanism.source, path)
        with listen(), refusals(design.mechanism.name):
            text = spec.to_xml()
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot write the model: {error.strerror or error}", where=str(path)) from None
    return path


def reload(path: Path) -> mujoco.MjSpec:
    """Read a saved model; raises ModelError naming what MuJoCo refuses."""
    if not Path(path).is_file():
        raise InputError("there is no such model", where=str(path), hint="save the design first, or leave `model` out")
    with refusals(Path(path).name):
        spec = mujoco.MjSpec.from_file(str(path))
    # Lengths of muscles, which the compiler would find by simulation, do not matter to statics.
    spec.compiler.LRopt.mode = int(mujoco.mjtLRMode.mjLRMODE_NONE)
    return spec


def file_name(name: str) -> str:
    """A name that any file system takes."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "_" for letter in name).strip(".") or "model"


def _bring_assets(spec: mujoco.MjSpec, source: Path | None, path: Path) -> None:
    """Copy meshes, height fields, skins and textures beside the model, so that the folder can be moved."""
    origin = Path(source).resolve().parent if source else Path.cwd()
    beside = f"{path.stem}_assets"
    taken: dict[str, Path] = {}
    for item, field, folder in _asset_files(spec):
        value = getattr(item, field)
        names = [value] if isinstance(value, str) else list(value)
        moved = []
        for name in names:
            where = origin / folder / (Path(name).name if spec.strippath else name)
            moved.append(_copy(where, path.parent / beside, taken) if name else name)
        setattr(item, field, moved[0] if isinstance(value, str) else moved)
    if taken:
        spec.modelfiledir = str(path.parent.resolve())
        spec.compiler.meshdir = spec.compiler.texturedir = beside


def _asset_files(spec: mujoco.MjSpec) -> Iterator[tuple[Any, str, str]]:
    """Every element that reads a file, the field that names it and the folder it is kept in."""
    for items in (spec.meshes, spec.hfields, spec.skins):
        for item in items:
            if item.file:
                yield item, "file", spec.compiler.meshdir
    for item in spec.textures:
        if item.file:
            yield item, "file", spec.compiler.texturedir
        if any(item.cubefiles):
            yield item, "cubefiles", spec.compiler.texturedir


def _copy(source: Path, folder: Path, taken: dict[str, Path]) -> str:
    source = source.resolve()
    if not source.is_file():
        raise EquipoiseError(f"the model needs {source.name}, which is no longer there", where=str(source.parent))
    number, name = 1, source.name
    while taken.get(name, source) != source:
        number += 1
        name = f"{source.stem}_{number}{source.suffix}"
    # A cubic texture may name one file twice, and a design may be saved where its model lies.
    if name not in taken and (folder / name).resolve() != source:
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, folder / name)
    taken[name] = source
    return name
