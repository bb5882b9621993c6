"""What a loop that does not close has to say: the pose, the gap, the singular value and what to do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from equipoise.affine import Array
from equipoise.errors import LoopError
from equipoise.loops.branch import Branch
from equipoise.loops.posture import Evaluator
from equipoise.loops.roadmap import Blocked
from equipoise.loops.walk import CLOSED, Closed, Loop

if TYPE_CHECKING:
    from equipoise.mechanism import Mechanism


def gap(loop: Loop, closed: Closed) -> Array:
    """Largest gap (N,) of any one equality, m; angles count at the characteristic length."""
    starts = np.cumsum([0] + [len(item.factor) for item in loop.equalities[:-1]])
    return loop.reach * np.sqrt(np.add.reduceat(closed.error**2, starts, axis=1).max(axis=1))


def pose_text(mechanism: Mechanism, driven: Array, only: NDArray[np.int_] | None = None) -> str:
    """Driven positions (nd,) in words, degrees or millimetres; only names the columns to mention."""
    columns = range(len(driven)) if only is None else [int(column) for column in only]
    slides = [unit == "N" for unit in mechanism.driven_units]
    values = [f"{driven[i] * 1e3:.4g} mm" if slides[i] else f"{np.degrees(driven[i]):.4g} deg" for i in columns]
    return ", ".join(f"{mechanism.driven[i]} = {value}" for i, value in zip(columns, values, strict=True))


def advice(mechanism: Mechanism, branch: Branch, limit: str = "") -> str:
    """What to try when poses do not close."""
    joints = " or ".join(mechanism.driven[i] for i in branch.places[branch.curved])
    return f"reduce the range of {joints}{limit}, name another keyframe as `branch`, or lower the margin `singularity`"


def blocked_way(
    mechanism: Mechanism, branch: Branch, evaluate: Evaluator, blocked: Blocked, driven: Array
) -> LoopError:
    """What stopped the walk to a pose: no closed posture there, or a singularity on every way."""
    loop, columns = branch.loop, branch.places[branch.curved]
    best = _least(loop, evaluate, loop.move(blocked.last.q, blocked.ahead[None], loop.driven))
    width = float(gap(loop, best)[0])
    reached = driven.copy()
    reached[branch.places] = blocked.stop * loop.columns[loop.driven]
    pose, stop = pose_text(mechanism, driven, columns), pose_text(mechanism, reached, columns)
    if width > CLOSED * loop.reach:
        what = f"the loops do not close at {pose}: the gap is {width * 1e3:.4g} mm"
    else:
        what = f"a singularity bars the way to {pose} (the gap there would be 0 mm)"
    more = f"; {blocked.others} more poses are barred or untried" if blocked.others else ""
    return LoopError(
        f"{what}; the branch ends near {stop}, where the singular value is {blocked.lowest:.3g} "
        f"(margin {mechanism.singularity:g}){more}",
        where=mechanism.name,
        hint=advice(mechanism, branch, f" to end before {stop}" if len(columns) == 1 else ""),
    )


def _least(loop: Loop, evaluate: Evaluator, q: Array) -> Closed:
    """The posture of least squared gap near q (1, nq) with the driven dofs held, by Levenberg-Marquardt."""
    now, damping = loop.linearise(evaluate, q), 1e-3
    for _ in range(100):
        slope, error = now.slope[0], now.error[0]
        normal = slope.T @ slope + damping * np.eye(slope.shape[1])
        step = -np.linalg.solve(normal, slope.T @ error)
        there = loop.linearise(evaluate, loop.move(now.q, step[None], loop.dependent))
        better = np.linalg.norm(there.error) < np.linalg.norm(error)
        now, damping = (there, 0.3 * damping) if better else (now, 5.0 * damping)
        if np.abs(step).max() < 1e-9 or now.worst[0] < 1e-13:
            break
    return now
