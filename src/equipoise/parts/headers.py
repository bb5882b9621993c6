"""What the columns of a catalogue are called, and in which units they are written."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Column:
    """A column that a catalogue may have: what it is, its dimension, and the names it goes by.

    names are compared without case, blanks and dots; symbols with case, as `d` is a wire and `D` a coil.
    """

    key: str
    kind: str
    names: tuple[str, ...]
    symbols: tuple[str, ...] = ()


COLUMNS = (
    Column(
        "part", "text",
        ("part", "part number", "part no", "partno", "part #", "p/n", "pn", "sku", "article", "article no",
         "article number", "artikel", "artikelnummer", "artikel nr", "artikelnr",
         "bestellnummer", "bestell nr", "bestellnr", "order code",
         "order number", "order no", "stock number", "stock no", "stock #", "catalog number", "catalogue number",
         "catalog no", "item", "item number", "number", "no", "nr", "reference", "ref", "code", "lee stock number"),
    ),
    Column(
        "rate", "rate",
        ("rate", "spring rate", "spring constant", "stiffness", "federrate", "federkonstante", "raideur", "constant",
         "k factor"), ("R", "k", "c", "K"),
    ),
    Column(
        "free_length", "length",
        ("free length", "length free", "unloaded length", "length unloaded", "length", "lange", "länge",
         "freie länge", "ungespannte länge", "length inside hooks", "free length inside hooks", "longueur libre", "fl"),
        ("L0", "Lo", "L", "L_0"),
    ),
    Column(
        "initial_tension", "force",
        ("initial tension", "initial load", "initial force", "innere vorspannkraft", "vorspannkraft", "vorspannung",
         "preload", "it"), ("F0", "Fo", "Fi", "F_0"),
    ),
    Column(
        "longest", "length",
        ("max length", "maximum length", "max extended length", "maximum extended length", "extended length",
         "length at max load", "loaded length", "length loaded", "länge gespannt", "max ext length"),
        ("Ln", "Lmax", "L_n"),
    ),
    Column("solid", "length", ("solid length", "solid height", "min length", "minimum length", "blocklänge"), ("Lc",)),
    Column(
        "force", "force",
        ("max load", "maximum load", "max force", "maximum force", "load at max length", "load", "suggested max load",
         "load capacity", "max kraft", "federkraft"), ("Fn", "Fmax", "F_n", "F2"),
    ),
    Column(
        "travel", "length",
        ("max deflection", "maximum deflection", "max travel", "maximum travel", "travel", "max extension",
         "maximum extension", "deflection", "suggested max deflection", "federweg", "stroke"), ("sn", "s_n", "Sn"),
    ),
    Column("outside", "length", ("outside diameter", "outer diameter", "od", "aussendurchmesser", "außendurchmesser"),
           ("De", "Da", "OD", "D_e")),
    Column("diameter", "length", ("mean diameter", "mean coil diameter", "mittlerer durchmesser"), ("D", "Dm", "D_m")),
    Column("wire", "length", ("wire", "wire diameter", "wire dia", "wire size", "drahtdurchmesser", "draht"), ("d",)),
    Column("coils", "number", ("active coils", "coils", "number of coils", "windungen", "turns"), ("n", "Na")),
    Column("mass", "mass", ("mass", "weight", "gewicht", "masse"), ("m",)),
    Column("grade", "text", ("material", "grade", "werkstoff", "wire grade", "mat")),
    Column("form", "text", ("form", "type", "kind", "spring type", "typ", "art")),
)  # fmt: skip

KINDS = {column.key: column.kind for column in COLUMNS}

METRIC = {"length": "mm", "force": "N", "rate": "N/mm", "mass": "g"}
INCH = {"length": "in", "force": "lbf", "rate": "lbf/in", "mass": "lb"}
SYSTEMS = {"metric": METRIC, "inch": INCH}

_UNITS = {
    "length": {"mm": "mm", "cm": "cm", "m": "m", "in": "in", "inch": "in", "inches": "in", '"': "in", "ins": "in"},
    "force": {"n": "N", "kn": "kN", "lb": "lbf", "lbs": "lbf", "lbf": "lbf", "pound": "lbf", "pounds": "lbf",
              "oz": "ozf", "ozf": "ozf", "kgf": "kgf", "kg": "kgf"},
    "rate": {"n/mm": "N/mm", "n/m": "N/m", "n/cm": "N/cm", "lb/in": "lbf/in", "lbs/in": "lbf/in", "lbf/in": "lbf/in",
             "lb/inch": "lbf/in", "lbs/inch": "lbf/in", "pounds/inch": "lbf/in", "ozf/in": "ozf/in", "oz/in": "ozf/in",
             "kgf/mm": "kgf/mm", "kg/mm": "kgf/mm", "nmm": "N/mm"},
    "mass": {"g": "g", "kg": "kg", "mg": "mg", "lb": "lb", "lbs": "lb", "oz": "oz", "gram": "g", "grams": "g"},
}  # fmt: skip
FACTORS = {
    "mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254,
    "N": 1.0, "kN": 1e3, "lbf": 4.4482216152605, "ozf": 4.4482216152605 / 16, "kgf": 9.80665,
    "N/mm": 1e3, "N/m": 1.0, "N/cm": 1e2, "lbf/in": 4.4482216152605 / 0.0254, "ozf/in": 4.4482216152605 / 16 / 0.0254,
    "kgf/mm": 9806.65, "g": 1e-3, "kg": 1.0, "mg": 1e-6, "lb": 0.45359237, "oz": 0.028349523125, "": 1.0,
}  # fmt: skip
"""SI value of one of each unit; exact by definition."""
IMPERIAL = ("in", "lbf", "ozf", "lbf/in", "ozf/in", "lb", "oz")

_SPLIT = re.compile(r"^(.*?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])]|,\s*([^,\s]+(?:/\w+)?)|\bin\s+(\S+))?\s*$")


def unit_of(text: str, kind: str) -> str | None:
    """The unit that a word stands for in a column of a kind, or None."""
    word = text.strip().lower().rstrip(".").replace(" ", "").replace("per", "/").replace("in./", "in/")
    return _UNITS.get(kind, {}).get(word)


def recognise(header: str) -> tuple[str, str | None] | None:
    """(column, unit or None) of a header such as `Spring Rate [lbs/in]`; None for what nobody here knows."""
    found = _SPLIT.match(header.strip())
    name, unit = (found.group(1), next((g for g in found.groups()[1:] if g), None)) if found else (header, None)
    for candidate, said in ((name, unit), (header.strip(), None), *_tail(name)):
        for column in COLUMNS:
            plain = re.sub(r"[\s._-]+", " ", candidate.strip().lower()).strip()
            if candidate.strip() in column.symbols or plain in column.names:
                return column.key, unit_of(said, column.kind) if said else None
    return None


def _tail(name: str) -> tuple[tuple[str, str], ...]:
    """`Rate N/mm`, `free_length_mm`: a unit as the last word."""
    words = re.split(r"[\s_]+", name.strip())
    return ((" ".join(words[:-1]), words[-1]),) if len(words) > 1 else ()
