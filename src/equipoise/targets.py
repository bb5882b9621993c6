"""What a command is pointed at: a problem file, a design, or a bare robot file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from equipoise.design import Design
from equipoise.errors import InputError
from equipoise.mechanism import Mechanism
from equipoise.problem import Problem, load_problem, model_problem

PROBLEM = (".yaml", ".yml")
MODEL = (".urdf", ".xml", ".mjcf")


@dataclass(frozen=True, eq=False)
class Target:
    """A problem; the design where it was solved already, with remarks; whether it is only a robot file."""

    problem: Problem
    design: Design | None = None
    remarks: tuple[str, ...] = ()
    bare: bool = False


def target_of(name: str) -> Target:
    """Read what a name means; raises InputError naming what is wrong with the file, place and next step."""
    kind = _kind(name)
    if kind == "model":
        return Target(model_problem(name), bare=True)
    if kind == "design":
        from equipoise.designfile import load_design

        problem, design, remarks = load_design(Path(name))
        return Target(problem, design, remarks)
    problem = load_problem(name)
    problem.check()
    return Target(problem)


def mechanism_of(name: str) -> Mechanism:
    """The mechanism alone: nothing else in the file needs to fit it, or be there."""
    if _kind(name) == "problem":
        return load_problem(name).mechanism
    return target_of(name).problem.mechanism


def _kind(name: str) -> str:
    path = Path(name)
    suffix = path.suffix.lower()
    if name.startswith("package:") or suffix in MODEL:
        return "model"
    if suffix == ".json":
        return "design"
    if suffix in PROBLEM:
        return "problem"
    try:
        with path.open("rb") as stream:
            start = stream.read(512).decode("utf-8", "replace").lstrip("\ufeff \t\r\n")
    except (OSError, ValueError):
        # The reader of problem files says what is missing, and what lies beside it.
        return "problem"
    return "model" if start.startswith("<") else "design" if start.startswith("{") else "problem"


def needs_problem(mechanism: Mechanism, address: str, verb: str) -> InputError:
    """Why a bare robot file is not enough, with a problem file to start from."""
    return InputError(
        f"`{verb}` needs a problem file: it says what may be added to the robot, where, and what counts. "
        f"This is one for {mechanism.name}, ready to edit:\n\n{snippet(mechanism, address)}",
        where=address,
        hint=f"save it as {mechanism.name}.yaml and run: equipoise {verb} {mechanism.name}.yaml",
    )


def snippet(mechanism: Mechanism, address: str) -> str:
    """A problem file for a robot: one ideal spring over the joint that gravity loads most."""
    from equipoise.verbs.analyze import analyze

    rows = analyze(mechanism).rows
    joint = max(rows, key=lambda name: (rows[name].unit == "N m", rows[name].peak))
    model = mechanism.model
    child = int(model.jnt_bodyid[mechanism.joint_id(joint)])
    parent = int(model.body_parentid[child])
    reach = round(0.3 * _size(mechanism, child), 3)
    # The fixed end goes above the joint, the other along the link; `shape` then moves both.
    data = mujoco.MjData(model)
    data.qpos = mechanism.reference
    mujoco.mj_kinematics(model, data)
    weight = float(np.linalg.norm(mechanism.gravity))
    up = -mechanism.gravity / weight if weight > 0 else np.array([0.0, 0.0, 1.0])
    first = model.body_pos[child] + reach * (up @ data.xmat[parent].reshape(3, 3))
    second = reach * _outwards(mechanism, child)
    lines = [
        f"mechanism: {{model: {address}}}",
        "sweep: {sobol: 2048, seed: 0}",
        "balancers:",
        f"  # [body, x, y, z] in the body's own frame, m; the joint between the two is {joint}",
        f"  - spring: {{name: s1, path: {{line: [{_point(mechanism, parent, first)}, "
        f"{_point(mechanism, child, second)}]}}, law: zero_free_length}}",
        "shape:",
    ]
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_quat[child])
    along = model.jnt_axis[mechanism.joint_id(joint)]
    for end, (place, axis) in enumerate(((first, turn.reshape(3, 3) @ along), (second, along))):
        for letter, value, share in zip("xyz", place, np.abs(axis), strict=True):
            # Along the joint's axis a point may slide without any effect on the joint.
            if share < 0.99:
                lines.append(f"  s1.path.line.{end}.{letter}: [{value - reach:.3g}, {value + reach:.3g}]")
    lines.append("objective: {goal: hold, norm: peak}")
    return "\n".join(lines)


def _point(mechanism: Mechanism, body: int, place: np.ndarray) -> str:
    numbers = ", ".join(f"{round(value, 4) + 0.0:g}" for value in place)
    return f"[{mechanism.model.body(body).name}, {numbers}]"


def _size(mechanism: Mechanism, body: int) -> float:
    """How far the farthest body that hangs on this one is from it, m."""
    model = mechanism.model
    distance = {body: 0.0}
    for other in range(body + 1, model.nbody):
        parent = int(model.body_parentid[other])
        if parent in distance:
            distance[other] = distance[parent] + float(np.linalg.norm(model.body_pos[other]))
    return max(distance.values()) or 0.3


def _outwards(mechanism: Mechanism, body: int) -> np.ndarray:
    """The direction from a body's joint to the next body, or to its centre of mass, in its own frame."""
    model = mechanism.model
    places = [model.body_pos[i] for i in range(body + 1, model.nbody) if model.body_parentid[i] == body]
    for place in [*sorted(places, key=np.linalg.norm, reverse=True), model.body_ipos[body]]:
        length = float(np.linalg.norm(place))
        if length > 1e-6:
            return np.asarray(place) / length
    return np.array([1.0, 0.0, 0.0])
