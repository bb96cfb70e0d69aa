"""Reading YAML 1.2 core with marks."""

import math

import pytest

from mpmcli.core.errors import SceneError
from mpmcli.scene.tree import compose, compose_value


def read(text: str) -> object:
    """The plain value of YAML text."""
    return compose(text, "a.yaml").plain()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1e3", 1000.0),
        ("1E5", 1e5),
        ("1.5e-3", 1.5e-3),
        ("+.5", 0.5),
        ("1.", 1.0),
        ("010", 10),
        ("0o17", 15),
        ("0xff", 255),
        ("-7", -7),
        ("1_000", "1_000"),
        ("12:30:00", "12:30:00"),
        ("2020-01-01", "2020-01-01"),
        ("on", "on"),
        ("no", "no"),
        ("Yes", "Yes"),
        ("y", "y"),
        ("true", True),
        ("False", False),
        ("~", None),
        ("null", None),
        ("", None),
        ("'1e3'", "1e3"),
        ('"true"', "true"),
        ("!!str 3", "3"),
        ("!!float 3", 3.0),
        ("1/3", "1/3"),
        ("=", "="),
        ("9" * 400, math.inf),
        (".inf", math.inf),
        ("-.INF", -math.inf),
    ],
)
def test_scalars_of_yaml_1_2(text: str, expected: object) -> None:
    value = read(f"key: {text}\n")["key"]  # type: ignore[index]
    assert value == expected
    assert type(value) is type(expected)


def test_not_a_number() -> None:
    assert math.isnan(read("a: .nan")["a"])  # type: ignore[index]


def test_marks_point_at_values_and_keys() -> None:
    root = compose("a: 1\nb:\n  - {name: left, c: 2}\n", "a.yaml")
    body = root.value["b"].value[0]
    assert body.value["c"].mark == ("a.yaml", 3, 21)
    assert body.keys["c"] == ("a.yaml", 3, 18)
    assert root.member("b").member("left") is body  # type: ignore[union-attr]
    assert root.member("b").member("0") is body  # type: ignore[union-attr]
    assert root.member("b").member("1") is None  # type: ignore[union-attr]


def test_every_repeated_key_is_told() -> None:
    with pytest.raises(SceneError) as caught:
        compose("a: 1\nb: 2\na: 3\nb: {c: 1, c: 2}\n", "a.yaml")
    assert [(p.path, p.line, p.column) for p in caught.value.problems] == [
        ("a", 3, 1),
        ("c", 4, 11),
        ("b", 4, 1),
    ]
    assert "line 1" in caught.value.problems[0].message


@pytest.mark.parametrize(
    "text",
    ["{value: interpolate(t, 0, 0, 1, 1)}", 'a: {value: interpolate(t, "table.csv")}', "a: [f(1, 'b' 2]"],
)
def test_expressions_that_a_comma_cuts_are_told_to_need_quotes(text: str) -> None:
    with pytest.raises(SceneError) as caught:
        compose(f"{text}\n", "a.yaml")
    assert caught.value.problems[0].message.endswith("; an expression with commas needs quotes")


@pytest.mark.parametrize("text", ["{a: 1, a: 2}", "a: [1, 2", "{title: (1), title: 2}"])
def test_other_texts_need_no_quotes(text: str) -> None:
    with pytest.raises(SceneError) as caught:
        compose(f"{text}\n", "a.yaml")
    assert "quotes" not in caught.value.problems[0].message


def test_aliases_and_merging() -> None:
    assert read("base: &b {x: 1, y: [2]}\nc: {<<: *b, x: 3}\nd: *b\n") == {
        "base": {"x": 1, "y": [2]},
        "c": {"x": 3, "y": [2]},
        "d": {"x": 1, "y": [2]},
    }
    assert read("a: &a {x: 1}\nb: &b {z: 2}\nc: {<<: [*a, *b]}\n")["c"] == {"x": 1, "z": 2}  # type: ignore[index]


def test_keys_are_text() -> None:
    assert read("1: a\nnull: b\non: c\n") == {"1": "a", "null": "b", "on": "c"}


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "empty"),
        ("# nothing\n", "empty"),
        ("---\n...\n", "empty"),
        ("[" * 100_000, "nesting"),
        ("- " * 100_000, "nesting"),
        ("{a: " * 100_000, "nesting"),
        ("a: !mine 3", "tag"),
        ("a: 1\n<<: 3\n", "merge"),
        ("a:\n\tb: 1\n", "tab"),
        ("a: b: c", "syntax"),
        ("a: @b", "syntax"),
        ("a: \0", "encoding"),
    ],
)
def test_refusals(text: str, code: str) -> None:
    with pytest.raises(SceneError) as caught:
        compose(text, "a.yaml")
    problem = caught.value.problems[0]
    assert problem.code == code
    assert problem.line is not None
    assert problem.file == "a.yaml"


def test_aliases_that_nest_are_refused() -> None:
    rows = "".join(f"k{i + 1}: &k{i + 1} [*k{i}]\n" for i in range(2000))
    with pytest.raises(SceneError, match="nested deeper"):
        compose("k0: &k0 [x]\n" + rows, "a.yaml")


def test_values_of_options_have_no_line() -> None:
    node = compose_value("{kind: flip}", "--set a")
    assert node.plain() == {"kind": "flip"}
    assert node.value["kind"].mark == ("--set a", None, None)
    assert compose_value("", "--set a").value is None
    assert compose_value("null", "--set a").value is None
    with pytest.raises(SceneError) as caught:
        compose_value("[1", "--set a")
    assert caught.value.problems[0].line is None
