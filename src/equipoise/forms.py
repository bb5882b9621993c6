"""Forms: how a block of a problem file mirrors a constructor, derived from the constructor's own annotations.

A dataclass or function is a form: its parameters are the fields, `units.Quantity` marks say the units, a list
fills the fields in order. A `Family` is a tagged union of forms. Pydantic does the reading and the JSON Schema.
"""

from __future__ import annotations

import functools
import inspect
import typing
from collections.abc import Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field, is_dataclass
from typing import Annotated, Any

from pydantic_core import PydanticCustomError, core_schema

from equipoise.errors import EquipoiseError, nearest

Constructor = Callable[..., Any]
MARK = "equipoise"
"""The key under which a core schema names the form or family that it was made from."""


@dataclass
class Reading:
    """What validation needs to know of its file, and what it notes of how blocks were written.

    lists {id of a list: names of the fields it fills}; folded {id of a block: (tag, its first field)}.
    """

    folder: str = ""
    lists: dict[int, tuple[str, ...]] = field(default_factory=dict)
    folded: dict[int, tuple[str, str]] = field(default_factory=dict)


def fail(message: str, hint: str = "", key: Any = None) -> PydanticCustomError:
    """An error at the present place of the file, or at one of its entries."""
    context: dict[str, Any] = {"message": message, "hint": hint, "key": key}
    return PydanticCustomError("equipoise", "{message}", context)


def words(value: Any) -> str:
    """A value as an error message shows it."""
    if value is None:
        return "nothing"
    if isinstance(value, str):
        return f"the text {value[:40]!r}"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return f"the number {value:g}" if abs(value) < 1e300 else "a number out of range"
    return f"a list of {len(value)}" if isinstance(value, list) else "a block"


@dataclass(frozen=True)
class Later:
    """A constructor with its arguments, called when the mechanism is known or wanted."""

    constructor: Constructor
    arguments: Mapping[str, Any]

    def __call__(self, *leading: Any, **changed: Any) -> Any:
        """Call the constructor, the mechanism first where it takes one."""
        return self.constructor(*leading, **{**self.arguments, **changed})

    def asks(self, name: str) -> bool:
        """Whether the constructor takes something of this name."""
        return name in inspect.signature(self.constructor).parameters


HANDED = ("mechanism", "balancers")
"""What functions that build from a problem get from it."""


@functools.cache
def parameters(constructor: Constructor) -> dict[str, tuple[Any, bool, bool]]:
    """Fields of a constructor in order: {name: (type, required, may be null)}; what the problem hands over is none."""
    hints = typing.get_type_hints(constructor, include_extras=True)
    found = {}
    for name, parameter in inspect.signature(constructor).parameters.items():
        if name in HANDED and not is_dataclass(constructor):
            continue
        hint = hints.get(name, str)
        empty = type(None) in typing.get_args(hint)
        found[name] = (hint, parameter.default is inspect.Parameter.empty and not empty, empty)
    return found


def _scalar(hint: Any) -> bool:
    """Whether a type is written as one number or word."""
    while typing.get_origin(hint) is Annotated:
        hint = typing.get_args(hint)[0]
    return hint in (str, int, float)


@dataclass(frozen=True)
class Form:
    """The fields of one constructor."""

    constructor: Constructor
    later: bool = False

    @property
    def name(self) -> str:
        """The constructor's name, which the schema uses."""
        return self.constructor.__qualname__.replace(".", "_")

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        from equipoise.fields import annotation

        fields = {
            name: core_schema.typed_dict_field(handler.generate_schema(annotation(hint)), required=required)
            for name, (hint, required, _) in parameters(self.constructor).items()
        }
        inner = core_schema.typed_dict_schema(fields, extra_behavior="forbid")
        return core_schema.with_info_wrap_validator_function(self._read, inner, ref=self.name, metadata={MARK: self})

    def _read(self, value: Any, handler: Any, info: Any) -> Any:
        known = parameters(self.constructor)
        given = self._fields(value, tuple(known), info.context)
        for name in given:
            if name not in known:
                hint = nearest(name, list(known))
                raise fail(f"{self.word} has no field {name!r}", hint, key=name)
        arguments = handler(given)
        for name, (_, _, empty) in known.items():
            # A parameter that may be None and has no default is an unknown of the program: leaving it out says so.
            if empty and inspect.signature(self.constructor).parameters[name].default is inspect.Parameter.empty:
                arguments.setdefault(name, None)
        if self.later:
            return Later(self.constructor, arguments)
        try:
            return self.constructor(**arguments)
        except EquipoiseError as error:
            raise fail(error.message, error.hint) from None

    @property
    def word(self) -> str:
        """What messages call the block."""
        return self.constructor.__name__.lower().replace("_", " ")

    @property
    def bare(self) -> bool:
        """Whether a bare value fills the first field: the only one that must be given, and no block of its own."""
        known = parameters(self.constructor)
        required = [name for name, (_, needed, _) in known.items() if needed]
        return bool(required) and required == list(known)[:1] and _scalar(known[required[0]][0])

    def _fields(self, value: Any, names: tuple[str, ...], reading: Reading) -> Mapping[str, Any]:
        if value is None:
            return {}
        if isinstance(value, list):
            if len(value) > len(names):
                raise fail(f"{len(value)} values for the {len(names)} fields of {self.word}", ", ".join(names))
            reading.lists[id(value)] = names
            return dict(zip(names, value, strict=False))
        if isinstance(value, Mapping):
            return value
        if self.bare and isinstance(value, str | int | float) and not isinstance(value, bool):
            return {names[0]: value}
        example = f"{{{', '.join(f'{name}: ...' for name in names[:3])}{', ...' if len(names) > 3 else ''}}}"
        raise fail(f"expected the fields of {self.word}, got {words(value)}", f"write {example}")


_open: list[str] = []
"""Families whose schemas are being written."""
_whole = ContextVar("_whole", default=False)
"""Whether families are written with all their members; else each member when a file first has it."""


@functools.cache
def adapter(form: Form) -> Any:
    """What reads a form."""
    from pydantic import TypeAdapter

    return TypeAdapter(Annotated[Any, form])


def whole(form: Form) -> Any:
    """What reads a form, with everything that may stand in it written out."""
    from pydantic import TypeAdapter

    before = _whole.set(True)
    try:
        return TypeAdapter(Annotated[Any, form])
    finally:
        _whole.reset(before)


def _member(form: Form, handler: Any) -> core_schema.CoreSchema:
    """A member's schema: to write that of all there are takes longer than to read a file."""
    if _whole.get():
        return handler.generate_schema(Annotated[Any, form])
    return core_schema.with_info_plain_validator_function(
        lambda value, info: adapter(form).validate_python(value, context=info.context)
    )


@dataclass(frozen=True)
class Family:
    """A tagged union: `{coil: {...}}`, or just `coil` where no field is needed.

    members() answers {tag: constructor}. In a leading family the tag's own value is the first field and the
    others stand beside it: `{stroke: s1, max: 600 mm}`; `nested` are the tags whose fields stand within.
    """

    what: str
    members: Callable[[], Mapping[str, Constructor]]
    leading: bool = False
    nested: tuple[str, ...] = ()
    later: bool = False

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        if self.what in _open:
            # A member that holds another of its family, as a gear another gear's angle.
            return core_schema.definition_reference_schema(f"any_{self.what}")
        _open.append(self.what)
        try:
            return self._schema(handler)
        finally:
            _open.pop()

    def _schema(self, handler: Any) -> core_schema.CoreSchema:
        fields = {
            tag: core_schema.typed_dict_field(_member(Form(item, self.later), handler), required=False)
            for tag, item in self.members().items()
        }
        inner = core_schema.typed_dict_schema(fields, extra_behavior="forbid")
        return core_schema.with_info_wrap_validator_function(
            self._read, inner, ref=f"any_{self.what}", metadata={MARK: self}
        )

    def leads(self, tag: str) -> bool:
        """Whether the tag's own value is its first field."""
        return self.leading and tag not in self.nested

    def _read(self, value: Any, handler: Any, info: Any) -> Any:
        members = self.members()
        if isinstance(value, str):
            self._known(value, None)
            value = {value: {}}
        elif not isinstance(value, Mapping):
            raise fail(f"expected a {self.what}, got {words(value)}", f"write {{{next(iter(members))}: ...}}")
        else:
            tags = [key for key in value if key in members]
            if not tags:
                known = list(members)
                if not value:
                    raise fail(f"the {self.what} is empty", nearest("", known))
                self._known(next(iter(value)), next(iter(value)))
            tag = tags[0]
            if self.leads(tag):
                first = next(iter(parameters(members[tag])))
                info.context.folded[id(value)] = (tag, first)
                if first in value and first != tag:
                    raise fail(f"{first!r} is given twice: it is the value of {tag!r}", "remove it", key=first)
                value = {tag: {first if key == tag else key: item for key, item in value.items()}}
            elif len(value) > 1:
                other = next(key for key in value if key != tag)
                hint = f"one of {tag} and {other} only" if other in members else f"move {other} into {{{tag}: {{...}}}}"
                raise fail(f"a {self.what} has one tag, {other!r} stands beside {tag!r}", hint, key=other)
        return next(iter(handler(value).values()))

    def _known(self, tag: str, key: str | None) -> None:
        known = list(self.members())
        if tag not in known:
            raise fail(f"there is no {self.what} {tag!r}", nearest(tag, known), key=key)
