"""What the columns of a catalogue are called, and in which units they are written."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Column:
    """A column that a catalogue may have: what it is, its dimension, and the names it goes by.

    names are compared without case, blanks, dots and abbreviations; symbols with case, as `d` is a wire and `D` a coil.
    """

    key: str
    kind: str
    names: tuple[str, ...]
    symbols: tuple[str, ...] = ()


COLUMNS = (
    Column(
        "part", "text",
        ("part", "part number", "partno", "part #", "p/n", "pn", "sku", "article", "article number", "artikel",
         "artikelnummer", "artikel nr", "artikelnr", "bestellnummer", "bestell nr", "bestellnr", "order code",
         "order number", "stock number", "stock #", "catalog number", "catalogue number", "item", "item number",
         "number", "reference", "ref", "code", "lee stock number"),
    ),
    Column(
        "rate", "rate",
        ("rate", "spring rate", "spring constant", "stiffness", "federrate", "federkonstante", "federsteifigkeit",
         "raideur", "constant", "k factor"), ("R", "k", "c", "K"),
    ),
    Column(
        "free_length", "length",
        ("free length", "length free", "unloaded length", "length unloaded", "length", "lange", "länge",
         "freie länge", "ungespannte länge", "länge ungespannt", "unbelastete länge", "länge unbelastet",
         "length inside hooks", "free length inside hooks", "longueur libre", "fl"),
        ("L0", "Lo", "L", "L_0"),
    ),
    Column(
        "initial_tension", "force",
        ("initial tension", "initial load", "initial force", "innere vorspannkraft", "vorspannkraft", "vorspannung",
         "preload", "it"), ("F0", "Fo", "Fi", "F_0"),
    ),
    Column(
        "longest", "length",
        ("max length", "max extended length", "extended length", "length at max load", "loaded length",
         "length loaded", "länge gespannt", "max länge", "gespannte länge", "größte länge"),
        ("Ln", "Lmax", "L_n"),
    ),
    Column("solid", "length", ("solid length", "solid height", "min length", "blocklänge"), ("Lc",)),
    Column(
        "force", "force",
        ("max load", "max force", "load at max length", "load", "suggested max load", "load capacity", "max kraft",
         "größte kraft", "max federkraft", "federkraft"), ("Fn", "Fmax", "F_n", "F2"),
    ),
    Column(
        "travel", "length",
        ("max deflection", "max travel", "travel", "max extension", "deflection", "suggested max deflection",
         "federweg", "max federweg", "größter federweg", "stroke"), ("sn", "s_n", "Sn"),
    ),
    Column("outside", "length",
           ("outside diameter", "outer diameter", "coil outside diameter", "od", "aussendurchmesser",
            "außendurchmesser", "äußerer durchmesser"), ("De", "Da", "OD", "D_e")),
    Column("diameter", "length",
           ("mean diameter", "mean coil diameter", "mittlerer durchmesser", "mittlerer windungsdurchmesser"),
           ("D", "Dm", "D_m")),
    Column("wire", "length",
           ("wire", "wire diameter", "wire size", "wire thickness", "drahtdurchmesser", "drahtstärke", "drahtdicke",
            "draht"), ("d",)),
    Column("coils", "number",
           ("active coils", "coils", "number of coils", "number of active coils", "windungen", "windungszahl",
            "anzahl windungen", "wirksame windungen", "federnde windungen", "turns"), ("n", "Na")),
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


_LONG = {
    "dia": "diameter", "diam": "diameter", "ø": "diameter", "len": "length", "ext": "extended", "defl": "deflection",
    "maximum": "max", "maximale": "max", "maximaler": "max", "minimum": "min", "number": "no", "nr": "no",
}  # fmt: skip


def unit_of(text: str, kind: str) -> str | None:
    """The unit that a word stands for in a column of a kind, or None."""
    word = text.strip().lower().rstrip(".").replace(" ", "").replace("per", "/").replace("in./", "in/")
    return _UNITS.get(kind, {}).get(word)


def recognise(header: str) -> tuple[str, str | None] | None:
    """(column, unit or None) of a header such as `Spring Rate [lbs/in]`; None for what nobody here knows."""
    found = _SPLIT.match(header.strip())
    name, unit = (found.group(1), next((g for g in found.groups()[1:] if g), None)) if found else (header, None)
    for candidate, said in (*_named(name, unit), (header.strip(), None), *_tail(name)):
        column = _SYMBOLS.get(candidate.strip()) or _NAMES.get(_plain(candidate))
        if column is not None:
            return column.key, unit_of(said, column.kind) if said else None
    return None


def _plain(name: str) -> str:
    """A name without case, blanks, dots and abbreviations."""
    words = re.sub(r"[\s._-]+", " ", name.strip().lower()).split()
    return " ".join(_LONG.get(word, word) for word in words)


_SYMBOLS = {symbol: column for column in COLUMNS for symbol in column.symbols}
_NAMES = {_plain(name): column for column in COLUMNS for name in column.names}


def _named(name: str, unit: str | None) -> tuple[tuple[str, str | None], ...]:
    """`Länge L0`, `max. Länge Ln`: a symbol of two letters behind its name says more than the name; then the name."""
    words = name.split()
    last = words[-1] if len(words) > 1 else ""
    symbol = ((last, unit),) if len(last) > 1 and last in _SYMBOLS else ()
    return (*symbol, (name, unit))


def _tail(name: str) -> tuple[tuple[str, str], ...]:
    """`Rate N/mm`, `free_length_mm`: a unit, or a symbol of one letter, as the last word."""
    words = re.split(r"[\s_]+", name.strip())
    return ((" ".join(words[:-1]), words[-1]),) if len(words) > 1 else ()
