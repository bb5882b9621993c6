"""Formulas of cylindrical helical springs of round wire; every argument is a number or an array of rows, SI."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np


def spring_index(wire: Any, diameter: Any) -> Any:
    """w = D / d, with the mean coil diameter D, m, and the wire d, m."""
    return diameter / wire


def rate(wire: Any, diameter: Any, coils: Any, shear: Any) -> Any:
    """R = G d^4 / (8 D^3 n), N/m; n active coils, shear modulus G, Pa [fossee_bhandari, Ex. 10.1]."""
    return shear * wire**4 / (8 * diameter**3 * coils)


def shear_stress(force: Any, wire: Any, diameter: Any) -> Any:
    """tau = 8 F D / (pi d^3), Pa, without correction for curvature [caruso_en_springs]."""
    return 8 * force * diameter / (np.pi * wire**3)


def wahl(index: Any) -> Any:
    """k = (4w - 1)/(4w - 4) + .615/w: curvature and direct shear [fossee_bhandari, Ex. 10.1]."""
    return (4 * index - 1) / (4 * index - 4) + 0.615 / index


def bergstraesser(index: Any) -> Any:
    """k = (w + .5)/(w - .75): curvature and direct shear, within 1 % of Wahl's for w >= 4 [caruso_en_springs]."""
    return (index + 0.5) / (index - 0.75)


def bending_correction(index: Any) -> Any:
    """q = (w + .07)/(w - .75) of a torsion spring's bending stress (unsourced)."""
    return (index + 0.07) / (index - 0.75)


CORRECTIONS = {"wahl": wahl, "bergstraesser": bergstraesser}
"""Factors of a coil's shear stress by what they are called."""
Correction = Literal["wahl", "bergstraesser"]


def wire_mass(wire: Any, diameter: Any, total_coils: Any, density: Any) -> Any:
    """m = rho pi^2 d^2 D n_t / 4, kg [caruso_en_springs]."""
    return density * np.pi**2 * wire**2 * diameter * total_coils / 4


def natural_frequency(wire: Any, diameter: Any, coils: Any, shear: Any, density: Any) -> Any:
    """f = d / (2 pi n D^2) sqrt(G / (2 rho)), Hz: the first surge mode between two held ends [caruso_en_springs]."""
    return wire / (2 * np.pi * coils * diameter**2) * np.sqrt(shear / (2 * density))


def fatigue_safety(least: Any, largest: Any, strength: Any, *, peened: bool = False) -> Any:
    """n = 1 / (ta / Sse + tm / Ssu) of shear stresses between two values, Pa, for a life without end.

        ta = (t2 - t1)/2,   tm = (t2 + t1)/2,   Sse = Ssa / (1 - Ssm / Ssu),   Ssu = .67 Rm

    Zimmerli's point: Ssa 241 MPa at Ssm 379 MPa, shot-peened 398 at 534, for steel wire below 10 mm; the stresses
    are those with Wahl's correction, or Bergstraesser's, strength Rm in Pa [machinecalcs].
    """
    amplitude, mean = (398e6, 534e6) if peened else (241e6, 379e6)
    ultimate = 0.67 * strength
    endurance = amplitude / (1 - mean / ultimate)
    ta, tm = (largest - least) / 2, (largest + least) / 2
    return 1 / (ta / endurance + tm / ultimate)


def smallest(*values: Any) -> Any:
    """The least of several values by their real part, which may be complex or rows."""
    found = values[0]
    for value in values[1:]:
        found = np.where(np.real(value) < np.real(found), value, found)
    return found[()] if isinstance(found, np.ndarray) else found
