"""Constants of a scene, and changes from the command line."""

import pytest

from mpmcli.core.errors import SceneError
from mpmcli.scene.constants import read_constants
from mpmcli.scene.loader import load_scene
from mpmcli.scene.tree import compose
from mpmcli.scene.units import Units

MM = Units("mm", "g", "ms")


def constants(text: str) -> tuple[dict[str, float], list[str]]:
    """Values, and messages of what is wrong."""
    values, problems = read_constants(compose(f"constants: {text}", "a.yaml").value["constants"], MM)
    return values, [f"{p.path}: {p.message}" for p in problems]


def test_values_in_any_order() -> None:
    values, problems = constants('{a: "2*b", b: "c + 1", c: 3, E: 1 GPa, q: "sqrt(E/a)", n: 1e3}')
    assert not problems
    assert list(values) == ["a", "b", "c", "E", "q", "n"]
    assert values == {"a": 8.0, "b": 4.0, "c": 3.0, "E": 1000.0, "q": 125**0.5, "n": 1000.0}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{a: "b", b: "a"}', "constants.a: the constants have a circular definition: a → b → a"),
        ('{a: "a + 1"}', "constants.a: the constants have a circular definition: a → a"),
        ('{a: "d*2", d_: 1}', "constants.a: 'd' is not known; did you mean 'd_'?"),
        ("{sin: 1}", "constants.sin: 'sin' is a reserved name of expressions; choose another name"),
        ("{pi: 3}", "constants.pi: 'pi' is a reserved name of expressions; choose another name"),
        ("{x: 3}", "constants.x: 'x' is a reserved name of expressions; choose another name"),
        ("{2a: 3}", "constants.2a: '2a' is not a valid name; use letters, digits and _"),
        (
            "{a: true}",
            "constants.a: a number, text with a unit, or an expression of other constants is needed",
        ),
        (
            "{a: [1]}",
            "constants.a: a number, text with a unit, or an expression of other constants is needed",
        ),
        ("{a: .nan}", "constants.a: must be finite"),
        ("{a: 1/0}", "constants.a: '1/0' is inf; a finite number is needed"),
        ("{a: 3 flurbs}", "constants.a: 'flurbs' in '3 flurbs' is not a unit"),
        ("[1, 2]", "constants: a mapping of names to values is needed"),
    ],
)
def test_refusals(text: str, words: str) -> None:
    _, problems = constants(text)
    assert problems == [words]


def test_a_circle_is_told_once() -> None:
    values, problems = constants('{a: "b", b: "c", c: "a", d: 1}')
    assert values == {"d": 1.0}
    assert len(problems) == 1


def test_what_follows_from_a_fault_is_told_as_such() -> None:
    _, problems = constants('{a: "1/0", b: "2*a"}')
    assert problems[1] == "constants.b: needs the constant 'a', which has no value"


def test_long_chains_and_what_needs_a_circle() -> None:
    chain = ", ".join(f'c{i}: "c{i + 1} + 1"' for i in range(900))
    values, problems = constants(f"{{{chain}, c900: 1}}")
    assert (values["c0"], problems) == (901.0, [])
    _, problems = constants('{d: "2*b", a: "b", b: "c + a", c: 1, e: "f", f: "e"}')
    assert problems == [
        "constants.a: the constants have a circular definition: a → b → a",
        "constants.e: the constants have a circular definition: e → f → e",
        "constants.d: needs the constant 'b', which has no value",
    ]


def test_set_replaces_what_stands_there(scene: str) -> None:
    loaded = load_scene(
        scene,
        sets=(
            "method.transfer={kind: flip}",
            "bodies.block.velocity=[1, 0]",
            "loads.0.acceleration=[0, 0]",
            "time.end=1e3",
            "grid.cell=0.5",
            "title=",
        ),
    )
    assert loaded.scene.method.transfer.kind == "flip"
    assert [component() for component in loaded.scene.bodies[0].velocity] == [1.0, 0.0]
    assert loaded.scene.time.end == 1000.0
    assert loaded.scene.grid.cells == (80, 80)


def test_define_sets_a_constant(scene: str) -> None:
    loaded = load_scene(scene, defines=("R=20",))
    assert loaded.constants == {"R": 20.0, "v": 40.0}
    assert load_scene(scene, defines=("v=1 mm/s",)).constants["v"] == 1e-3
    assert loaded.overrides == {"set": [], "define": ["R=20"]}


def test_define_may_give_what_the_scene_lacks(scene: str) -> None:
    text = scene.replace('constants: {R: 10, v: "2*R"}\n', "")
    assert load_scene(text, defines=("v=3",)).constants == {"v": 3.0}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            {"sets": ["bodies.blok.velocity=[1, 0]"]},
            "'blok' is not a member of the list; did you mean 'block'? (block)",
        ),
        ({"sets": ["probes.7.near=[1, 0]"]}, "'7' is not a member of the list (corner)"),
        ({"sets": ["method.transfr.order=3"]}, "unknown key 'transfr'; did you mean 'transfer'?"),
        ({"sets": ["title.x=3"]}, "'title' is a single value and has no keys"),
        ({"sets": ["..=3"]}, "a dotted key is needed"),
        ({"sets": ["time.end=[1"]}, "did not find the expected"),
        ({"sets": ["time.end=-1"]}, "-1 is out of range: must be above 0"),
        ({"defines": ["V=3"]}, "the scene has no constant 'V'; did you mean 'v'?"),
        ({"defines": ["v=true"]}, "a number, text with a unit"),
    ],
)
def test_refused_options_name_the_option(scene: str, options: dict[str, list[str]], words: str) -> None:
    with pytest.raises(SceneError) as caught:
        load_scene(scene, **options)  # type: ignore[arg-type]
    problem = caught.value.problems[0]
    assert words in problem.message
    assert str(problem.file).startswith(("--set ", "-D "))
    assert problem.line is None
