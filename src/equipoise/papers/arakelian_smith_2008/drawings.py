"""Figures 6 to 8 and 10 and Table 2 from our computation."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

import equipoise as eq
from equipoise.affine import Array
from equipoise.papers.arakelian_smith_2008 import model
from equipoise.papers.arakelian_smith_2008.model import COUNTER_ROTATED, EXACT, LEGS, SLENDER, L, thrice
from equipoise.papers.paper import Drawing
from equipoise.reporting import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

EVERY = 3


def _axes(up: str, height: float = 3.8) -> tuple[Figure, Axes]:
    made = style.figure(7.6, height)
    axes = made.add_subplot()
    axes.set_xlabel("time, s")
    axes.set_ylabel(up)
    axes.set_xlim(0, model.T)
    axes.axhline(0.0, color=style.MUTED, lw=0.8)
    return made, axes


@functools.cache
def bearings() -> tuple[tuple[str, ...], Array]:
    """Names and forces (N, 3, 3) of the base bearings with counterweights and gears."""
    mechanism = eq.rrr3(
        model.PIVOTS, model.PINS, thrice(L), thrice(L), pose=model.START, gravity=(0, 0, 0),
        crank_masses=thrice(EXACT.crank[0]), crank_coms=thrice((EXACT.crank[1], 0.0)),
        crank_inertias=thrice(EXACT.crank[2]),
        rod_masses=thrice(EXACT.rod[0]), rod_coms=thrice((EXACT.rod[1], 0.0)), rod_inertias=thrice(EXACT.rod[2]),
        platform_mass=model.PLATFORM, platform_inertia=EXACT.platform,
    )  # fmt: skip
    states = model.states()
    at = mechanism.states(model.sweep(samples=(len(states) - 1) // EVERY + 1))
    found = eq.bearing_forces(at, model.rotors(COUNTER_ROTATED))
    base = [k for k, bearing in enumerate(found.bearings) if bearing.on_base]
    return tuple(found.bearings[k].name for k in base), found.force[:, base]


def force(axis: int) -> Figure:
    """Figs. 6 and 7: the three base bearings, and what they add up to."""
    made, axes = _axes(f"force along {'X' if axis == 0 else 'Y'}, N")
    _, forces = bearings()
    time = model.time()[::EVERY]
    for leg in LEGS:
        axes.plot(time, forces[:, leg - 1, axis], color=style.PARTS[leg - 1], lw=1.4, label=f"bearing O{leg}")
    axes.plot(model.time(), model.base(SLENDER)[0][:, axis], "--", color=style.BEFORE, label="sum, bare links")
    axes.plot(time, forces[..., axis].sum(axis=1), color=style.AFTER, lw=2.4, label="sum, balanced")
    made.legend(loc="outside right upper")
    return made


def moments() -> Figure:
    """Fig. 8: the two parts apart, and their sum."""
    made, axes = _axes("moment, N m")
    reactions = model.torques(COUNTER_ROTATED).sum(axis=1)
    total = model.base(COUNTER_ROTATED)[1]
    axes.plot(model.time(), total - reactions, color=style.PARTS[0], label="bearing forces")
    axes.plot(model.time(), reactions, color=style.PARTS[1], label="input torques")
    axes.plot(model.time(), total, color=style.AFTER, lw=2.4, label="both")
    made.legend(loc="outside right upper")
    return made


def rotation() -> Figure:
    """Fig. 10: acceleration, speed and angle of the flywheel."""
    law = model.law()
    made = style.figure(7.6, 6.4)
    rows = made.subplots(3, 1, sharex=True)
    for axes, values, words in zip(
        rows,
        (law.acceleration, law.speed, law.angle),
        ("acceleration, rad/s²", "speed, rad/s", "angle, rad"),
        strict=True,
    ):
        axes.plot(law.time, values, color=style.AFTER)
        axes.axhline(0.0, color=style.MUTED, lw=0.8)
        axes.set_ylabel(words)
    rows[-1].set_xlabel("time, s")
    rows[-1].set_xlim(0, model.T)
    return made


def accelerations() -> Figure:
    """Table 2: links 2i, links 3i and the platform."""
    made, axes = _axes("angular acceleration, rad/s²", 4.2)
    _, _, pull = model.angles()
    for leg in LEGS:
        colour = style.PARTS[leg - 1]
        axes.plot(model.time(), pull[:, leg - 1], "--", color=colour, lw=1.2, label=f"link 2{leg}")
        axes.plot(model.time(), pull[:, leg + 2], color=colour, label=f"link 3{leg}")
    axes.plot(model.time(), pull[:, 6], color=style.INK, label="platform")
    axes.set_ylim(-1.15 * np.abs(pull).max(), 1.15 * np.abs(pull).max())
    made.legend(loc="outside right upper")
    return made


DRAWINGS = (
    Drawing("Figure 6", "Base bearings along X with counterweights and gears: they add up to nothing.",
            functools.partial(force, 0)),
    Drawing("Figure 7", "Base bearings along Y.", functools.partial(force, 2)),
    Drawing("Figure 8", "Moment of the bearing forces and reactions of the input torques, apart and both.", moments),
    Drawing("Figure 10", "Law of rotation of the flywheel, I* = 0.01 kg m2, I_pl = 0.015 kg m2.", rotation),
    Drawing("Table 2", "Angular accelerations of the links over the motion, as curves.", accelerations),
)  # fmt: skip
