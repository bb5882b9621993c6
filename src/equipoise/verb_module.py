"""Subpackages that are called like a verb (`report`, `verify`) and therefore answer to a call."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import Any


class VerbModule(ModuleType):
    """A module that can be called: the verb of the same name in `equipoise.verbs`.

    Importing `equipoise.report.words` puts the subpackage where `equipoise.report`, the verb, was; so the
    subpackage must do what the verb does, whatever was imported first.
    """

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Call the verb."""
        name = self.__name__.rpartition(".")[2]
        return getattr(importlib.import_module(f"equipoise.verbs.{name}"), name)(*args, **options)


def answer_calls(module: str) -> None:
    """Make a subpackage callable; it says so in its own `__init__`."""
    sys.modules[module].__class__ = VerbModule
