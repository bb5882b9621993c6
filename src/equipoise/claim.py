"""A claim: a printed number or sentence of a paper, ours beside it, and a verdict that follows from the two."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Literal

from equipoise.errors import InputError

Verdict = Literal["reproduced", "reproduced with correction", "not reproduced", "underspecified"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "reproduced with correction", "not reproduced", "underspecified")
ROUNDING = 1e-9
SMALL = 1e-6


@dataclass(frozen=True)
class Claim:
    """One printed number or checkable sentence of a paper.

    claim says in our words what is printed at `where`; printed holds the source's digits, None for a sentence;
    ours the value that physics and the paper's data give, None where the paper does not say enough; tol half a
    unit of the last printed digit, or what a stated reading allows, None for bounds, ranges and sentences;
    agrees compares the two (None where nothing can be compared); correction says what had to be put right in
    the paper's text before they agreed; note adds the reading and the reason.
    """

    paper: str
    claim: str
    where: str
    printed: str | None
    ours: float | None
    unit: str = ""
    agrees: bool | None = None
    tol: float | None = None
    correction: str = ""
    remark: str = ""

    @property
    def verdict(self) -> Verdict:
        """The verdict, which nobody types: it follows from the comparison and from whether a correction was needed."""
        if self.agrees is None:
            return "underspecified"
        if not self.agrees:
            return "not reproduced"
        return "reproduced with correction" if self.correction else "reproduced"

    @property
    def note(self) -> str:
        """The correction, the reading and the reason."""
        return "; ".join(part for part in (self.correction, self.remark) if part)

    def json(self) -> dict[str, Any]:
        """The claim as `equipoise reproduce --json` prints it; printed digits become a number where they are one."""
        printed = None if self.printed is None else _number(self.printed)
        return {
            "paper": self.paper,
            "claim": self.claim,
            "where": self.where,
            "printed": self.printed if printed is None else float(printed),
            "ours": self.ours,
            "tol": self.tol,
            "unit": self.unit,
            "verdict": self.verdict,
            "note": self.note,
        }


@dataclass(frozen=True)
class Reason:
    """Why a printed number differs from the one its text leads to: in words, and the value it gives."""

    words: str
    gives: float


@dataclass(frozen=True)
class Source:
    """A paper under examination: it makes the claims that carry its name."""

    paper: str

    def number(
        self,
        claim: str,
        where: str,
        printed: str,
        ours: float,
        unit: str = "",
        *,
        correction: Reason | None = None,
        slip: Reason | None = None,
        about: tuple[float, str] | None = None,
        note: str = "",
    ) -> Claim:
        """A printed number: |ours - printed| <= half a unit of its last digit.

        ours follows the paper's text to the letter; correction mends the text (a misprinted input, equation or
        unit) and its value replaces ours where it gives the printed digits and the letter does not; slip
        explains a printed number that is itself wrong, and stands in the note only. about is (tolerance,
        reading) for a number printed as approximate.
        Raises ValueError for a correction that is not needed: the printed text then needs no mending.
        """
        tol, reading = about or (half_unit(printed), "")
        remarks = [reading, note]
        letter = _near(ours, printed, tol)
        if correction is not None:
            if letter:
                raise ValueError(f"{self.paper}, {where}: {claim} needs no correction")
            remarks.append(f"to the letter {digits(ours, tol)}")
            ours = correction.gives
        if slip is not None:
            same = "the printed digits" if _near(slip.gives, printed, tol) else "not the printed digits either"
            remarks.append(f"{slip.words} gives {digits(slip.gives, tol)}, {same}")
        remark = "; ".join(part for part in remarks if part)
        words = correction.words if correction else ""
        near = _near(ours, printed, tol)
        return self._made(claim, where, printed, ours, tol=tol, unit=unit, agrees=near, correction=words, remark=remark)

    def at_most(
        self, claim: str, where: str, printed: str, ours: float, unit: str = "", *, note: str = "", correction: str = ""
    ) -> Claim:
        """A printed upper bound: ours <= printed, rounded as printed."""
        holds = ours <= float(_digits(printed)) + half_unit(printed)
        remark = f"read as at most; {note}" if note else "read as at most"
        return self._made(claim, where, printed, ours, unit=unit, agrees=holds, correction=correction, remark=remark)

    def at_least(
        self, claim: str, where: str, printed: str, ours: float, unit: str = "", *, note: str = "", correction: str = ""
    ) -> Claim:
        """A printed lower bound: ours >= printed, rounded as printed."""
        holds = ours >= float(_digits(printed)) - half_unit(printed)
        remark = f"read as at least; {note}" if note else "read as at least"
        return self._made(claim, where, printed, ours, unit=unit, agrees=holds, correction=correction, remark=remark)

    def between(
        self,
        claim: str,
        where: str,
        printed: tuple[str, str],
        ours: float,
        unit: str = "",
        *,
        note: str = "",
        correction: str = "",
    ) -> Claim:
        """A printed range: lower <= ours <= upper, ends included, rounded as printed."""
        low, high = (float(_digits(end)) for end in printed)
        holds = low - half_unit(printed[0]) <= ours <= high + half_unit(printed[1])
        ends = " to ".join(printed)
        return self._made(claim, where, ends, ours, unit=unit, agrees=holds, correction=correction, remark=note)

    def sentence(
        self,
        claim: str,
        where: str,
        ours: float,
        holds: Callable[[float], bool],
        unit: str = "",
        *,
        note: str,
        correction: str = "",
    ) -> Claim:
        """A checkable sentence: `ours` is the number that decides it and `holds` the test that it must pass.

        note says what the number is and what was tested; correction what had to be put right in the sentence.
        """
        held = bool(holds(ours))
        return self._made(claim, where, None, ours, unit=unit, agrees=held, correction=correction, remark=note)

    def underspecified(self, claim: str, where: str, printed: str | None, unit: str = "", *, note: str) -> Claim:
        """A printed number or sentence that the paper gives too little to compute; note says what is missing."""
        return self._made(claim, where, printed, None, unit=unit, agrees=None, remark=note)

    def _made(self, claim: str, where: str, printed: str | None, ours: float | None, **rest: Any) -> Claim:
        made = Claim(self.paper, claim, where, printed, None if ours is None else float(ours), **rest)
        if not made.note and not made.agrees:
            raise ValueError(f"{self.paper}, {where}: {claim} needs a note that says why")
        return made


def half_unit(printed: str) -> float:
    """Half a unit of the last printed digit: 0.05 for `324.5`, 0.5 for `1,114`, 50 for `1.1e3`.

    Raises InputError for text that is not a number.
    """
    exponent = _digits(printed).as_tuple().exponent
    assert isinstance(exponent, int)
    return float(Decimal(5).scaleb(exponent - 1))


def digits(value: float, tol: float | None) -> str:
    """A value with two digits more than the tolerance it is judged by, six significant digits without one."""
    if not tol:
        return f"{value:.1g}" if abs(value) < SMALL else f"{value:.6g}"
    decimals = max(0, 2 - Decimal(repr(2 * tol)).adjusted())
    return f"{value:.{decimals}f}"


def _near(ours: float, printed: str, tol: float) -> bool:
    return bool(abs(ours - float(_digits(printed))) <= tol * (1 + ROUNDING))


def _number(printed: str) -> Decimal | None:
    text = printed.replace("−", "-").replace(",", "").strip()
    return Decimal(text) if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text) else None


def _digits(printed: str) -> Decimal:
    value = _number(printed)
    if value is None:
        raise InputError(f"{printed!r} is not a printed number", hint="give its digits alone, the unit apart")
    return value
