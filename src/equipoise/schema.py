"""JSON Schema of problem files: pydantic's own, with the short ways of writing forms and families added."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema

from equipoise.forms import MARK, Family, Form

Block = dict[str, Any]
Mark = TypeVar("Mark", Form, Family)
_KIND = "x-kind"


class _Generator(GenerateJsonSchema):
    """Notes which block came from which form or family."""

    marks: dict[str, Form | Family]

    def function_wrap_schema(self, schema: Any) -> Block:
        block = super().function_wrap_schema(schema)
        mark = schema.get("metadata", {}).get(MARK)
        if mark is None:
            return block
        kind = schema["ref"]
        self.marks = {**getattr(self, "marks", {}), kind: mark}
        return {**block, _KIND: kind}


def json_schema(adapter: TypeAdapter[Any]) -> Block:
    """The schema (draft 2020-12) of what an adapter reads."""
    generator = _Generator(by_alias=True, ref_template="#/$defs/{model}")
    whole = generator.generate(adapter.core_schema, mode="validation")
    defs = whole.get("$defs", {})

    def resolved(block: Block) -> Block:
        return defs[block["$ref"].removeprefix("#/$defs/")] if "$ref" in block else block

    def spelled(kind: type[Mark], rewrite: Callable[[Mark, Block, Callable[[Block], Block]], Block]) -> None:
        for block in list(_blocks(whole)):
            mark = generator.marks.get(block.get(_KIND, ""))
            if isinstance(mark, kind):
                new = rewrite(mark, {key: value for key, value in block.items() if key != _KIND}, resolved)
                block.clear()
                block.update(new)

    # Families read the plain fields of their forms, so forms get their other spellings last.
    spelled(Family, _family)
    spelled(Form, _form)
    for block in _blocks(whole):
        block.pop(_KIND, None)
        if "oneOf" in block:
            # Branches of a union are told apart by their shape, which a list of three shares with any list.
            block["anyOf"] = block.pop("oneOf")
            block.pop("discriminator", None)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "equipoise problem file", **whole}


def _blocks(node: Any) -> Iterator[Block]:
    """All objects of a schema, the inner ones first."""
    for child in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        yield from _blocks(child)
    if isinstance(node, dict):
        yield node


def _form(form: Form, block: Block, _resolved: Callable[[Block], Block]) -> Block:
    """Fields by name, or listed in order."""
    defs = {"$defs": block.pop("$defs")} if "$defs" in block else {}
    required = block.get("required", [])
    listed = {
        "type": "array",
        "prefixItems": list(block["properties"].values()),
        "items": False,
        "minItems": len(required),
    }
    named = {**block, "additionalProperties": False, "description": inspect.getdoc(form.constructor) or form.name}
    first = [next(iter(block["properties"].values()))] if form.bare else []
    # `tag:` with nothing behind it is a constructor without arguments.
    ways = [named, listed] if block["properties"] else [named]
    return {"title": form.name, "anyOf": [*ways, *first, *([] if required else [{"type": "null"}])], **defs}


def _family(family: Family, block: Block, resolved: Callable[[Block], Block]) -> Block:
    """One block per tag; the tag alone where no field is needed."""
    options: list[Block] = []
    bare = []
    for tag, reference in block["properties"].items():
        form = resolved(reference)
        required = form.get("required", [])
        if not required:
            bare.append(tag)
        entry: Block = {"properties": {tag: reference}, "required": [tag]}
        if family.leads(tag):
            first = next(iter(form["properties"]))
            entry["properties"] = {tag if name == first else name: item for name, item in form["properties"].items()}
            entry["required"] = [tag, *(name for name in required if name != first)]
            entry["description"] = inspect.getdoc(family.members()[tag]) or tag
        options.append({"title": tag, "type": "object", "additionalProperties": False, **entry})
    return {"title": family.what, "anyOf": [*options, *([{"enum": bare}] if bare else [])]}
