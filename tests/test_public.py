"""The public names: what `equipoise` offers flat, that nothing shadows it, and what importing it does not load."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import subprocess
import sys

import pytest

import equipoise as eq


def test_no_module_bears_a_public_name():
    modules = {module.name for module in pkgutil.iter_modules(eq.__path__)}
    assert modules
    assert not modules & set(eq.__all__)


def test_the_lists_of_public_names_agree():
    tree = ast.parse(inspect.getsource(eq))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    typed = {
        alias.name: node.module.removeprefix("equipoise.")
        for node in block.body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }
    assert typed == eq._HOME
    assert sorted(eq.__all__) == sorted(["__version__", *eq._HOME])


@pytest.mark.parametrize("name", eq.__all__)
def test_every_public_name_answers(name):
    value = getattr(eq, name)
    if name in eq._HOME:
        home = importlib.import_module(f"equipoise.{eq._HOME[name]}")
        assert value is getattr(home, name)
        assert (value.__doc__ or "").strip()
    assert name in dir(eq)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'Sprig'"):
        eq.Sprig  # noqa: B018


HEAVY = ("clarabel", "ezdxf", "highspy", "matplotlib", "mujoco", "numpy", "pint", "pydantic", "ruamel", "scipy")
SOLVERS = ("clarabel", "ezdxf", "highspy", "matplotlib", "pint", "scipy.interpolate", "scipy.optimize", "scipy.stats")
HELP = """
import contextlib, io
from equipoise.cli import main
sys.argv = ["equipoise", "--help"]
with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.suppress(SystemExit):
    main()
assert "design" in said.getvalue()
"""


@pytest.mark.parametrize(
    ("code", "absent"),
    [
        pytest.param("import equipoise", (*HEAVY, "rich", "typer"), id="import equipoise"),
        pytest.param(HELP, HEAVY, id="equipoise --help"),
        pytest.param("import equipoise.problem", SOLVERS, id="import equipoise.problem"),
    ],
)
def test_what_is_not_imported_before_it_is_used(code, absent):
    report = "\nprint(*sorted(set(sys.modules)))"
    run = subprocess.run(
        [sys.executable, "-c", "import sys\n" + code + report], capture_output=True, text=True, check=True
    )
    loaded = set(run.stdout.split())
    assert "equipoise" in loaded
    assert not loaded & set(absent)
