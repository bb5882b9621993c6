"""The public names: what `equipoise` offers flat, and that nothing shadows it."""

from __future__ import annotations

import pkgutil

import equipoise as eq


def test_no_module_bears_a_public_name():
    modules = {module.name for module in pkgutil.iter_modules(eq.__path__)}
    assert modules
    assert not modules & set(eq.__all__)
