"""The tensions that cables may have, and small linear programs over them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError
from equipoise.platform import platform_of
from equipoise.states import States

OPTIONS = {
    "output_flag": False,
    "presolve": "off",
    "solver": "simplex",
    "primal_feasibility_tolerance": 1e-10,
    "dual_feasibility_tolerance": 1e-10,
}


def allowed(
    states: States, t_min: float | Sequence[float] | None, t_max: float | Sequence[float] | None
) -> tuple[Array, Array]:
    """Least and largest tension (m,) per cable, N: what is given, else what the platform says.

    Raises InputError for limits that are reversed or not one per cable.
    """
    platform = platform_of(states.mechanism)
    count = len(platform.cables)
    low, high = (
        np.asarray(said if given is None else given, dtype=float)
        for given, said in ((t_min, platform.t_min or 0.0), (t_max, platform.t_max or np.inf))
    )
    for value, what in ((low, "t_min"), (high, "t_max")):
        if value.shape not in ((), (count,)):
            raise InputError(f"{value.size} values of {what} for {count} cables", where="tension limits")
    low, high = np.broadcast_to(low, count), np.broadcast_to(high, count)
    crossed = np.flatnonzero(~(low <= high))
    if len(crossed):
        cable = crossed[0]
        raise InputError(
            f"t_min {low[cable]:g} N is above t_max {high[cable]:g} N",
            where="tension limits",
            hint=f"of {platform.cables[cable]}: lower t_min or raise t_max",
        )
    return low, high


def roomiest(W: Array, w: Array, low: Array, high: Array, *, above: bool = True) -> float:
    """max s with W t + w = 0, low + s <= t <= high - s (high alone unless `above`).

    Minus infinity where no t holds the load, infinity where room has no end.
    """
    import highspy

    n, m = W.shape
    bounded = np.isfinite(high)
    rows = np.zeros((n + m + int(bounded.sum()), m + 1))
    rows[:n, :m] = W
    rows[n : n + m, :m] = np.eye(m)
    rows[n : n + m, m] = -1.0
    rows[n + m :, :m] = np.eye(m)[bounded]
    rows[n + m :, m] = 1.0 if above else 0.0
    floor = np.concatenate([-w, low, np.full(int(bounded.sum()), -np.inf)])
    roof = np.concatenate([-w, np.full(m, np.inf), high[bounded]])
    solver = highspy.Highs()
    for option, value in OPTIONS.items():
        solver.setOptionValue(option, value)
    count = len(rows)
    # Without a roof the room has no end: what is more than enough ends it.
    most = np.inf if bounded.any() else 1.0 + 2.0 * float(np.abs(low).max()) + float(np.abs(w).max())
    solver.passModel(
        m + 1, count, rows.size, 1, -1, 0.0,
        np.append(np.zeros(m), 1.0), np.full(m + 1, -np.inf), np.append(np.full(m, np.inf), most), floor, roof,
        np.arange(m + 2, dtype=np.int32) * count, np.tile(np.arange(count, dtype=np.int32), m + 1),
        rows.T.ravel(), np.zeros(m + 1, dtype=np.int32),
    )  # fmt: skip
    solver.run()
    if solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return -np.inf
    room = float(solver.getSolution().col_value[m])
    return room if room < most else np.inf
