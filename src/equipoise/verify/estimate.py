"""Where no bound is at hand: the peak between the samples, estimated from local slopes and sampled curvature."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from equipoise.affine import Array
from equipoise.verify.boxes import Found, Judged, search

STEP = 1e-3
SAFETY = 1.5
SAMPLES = 128
MOST = 6_000
CHUNK = 512


def estimate(
    residual: Callable[[Array], Array],
    box: Array,
    columns: Sequence[int],
    peaks: Sequence[float],
    relative: float,
    of_load: float,
    budget: int,
) -> list[Found]:
    """An estimate of max |r_j| over a box for each of `columns`, by branch and bound with

        |r_j(q)| <= |r_j(c)| + sum_i |dr_j/dq_i(c)| h_i + sum_ik M_jik h_i h_k / 2

    slopes by central differences; M is 1.5 times the largest second derivative at random positions, which is
    why this is no bound. residual maps positions (N, nd) to efforts (S, N, nd); peaks are values known to be
    reached. Raises LoopError where loops do not close in the box.
    """
    swept = np.flatnonzero(np.ptp(box, axis=1) > 0)
    rng = np.random.default_rng(1)
    samples = box[:, 0] + rng.random((SAMPLES, len(box))) * np.ptp(box, axis=1)
    step = STEP * np.minimum(1.0, np.ptp(box, axis=1)[swept])

    def local(q: Array) -> tuple[Array, Array]:
        """Efforts (S, N, R) and slopes (S, N, R, n) of the columns."""
        shifts = np.concatenate([[0.0 * q[0]], *(_pair(len(box), i, h) for i, h in zip(swept, step, strict=True))])
        around = residual((q + shifts[:, None]).reshape(-1, len(box)))[..., columns]
        around = around.reshape(len(around), len(shifts), len(q), -1)
        slopes = (around[:, 1::2] - around[:, 2::2]) / (2 * step[:, None, None])
        return around[:, 0], np.moveaxis(slopes, 1, -1)

    bend = np.stack(
        [
            np.abs(local(samples + _pair(len(box), i, h)[0])[1] - local(samples + _pair(len(box), i, h)[1])[1])
            .max(axis=(0, 1)) / (2 * h)
            for i, h in zip(swept, step, strict=True)
        ] or [np.zeros((len(columns), 0))],
        axis=1,
    )  # fmt: skip
    loads = np.abs(residual(samples)).max(axis=(0, 1))
    found = []
    for row, column in enumerate(columns):
        curvature = SAFETY * np.maximum(bend[row], np.swapaxes(bend[row], 0, 1)) if len(swept) else bend[row]

        def enclose(centre: Array, half: Array, row: int = row, curvature: Array = curvature) -> Judged:
            q = np.tile(box.mean(axis=1), (len(centre), 1))
            q[:, swept] = centre
            value, slope = local(q)
            linear = np.abs(slope[:, :, row]) * half
            second = np.einsum("ci,ik,ck->ci", half, curvature, half) / 2 if len(swept) else half
            upper = np.abs(value[:, :, row]) + linear.sum(axis=-1) + second.sum(axis=-1)
            return Judged(
                upper.max(axis=0),
                np.abs(value[:, :, row]).max(axis=0),
                (linear.max(axis=0) + second).argmax(axis=1) if len(swept) else np.zeros(len(centre), dtype=int),
            )

        absolute = of_load * float(loads[column])
        found.append(search(enclose, box[swept], peaks[row], relative, absolute, min(budget, MOST), CHUNK))
    return found


def _pair(width: int, joint: int, step: float) -> Array:
    pair = np.zeros((2, width))
    pair[:, joint] = step, -step
    return pair
