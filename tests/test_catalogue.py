"""Catalogues: what the reader recognises, what it refuses and where, what can be wound, what filters leave."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import equipoise as eq
from equipoise.cli import main
from equipoise.errors import InputError
from equipoise.parts.headers import FACTORS, recognise
from equipoise.units import to_si

STOCK = Path(__file__).parents[1] / "examples" / "stock_springs.csv"
INCH = """\
Part No,Outside Diameter (in),Wire Dia (in),Free Length (in),Rate (lbs/in),Initial Tension (lbs),Max Load (lbs)
E-1,0.5,0.063,2.0,8.5,2.1,20
E-2,0.25,0.031,1.0,4.2,0.8,6
"""


def write(tmp_path, text):
    file = tmp_path / "springs.csv"
    file.write_text(text, encoding="utf-8")
    return file


def test_inches_and_pounds(tmp_path):
    found = eq.read_catalogue(write(tmp_path, INCH))
    assert found.part == ("E-1", "E-2")
    assert found.rate[0] == pytest.approx(8.5 * 4.4482216152605 / 0.0254)
    assert found.free_length == pytest.approx([0.0508, 0.0254])
    assert found.initial_tension[1] == pytest.approx(0.8 * 4.4482216152605)
    assert found.travel[0] == pytest.approx((20 - 2.1) / 8.5 * 0.0254)
    assert list(found.line) == [2, 3]
    spring = found.spring(0, 2)
    assert spring.k == pytest.approx(2 * found.rate[0])
    assert "E-1" in spring.order_line()
    # The mass that the file leaves out is that of the wire whose coils give the rate.
    wire, diameter = 0.063 * 0.0254, (0.5 - 0.063) * 0.0254
    coils = eq.grade("ASTM A228").shear * wire**4 / (8 * diameter**3 * found.rate[0])
    assert found.mass[0] == pytest.approx(7850 * np.pi**2 * wire**2 * diameter * (coils + 2) / 4)


@pytest.mark.parametrize("unit", [unit for unit in FACTORS if unit])
def test_factors_are_those_of_pint(unit):
    """ozf is a sixteenth of lbf; all others pint knows by the same name."""
    kinds = {"N/m": "/", "N": ("N", "kN", "lbf", "ozf", "kgf"), "m": ("mm", "cm", "m", "in")}
    kind = next((si for si, marks in kinds.items() if ("/" in unit if marks == "/" else unit in marks)), "kg")
    share = 16 if "ozf" in unit else 1
    assert FACTORS[unit] * share == pytest.approx(to_si(f"1 {unit.replace('ozf', 'lbf')}", kind), rel=1e-12)


@pytest.mark.parametrize(
    ("header", "found"),
    [
        ("Spring Rate [lbs/in]", ("rate", "lbf/in")),
        ("R (N/mm)", ("rate", "N/mm")),
        ("Federrate, N/mm", ("rate", "N/mm")),
        ("L0", ("free_length", None)),
        ("Free Length (in)", ("free_length", "in")),
        ("free_length_mm", ("free_length", "mm")),
        ("d", ("wire", None)),
        ("D", ("diameter", None)),
        ("De [mm]", ("outside", "mm")),
        ("F0 N", ("initial_tension", "N")),
        ("Artikelnummer", ("part", None)),
        ("Stock #", ("part", None)),
        ("Max. Load (lbs)", ("force", "lbf")),
        ("Ln", ("longest", None)),
        ("Gewicht [g]", ("mass", "g")),
        ("Wire Dia. (in)", ("wire", "in")),
        ("Outside Dia. (in)", ("outside", "in")),
        ("Max Ext. Length (in)", ("longest", "in")),
        ("Drahtstärke d", ("wire", None)),
        ("Länge L0", ("free_length", None)),
        ("Länge Ln [mm]", ("longest", "mm")),
        ("Max. Kraft Fn", ("force", None)),
        ("Windungszahl n", ("coils", None)),
        ("Free length m", ("free_length", "m")),
        ("Price (EUR)", None),
    ],
)
def test_headers_are_recognised(header, found):
    assert recognise(header) == found


def test_german_with_a_line_of_units_and_decimal_commas(tmp_path):
    text = (
        "Artikelnummer;d;De;L0;R;F0;Ln;Gewicht\n;mm;mm;mm;N/mm;N;mm;g\n"
        "Z-1;1,0;10,0;50,5;0,35;4,2;110;6,1\nZ-2;2,0;20,0;80;0,8;12;190;30\n"
    )
    found = eq.read_catalogue(write(tmp_path, text))
    assert found.rate == pytest.approx([350, 800])
    assert found.travel == pytest.approx([0.0595, 0.11])
    assert found.mass == pytest.approx([0.0061, 0.03])
    assert found.width == pytest.approx([0.01, 0.02])


def test_units_in_cells_and_mapped_columns(tmp_path):
    text = "which one,Rate,Free length,elongation\nA,1.2 N/mm,50 mm,30 mm\nB,2 N/mm,60 mm,20 mm\n"
    found = eq.read_catalogue(write(tmp_path, text), columns={"part": "which one", "travel": "elongation"})
    assert found.rate == pytest.approx([1200, 2000])
    assert found.travel == pytest.approx([0.03, 0.02])
    assert "no mass" in found.remarks[0]
    text = "part,Rate [N/mm],Free length [mm],Max length [mm],Price,Stock qty\nA,1.2,50,80,3.10,12\n"
    assert "columns that are not read: 'Price', 'Stock qty'" in eq.read_catalogue(write(tmp_path, text)).remarks


def test_columns_without_a_unit_follow_the_others_or_what_is_asked(tmp_path):
    text = "part,rate,free length,max length [mm]\nA,1.2,50,80\n"
    assert eq.read_catalogue(write(tmp_path, text)).rate[0] == pytest.approx(1200)
    bare = "part,rate,free length,max length\nA,1.2,50,80\n"
    assert eq.read_catalogue(write(tmp_path, bare), units="inch").free_length[0] == pytest.approx(50 * 0.0254)


def test_compression_springs_may_stand_beside(tmp_path):
    text = "part,type,R [N/mm],L0 [mm],Lc [mm],Ln [mm]\nC,compression,2,80,30,\nE,extension,1,50,,90\n"
    found = eq.read_catalogue(write(tmp_path, text))
    assert found.form == ("compression", "extension")
    assert found.travel == pytest.approx([0.05, 0.04])
    assert found.spring(0).span == pytest.approx((0.03, 0.08))


METRIC = "part,rate [N/mm],free length [mm],max length [mm]\n"


@pytest.mark.parametrize(
    ("text", "where", "words"),
    [
        ("", "springs.csv", "empty"),
        (METRIC, "springs.csv", "no rows"),
        ("part,free length [mm],max length [mm]\nA,1,2\n", "row 1", "no column for the rate among 'part'"),
        ("part,rate [N/mm],free length [mm]\nA,1,2\n", "row 1", "no column says how far"),
        (METRIC + "A,1,50,80\nB,-1,50,80\n", "row 3, column 'rate [N/mm]'", "is -1, it must be positive"),
        (METRIC + "A,1,50,80\nB,0,50,80\nC,0,50,80\n", "row 3", "and 1 more rows"),
        (METRIC + "A,1,50,80\nA,2,50,80\n", "row 3, column 'part'", "'A' stands twice, first in row 2"),
        (METRIC + "A,1,50,80\nB,2 lbf/in,50,80\n", "row 3, column 'rate [N/mm]'", "mixed units"),
        (METRIC + "A,1,fifty,80\n", "row 2, column 'free length [mm]'", "'fifty' is not a number"),
        (METRIC + "A,1,50 parsec,80\n", "row 2", "'parsec' is no unit of a length"),
        (METRIC + "A,1,,80\n", "row 2, column 'free length [mm]'", "is empty"),
        (METRIC + ",1,50,80\n", "row 2, column 'part'", "no part number"),
        (METRIC + "A,1,50,40\n", "row 2, column 'max length [mm]'", "no travel"),
        (METRIC + "A,1,50,\n", "row 2", "nothing says how far"),
        (METRIC + "A,1,50,80,90\n", "row 2", "5 cells under 4 headers"),
        ("part,rate,free length,max length\nA,1,50,80\n", "column 'rate'", "no column says its unit"),
        ("part,rate,free length [mm],max length [in]\nA,1,50,80\n", "column 'rate'", "both metric and inch"),
        ("part,rate [N/mm],k [N/mm],L0 [mm],Ln [mm]\nA,1,1,5,8\n", "springs.csv", "both 'rate \\[N/mm\\]' and 'k"),
        ("part,type,R [N/mm],L0 [mm],Ln [mm]\nA,wave,1,5,8\n", "row 2, column 'type'", "no kind of spring"),
        (METRIC + '"A\nB",1,50,80\nC,x,50,80\n', "row 4, column 'rate [N/mm]'", "'x' is not a number"),
        (METRIC + 'A,1,50,80\n"B,1,50,80\nC,1,50,80\n', "row 3", "a quote is amiss"),
        (METRIC + "A,1,50,80\n" + "B" * 200_000 + ",1,50,80\n", "row 3", "more than 131072 characters"),
        (METRIC + "A,=B2*2,50,80\n", "row 2, column 'rate [N/mm]'", "'=B2\\*2' is not a number"),
        (METRIC + 'A,"1,5",50,80\n', "row 2, column 'rate [N/mm]'", "'1,5' is not a number"),
        (METRIC + "A,1e300,50,80\n", "row 2, column 'rate [N/mm]'", "beyond all springs"),
    ],
)
def test_faults_are_told_with_row_and_column(tmp_path, text, where, words):
    with pytest.raises(InputError, match=words) as error:
        eq.read_catalogue(write(tmp_path, text))
    assert where in error.value.where
    assert error.value.exit_code == 2


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings_are_recognised(tmp_path, encoding):
    """Excel's ways of saving text; thousands with points, decimals with commas."""
    file = tmp_path / "springs.csv"
    file.write_bytes("Artikelnr.;Federrate [N/m];L0 [mm];Länge max. [mm]\nZ-Ø1;1.234,5;50,5;80\n".encode(encoding))
    found = eq.read_catalogue(file, columns={"longest": "Länge max. [mm]"})
    assert found.part == ("Z-Ø1",)
    assert (found.rate[0], found.free_length[0]) == pytest.approx((1234.5, 0.0505))


PIECES = ["1", "-1", "0", "1,5", "1.234,5", "1e400", "1e308", "5 mm", "2 in", "=A1", "", "nan", '"a\nb"', '"', "x,y",
          "1..2", "1,2,3", "±3", "٣", "\x85", "\x0b", "a\rb", "\0", "N/mm"]  # fmt: skip


@st.composite
def files(draw):
    """Tables with a few cells amiss, in any encoding, or no table at all."""
    mark, end = draw(st.sampled_from(",;\t|")), draw(st.sampled_from(["\n", "\r\n", "\r", "\n\n"]))
    heads = ["part", "rate [N/mm]", "free length [mm]", "max length [mm]", "wire [mm]", "outside diameter [mm]", "type"]
    count = draw(st.integers(3, len(heads)))
    good = st.integers(1, 90).map(str)
    bad = st.one_of(st.sampled_from(PIECES), st.text(max_size=4))
    rows = [
        [f"P{i}", *(draw(bad if draw(st.integers(0, 9)) == 0 else good) for _ in heads[1:count])]
        for i in range(draw(st.integers(0, 3)))
    ]
    text = end.join(mark.join(row) for row in [heads[:count], *rows])
    return draw(st.one_of(st.just(text.encode(draw(st.sampled_from(["utf-8", "utf-16"])), "ignore")), st.binary()))


@settings(max_examples=150, deadline=None, database=None, derandomize=True)
@given(files())
def test_any_file_is_read_or_refused(raw):
    """Whatever stands in a file: numbers that are finite, or a message, never a fault of our own."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "springs.csv"
        file.write_bytes(raw)
        with contextlib.suppress(InputError):
            found = eq.read_catalogue(file)
            for values in (found.rate, found.free_length, found.travel, found.mass, found.initial_tension):
                assert np.isfinite(values).all()


def test_a_file_that_is_none(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        eq.read_catalogue(tmp_path / "none.csv")
    (tmp_path / "binary.csv").write_bytes(b"part\0rate")
    with pytest.raises(InputError, match="no text file"):
        eq.read_catalogue(tmp_path / "binary.csv")
    with pytest.raises(InputError, match="no column 'rte' to map"):
        eq.read_catalogue(write(tmp_path, INCH), columns={"rte": "Rate (lbs/in)"})
    with pytest.raises(InputError, match="no header 'Rte'"):
        eq.read_catalogue(write(tmp_path, INCH), columns={"rate": "Rte"})


def test_units_that_cells_mix_are_told_by_row(tmp_path):
    text = "part,Rate,L0,Ln\nA,0.5 N/mm,50 mm,80 mm\nB,3 lbs/in,60 mm,90 mm\n"
    with pytest.raises(InputError, match="mixed units: '3 lbs/in' in a column in N/mm") as caught:
        eq.read_catalogue(write(tmp_path, text))
    assert "row 3, column 'Rate'" in caught.value.where


def test_a_rate_that_its_wire_cannot_have_is_remarked(tmp_path):
    text = "part,d [mm],D [mm],n,R [N/mm],L0 [mm],Ln [mm]\nA,2,20,30,0.679,100,200\nB,2,20,30,6.79,100,200\n"
    found = eq.read_catalogue(write(tmp_path, text))
    assert len(found.remarks) == 1
    assert found.remarks[0].startswith("row 3: the rate of B is 10")


def test_the_grid_holds_what_can_be_wound():
    grid = eq.MakeableGrid(wire=(0.001, 0.002), index=(3.0, 6.0, 10.0), coils=(1.0, 20.0), tension=(0.5, 1.0))
    found = grid.catalogue()
    sizes = eq.preferred_sizes()
    count = int(((sizes > 0.00099) & (sizes < 0.00201)).sum())
    assert len(found) == count * 2 * 1 * 2
    assert any(f"{count * 4} left out: spring index outside 4..20" in remark for remark in found.remarks)
    for row in range(0, len(found), 7):
        spring = found.spring(row)
        assert spring.k == pytest.approx(found.rate[row])
        assert spring.span[1] - spring.span[0] == pytest.approx(found.travel[row])
        assert spring.own_mass == pytest.approx(found.mass[row])
    with pytest.raises(InputError, match="no wire to try"):
        eq.MakeableGrid(wire=(0.03, 0.04)).catalogue()
    with pytest.raises(InputError, match=r"can be wound: .* spring index"):
        eq.MakeableGrid(index=(2.0,)).catalogue()


def test_filters_say_how_many_they_removed():
    whole = eq.read_catalogue(STOCK)
    assert len(whole) == 1300
    kept, removed = eq.Pick(catalogue=STOCK, part="SY-00*", width=0.01, mass=0.01).table()
    assert removed["part SY-00*"] == 1300 - 99
    assert len(kept) == 99 - sum(count for words, count in removed.items() if "part" not in words)
    assert (kept.width <= 0.01).all()
    with pytest.raises(InputError, match="none of its 1300 springs is left: 1300 by part XY") as error:
        eq.Pick(catalogue=STOCK, part="XY*").table()
    assert "relax the filter" in error.value.hint
    with pytest.raises(InputError, match="keep is 0"):
        eq.Pick(keep=0)
    with pytest.raises(InputError, match="both asked for"):
        eq.Pick(catalogue=STOCK, grid=eq.MakeableGrid())


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ("{wire: 30 mm, diameter: 200 mm, coils: 5}", "wire 30 mm is outside EN 10270-1 SH"),
        ("{wire: 1 mm, diameter: 3 mm, coils: 5}", "spring index D / d is 3, it must lie in 4..20"),
        ("{wire: 2 mm, diameter: 20 mm, coils: 9, initial_tension: 200 N}", "200 N cannot be wound"),
        ("{wire: 2 mm, diameter: 20 mm, coils: 9, grade: SW}", "no wire 'SW'"),
    ],
)
def test_a_part_that_cannot_be_made_names_its_line(tmp_path, capsys, law, words):
    file = tmp_path / "arm.yaml"
    file.write_text(
        "mechanism: {chain: {links: [{name: arm, length: 600 mm, mass: 4 kg}]}}\n"
        "balancers:\n  - spring:\n      name: s1\n"
        "      path: {line: [[world, 0, 0, 300 mm], [arm, 200 mm, 0, 0]]}\n"
        f"      law: {{extension_spring: {law}}}\n"
    )
    assert main(["balance", str(file)]) == 2
    said = capsys.readouterr().err
    assert words in said
    assert "line 6, balancers[0].spring.law.extension_spring" in said
