"""Claims as text for a terminal."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Sequence

from equipoise.claim import VERDICTS, Claim, digits
from equipoise.papers.paper import Improvement, Paper
from equipoise.reporting.numbers import sig
from equipoise.reporting.references import reference

WIDTH = 118
WHERE = 16
CLAIM = 51


def whole(paper: Paper, claims: Sequence[Claim], improved: Sequence[Improvement]) -> str:
    """One paper: title, a block per claim, the count of verdicts, and what can be improved."""
    head = textwrap.fill(reference(paper.key), WIDTH)
    parts = [head, "", table(claims), "", tally(claims)]
    if improved:
        parts += ["", "What the same parts can do", "-" * 26, improvements(improved)]
    return "\n".join(parts)


def table(claims: Sequence[Claim]) -> str:
    """A line per claim, `where  claim  printed  ours  verdict`, with its note below."""
    lines = [f"{'where':<{WHERE}}{'claim':<{CLAIM}}{'printed':>11}{'ours':>12}  verdict"]
    for claim in claims:
        first, *more = textwrap.wrap(worded(claim), CLAIM - 2) or [""]
        printed, ours = claim.printed or "", value(claim)
        lines.append(f"{claim.where[: WHERE - 1]:<{WHERE}}{first:<{CLAIM}}{printed:>11}{ours:>12}  {claim.verdict}")
        lines += [f"{'':<{WHERE}}{line}" for line in more]
        if claim.note:
            lines += textwrap.wrap(
                claim.note, WIDTH - WHERE, initial_indent=" " * (WHERE + 2), subsequent_indent=" " * (WHERE + 2)
            )
    return "\n".join(lines)


def worded(claim: Claim) -> str:
    """The claim with its unit."""
    return f"{claim.claim} [{claim.unit}]" if claim.unit else claim.claim


def value(claim: Claim) -> str:
    """Our value with two digits more than the claim is judged by."""
    return "" if claim.ours is None else digits(claim.ours, claim.tol)


def tally(claims: Sequence[Claim]) -> str:
    """`38 claims: 21 reproduced, 9 reproduced with correction, ...`."""
    found = Counter(claim.verdict for claim in claims)
    counts = ", ".join(f"{found[verdict]} {verdict}" for verdict in VERDICTS if found[verdict])
    return f"{len(claims)} claims: {counts}"


def improvements(improved: Sequence[Improvement]) -> str:
    """Two or three lines per improvement."""
    lines = []
    for one in improved:
        before = "" if one.published is None else f"{sig(one.published)} -> "
        certificate = f"  ({one.certificate})" if one.certificate else ""
        head = f"{one.what}; {one.over}: {one.norm} {before}{sig(one.ours)} {one.unit}{certificate}"
        lines += textwrap.wrap(head, WIDTH, subsequent_indent="  ")
        values = ", ".join(f"{name} {text}" for name, text in one.values.items())
        for text in (values, one.note):
            lines += textwrap.wrap(text, WIDTH - 4, initial_indent="    ", subsequent_indent="    ")
    return "\n".join(lines)
