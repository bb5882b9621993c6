"""What the literature gave: every key resolves, and a design cites what it uses."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import re
from pathlib import Path

import pytest

import equipoise
import equipoise as eq
from equipoise.reporting.references import entries, reference

ROOT = Path(equipoise.__file__).parent
KEY = re.compile(r"[\[\s]([a-z]+(?:_[a-z]+)*_\d{4}|" + "|".join(entries()) + r")(?=[\],])")
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef)


def docstrings():
    """(file, name, docstring) of everything in the package that has one."""
    for file in sorted(ROOT.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, DOCUMENTED) and (text := ast.get_docstring(node)):
                yield file.relative_to(ROOT), getattr(node, "name", ""), text


def classes():
    """Every class of the package."""
    for module in pkgutil.walk_packages(equipoise.__path__, "equipoise."):
        if module.name.endswith("__main__"):
            continue
        for item in vars(importlib.import_module(module.name)).values():
            if isinstance(item, type) and item.__module__ == module.name:
                yield item


def test_keys_in_docstrings_stand_in_the_bibliography():
    found = {key for _, _, text in docstrings() for key in KEY.findall(text)}
    assert {"quaglia_yin_2015", "arakelian_smith_2008", "drillis_contini_1966"} <= found
    assert found <= set(entries())


def test_classes_name_the_sources_that_their_docstrings_cite():
    named = [item for item in classes() if "sources" in vars(item) and isinstance(item.sources, tuple)]
    assert len(named) >= 8
    for item in named:
        assert set(item.sources) <= set(entries()), item
    for item in classes():
        cited = set(KEY.findall(item.__doc__ or ""))
        assert cited <= set(getattr(item, "sources", ())), item


def test_every_entry_is_a_sentence():
    for key in entries():
        assert reference(key).count(".") >= 1
        assert "{" not in reference(key)


def test_a_design_cites_its_mechanism_parts_and_solver():
    leg = eq.human_leg(80.0, 1.8)
    wire = eq.WireMass(diameter=0.03, coils=80, wire_length=8.0)
    ends = eq.Line(leg.at("world", 0.05, 0, 0.1), leg.at("thigh", 0.2))
    spring = eq.Spring("s", ends, eq.ZeroFreeLength(k=500.0), mass=wire)
    weight = eq.Counterweight("w", leg.at("shank", -0.1))
    over = eq.Sweep.grid(leg, {"hip": (-2.0, -1.0, 3)})
    assert eq.balance(leg, [spring, weight], over).cite() == [
        "mujoco", "clarabel", "bmc_segments", "drillis_contini_1966", "arakelian_ghazaryan_2008",
    ]  # fmt: skip
    assert "highs" in eq.balance(leg, [weight], over, norm="peak").cite()


@pytest.mark.parametrize("table", ["winter", "de_leva_male"])
def test_body_tables_name_where_they_were_read(table):
    assert set(eq.human_leg(80.0, 1.8, table=table).sources) <= set(entries())
