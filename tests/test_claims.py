"""Claims: verdicts follow from numbers; the papers' pages, tables and JSON keep to the contract."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

import equipoise as eq
from equipoise.claim import VERDICTS, Reason, Source, half_unit
from equipoise.cli import main
from equipoise.papers import SLUGS, find, paper
from equipoise.papers.pages import markdown
from equipoise.reporting.references import entries

DOCS = Path(__file__).parent.parent / "docs" / "papers"
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")
S = Source("a-paper-2000")


@pytest.mark.parametrize(
    ("printed", "half"),
    [("299", 0.5), ("324.5", 0.05), ("-0.089", 0.0005), ("1,114", 0.5), ("1.1e3", 50), ("0.80", 0.005)],
)
def test_half_a_unit_of_the_last_printed_digit(printed, half):
    assert half_unit(printed) == pytest.approx(half, rel=1e-12)


@pytest.mark.parametrize(
    ("ours", "verdict"),
    [(324.45, "reproduced"), (324.55, "reproduced"), (324.449, "not reproduced"), (-324.5, "not reproduced")],
)
def test_a_number_is_judged_by_its_last_digit(ours, verdict):
    assert S.number("k", "Eq. 1", "324.5", ours, "N/m", note="why").verdict == verdict


def test_a_correction_must_be_needed_and_must_help():
    mended = S.number("k", "Eq. 1", "324.5", 324.16, correction=Reason("wire rounded", 324.47))
    assert (mended.verdict, mended.ours) == ("reproduced with correction", 324.47)
    assert "wire rounded" in mended.note
    assert "324.160" in mended.note
    failed = S.number("k", "Eq. 1", "324.5", 324.16, correction=Reason("wire rounded", 320.0))
    assert failed.verdict == "not reproduced"
    with pytest.raises(ValueError, match="needs no correction"):
        S.number("k", "Eq. 1", "324.5", 324.5, correction=Reason("wire rounded", 324.47))


def test_a_slip_explains_and_does_not_excuse():
    wrong = S.number("k", "Eq. 21", "1114", 1107.3, slip=Reason("C2^2 dropped", 1114.2))
    assert wrong.verdict == "not reproduced"
    assert wrong.ours == 1107.3
    assert "C2^2 dropped gives 1114.20, the printed digits" in wrong.note
    assert "not the printed digits either" in S.number("k", "x", "1114", 1107.3, slip=Reason("g = 10", 1110.0)).note


def test_bounds_ranges_sentences_and_gaps():
    assert S.at_most("elongation", "I", "25", 25.4, "%").verdict == "reproduced"
    assert S.at_most("elongation", "I", "25", 59.0, "%").verdict == "not reproduced"
    assert S.at_least("reduction", "I", "90", 95.0, "%").verdict == "reproduced"
    assert S.between("error", "I", ("10", "15"), 15.6, "%", note="n").verdict == "not reproduced"
    assert S.between("error", "I", ("10", "15"), 12, "%", note="n").json()["printed"] == "10 to 15"
    assert S.sentence("less", "I", 1.2, lambda x: x < 1, note="n").verdict == "not reproduced"
    assert S.underspecified("k", "I", "522", note="n").verdict == "underspecified"
    assert S.number("C", "V", "195", 195.4, about=(2.0, "about")).tol == 2.0
    with pytest.raises(ValueError, match="needs a note"):
        S.number("k", "I", "522", 500.0)
    with pytest.raises(eq.InputError, match="not a printed number"):
        S.number("k", "I", "522 N/m", 522.0)


@pytest.mark.parametrize("slug", SLUGS)
def test_a_paper_keeps_the_contract(slug):
    one = paper(slug)
    assert one.slug == slug
    assert one.key in entries()
    claims = one.claims()
    assert claims
    seen = {(claim.where, claim.claim, claim.printed) for claim in claims}
    assert len(seen) == len(claims)
    for row in json.loads(json.dumps([claim.json() for claim in claims], allow_nan=False)):
        assert list(row) == ["paper", "claim", "where", "printed", "ours", "tol", "unit", "verdict", "note"]
        assert row["paper"] == slug
        assert row["verdict"] in VERDICTS
        assert row["note"] or row["verdict"] == "reproduced"
        assert (row["ours"] is None) == (row["verdict"] == "underspecified")
        if row["tol"] is not None:
            near = math.isclose(row["ours"], row["printed"], abs_tol=row["tol"] * (1 + 1e-6), rel_tol=0)
            assert near == row["verdict"].startswith("reproduced"), row


@pytest.mark.parametrize("slug", SLUGS)
def test_the_documentation_is_what_the_claims_say(slug):
    """Words exactly, numbers to 1e-3 (optima differ in late digits between machines)."""
    one = paper(slug)
    fresh = markdown(one, one.claims(), one.improved())
    kept = (DOCS / f"{slug}.md").read_text(encoding="utf-8")
    hint = "python -m equipoise.papers docs/papers writes the pages anew"
    assert NUMBER.sub("#", kept) == NUMBER.sub("#", fresh), hint
    for old, new in zip(NUMBER.findall(kept), NUMBER.findall(fresh), strict=True):
        assert float(old) == pytest.approx(float(new), rel=1e-3, abs=1e-9), hint


def test_every_page_has_its_paper():
    assert {page.stem for page in DOCS.glob("*.md")} == set(SLUGS)


def test_a_paper_is_found_by_an_unambiguous_part():
    assert find() == SLUGS
    for slug in SLUGS:
        assert find(slug) == find(slug.upper().replace("-", "_")) == (slug,)
    assert find("ghazaryan") == ("arakelian-ghazaryan-2008",)
    for wrong in ("nobody", "", "-"):
        with pytest.raises(eq.InputError):
            find(wrong)


def test_reproduce_on_the_command_line(tmp_path, capsys):
    slug = "quaglia-yin-2015"
    assert main(["reproduce", slug, "--json", "--out", str(tmp_path / "out")]) == 0
    out, err = capsys.readouterr()
    rows = json.loads(out)
    assert {row["paper"] for row in rows} == {slug}
    assert slug in err
    page = (tmp_path / "out" / f"{slug}.html").read_text(encoding="utf-8")
    assert all(verdict in page for verdict in {row["verdict"] for row in rows})
    assert json.loads((tmp_path / "out" / f"{slug}.json").read_text())["claims"] == rows
    pictures = list((tmp_path / "out").glob("*.png"))
    assert len(pictures) == len(paper(slug).drawings)
    assert main(["reproduce", "nobody"]) == 2
    assert "fits no paper" in capsys.readouterr().err


def test_the_table_reads_on_a_terminal(capsys):
    assert main(["reproduce", "ghazaryan"]) == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert max(map(len, err.splitlines())) <= 120
    assert "claims: " in err
