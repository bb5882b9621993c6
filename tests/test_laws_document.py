"""Every snippet of docs/laws.md is a spring that the problem file reads and that balances an arm."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import equipoise as eq
from equipoise.problem import load_problem
from equipoise.tags import LAWS

TEXT = (Path(__file__).parents[1] / "docs" / "laws.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.DOTALL)
PROBLEM = """\
mechanism: {{chain: {{links: [{{name: elbow, length: 0.4, mass: 3}}]}}}}
sweep: {{grid: {{elbow_joint: [-40 deg, 60 deg, 21]}}}}
balancers:
  - spring:
      name: s1
{body}
objective: {{goal: hold, norm: rms}}
"""
LINE = "      path: {line: [[world, 0, 0, 60 cm], [elbow, 30 cm, 0, 0]]}\n"


def problem(tmp_path, snippet):
    body = "".join(f"      {line}\n" for line in snippet.splitlines())
    if "path:" not in snippet:
        body = LINE + body
    file = tmp_path / "problem.yaml"
    file.write_text(PROBLEM.format(body=body), encoding="utf-8")
    return load_problem(file)


@pytest.mark.parametrize("snippet", SNIPPETS, ids=[snippet.split("\n")[0][:40] for snippet in SNIPPETS])
def test_snippets_are_springs(tmp_path, snippet):
    found = problem(tmp_path, snippet)
    found.check()
    design = eq.balance(found.mechanism, found.balancers, found.sweep, norm="rms")
    part = design.parts()[0]
    assert design.after["elbow_joint"].rms > 0
    assert set(part["units"]) == set(part["parameters"])


def test_every_law_has_a_snippet():
    assert [tag for tag in LAWS if not re.search(rf"law:\s+\{{?{tag}\b|^  {tag}:", "\n".join(SNIPPETS), re.M)] == []
