"""Springs that are still to be wound: the polygon of what can be, the closed forms about it, and what is ordered."""

from __future__ import annotations

import numpy as np
import pytest

import equipoise as eq
from equipoise.discovery.ask import asked
from equipoise.limits import Setting, implied
from equipoise.parts import ExtensionSpring
from equipoise.targets import target_of

RNG = np.random.default_rng(5)


def arm():
    return eq.chain([eq.Link("upper", length=0.5, mass=3.0)], base=(0.0, 0.0, 0.3))


def spring(law):
    mech = arm()
    return mech, eq.Spring("s1", eq.Line(mech.at("world", -0.05, 0, 0.8), mech.at("upper", 0.3, 0, 0)), law)


SWEEP = {"upper_joint": (-0.9, 0.9, 41)}


@pytest.mark.parametrize(("wire", "index", "number"), [(0.003, 8.0, 2.0), (0.0015, 11.0, 1.0), (0.005, 5.5, 4.0)])
def test_the_polygon_is_what_extension_springs_can_be(wire, index, number):
    """Rows against the part's own formulas: strength, closed length, initial tension that can be wound."""
    law = eq.WindableSpring(wire, index, number=number)
    mech, one = spring(law)
    states = mech.states(eq.Sweep.grid(mech, {"upper_joint": (0.0, 0.6, 21)}))
    length = one.path.deform(states)[0]
    rows = implied([one], Setting({"s1": one}, states, lambda _: None))
    kept = 0
    for _ in range(600):
        k = law.stack / (wire * RNG.uniform(2.0, 150.0))
        product = k * length.min() * RNG.uniform(-0.1, 1.1)
        inside = all((row.G @ [k, product] <= row.h + 1e-9).all() for row in rows)
        coils = law.coils_of(k)
        bare = ExtensionSpring(wire, index * wire, coils, number=number)
        assert bare.k == pytest.approx(k)
        # All of the initial tensions that a winder could choose, with a leader for what is missing in length.
        tension = np.linspace(0.0, float(law.largest_tension), 2001)
        rest = (product + tension) / k
        serves = (rest <= length.min() + 1e-12) & (rest >= bare.own_length - 1e-12)
        strong = k * length.max() - product <= bare.largest_force + 1e-9
        assert inside == bool(serves.any() and strong) or _near(rows, k, product)
        kept += inside
        if inside:
            made = law.wound(k, product, length)
            assert made.span[0] <= length.min() * (1 + 1e-9)
            assert made.span[1] >= length.max() * (1 - 1e-6)
            np.testing.assert_allclose(made.tension + made.k * (length - made.rest), k * length - product, rtol=1e-9)
    assert kept > 3


def _near(rows, k, product):
    """Whether a point lies so close to the polygon's edge that a grid of tensions may miss it."""
    return min((np.abs(row.G @ [k, product] - row.h) / row.scale).min() for row in rows) < 2e-3


def test_a_balanced_spring_can_be_wound_and_does_the_same():
    mech, one = spring(eq.WindableSpring(0.003, 8.0, number=2.0, width=0.06))
    sweep = eq.Sweep.grid(mech, SWEEP)
    free = {"s1.path.line.1.x": (0.1, 0.45), "s1.law.wire": (0.001, 0.006), "s1.law.index": (5.0, 12.0)}
    design = eq.shape(mech, [one], sweep, free, norm="peak", starts=3)
    law = design.balancers[0].law
    assert (law.index + 1) * law.wire <= 0.06 * (1 + 1e-9)
    length = design.balancers[0].path.deform(design.states)[0]
    made = law.wound(design.values["s1.k"], design.values["s1.k_free_length"], length)
    again = eq.balance(mech, [eq.Spring("s1", design.balancers[0].path, made, mass=-made.own_mass)], sweep, norm="peak")
    assert again.after["upper_joint"].peak == pytest.approx(design.after["upper_joint"].peak, abs=1e-6)
    assert design.after["upper_joint"].peak < 0.2 * design.before["upper_joint"].peak
    assert "coils" in design.parts()[0]["parameters"]


def test_closed_forms_of_what_can_be_wound():
    """The stiffest spring of the closed form lies on the polygon's edge, and none of the options is stiffer."""
    make = eq.Makeable(width=0.05, parallel=2, mass=3.0)
    short = RNG.uniform(0.15, 0.5, 60)
    long = short * RNG.uniform(1.05, 2.5, 60)
    least = make.least_free(short, long)
    sound = np.isfinite(least)
    short, long, least = short[sound], long[sound], least[sound]
    free = least + 0.4 * (0.98 * short - least)
    rate, option = make.most_straight(short, long, free)
    assert (rate > 0).all()
    for i in range(len(short)):
        law, ends = make.start(option[i]), np.array([short[i], long[i]])
        made = law.wound(rate[i] * (1 - 1e-9), rate[i] * free[i], ends)
        assert made.largest_force == pytest.approx(rate[i] * (long[i] - free[i]), rel=1e-6)
        assert made.own_mass <= 3.0 * (1 + 1e-6)
        assert made.diameter + made.wire <= 0.05 * (1 + 1e-9)
        k = 1.02 * rate[i]
        for other in range(0, len(make.options.wire), 7):
            trial = make.start(other)
            if trial.least_rate <= k:
                with pytest.raises(eq.InfeasibleError):
                    trial.wound(k, k * free[i], ends)


def test_round_sizes_are_stocked_and_serve():
    make = eq.Makeable(width=0.06, parallel=3)
    law, length = make.law(0.00312, 9.3, 3.0), np.linspace(0.4, 0.7, 20)
    k = 900.0
    product = k * 0.3
    for chosen in make.round(law, k, product, length):
        assert np.abs(make.sizes - chosen.wire).min() < 1e-12
        diameter = chosen.wire * chosen.index
        assert diameter / 0.0005 == pytest.approx(round(diameter / 0.0005), abs=1e-6)
        made = chosen.wound(k, product, length)
        assert made.number <= 3
        assert made.largest_force >= k * 0.7 - product


def test_a_spring_in_a_room_fits_when_stretched():
    law = eq.WindableSpring(0.003, 9.0, number=2.0, room=0.5)
    assert law.k is None
    make = eq.Makeable(parallel=2)
    stroke, room = np.array([0.05, 0.1]), np.array([0.4, 0.5])
    reach = make.longest_behind(stroke, room)
    assert (reach >= stroke).all()
    rate, option = make.most_behind(stroke, room, reach * 0.9)
    assert (rate > 0).all()
    for i in range(2):
        # Lengths of the spring itself, l - L0 from x - stroke to x.
        x = reach[i] * 0.9
        ends, law = np.array([1.0 + x - stroke[i], 1.0 + x]), make.start(option[i], float(room[i]))
        made = law.wound(rate[i], rate[i] * 1.0, ends)
        force = rate[i] * (ends - 1.0)
        assert force[0] >= made.tension * (1 - 1e-6)
        extended = made.own_length + (force[1] - made.tension) / made.k
        assert extended <= room[i] * (1 + 1e-6)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: eq.WindableSpring(-0.003, 8.0), "wire is -0.003"),
        (lambda: eq.WindableSpring(0.003, 30.0), "spring index"),
        (lambda: eq.WindableSpring(0.05, 8.0), "outside EN 10270-1 SH"),
        (lambda: eq.Makeable(index=(3.0, 12.0)), "index runs from 3"),
        (lambda: eq.Makeable(width=0.001), "no metric size"),
        (lambda: eq.Makeable(parallel=0), "parallel is 0"),
        (lambda: eq.Makeable(grade="nothing"), "no wire"),
    ],
)
def test_what_cannot_be_wound_is_said(make, said):
    with pytest.raises(eq.InputError, match=said):
        make()


def two_links():
    links = [
        eq.Link("upper", length=0.5, mass=3.0, limits=(-1.0, 1.0)),
        eq.Link("fore", length=0.4, mass=2.0, com=(0.15, 0.02), limits=(-0.2, 1.8)),
    ]
    return eq.chain(links, base=(0.0, 0.0, 0.3))


@pytest.mark.parametrize("kind", [eq.Coils(rest=1.0), eq.CableSprings(ratio=0.5, rooms={"upper": 0.45})])
def test_a_front_of_springs_that_can_be_wound(kind):
    """Stocked wire, round numbers, the working range at poses that the design never saw, own masses counted."""
    mech = two_links()
    make = eq.Makeable(width=0.05, parallel=2)
    pairs = ((mech.bodies[0], "upper"),) if isinstance(kind, eq.CableSprings) else None
    request = eq.Discover(1, kinds=(kind,), pairs=pairs, candidates=300, contenders=1, make=make)
    front = eq.discover(mech, eq.Sweep.sobol(mech, 48), request)
    design = front.designs[0]
    spring = design.balancers[0]
    part = spring.law
    assert isinstance(part, ExtensionSpring)
    assert np.abs(make.sizes - part.wire).min() < 1e-12
    assert part.coils / 0.5 == pytest.approx(round(part.coils / 0.5))
    assert part.diameter + part.wire <= 0.05 * (1 + 1e-9)
    assert design.added_mass == pytest.approx(part.own_mass)
    unseen = mech.states(eq.Sweep.sobol(mech, 512, seed=9))
    length = spring.path.deform(unseen)[0]
    assert part.span[0] <= length.min() + 1e-4
    assert length.max() <= part.span[1] + 1e-4
    if isinstance(kind, eq.CableSprings):
        anchor, guide = (np.array(item.at) for item in spring.path.through[:2])
        assert length.max() <= np.linalg.norm(anchor - guide) - kind.fittings + 1e-4
    assert front.values[0] < 0.6 * front.before
    assert any("before rounding to sizes" in note for note in front.notes)
    assert "EN 13906-2, wire EN 10270-1 SH" in design.parts()[0]["order"]
    assert eq.verify(design, poses=100).verification.agrees


def test_an_ideal_spring_is_made_by_a_cable():
    make = eq.Makeable()
    request = eq.Discover(kinds=(eq.Ideal(force=900.0), eq.CableSprings(force=900.0), eq.TorsionSprings()), make=make)
    assert request.tried == (eq.CableSprings(force=900.0, make=make), eq.TorsionSprings())


def test_the_command_line_asks_for_wound_springs(tmp_path):
    file = tmp_path / "arm.yaml"
    file.write_text(
        "mechanism: {chain: {links: [{name: upper, length: 0.5, mass: 3}]}}\n"
        "sweep: {sobol: 32}\n"
        "discover: {springs: 1, kinds: [coil], make: {width: 50 mm, index: [5, 10], mass: 3 kg}}\n",
        encoding="utf-8",
    )
    asked_for = asked(target_of(str(file)), None, None, None, None, "SM").content.discover
    assert asked_for.make == eq.Makeable(grade="SM", width=0.05, index=(5.0, 10.0), mass=3.0)


def test_a_spring_is_rounded_where_its_hooks_have_moved_to():
    """Hooks refined around a round size have other poses at which the spring is longest; those count as well."""
    arm = eq.Mechanism.load("package://example-robot-data/robots/so_arm_description/urdf/so101.urdf")
    kind = eq.CableSprings(radius=0.005, guide="swivel", rooms={"shoulder_link": 0.15}, fittings=0.015)
    make = eq.Makeable(width=0.016, parallel=2)
    pairs = (("shoulder_link", "lower_arm_link"),)
    request = eq.Discover(1, kinds=(kind,), pairs=pairs, candidates=600, contenders=1, make=make)
    front = eq.discover(arm, eq.Sweep.sobol(arm, 48, seed=1), request)
    (spring,) = front.designs[0].balancers
    length = spring.path.deform(arm.states(eq.Sweep.sobol(arm, 4096, seed=7)))[0]
    assert spring.law.span[0] - 1e-4 <= length.min()
    assert length.max() <= spring.law.span[1] + 1e-4
    assert front.values[0] < 0.7 * front.before
