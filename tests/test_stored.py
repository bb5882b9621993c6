"""What the model holds of every law: native tendons, cubics, and forces driven in memory."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import equipoise as eq
from equipoise.balancers.laws.stored import nearest_cubic
from equipoise.verification.simulate import holding, unstored
from test_laws import LAWS, TORQUES


@pytest.fixture(scope="module")
def arm():
    return eq.chain([eq.Link("upper", length=0.5, mass=3.0), eq.Link("fore", length=0.4, mass=2.0, com=(0.15, 0.02))])


def agrees(mechanism, part):
    """MuJoCo's holding effort with the part in the model, against ours."""
    rng = np.random.default_rng(1)
    poses = rng.uniform((-0.2, 0.4), (1.0, 1.6), (40, 2))
    states = mechanism.states(eq.Sweep(poses, np.ones(len(poses)), "random"))
    size = {"Pa": 1e6, "N/m": 300.0, "N": 40.0, "N m/rad": 5.0, "N m": 3.0, "kg": 2.0}
    values = {unknown.name: size[unknown.unit] * (1 + 0.3 * i) for i, unknown in enumerate(part.unknowns)}
    spec = mechanism.spec.copy()
    part.install(spec, values, states)
    forces = unstored(SimpleNamespace(balancers=(part,), values=values, states=states))
    simulated = holding(spec, states, forces, part.path.positions(states, part.name))
    ours = states.holding + part.effort(states, "hold").at(np.array(list(values.values())))
    load = max(np.abs(states.holding).max(), np.abs(ours).max())
    np.testing.assert_allclose(simulated, ours, atol=1e-11 * load)
    return bool(forces)


@pytest.mark.parametrize("law", LAWS)
def test_laws_on_a_line(arm, law):
    path = eq.Line(eq.Point("world", (0.1, 0.05, 0.6)), eq.Point("fore", (0.12, 0.01, 0.03)))
    driven = agrees(arm, eq.Spring("b", path, LAWS[law], mass=0.7, mass_at=0.3))
    assert driven == (law.startswith(("gas", "hydro", "bspline")) or law == "polynomial")


@pytest.mark.parametrize("law", LAWS)
def test_laws_on_a_yoke(arm, law):
    path = eq.ScotchYoke(eq.Absolute("fore"), 0.12, phase=0.3, offset=0.5)
    agrees(arm, eq.Spring("b", path, LAWS[law]))


@pytest.mark.parametrize("law", TORQUES)
def test_laws_on_an_angle(arm, law):
    agrees(arm, eq.Spring("b", eq.Angle("fore_joint", ratio=1.5, offset=-0.2), TORQUES[law]))


def test_the_nearest_cubic_alternates():
    for f in (np.exp, lambda x: 1 / (2.2 + x), lambda x: np.cos(3 * x) + x):
        coefficients, error = nearest_cubic(f)
        x = np.linspace(-1, 1, 4001)
        deviation = f(x) - np.polynomial.polynomial.polyval(x, coefficients)
        assert np.abs(deviation).max() == pytest.approx(error, rel=1e-4)
        peaks = [
            part[np.abs(part).argmax()] for part in np.split(deviation, np.flatnonzero(np.diff(np.sign(deviation))) + 1)
        ]
        assert sum(abs(peak) > 0.999 * error for peak in peaks) >= 5
    assert nearest_cubic(lambda x: 1 - 2 * x + 3 * x**3)[1] < 1e-14
