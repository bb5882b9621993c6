"""Springs that meet are slid along their joints' axis, which changes nothing else."""

import numpy as np
import pytest

import equipoise as eq
from equipoise.discovery.apart import Leeway, set_apart
from equipoise.discovery.ground import Ground
from equipoise.discovery.lattice import KeepOut
from equipoise.interference.findings import clashes


@pytest.fixture(scope="module")
def crossed():
    """Two coils in one plane that cross, on an arm of two links."""
    mech = eq.chain([eq.Link("upper", length=0.5, mass=3.0), eq.Link("fore", length=0.4, mass=2.0)])
    over = eq.Sweep.sobol(mech, 32, ranges={"upper_joint": (-0.4, 0.4), "fore_joint": (-0.5, 0.5)})
    springs = [
        eq.Spring("s1", eq.Line(eq.Point("world", (0.1, 0, 0.25)), eq.Point("upper", (0.25, 0, 0))), eq.Linear()),
        eq.Spring("s2", eq.Line(eq.Point("world", (0.25, 0, 0.25)), eq.Point("upper", (0.1, 0, 0))), eq.Linear()),
    ]
    return eq.balance(mech, springs, over), Ground(mech, np.zeros(2), ())


def met(design):
    return [clash for clash in clashes(design) if clash.what in ("s1", "s2")]


def test_crossing_springs_are_slid_apart(crossed):
    design, ground = crossed
    assert met(design)
    apart = set_apart(design, Leeway(ground, 0.1))
    assert not met(apart)
    lines = [(spring.path.a.at, spring.path.b.at) for spring in apart.balancers]
    slid = [a[1] for a, b in lines if a[1] == b[1]]
    assert len(slid) == 2
    assert 0 < max(map(abs, slid)) <= 0.1 + 1e-9
    np.testing.assert_allclose(
        apart.residual(apart.states, "hold"), design.residual(design.states, "hold"), atol=1e-12 * 50
    )
    assert apart.certificate == design.certificate
    assert eq.verify(apart, poses=100).verification.agrees


BESIDE = (KeepOut("upper", (-1, 1e-4, -1), (1, 1, 1)), KeepOut("upper", (-1, -1, -1), (1, -1e-4, 1)))


@pytest.mark.parametrize("leeway", [{"margin": 0.0}, {"margin": 0.1, "keep_out": BESIDE}])
def test_without_room_they_stay(crossed, leeway):
    design, ground = crossed
    assert set_apart(design, Leeway(ground, **leeway)) is design
