"""A made-up catalogue of extension springs, the same for the same seed: no maker's numbers are in it.

Run: python benchmarks/synthetic_catalogue.py 1300 > examples/stock_springs.csv
"""

from __future__ import annotations

import sys

import numpy as np

import equipoise as eq

HEADER = (
    "Part number", "Wire [mm]", "Outside diameter [mm]", "Free length [mm]", "Rate [N/mm]", "Initial tension [N]",
    "Max length [mm]", "Max load [N]", "Weight [g]", "Material",
)  # fmt: skip


def rows(count: int, seed: int = 0, wire: tuple[float, float] = (0.5, 5.0)) -> list[tuple[str, ...]]:
    """Rows of springs that could be wound of EN 10270-1 SH, with numbers rounded as catalogues round them."""
    rng = np.random.default_rng(seed)
    sizes = eq.preferred_sizes()
    sizes = sizes[(sizes >= wire[0] * 1e-3) & (sizes <= wire[1] * 1e-3)]
    d = rng.choice(sizes, count)
    diameter = np.round(rng.uniform(5, 14, count) * d, 4)
    coils = np.round(rng.uniform(12, 90, count), 1)
    bare = eq.ExtensionSpring(d, diameter, coils)
    tension = rng.uniform(0.2, 0.9, count) * bare.largest_tension
    made = eq.ExtensionSpring(d, diameter, coils, initial_tension=tension)
    # Catalogues stay some way below what the wire would bear.
    load = tension + 0.9 * (made.largest_force - tension)
    longest = made.own_length + (load - tension) / made.k
    columns = (
        (1e3 * d, 4), (1e3 * (diameter + d), 4), (1e3 * made.own_length, 5), (made.k / 1e3, 4), (tension, 3),
        (1e3 * longest, 5), (load, 4), (1e3 * made.own_mass, 3),
    )  # fmt: skip
    cells = [[f"{value:.{digits}g}" for value in values] for values, digits in columns]
    order = np.argsort(d * 1e6 + diameter, kind="stable")
    return [(f"SY-{k + 1:04d}", *(column[i] for column in cells), "EN 10270-1 SH") for k, i in enumerate(order)]


def text(count: int, seed: int = 0) -> str:
    """The catalogue as CSV."""
    lines = [f"# synthetic, seed {seed}: no maker sells these", ",".join(HEADER)]
    return "\n".join([*lines, *(",".join(row) for row in rows(count, seed))]) + "\n"


if __name__ == "__main__":
    sys.stdout.write(text(int(sys.argv[1])))
