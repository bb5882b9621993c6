"""Formulas and data of real parts against worked examples whose text was opened; the address stands with each."""

from __future__ import annotations

import math

import numpy as np
import pytest

import equipoise as eq
from equipoise.errors import InputError
from equipoise.parts import coil, compression, extension, gas, strip, torsion
from equipoise.parts.wire import UNSOURCED, grades, rows
from equipoise.reporting.references import entries

MM, MPA = 1e-3, 1e6


def test_bhandari_10_1():
    """github.com/FOSSEE/Scilab-TBC-Uploads, 764/CH10/EX10.1.b: d 6.625083, D 42, N 8, Nt 10, L 109.337611 mm."""
    force, sut, index, shear = 1250.0, 1090 * MPA, 6.0, 81370 * MPA
    d = math.sqrt(8 * coil.wahl(index) * force * index / (math.pi * 0.5 * sut))
    assert d / MM == pytest.approx(6.625083, abs=5e-7)
    wire, diameter = 7 * MM, 42 * MM
    stress = coil.wahl(index) * coil.shear_stress(force, d, index * d)
    assert stress == pytest.approx(0.5 * sut)
    coils = math.ceil(coil.rate(wire, diameter, 1, shear) * 30 * MM / force)
    assert coils == 8
    solid = compression.solid_length(wire, coils + 2)
    deflection = force / coil.rate(wire, diameter, coils, shear)
    assert (solid + (coils + 1) * MM + deflection) / MM == pytest.approx(109.337611, abs=5e-7)


def test_bhandari_10_2():
    """764/CH10/EX10.2.b: D 55, N 5, actual rate 179.014000 N/mm."""
    assert coil.rate(11 * MM, 55 * MM, 5, 81370 * MPA) / 1e3 == pytest.approx(179.014, abs=5e-7)


def test_bhandari_10_21():
    """764/CH10/EX10.21.b: d 1.6, D 18 mm, E 207000, 3 N mm/rad: N = 393, rounded up."""
    one = torsion.torsion_rate(1.6 * MM, 18 * MM, 1, 207000 * MPA)
    assert math.ceil(one / 3e-3) == 393


def test_metoolbox_extension_spring():
    """HelicalExtensionSpring_example.ipynb: safety of body 1.46, hook bending 1.29, hook torsion 1.41."""
    d, diameter, r1, r2, sut, force = 0.88 * MM, 5.41 * MM, 2.69 * MM, 2.672 * MM, 1823.3 * MPA, 22.24
    shear = coil.shear_stress(force, d, diameter)
    body = 0.45 * sut / (coil.wahl(diameter / d) * shear)
    bending = extension.hook_bending_factor(r1, d) * 2 * shear + 4 * force / (math.pi * d**2)
    side = extension.hook_torsion_factor(r2, d) * shear
    assert (round(body, 2), round(0.75 * sut / bending, 2), round(0.4 * sut / side, 2)) == (1.46, 1.29, 1.41)


def test_the_class_bears_what_its_formulas_say():
    """The same spring as a part: hook factors with its own radii, the rate 3.13 N/mm at 11.94 coils and G 80 GPa."""
    d, diameter = 0.88 * MM, 5.41 * MM
    assert coil.rate(d, diameter, 11.94, 80e9) / 1e3 == pytest.approx(3.13, abs=0.05)
    spring = eq.ExtensionSpring(d, diameter, 11.94, grade="ASTM A227", initial_tension=5.29, bend=2.672 * MM)
    words = {name: share * spring.strength / each for name, each, share, _ in spring.per_newton}
    assert words["hook torsion"] / 22.24 == pytest.approx(1.41, abs=0.01)
    assert spring.largest_force == pytest.approx(min(words.values()))
    low, high = spring.span
    assert spring.force_at(np.array([low, high]), {}) == pytest.approx([5.29, spring.largest_force])


def test_machinecalcs_hook_factors():
    """machinecalcs.com/extension-spring-hook-stress-calculator: KA 1.333, KB 1.375, stresses 679.1, 350.1, 301.5."""
    assert extension.hook_bending_factor(3.0, 2.0) == pytest.approx(1.333, abs=5e-4)
    assert extension.hook_torsion_factor(3.0, 2.0) == pytest.approx(1.375, abs=5e-4)
    plain = 350.1 / 1.375
    assert 2 * 4 / 3 * plain == pytest.approx(679.1, abs=0.2)
    assert coil.wahl(8.0) * plain == pytest.approx(301.5, abs=0.1)


def test_stress_by_either_factor_is_told_of_a_part():
    """w = 8: Wahl's factor 1.1840, Bergstraesser's 1.1724; fatigue takes either; a torsion spring has its own."""
    lengths = np.array([0.12, 0.15])
    pulled = eq.ExtensionSpring(2 * MM, 16 * MM, 30)
    shear = coil.shear_stress(pulled.force_of_one(lengths), 2 * MM, 16 * MM)
    assert pulled.stress(lengths, "wahl") == pytest.approx((31 / 28 + 0.615 / 8) * shear)
    assert pulled.stress(lengths, "bergstraesser") == pytest.approx(8.5 / 7.25 * shear)
    told = pulled.record(lengths)["stress"]
    assert told["wahl"] / told["plain"] == pytest.approx(1.1840, abs=1e-4)
    assert told["bergstraesser"] / told["plain"] == pytest.approx(1.1724, abs=1e-4)
    assert pulled.fatigue(lengths, correction="bergstraesser") > pulled.fatigue(lengths)
    pressed = eq.CompressionSpring(2 * MM, 16 * MM, 10, free_length=0.06)
    assert pressed.stress(np.array([0.05]), "wahl") == pytest.approx(
        (31 / 28 + 0.615 / 8) * coil.shear_stress(0.01 * pressed.k, 2 * MM, 16 * MM)
    )
    turned = eq.TorsionSpring(2 * MM, 16 * MM, 5)
    assert turned.record(np.array([0.0, 0.5]))["stress"]["curvature"] == pytest.approx(
        8.07 / 7.25 * torsion.bending_stress(0.5 * turned.k, 2 * MM)
    )
    with pytest.raises(InputError, match="no correction 'whal'"):
        pulled.stress(lengths, "whal")


def test_metoolbox_torsion_spring():
    """HelicalToresionSpring_example.ipynb: 4.66 coils for 525.11 N mm/rad (factor 10.8), safety 1.00 at 851.27 N mm."""
    d, diameter = 1.829 * MM, 13.252 * MM
    assert torsion.torsion_rate(d, diameter, 4.66, 196.5e9, 10.8) * 1e3 == pytest.approx(525.11, rel=1.1e-3)
    c = diameter / d
    inner = (4 * c * c - c - 1) / (4 * c * (c - 1))
    assert 1579.81 * MPA / (inner * torsion.bending_stress(0.85127, d)) == pytest.approx(1.0, abs=5e-3)
    assert coil.bending_correction(c) == pytest.approx(inner, rel=0.015)


def test_acxess_torsion_rate():
    """acxesspring.com/torsion-spring-rate-force-constant.html: 2.988 lb in per 360 degrees."""
    inch, psi = 0.0254, 6894.757
    found = torsion.torsion_rate(0.035 * inch, 0.465 * inch, 3, 30e6 * psi, 10.8) * 2 * math.pi
    assert found / (4.4482216 * inch) == pytest.approx(2.988, abs=5e-4)


def test_machinecalcs_fatigue():
    """machinecalcs.com/spring-fatigue-life-calculator: d 2, D 16, 20 to 80 N, Sut 2000: 180.9, 301.5, n 1.31."""
    low, high = (coil.wahl(8.0) * coil.shear_stress(force, 2 * MM, 16 * MM) for force in (20.0, 80.0))
    assert ((high - low) / 2e6, (high + low) / 2e6) == pytest.approx((180.9, 301.5), abs=0.05)
    assert coil.fatigue_safety(low, high, 2000 * MPA) == pytest.approx(1.31, abs=5e-3)
    assert coil.fatigue_safety(low, high, 2000 * MPA, peened=True) > 1.4


def test_machinecalcs_rate_and_mass():
    """machinecalcs.com/spring-natural-frequency-calculator: d 2, D 16, Na 6, Nt 8: 6.453 N/mm, 0.009917 kg."""
    wire = eq.grade("ASTM A228")
    assert coil.rate(2 * MM, 16 * MM, 6, wire.shear) / 1e3 == pytest.approx(6.453, abs=1e-3)
    assert coil.wire_mass(2 * MM, 16 * MM, 8, wire.density) == pytest.approx(0.009917, abs=5e-7)


def test_surge_is_half_the_root_of_rate_over_mass():
    """efunda.com: the lowest resonance follows from rate and mass; all coils active."""
    d, diameter, n, wire = 2 * MM, 16 * MM, 6.0, eq.grade("ASTM A228")
    rate, mass = coil.rate(d, diameter, n, wire.shear), coil.wire_mass(d, diameter, n, wire.density)
    found = coil.natural_frequency(d, diameter, n, wire.shear, wire.density)
    assert found == pytest.approx(0.5 * math.sqrt(rate / mass), rel=1e-12)


def test_machinecalcs_buckling():
    """machinecalcs.com/spring-buckling-calculator: music wire never buckles up to alpha L0 / D = 2.63."""
    young, shear = 206.8e9, 79.3e9
    free = {x: compression.buckling_deflection(x, 1.0, 1.0, young, shear) for x in (2.62, 2.64, 5.26)}
    assert free[2.62] == math.inf
    c1, c2 = young / (2 * (young - shear)), 2 * math.pi**2 * (young - shear) / (2 * shear + young)
    for length in (2.64, 5.26):
        assert free[length] == pytest.approx(length * c1 * (1 - math.sqrt(1 - c2 / length**2)), rel=1e-12)
    assert math.sqrt(c2) == pytest.approx(2.63, abs=0.01)


def test_gas_spring_reads_its_data_sheet():
    """yeswin.com and jpgasspring.com: F1, F2 10 mm from the ends (stroke above 80 mm), Fr = (F3 - F1) / 2."""
    friction = gas.friction_of(200.0, 230.0)
    assert friction == 15.0
    strut = eq.GasSpring(200.0, 260.0, stroke=0.15, length=0.4, friction=friction)
    ends = strut.force_of_one(np.array([0.39, 0.26]))
    assert ends == pytest.approx([215.0, 275.0])
    assert gas.measuring_distance(np.array([0.08, 0.081])) == pytest.approx([0.005, 0.010])
    warm = eq.GasSpring(200.0, 260.0, stroke=0.15, length=0.4, temperature=293.15 + 10)
    assert warm.force_of_one(np.array([0.39]))[0] / 200 == pytest.approx(1 + 10 / 293.15)
    slow, quick = (eq.GasSpring(200.0, 260.0, 0.15, 0.4, exponent=n).force_of_one(np.array([0.3]))[0] for n in (1, 1.4))
    assert 200 < slow < quick < 260


def test_strip_force():
    """springipedia.com/constant-force-design-theory.asp gives E b t^3 / (26.4 R^2)."""
    spring = eq.ConstantForceSpring(0.02, 2e-4, 0.0125, travel=0.5, number=2.0)
    assert strip.strip_force(0.02, 2e-4, 0.0125, 193e9) == pytest.approx(193e9 * 0.02 * 8e-12 / 26.4 / 1.5625e-4)
    assert spring.force_at(np.array([0.0, 0.4]), {}) == pytest.approx(2 * 7.486, abs=0.002)


STRENGTH = {
    # mollificiomodenese.it, glossary, SM and SH
    "EN 10270-1 SM": {0.3: 2370, 0.5: 2200, 1.0: 1980, 2.0: 1760, 3.6: 1570, 5.0: 1460, 10.0: 1240, 20.0: 1020},
    # durofer.ch/en/products/wire/spring-wire
    "EN 10270-1 SH": {0.30: 2660, 0.35: 2600, 0.40: 2560, 0.45: 2510},
    # metalleschmidt.de/en/wire/oil-tempered-steel
    "EN 10270-2 FDSiCr": {0.5: 2100, 0.65: 2100},
    "EN 10270-2 VDSiCr": {0.6: 2080},
    # MEtoolbox, HelicalToresionSpring_example.ipynb
    "ASTM A228": {1.829: 2025.67},
}


@pytest.mark.parametrize("name", STRENGTH)
def test_strengths_are_those_of_the_opened_tables(name):
    sizes = np.array(list(STRENGTH[name])) * MM
    np.testing.assert_allclose(eq.grade(name).strength(sizes) / MPA, list(STRENGTH[name].values()), rtol=0.006)


def test_stainless_strength_lies_below_every_step():
    """stahlbecker.de/node/126, X10CrNi18-8 NS: upper ends of the steps, mm, and the strength, N/mm2."""
    ends = [0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.25, 5.0, 6.0, 7.0, 8.5, 10.0]
    steps = np.arange(2200, 1200, -50)
    wire = eq.grade("EN 10270-3 1.4310")
    for low, high, step in zip(ends[:-1], ends[1:], steps[1:], strict=True):
        found = wire.strength(np.linspace(low * 1.0001, high, 20) * MM) / MPA
        assert found.max() <= step * 1.0005
        assert found.max() >= 0.96 * step


def test_every_row_has_a_source_or_says_that_it_has_none():
    for row in rows("wires.csv"):
        assert {row["strength_source"], row["moduli_source"]} <= {*entries(), UNSOURCED}
        assert float(row["least"]) < float(row["largest"])
    assert {wire.name.split()[0] for wire in grades().values()} == {"EN", "ASTM"}
    assert eq.grade("EN 10270-1 SL").unsourced
    assert not eq.grade("SH").unsourced


def test_sizes_ascend():
    for series, least in (("metric", 0.3), ("inch", 0.254)):
        sizes = eq.preferred_sizes(series)
        assert sizes[0] == pytest.approx(least * MM)
        assert (np.diff(sizes) > 0).all()


def test_rows_are_arrays():
    """A thousand springs at once are the springs one by one; rows that cannot be made are told apart by reason."""
    rng = np.random.default_rng(0)
    d = rng.uniform(0.2, 21, 1000) * MM
    columns = {"wire": d, "diameter": d * rng.uniform(3, 22, 1000), "coils": rng.uniform(5, 60, 1000)}
    many = eq.ExtensionSpring.of_rows(**columns, initial_tension=d * 3e3)
    bad = {fault.reason: np.asarray(fault.rows) for fault in many.faults()}
    assert set(bad) == {
        "wire outside its standard", "spring index outside 4..20", "fewer than two coils",
        "initial tension cannot be wound",
    }  # fmt: skip
    assert all(bad[reason].any() for reason in bad if "coils" not in reason)
    good = np.flatnonzero(~np.any(list(bad.values()), axis=0))
    assert len(good) > 100
    for i in good[:20]:
        one = eq.ExtensionSpring(
            *(float(v[i]) for v in (d, many.diameter, many.coils)), initial_tension=float(d[i] * 3e3)
        )
        for what in ("k", "rest", "largest_force", "own_mass", "natural_frequency"):
            assert getattr(one, what) == pytest.approx(getattr(many, what)[i])
        assert one.span[1] == pytest.approx(many.span[1][i])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: eq.ExtensionSpring(0.03, 0.2, 5), "30 mm is outside EN 10270-1 SH, .* 0.3 to 20 mm"),
        (lambda: eq.ExtensionSpring(0.001, 0.003, 5), "index D / d is 3, it must lie in 4..20"),
        (lambda: eq.CompressionSpring(0.001, 0.021, 5, free_length=0.1), "index D / d is 21"),
        (lambda: eq.ExtensionSpring(0.002, 0.02, 9, initial_tension=200), "200 N cannot be wound: 0 to 22.58 N"),
        (lambda: eq.ExtensionSpring(0.002, 0.02, 1), "1 active coils"),
        (lambda: eq.ExtensionSpring(0.002, 0.02, 9, grade="EN 10270-1 XX"), "no wire 'EN 10270-1 XX'"),
        (lambda: eq.CompressionSpring(0.005, 0.04, 10, free_length=0.05), "leaves no way to go: solid it is 60 mm"),
        (lambda: eq.GasSpring(260, 200, 0.1, 0.3), "0 < f1 < f2"),
        (lambda: eq.GasSpring(200, 260, 0.015, 0.3, exponent=1), None),
        (lambda: eq.GasSpring(200, 260, 0.005, 0.3), "not longer than twice"),
        (lambda: eq.GasSpring(200, 260, 0.2, 0.15), "not above the stroke"),
        (lambda: eq.ConstantForceSpring(0.02, 2e-3, 0.0125, 0.5), "cannot roll"),
        (lambda: eq.StockSpring("A", -5.0, 0.1, limit=0.2), "rate of A is -5"),
        (lambda: eq.StockSpring("A", 5.0, 0.1), "neither"),
        (lambda: eq.StockSpring("A", 5.0, 0.1, limit=0.05), "no travel"),
        (lambda: eq.preferred_sizes("cubit"), "no series"),
    ],
)
def test_what_cannot_be_made_says_why(make, words):
    if words is None:
        assert make().k if hasattr(make(), "k") else make()
        return
    with pytest.raises(InputError, match=words) as error:
        make()
    assert error.value.hint


def test_a_part_balances_and_says_how_it_is_ordered():
    arm = eq.chain([eq.Link("arm", length=0.5, mass=2.0)])
    over = eq.Sweep.grid(arm, {"arm_joint": (-0.5, 1.0, 21)})
    law = eq.ExtensionSpring(0.003, 0.03, 80, initial_tension=20.0)
    spring = eq.Spring("s", eq.Line(arm.at("world", 0, 0, 0.55), arm.at("arm", 0.25)), law, mass=0.1)
    design = eq.balance(arm, [spring], over)
    part = design.parts()[0]
    assert part["order"] == "EN 13906-2, wire EN 10270-1 SH 3, D 30, n 80, L0 297, F0 20 N, R 0.382 N/mm"
    assert part["mass"] == pytest.approx(0.1 + law.own_mass)
    worst = max(clause["used"] for name, clause in part["clauses"].items() if name != "initial tension")
    assert worst == pytest.approx(part["force"][1] / law.largest_force)
    assert part["unsourced"] == ["the largest initial tension"]
    assert "hook bending" in str(design)
    assert part["order"] in " ".join(str(design).split())
    assert {"tinmy_hooks", "aabag_extension"} <= set(design.cite())
    checked = eq.verify(design, poses=50)
    assert checked.verification.agrees


def test_a_part_that_is_too_short_is_a_limit_not_kept():
    arm = eq.chain([eq.Link("arm", length=0.5, mass=2.0)])
    over = eq.Sweep.grid(arm, {"arm_joint": (-0.5, 1.0, 21)})
    law = eq.StockSpring("S-1", 400.0, 0.2, limit=0.3)
    spring = eq.Spring("s", eq.Line(arm.at("world", 0, 0, 0.55), arm.at("arm", 0.25)), law)
    with pytest.raises(eq.InfeasibleError, match="working range of s"):
        eq.balance(arm, [spring], over)


def arm_and_sweep():
    arm = eq.chain([eq.Link("arm", length=0.5, mass=2.0)])
    return arm, eq.Sweep.grid(arm, {"arm_joint": (-0.5, 1.0, 21)})


def line(arm):
    return eq.Line(arm.at("world", 0, 0, 0.55), arm.at("arm", 0.25))


def test_the_spring_index_bounds_the_rate_that_is_found():
    """d^4 = 8 D^3 n k / G, so D / d <= 15 asks for k >= G D / (8 n 15^4), which costs balance here."""
    arm, over = arm_and_sweep()
    free = eq.balance(arm, [eq.Spring("s", line(arm), eq.Coil(free_length=0.3))], over)
    limit = eq.SpringIndex("s", min=4.0, max=8.0, diameter=0.05, coils=60.0)
    kept = eq.balance(arm, [eq.Spring("s", line(arm), eq.Coil(free_length=0.3))], over, limits=[limit])
    assert free.values["s.k"] < kept.values["s.k"] == pytest.approx(81.5e9 * 0.05 / (8 * 60 * 8**4))
    assert any("spring index of s <= 8" in active.limit for active in kept.certificate.active)
    wire = (8 * 0.05**3 * 60 * kept.values["s.k"] / 81.5e9) ** 0.25
    assert 0.05 / wire == pytest.approx(8.0)


def test_the_spring_index_bounds_a_shaped_rate_and_a_shaped_wire():
    arm, over = arm_and_sweep()
    wire = eq.WireMass(diameter=0.05, coils=60, wire_length=9.0, shear_modulus=81.5e9)
    ideal = eq.Spring("s", line(arm), eq.ZeroFreeLength(k=100.0), mass=wire)
    limits = [eq.SpringIndex("s", max=12.0)]
    design = eq.shape(arm, [ideal], over, {"s.law.k": (20.0, 2000.0)}, limits=limits, starts=2)
    assert 0.05 / wire.thickness(design.geometry["s.law.k"]) == pytest.approx(12.0, rel=1e-6)
    made = eq.Spring("s", line(arm), eq.ExtensionSpring(0.003, 0.03, 80.0, initial_tension=10.0))
    bounds = {"s.law.wire": (0.002, 0.004), "s.law.coils": (40.0, 90.0)}
    for low, high in ((4.0, 9.5), (11.0, 15.0)):
        found = eq.shape(arm, [made], over, bounds, limits=[eq.SpringIndex("s", low, high)], starts=3)
        assert low - 1e-6 <= 0.03 / found.geometry["s.law.wire"] <= high + 1e-6


def test_elongation_of_a_part_is_that_of_the_spring_without_its_leader():
    arm, over = arm_and_sweep()
    law = eq.ExtensionSpring(0.003, 0.03, 60, initial_tension=20.0, leader=0.1)
    spring = eq.Spring("s", line(arm), law)
    length = spring.path.deform(arm.states(over))[0]
    most = (length.max() - 0.1) / law.own_length - 1
    for bound, fine in ((most * 1.001, True), (most * 0.999, False)):
        limit = [eq.Elongation("s", max=bound)]
        if fine:
            assert eq.balance(arm, [spring], over, limits=limit).certificate.violation <= 1e-9
        else:
            with pytest.raises(eq.InfeasibleError, match="elongation of s"):
                eq.balance(arm, [spring], over, limits=limit)


@pytest.mark.parametrize(
    ("limit", "law", "words"),
    [
        (eq.SpringIndex("s"), eq.ZeroFreeLength(), "needs positive bounds"),
        (eq.SpringIndex("s", 15.0, 4.0), eq.ZeroFreeLength(), "min below max"),
        (eq.SpringIndex("s", 4.0, 15.0), eq.ZeroFreeLength(), "nothing says what coil"),
        (eq.SpringIndex("s", 4.0, 15.0), eq.Constant(), "no rate that a coil's wire follows"),
        (eq.SpringIndex("t", 4.0, 15.0), eq.ZeroFreeLength(), "no spring called 't'"),
    ],
)
def test_an_index_that_nothing_has_says_so(limit, law, words):
    arm, over = arm_and_sweep()
    with pytest.raises(InputError, match=words):
        eq.balance(arm, [eq.Spring("s", line(arm), law)], over, limits=[limit])
