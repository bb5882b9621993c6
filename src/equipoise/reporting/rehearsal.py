"""What MuJoCo says of a motion, in words and tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from equipoise.reporting.markup import Raw, element, join, small, table
from equipoise.reporting.numbers import plain, sig

if TYPE_CHECKING:
    from equipoise.verification.findings import MotionCheck


def motion_words(found: MotionCheck) -> list[str]:
    """What inverse dynamics, a forward simulation and a floating base say of the motion; faults first."""
    worst = max(error.relative for error in found.errors.values())
    words = [f"in motion MuJoCo's inverse dynamics agrees to {sig(worst, 2)} of the load"]
    for name, (coarse, fine) in found.differences.items():
        words.append(
            f"simulated {name} differs by {sig(coarse.error, 2)} {coarse.unit} at {sig(1e3 * found.steps[0], 2)} ms "
            f"steps, by {sig(fine.error, 2)} at {sig(1e3 * found.steps[1], 2)} ms"
        )
    (shift, turn), (_, (still, rest)) = found.base.before, found.base.after
    words.append(
        f"a free base of {plain(found.base.mass, 3)} kg moves {sig(1e3 * still, 2)} mm and {sig(1e3 * rest, 2)} mrad, "
        f"without the parts {sig(1e3 * shift, 2)} mm and {sig(1e3 * turn, 2)} mrad"
    )
    return [*found.faults, *words]


def motion_table(check: MotionCheck) -> Raw:
    """The motion in MuJoCo: inverse dynamics, simulations at two time steps, a base that floats."""
    inverse = [[join([name, small(error.unit)]), sig(error.error, 2), sig(error.relative, 2)]
               for name, error in check.errors.items()]  # fmt: skip
    forward = [
        [join([name, small(fine.unit)]), sig(coarse.error, 2), sig(fine.error, 2), sig(fine.relative, 2)]
        for name, (coarse, fine) in check.differences.items()
    ]
    steps = [f"step {sig(1e3 * step, 3)} ms" for step in check.steps]
    base = check.base
    rows = [
        [word, sig(1e3 * shift, 3), sig(1e3 * turn, 3)]
        for word, (shift, turn) in (
            ("without the parts", base.before),
            (f"with them, {steps[0]}", base.after[0]),
            (f"with them, {steps[1]}", base.after[1]),
        )
    ]
    said = (
        f"The motion, on the saved model with every part as a body: MuJoCo's inverse dynamics at {check.instants} "
        "instants; a simulation driven by the motors' efforts, whose error falls with the time step; and, without "
        f"weight, on a floating base of {plain(base.mass, 3)} kg, radius of gyration {plain(base.radius, 3)} m."
    )
    return join(
        [
            element(
                "p", said, " ".join(f"{fault}." for fault in check.faults), class_="warning" if check.faults else ""
            ),
            table(["inverse dynamics", "difference", "relative"], inverse, numbers=1),
            table(["simulation", *steps, "relative"], forward, numbers=1),
            table(["floating base", "shift [mm]", "turn [mrad]"], rows, numbers=1),
        ]
    )
