"""The snippets of the README and the docs run: YAML is read as a problem, Python is executed."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from equipoise.problem import load_problem
from equipoise.problemfile import ProblemFile

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def snippets(language):
    """Every fenced block of a language, as (page and number, text)."""
    for page in PAGES:
        found = [text for kind, text in FENCE.findall(page.read_text()) if kind == language]
        for number, text in enumerate(found, 1):
            yield pytest.param(page, text, id=f"{page.relative_to(ROOT)}:{number}")


def problems():
    """YAML blocks of whole problems; those of a law or a path alone are read by the tests of their pages."""
    known = {field.name for field in fields(ProblemFile)}
    return [block for block in snippets("yaml") if known & set(YAML(typ="safe").load(block.values[1]))]


# What a page's snippets leave out stands in its first: the arm and the spring that the others speak of.
FIRST = {page: next((text for kind, text in FENCE.findall(page.read_text()) if kind == "yaml"), "") for page in PAGES}


@pytest.mark.parametrize(("page", "text"), problems())
def test_a_yaml_snippet_is_a_valid_problem(page, text, tmp_path):
    reader = YAML(typ="safe")
    said, first = reader.load(text), reader.load(FIRST[page])
    whole = {key: first[key] for key in ("mechanism", "balancers") if key in first} | said
    file = tmp_path / "problem.yaml"
    with file.open("w") as stream:
        YAML().dump(whole, stream)
    problem = load_problem(file)
    problem.check()
    assert len(problem.sweep.poses) > 0


@pytest.mark.parametrize(("page", "text"), list(snippets("python")))
def test_a_python_snippet_runs(page, text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(text, str(page), "exec"), {})


def test_links_lead_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#]+)", page.read_text()):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name} links to {target}"


def test_the_first_shell_block_is_the_two_commands():
    kind, text = FENCE.findall((ROOT / "README.md").read_text())[0]
    lines = text.strip().splitlines()
    assert kind == "sh"
    assert len(lines) == 2
    assert "equipoise design examples/ur10_shoulder.yaml" in lines[0]
    assert lines[1].endswith("pytest")
