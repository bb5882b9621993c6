"""A paper's page: HTML with its figures for `--out`, Markdown for the documentation."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from equipoise import __version__
from equipoise.claim import Claim
from equipoise.papers import words
from equipoise.papers.paper import Drawing, Improvement, Paper
from equipoise.reporting import style
from equipoise.reporting.markup import Raw, element, image, join, listing, prose, section, small, table
from equipoise.reporting.numbers import sig
from equipoise.reporting.references import entries, reference

DPI = 150


def html(paper: Paper, claims: Sequence[Claim], improved: Sequence[Improvement], out: Path) -> str:
    """The page as HTML text; every figure is drawn once, and also written to `out` as a PNG file."""
    pictures = [_drawn(paper, drawing, out) for drawing in paper.drawings]
    body = join(
        [
            element(
                "header",
                element("p", "A paper recomputed", class_="kicker"),
                element("h1", entries()[paper.key]["title"]),
                element("p", reference(paper.key), class_="sub-line"),
            ),
            section("What it is about", element("p", paper.about), element("p", f"Taken as given: {paper.given}")),
            section("What to know before using its results", listing([prose(text) for text in paper.findings])),
            *pictures,
            section("Claim by claim", _claims(claims), lead=words.tally(claims)),
            section("What the same parts can do", _improved(improved)) if improved else "",
            element("footer", f"Computed by equipoise {__version__}: equipoise reproduce {paper.slug}"),
        ],
        "\n",
    )
    css = (files("equipoise") / "reporting" / "page.css").read_text(encoding="utf-8")
    head = join(
        [
            Raw('<meta charset="utf-8">'),
            Raw('<meta name="viewport" content="width=device-width, initial-scale=1">'),
            element("title", paper.slug),
            Raw(f"<style>\n{css}</style>"),
        ],
        "\n",
    )
    page = element("html", element("head", head), element("body", element("main", body)), lang="en")
    return f"<!doctype html>\n{page}\n"


def file_name(paper: Paper, drawing: Drawing) -> str:
    """`<slug>_figure_2.png`."""
    return f"{paper.slug}_{drawing.name.lower().replace(' ', '_')}.png"


def _drawn(paper: Paper, drawing: Drawing, out: Path) -> Raw:
    with style.styled():
        figure = drawing.draw()
        figure.savefig(out / file_name(paper, drawing), dpi=DPI)
    return section(drawing.name, image(style.picture(figure), drawing.caption, drawing.caption))


def _claims(claims: Sequence[Claim]) -> Raw:
    rows = [
        (
            claim.where,
            join([words.worded(claim), small(claim.note)]),
            claim.printed or "",
            words.value(claim),
            claim.verdict,
        )
        for claim in claims
    ]
    return table(("Where", "Claim", "Printed", "Ours", "Verdict"), rows, numbers=2)


def _improved(improved: Sequence[Improvement]) -> Raw:
    rows = [
        (
            join([one.what, small("; ".join(part for part in (one.over, _values(one), one.note) if part))]),
            one.norm,
            "" if one.published is None else f"{sig(one.published)} {one.unit}",
            f"{sig(one.ours)} {one.unit}",
            one.certificate,
        )
        for one in improved
    ]
    return table(("Free", "Norm", "Published", "Ours", "Certificate"), rows, numbers=1)


def _values(one: Improvement) -> str:
    return ", ".join(f"{name} {text}" for name, text in one.values.items())


def markdown(paper: Paper, claims: Sequence[Claim], improved: Sequence[Improvement]) -> str:
    """The page of the documentation."""
    lines = [f"# {paper.slug}", "", reference(paper.key), "", paper.about, "", f"Taken as given: {paper.given}", ""]
    lines += [
        f"`equipoise reproduce {paper.slug} --out out/` computes this table anew and draws the paper's figures.",
        "",
        "## What to know before using its results",
        "",
        *(f"- {text}" for text in paper.findings),
        "",
        "## Claim by claim",
        "",
        f"{words.tally(claims)}.",
        "",
        "| where | claim | printed | ours | verdict |",
        "|---|---|---|---|---|",
    ]
    lines += [
        _row(claim.where, words.worded(claim), claim.printed or "", words.value(claim), _verdict(claim))
        for claim in claims
    ]
    if improved:
        lines += ["", "## What the same parts can do", "", "| free | over | norm | published | ours | design |"]
        lines += ["|---|---|---|---|---|---|"]
        lines += [
            _row(
                one.what,
                one.over,
                one.norm,
                "" if one.published is None else f"{sig(one.published)} {one.unit}",
                f"{sig(one.ours)} {one.unit}" + (f" ({one.certificate})" if one.certificate else ""),
                "; ".join(part for part in (_values(one), one.note) if part),
            )
            for one in improved
        ]
    return "\n".join(lines) + "\n"


def _verdict(claim: Claim) -> str:
    return f"**{claim.verdict}**: {claim.note}" if claim.note else f"**{claim.verdict}**"


def _row(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
