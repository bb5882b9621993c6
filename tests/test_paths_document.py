"""Every snippet of docs/paths.md is a spring that the problem file reads, and that the saved model confirms."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import equipoise as eq
from equipoise.problem import load_problem
from equipoise.tags import PATHS

TEXT = (Path(__file__).parents[1] / "docs" / "paths.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.DOTALL)
PROBLEM = """\
mechanism: {{chain: {{links: [{{name: upper, length: 0.5, mass: 3}}, {{name: fore, length: 0.4, mass: 2}}]}}}}
sweep: {{grid: {{upper_joint: [20 deg, 90 deg, 7], fore_joint: [-60 deg, 30 deg, 5]}}}}
balancers:
  - spring:
      name: s
{body}
objective: {{goal: hold, norm: rms}}
"""
ELSEWHERE = {
    "pinion": "a slide's, in tests/test_vertical.py",
    "reel": "a platform's cable, in docs/cables.md",
    "winding": "its drum, there too",
}


@pytest.mark.parametrize("snippet", SNIPPETS, ids=[snippet.split("\n")[0][:40] for snippet in SNIPPETS])
def test_snippets_are_springs(tmp_path, snippet):
    file = tmp_path / "problem.yaml"
    body = "".join(f"      {line}\n" for line in snippet.splitlines())
    file.write_text(PROBLEM.format(body=body), encoding="utf-8")
    found = load_problem(file)
    found.check()
    design = eq.balance(found.mechanism, found.balancers, found.sweep, norm="rms")
    checked = eq.verify(design, poses=50).verification
    assert checked is not None
    assert checked.agrees
    assert max(error.relative for error in checked.errors.values()) < 1e-8


def test_every_path_is_described():
    shown = "\n".join(SNIPPETS)
    assert [tag for tag in PATHS if tag not in ELSEWHERE and not re.search(rf"\b{tag}:", shown)] == []
    assert [tag for tag in PATHS if f"`{tag}`" not in TEXT] == []
