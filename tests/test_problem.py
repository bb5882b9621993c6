"""Problem files: what may be written, what it becomes, its JSON Schema, and broken files in bounded time."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import equipoise as eq
from equipoise.errors import EquipoiseError, ProblemError
from equipoise.problem import load_problem, problem_of, schema
from equipoise.tags import BALANCERS, LAWS, LIMITS, MECHANISMS, SWEEPS
from equipoise.units import COMMON, enumerated, to_si
from equipoise.yamlfile import parse_yaml

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.yaml"))
ARM = "mechanism: {chain: {links: [{name: arm, length: 1}]}}\n"


def read(text: str):
    return problem_of(parse_yaml(text, "p.yaml"), Path())


def spring(law: str):
    line = "{line: [[world, 0, 0, 1], [arm, 1]]}"
    return read(ARM + f"balancers: [{{spring: {{name: s, path: {line}, law: {law}}}}}]").balancers[0]


def test_every_way_to_write_a_law():
    assert spring("zero_free_length").law == eq.ZeroFreeLength()
    assert spring("{zero_free_length: }").law == eq.ZeroFreeLength()
    assert spring("{zero_free_length: {k: 0.4 N/mm}}").law == eq.ZeroFreeLength(k=400.0)
    assert spring("{zero_free_length: [400]}").law == eq.ZeroFreeLength(k=400.0)
    assert spring("coil").law == eq.Coil(free_length=None)
    assert spring("{coil: {free_length: 30 cm, initial_tension: null}}").law == eq.Coil(0.3, initial_tension=None)


def test_points_fill_in_order_or_by_name():
    by_list = spring("constant").path
    by_name = (
        read(
            ARM + "balancers: [{spring: {name: s, law: constant, path: {line: "
            "{a: {body: world, z: 1000 mm}, b: {body: arm, x: 1}}}}}]"
        )
        .balancers[0]
        .path
    )
    assert by_list == by_name == eq.Line(eq.Point("world", (0, 0, 1)), eq.Point("arm", (1, 0, 0)))


def test_numbers_follow_yaml_1_2():
    data = parse_yaml("{a: 1e-3, b: on, c: 010, d: 0x1F, e: 1_000, f: yes, g: .5, h: '5', i: ~}", "x").data
    assert data == {"a": 1e-3, "b": "on", "c": 10, "d": 31, "e": "1_000", "f": "yes", "g": 0.5, "h": "5", "i": None}


def test_units_of_free_parameters_follow_the_parameter():
    problem = read(
        ARM + "balancers: [{spring: {name: s, law: {coil: [1]}, path: {line: [[world, 0, 0, 1], [arm, 1]]}}}]\n"
        "shape: {s.law.k: [0.1 N/mm, 3 kN/m], s.path.line.b.x: [10 mm, 1], s.law.free_length: [10 mm, 1]}"
    )
    assert problem.bounds == {
        "s.law.k": (100.0, 3000.0),
        "s.path.line.b.x": (0.01, 1.0),
        "s.law.free_length": (0.01, 1.0),
    }


def test_sweeps_and_payloads():
    problem = read(
        ARM + "sweep: {grid: {arm_joint: [-90 deg, 0.5, 7]}, payload: [{body: arm, mass: [0, 500 g], at: [1, 0, 0]}]}"
    )
    sweep = problem.sweep
    assert sweep.poses[[0, -1], 0] == pytest.approx([-math.pi / 2, 0.5])
    assert sweep.scenarios.tolist() == [[0.0], [0.5]]
    assert len(read(ARM + "sweep: sobol").sweep.poses) == 2048
    assert len(read(ARM).sweep.poses) == 2048
    assert read(ARM + "sweep: {poses: [{arm_joint: 30 deg}]}").sweep.poses == pytest.approx(np.array([[math.pi / 6]]))


def test_paths_count_from_the_file(tmp_path, monkeypatch):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub/poses.csv").write_text("arm_joint [deg]\n90\n")
    (tmp_path / "sub/p.yaml").write_text(ARM + "sweep: {poses: poses.csv}")
    monkeypatch.chdir(tmp_path)
    assert load_problem("sub/p.yaml").sweep.poses == pytest.approx(np.array([[math.pi / 2]]))


def test_an_objective_is_a_block_or_a_list():
    one = read(ARM + "objective: {norm: peak, target: 35 N m}").objective
    two = read(ARM + "objective: [{norm: rms}, {norm: peak, cap: 50 %, divisor: motor}]").objective
    assert one == (eq.Aim(norm="peak", target=35.0),)
    assert [aim.cap for aim in two] == [None, 0.5]


def test_all_faults_of_a_file_are_told_in_its_order():
    with pytest.raises(ProblemError) as caught:
        read(ARM + "sweep: {sobol: many}\nlimits: [{stroke: s, max: 1 kg}]\nobjective: {norm: big}")
    text = str(caught.value)
    assert text.index("line 2, sweep.sobol") < text.index("line 3, limits[0].max") < text.index("line 4, objective")


def test_texts_that_pint_would_evaluate_are_refused_at_once():
    for text in ("9^9^9^9 m", "9**9**9 m", "1 " + "a" * 60 + "!", "m", "5 kg * (2", "[1] m", "1 m^99"):
        with pytest.raises(EquipoiseError):
            to_si(text, "m")
    assert to_si("35 Nm", "N m") == 35.0
    assert to_si("-30°", "rad") == pytest.approx(-math.pi / 6)


def test_a_number_without_unit_may_be_a_share():
    assert to_si("1/3", "") == 1 / 3
    assert to_si("-2 / 4", "") == -0.5
    for text in ("1/0", "1/00", "1/", "1/2/3", "1/-2", "1/" + "9" * 12):
        with pytest.raises(EquipoiseError):
            to_si(text, "")
    with pytest.raises(EquipoiseError):
        to_si("1/3", "m")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_schema_accepts_the_examples_and_refuses_what_the_reader_refuses(path):
    validator = jsonschema.Draft202012Validator(schema())
    data = load_problem(path).raw
    validator.validate(data)
    for fault in ({"sweeps": 1}, {"limits": [{"stroke": "s1", "maxx": 1}]}, {"search": {"starts": "many"}}):
        assert list(validator.iter_errors({**data, **fault}))


@pytest.mark.parametrize(("unit", "name"), [(unit, name) for unit, names in COMMON.items() for name in names])
def test_common_units_are_those_of_the_registry(unit, name, monkeypatch):
    for options in (unit, f"N m or {unit}" if unit in ("rad", "m") else f"{unit} or rad" if unit else unit):
        ours = to_si(f"-1.7e2 {name}", options)
        with monkeypatch.context() as patched:
            patched.setattr("equipoise.units.COMMON", {})
            theirs = to_si(f"-1.7e2 {name}", options)
        assert ours == pytest.approx(theirs, rel=4e-16)
        assert getattr(ours, "unit", None) == getattr(theirs, "unit", None)


def test_the_schema_holds_every_tag_and_says_the_units():
    whole = schema()
    jsonschema.Draft202012Validator.check_schema(whole)
    text = str(whole)
    for tag in (*MECHANISMS, *SWEEPS, *BALANCERS, *LAWS, *LIMITS):
        assert f"'{tag}'" in text
    assert "a number in N/m, or text with a unit" in text


@dataclasses.dataclass(frozen=True)
class Cubic(eq.Linear):
    """A law that joins by being listed."""

    cubic: float | None = None


def test_a_class_joins_by_being_listed(monkeypatch):
    from equipoise import forms

    monkeypatch.setitem(LAWS, "cubic", Cubic)
    forms.adapter.cache_clear()
    try:
        assert spring("{cubic: {cubic: 3}}").law == Cubic(cubic=3.0)
    finally:
        monkeypatch.undo()
        forms.adapter.cache_clear()


BASE = EXAMPLES[-1].read_text(encoding="utf-8")
SNIPPETS = st.sampled_from(
    ["null", "[]", "{}", "-1", ".nan", "1e999", "'", '"', "*a", "&a ", "!!x ", "- ", ": ", "? ", "\t", "\x00", "{a: ",
     "spring", "line", "5 m", "5 kg", "9^9^9 m", "%", "|\n", "<<: ", "true", "[[", "]]", "\u2028", "\ufeff", "😀"]
)  # fmt: skip


@settings(max_examples=120, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_broken_files_are_refused_in_words(data):
    text = BASE
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        length = data.draw(st.integers(0, 30))
        text = text[:start] + data.draw(SNIPPETS) + text[start + length :]
    try:
        problem = read(text)
        problem.mechanism, problem.bounds, problem.objective  # noqa: B018
    except EquipoiseError as error:
        told = error
    else:
        return
    assert str(told)
    assert told.exit_code == 2


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-5, 5) | st.floats() | st.sampled_from(["s1", "5 m", "coil", "world", ""]),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from([*LAWS, *LIMITS, *SWEEPS, "name", "spring", "max", "links"]), inner, max_size=3
        )
    ),
    max_leaves=6,
)
TOP = ["mechanism", "sweep", "balancers", "shape", "search", "limits", "objective", "other"]


@settings(max_examples=150, suppress_health_check=list(HealthCheck))
@given(st.dictionaries(st.sampled_from(TOP), VALUES, max_size=4))
def test_odd_data_is_refused_in_words(data):
    from equipoise.yamlfile import Document

    try:
        problem_of(Document("odd", {"mechanism": {"chain": {"links": []}}, **data}), Path())
    except EquipoiseError as error:
        told = error
    else:
        return
    assert told.exit_code == 2


@pytest.mark.parametrize(
    "text",
    ["[" * 20_000, "{" * 20_000, "- " * 20_000, "a: &a [" + "x," * 9 + "]\n" + "".join(
        f"{c}: &{c} [{','.join(['*' + p] * 9)}]\n" for p, c in zip("abcdefgh", "bcdefghi", strict=True)), "9" * 5000],
    ids=["brackets", "braces", "dashes", "aliases", "digits"],
)  # fmt: skip
def test_bombs_go_off_in_words(text):
    with pytest.raises(ProblemError):
        parse_yaml(text, "bomb.yaml")


def test_a_file_that_is_too_large(tmp_path):
    (tmp_path / "big.yaml").write_bytes(b"#" * 300_000)
    with pytest.raises(ProblemError, match="larger than 256 kB"):
        load_problem(tmp_path / "big.yaml")
    (tmp_path / "latin.yaml").write_bytes(b"a: 1\nb: \xff\n")
    with pytest.raises(ProblemError, match="UTF-8"):
        load_problem(tmp_path / "latin.yaml")


def test_words_are_enumerated():
    told = [enumerated(words) for words in ([], ["a"], ["a", "b"], ["a", "b", "c"])]
    assert told == ["", "a", "a and b", "a, b and c"]
