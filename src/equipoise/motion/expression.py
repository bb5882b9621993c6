"""Expressions in t: a small grammar read from Python's syntax tree, never evaluated as code."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping

import numpy as np

from equipoise.affine import Array
from equipoise.errors import InputError, nearest
from equipoise.motion.jet import FUNCTIONS, Jet

LONGEST = 500
DEEPEST = 40
CONSTANTS = {"pi": math.pi, "deg": math.pi / 180.0}
_OPERATORS: dict[type[ast.operator], Callable[[Jet, Jet], Jet]] = {
    ast.Add: Jet.__add__,
    ast.Sub: Jet.__sub__,
    ast.Mult: Jet.__mul__,
    ast.Div: Jet.__truediv__,
    ast.Pow: Jet.__pow__,
}
GRAMMAR = f"numbers, t, T, pi, deg, + - * / **, brackets, {', '.join(FUNCTIONS)}"


def check(text: str, where: str) -> ast.expr:
    """The syntax tree of an expression in t; raises InputError for anything outside the grammar.

    The grammar: numbers, t (s), T (the duration, s), pi, deg, + - * / **, brackets and the functions of `FUNCTIONS`.
    """
    if len(text) > LONGEST:
        raise InputError(f"the expression has {len(text)} characters, the limit is {LONGEST}", where=where)
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise InputError(f"cannot read the expression {text[:60]!r}", where=where, hint=f"use {GRAMMAR}") from None
    _check(tree, where, 0)
    return tree


def _check(node: ast.expr, where: str, depth: int) -> None:
    if depth > DEEPEST:
        raise InputError(f"the expression is nested deeper than {DEEPEST} levels", where=where)
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as value) if abs(value) < 1e300:
            return
        case ast.Name(id=name):
            known = ["t", "T", *CONSTANTS]
            if name not in known:
                hint = f"call it: {name}(...)" if name in FUNCTIONS else nearest(name, known)
                raise InputError(f"the expression names {name!r}, which is no variable", where=where, hint=hint)
            return
        case ast.UnaryOp(op=ast.UAdd() | ast.USub(), operand=operand):
            _check(operand, where, depth + 1)
            return
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            _check(left, where, depth + 1)
            _check(right, where, depth + 1)
            return
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]):
            if name not in FUNCTIONS:
                raise InputError(f"there is no function {name!r}", where=where, hint=nearest(name, list(FUNCTIONS)))
            _check(argument, where, depth + 1)
            return
    raise InputError(f"{ast.unparse(node)[:60]!r} is outside the grammar", where=where, hint=f"use {GRAMMAR}")


def evaluate(text: str, t: Array, duration: float, where: str) -> Jet:
    """An expression with its two time derivatives at t (N,), s; raises InputError where it is not finite."""
    names = {"T": duration, **CONSTANTS}
    with np.errstate(all="ignore"):
        jet = _value(check(text, where), Jet.time(np.asarray(t, dtype=float)), names)
    for what, values in (("value", jet.value), ("velocity", jet.rate), ("acceleration", jet.bend)):
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise InputError(f"the {what} of {text[:60]!r} is {values[bad[0]]} at t = {t[bad[0]]:.6g} s", where=where)
    return jet


def _value(node: ast.expr, t: Jet, names: Mapping[str, float]) -> Jet:
    match node:
        case ast.Constant(value=int() | float() as value):
            return Jet.constant(float(value), t.value)
        case ast.Name(id=name):
            return t if name == "t" else Jet.constant(names[name], t.value)
        case ast.UnaryOp(op=op, operand=operand):
            inner = _value(operand, t, names)
            return -inner if isinstance(op, ast.USub) else inner
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATORS[type(op)](_value(left, t, names), _value(right, t, names))
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            return FUNCTIONS[name](_value(argument, t, names))
    raise AssertionError("checked before")
