"""Fields: from a parameter's annotation to what a problem file may write there."""

from __future__ import annotations

import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import is_dataclass
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union

from pydantic import Discriminator, PlainValidator, Tag, WithJsonSchema, WrapValidator

from equipoise.errors import EquipoiseError, nearest
from equipoise.forms import Family, Form, fail, words
from equipoise.units import Quantity, to_si

BRANCH = "|"
"""What begins the tags of a union's branches, which are no part of a place in the file."""

_LISTS = (tuple, list, Sequence)
_BLOCKS = (dict, Mapping)


def annotation(hint: Any) -> Any:
    """The type that pydantic reads for a constructor's annotation."""
    from equipoise.tags import family_of

    if typing.get_origin(hint) is Annotated:
        marks = hint.__metadata__
        quantity = next((mark for mark in marks if isinstance(mark, Quantity)), None)
        family = any(isinstance(mark, Family | Form) for mark in marks)
        return _quantity(quantity.unit) if quantity else hint if family else annotation(typing.get_args(hint)[0])
    if typing.get_origin(hint) is not None:
        return _generic(typing.get_origin(hint), typing.get_args(hint))
    if family := family_of(hint):
        return Annotated[Any, family]
    if hint in _PLAIN:
        return _PLAIN[hint]()
    if is_dataclass(hint):
        return Annotated[Any, Form(typing.cast(Callable[..., Any], hint))]
    raise TypeError(f"a problem file has no way to write {hint}")


def _generic(origin: Any, inner: tuple[Any, ...]) -> Any:
    if origin in (Union, UnionType):
        return _union(inner)
    if origin is Literal:
        return _word(inner)
    if origin is tuple and (len(inner) < 2 or inner[1] is not ...):
        return _tuple(inner)
    if origin in _LISTS:
        return _list(inner[0])
    if origin in _BLOCKS:
        return Annotated[dict[str, annotation(inner[1])], WrapValidator(_block)]
    raise TypeError(f"a problem file has no way to write {origin}")


def _plain(read: Callable[..., Any], schema: dict[str, Any]) -> Any:
    return Annotated[Any, PlainValidator(read), WithJsonSchema(schema)]


def _quantity(unit: str) -> Any:
    def read(value: Any) -> float:
        try:
            if value is None or isinstance(value, list | dict):
                raise fail(f"expected {_called(unit)}, got {words(value)}", _example(unit))
            return to_si(value, unit)
        except EquipoiseError as error:
            raise fail(error.message, error.hint) from None

    return _plain(read, {"type": ["number", "string"], "description": _called(unit)})


def _called(unit: str) -> str:
    return f"a number in {unit}, or text with a unit" if unit else "a number"


def _example(unit: str) -> str:
    return f"write for example 1.5 or '1.5 {unit.split(' or ', 1)[0]}'" if unit else "give a bare number"


def _whole() -> Any:
    def read(value: Any) -> int:
        whole = isinstance(value, int) or (isinstance(value, float) and value.is_integer() and abs(value) < 2**53)
        if isinstance(value, bool) or not whole:
            raise fail(f"expected a whole number, got {words(value)}", "give a bare number such as 24")
        return int(value)

    return _plain(read, {"type": "integer"})


def _text() -> Any:
    def read(value: Any) -> str:
        if not isinstance(value, str) or not value:
            raise fail(
                f"expected text, got {words(value)}", "put it in quotes" if isinstance(value, int | float) else ""
            )
        return value

    return _plain(read, {"type": "string"})


def _file() -> Any:
    def read(value: Any, info: Any) -> str:
        if not isinstance(value, str) or not value:
            raise fail(f"expected a file's path, got {words(value)}")
        if value.startswith("package:") or not info.context.folder:
            return value
        # Paths in a problem file count from the file, wherever the program is started.
        return str(Path(info.context.folder) / Path(value).expanduser())

    return _plain(read, {"type": "string", "description": "a path relative to this file, or package://name/path"})


_PLAIN: dict[Any, Callable[[], Any]] = {
    int: _whole,
    str: _text,
    float: lambda: _quantity(""),
    Path: _file,
    Any: lambda: _plain(_scalar, {"type": ["number", "string"]}),
    type(None): lambda: _plain(_nothing, {"type": "null"}),
}


def _scalar(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise fail(f"expected a number or text with a unit, got {words(value)}")
    return value


def _nothing(value: Any) -> None:
    if value is not None:
        raise fail(f"expected nothing, got {words(value)}")


def _word(allowed: tuple[Any, ...]) -> Any:
    def read(value: Any) -> Any:
        if value not in allowed:
            raise fail(f"expected {' or '.join(map(str, allowed))}, got {words(value)}", nearest(str(value), allowed))
        return value

    return _plain(read, {"enum": list(allowed)})


def _block(value: Any, handler: Any) -> Any:
    if not isinstance(value, dict):
        raise fail(f"expected names with values, got {words(value)}", "write {name: value}")
    return handler(value)


def _list(item: Any) -> Any:
    def read(value: Any, handler: Any) -> Any:
        if not isinstance(value, list):
            raise fail(f"expected a list, got {words(value)}", "write [first, second, ...]")
        return handler(value)

    return Annotated[tuple[annotation(item), ...], WrapValidator(read)]


def _tuple(items: tuple[Any, ...]) -> Any:
    def read(value: Any, handler: Any) -> Any:
        if not isinstance(value, list):
            raise fail(f"expected a list of {len(items)}, got {words(value)}")
        if len(value) != len(items):
            raise fail(f"expected {len(items)} values, got {len(value)}")
        return handler(value)

    return Annotated[tuple[tuple(annotation(item) for item in items)], WrapValidator(read)]


def _union(options: tuple[Any, ...]) -> Any:
    if str in options and Path in options:
        options = tuple(option for option in options if option is not str)
    options = tuple(dict.fromkeys(options))
    if len(options) == 1:
        return annotation(options[0])
    shapes = [_shape(option) for option in options]
    tags = set().union(*(_tags(option) for option in options))

    def choose(value: Any) -> str:
        shape = "null" if value is None else "block" if isinstance(value, dict) else "scalar"
        wanted = [f"list {len(value)}", "list", "form"] if isinstance(value, list) else [shape]
        wanted += ["form", "family"] if shape == "block" else []
        if (isinstance(value, dict) and tags & set(value)) or (isinstance(value, str) and value in tags):
            wanted = ["family", *wanted]
        for kind in [*wanted, *(kind for kind in shapes if kind[:4] == "list" and isinstance(value, list))]:
            if kind in shapes:
                return f"{BRANCH}{shapes.index(kind)}"
        return f"{BRANCH}{next((i for i, kind in enumerate(shapes) if kind != 'null'), 0)}"

    branches = tuple(Annotated[annotation(o), Tag(f"{BRANCH}{i}")] for i, o in enumerate(options))
    return Annotated[Union[branches], Discriminator(choose)]  # noqa: UP007


def _tags(hint: Any) -> set[str]:
    """What a block of a family begins with."""
    from equipoise.tags import family_of

    family = None if typing.get_origin(hint) is not None else family_of(hint)
    return set(family.members()) if isinstance(family, Family) else set()


def _shape(hint: Any) -> str:
    """How a branch of a union is written: null, scalar, list (of a length), block, form or family."""
    from equipoise.tags import family_of

    if typing.get_origin(hint) is Annotated:
        mark = next((m for m in hint.__metadata__ if isinstance(m, Family | Form)), None)
        return "scalar" if mark is None else "form" if isinstance(mark, Form) else "family"
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is tuple and inner[-1] is not ...:
        return f"list {len(inner)}"
    if origin in _LISTS or origin in _BLOCKS:
        return "list" if origin in _LISTS else "block"
    if hint is type(None):
        return "null"
    family = family_of(hint)
    return "family" if isinstance(family, Family) else "form" if family or is_dataclass(hint) else "scalar"
