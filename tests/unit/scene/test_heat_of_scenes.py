"""What a scene says about heat: needs, contradictions, and what changes nothing."""

import pytest
import scene_problems
from scene_problems import changed

from mpmcli.core.errors import Problem, SceneError
from mpmcli.run.load import load
from mpmcli.scene import filling
from mpmcli.scene.filling import check_memory
from mpmcli.scene.loader import load_scene

SCENE = """\
version: 1
units: {length: mm, mass: g, time: ms}
analysis: {kind: plane_strain}
grid: {lower: [-20, -20], upper: [20, 20], cell: 1}
method: {shape: ugimp}
heat: {}
materials:
  steel: {kind: linear_elastic, density: 8e-3, E: 200e3, nu: 0.3, heat_capacity: 460 J/(kg K), conductivity: 45 W/(m K)}
  cork: {kind: neo_hookean, density: 1e-4, E: 10, nu: 0, heat_capacity: 2 kJ/(kg K), conductivity: [1e-3, 1e-3, 1e-3]}
  tool: {kind: rigid}
bodies:
  - {name: left, material: steel, region: {kind: box, lower: [-9, -5], upper: [0, 5]}}
  - {name: right, material: cork, region: {kind: box, lower: [0, -5], upper: [9, 5]}}
  - {name: plate, material: tool, region: {kind: box, lower: [-12, -7], upper: [12, -5]}}
contact:
  law: {kind: coulomb, friction: 0.3}
boundary:
  - {name: cold, kind: temperature, on: {body: left, face: {axis: x, side: lower}}, value: 280}
  - {name: line, kind: temperature, on: {plane: {axis: x, at: 12}}, value: "300 + t"}
loads:
  - {name: torch, kind: heat_flux, on: {body: right, face: {axis: x, side: upper}}, flux: 1 MW/m^2}
  - {name: air, kind: film, on: {body: right, face: {axis: y, side: upper}}, coefficient: 25 W/(m^2 K), around: 293}
  - {name: sky, kind: radiation, on: {body: right, face: {axis: y, side: upper}}, emissivity: 0.8, around: 4}
  - {name: current, kind: heat_source, on: {body: left}, power: 5, per: volume}
time: {end: 0.1}
"""
HOT = "value: 280}\n"


def problems_of(*changes: tuple[str, str], sets: tuple[str, ...] = ()) -> list[Problem]:
    """Errors and warnings of the scene after replacing pieces of its text."""
    return scene_problems.problems_of(changed(SCENE, *changes), sets)


def only(problems: list[Problem], path: str, words: str, severity: str = "error") -> Problem:
    """The one problem, which is at this place and says this."""
    assert [(p.path, p.severity) for p in problems] == [(path, severity)], problems
    assert words in problems[0].message
    assert problems[0].line is not None or str(problems[0].file).startswith("--set")
    return problems[0]


def test_the_scene_is_valid() -> None:
    assert problems_of() == []


# ---------------------------------------------------------------- materials


@pytest.mark.parametrize(
    ("text", "key"),
    [(", heat_capacity: 460 J/(kg K)", "heat_capacity"), (", conductivity: 45 W/(m K)", "conductivity")],
)
def test_conduction_needs_capacity_and_conductivity(text: str, key: str) -> None:
    words = "is missing; conduction of heat ('heat') in 'left'"
    found = only(problems_of((text, "")), f"materials.steel.{key}", words)
    assert found.line == 8
    assert ("0 for an insulator" in found.message) == (key == "conductivity")


def test_both_may_be_missing_at_once() -> None:
    found = problems_of((", heat_capacity: 460 J/(kg K), conductivity: 45 W/(m K)", ""))
    assert [p.path for p in found] == ["materials.steel.heat_capacity", "materials.steel.conductivity"]


def test_an_equation_of_state_is_stable_at_constant_temperature() -> None:
    solid = "{kind: mie_gruneisen, density: 8e-3, K: 180e3, gamma0: 2, conductivity: 1, heat_capacity: %s}"
    assert problems_of(sets=(f"materials.steel={solid % '440'}",)) == []
    words = "K = 1.8e+05 must be above gamma0^2*density*heat_capacity*T0 = 4.22e+06"
    only(problems_of(sets=(f"materials.steel={solid % '440e3'}",)), "materials.steel", words, "warning")


def test_materials_that_no_body_uses_need_nothing() -> None:
    spare = "  spare: {kind: linear_elastic, density: 1, E: 1, nu: 0}\n  tool:"
    only(problems_of(("  tool:", spare)), "materials.spare", "no body uses this material", "warning")


def test_conduction_without_a_conductor_has_no_effect() -> None:
    insulators = ("materials.steel.conductivity=0", "materials.cork.conductivity=[0, 0, 0]")
    only(problems_of(sets=insulators), "heat", "no material conducts heat: each conductivity is 0", "warning")
    assert problems_of(sets=insulators[:1]) == []


def test_bodies_that_cannot_be_read_are_no_reason_to_doubt_conductors() -> None:
    """``C`` is coulomb: what the other bodies conduct is not known, either."""
    found = problems_of(sets=tuple(f"bodies.{name}.temperature=100 C" for name in ("left", "right")))
    assert [problem.path for problem in found] == ["bodies.left.temperature", "bodies.right.temperature"]
    assert all(problem.message.endswith("; degrees Celsius are 'degC'") for problem in found)


@pytest.mark.parametrize("key", ["heat_capacity", "conductivity", "expansion", "T0"])
@pytest.mark.parametrize("value", ["-1", ".inf", ".nan", "'1e999 W'", "yes", "[]", "{a: 1}"])
def test_values_out_of_range_are_refused(key: str, value: str) -> None:
    found = problems_of(sets=(f"materials.cork.{key}={value}",))
    assert {p.severity for p in found} == {"error"}
    assert all(p.path.startswith(f"materials.cork.{key}") for p in found)


# ---------------------------------------------------------------- without heat

BARE = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-20, -20], upper: [20, 20], cell: 1}
materials:
  steel: {kind: linear_elastic, density: 1, E: 200, nu: 0.3}
bodies:
  - {name: left, material: steel, region: {kind: box, lower: [-9, -5], upper: [0, 5]}}
time: {end: 0.1}
"""


def bare(*sets: str) -> list[Problem]:
    """Errors and warnings of a scene without heat."""
    return scene_problems.problems_of(BARE, sets)


CAPACITY, ADIABATIC = "materials.steel.heat_capacity=1", "method.heating=adiabatic"


def test_a_conductivity_has_no_effect_without_heat() -> None:
    for more in ((), (ADIABATIC, CAPACITY)):
        found = bare("materials.steel.conductivity=1", *more)
        only(found, "materials.steel.conductivity", "has no effect without 'heat'", "warning")


def test_a_capacity_has_an_effect_with_adiabatic_heating() -> None:
    found = bare(CAPACITY)
    only(found, "materials.steel.heat_capacity", "without 'heat' or 'method.heating: adiabatic'", "warning")
    assert bare(CAPACITY, ADIABATIC) == []


def test_adiabatic_heating_needs_a_capacity() -> None:
    words = "has no effect, because no material has a heat_capacity"
    only(bare(ADIABATIC), "method.heating", words, "warning")


def test_temperatures_have_an_effect_where_something_depends_on_them() -> None:
    T0, body = "materials.steel.T0=200", "bodies.left.temperature=400"
    words = "has no effect because nothing depends on the temperature"
    only(bare(T0), "materials.steel.T0", words, "warning")
    only(bare(body), "bodies.left.temperature", "material 'steel' has no temperature", "warning")
    assert bare(T0, body, "materials.steel.expansion=1e-5") == []
    assert bare(T0, body, CAPACITY, ADIABATIC) == []


def test_expansion_needs_a_change_of_temperature() -> None:
    expansion = "materials.steel.expansion=1e-5"
    words = "has no effect because the temperature stays 300 (T0) without 'heat'"
    for more in ((), ("bodies.left.temperature=300",), (ADIABATIC,)):
        found = [p for p in bare(expansion, *more) if p.path != "method.heating"]
        only(found, "materials.steel.expansion", words, "warning")
    for temperature in ("301", "300+x"):
        assert bare(expansion, f"bodies.left.temperature={temperature}") == []
    assert bare(expansion, CAPACITY, ADIABATIC) == []


@pytest.mark.parametrize(
    ("temperature", "strain"), [("500", 2), ("100", -2), ("'300+90*x'", -8.1), ("400", None)]
)
def test_a_body_begins_near_its_temperature_without_stress(temperature: str, strain: float | None) -> None:
    found = bare("materials.steel.expansion=0.01", f"bodies.left.temperature={temperature}")
    if strain is None:
        assert found == []
    else:
        words = f"the thermal strain expansion*(temperature - T0) is {strain:g} at the start"
        only(found, "bodies.left.temperature", words, "warning")


def test_an_empty_section_is_as_good_as_none() -> None:
    found = bare("heat=null", "materials.steel.conductivity=1")
    only(found, "materials.steel.conductivity", "no effect", "warning")


def test_a_broken_section_of_heat_is_not_taken_for_none() -> None:
    found = problems_of(("heat: {}", "heat: {interval: 0, fourier: 9, transfer: {kind: xpic}}"))
    assert [p.path for p in found] == ["heat.interval", "heat.fourier", "heat.transfer.kind"]
    assert "0 is out of range: must be at least 1" in found[0].message
    assert "'xpic' is not a known transfer (allowed: flip, fmpm)" in found[2].message


# ---------------------------------------------------------------- conditions and loads


def test_heat_does_not_enter_rigid_bodies() -> None:
    face = "{body: right, face: {axis: x, side: upper}}"
    found = problems_of((face, face.replace("right", "plate")))
    only(found, "loads.torch.on.body", "the body 'plate' is rigid, and heat does not enter it")


PLANE = '{name: line, kind: temperature, on: {plane: {axis: x, at: 12}}, value: "300 + t"}'


@pytest.mark.parametrize(
    ("plane", "value", "clash"),
    [
        ("{axis: x, at: -9}", "300", True),
        ("{axis: x, at: -9}", "280 + 5*t", False),
        ("{axis: x, at: -8}", "300", False),
        ("{axis: x, at: -9, side: upper}", "300", False),
        ("{axis: y, at: -9}", "300", False),
    ],
)
def test_a_plane_and_a_face_at_the_same_place_agree(plane: str, value: str, clash: bool) -> None:
    wall = f'{{name: wall, kind: temperature, on: {{plane: {plane}}}, value: "{value}"}}'
    found = problems_of((PLANE, wall))
    if clash:
        only(found, "boundary.wall.value", "this place is held at another temperature by 'cold' in line 18")
    else:
        assert found == []


@pytest.mark.parametrize(("value", "clash"), [("300", False), ("300 + y", True), ("301", True)])
def test_two_planes_at_the_same_place_agree(value: str, clash: bool) -> None:
    other = PLANE.replace("name: line", "name: other").replace("300 + t", value)
    found = problems_of((PLANE, f"{PLANE}\n  - {other}"))
    if clash:
        only(found, "boundary.other.value", "this place is held at another temperature by 'line' in line 19")
    else:
        assert found == []


def test_a_face_on_the_axis_has_no_area() -> None:
    scene = """\
version: 1
analysis: {kind: axisymmetric}
grid: {lower: [0, -9], upper: [9, 9], cell: 1}
heat: {}
materials: {m: {kind: linear_elastic, density: 1, E: 200, nu: 0.3, heat_capacity: 1, conductivity: 1}}
bodies: [{name: rod, material: m, region: {kind: box, lower: [0, 0], upper: [4, 4]}}]
loads: [{name: q, kind: heat_flux, on: {body: rod, face: {axis: x, side: SIDE}}, flux: 1}]
time: {end: 1}
"""
    words = "has no effect, because this face of 'rod' is on the axis"
    only(load_scene(scene.replace("SIDE", "lower")).warnings, "loads.q.on", words, "warning")
    assert load_scene(scene.replace("SIDE", "upper")).warnings == []
    hollow = scene.replace("SIDE", "lower").replace("lower: [0, 0]", "lower: [1, 0]")
    assert load_scene(hollow).warnings == []


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("boundary.line.value", "1e300"),
        ("loads.torch.flux", "-1e31"),
        ("loads.air.coefficient", "1e30"),
        ("loads.sky.around", "1e35"),
        ("loads.current.power", "1e300"),
    ],
)
def test_conditions_and_loads_are_of_a_possible_size(key: str, value: str) -> None:
    only(problems_of(sets=(f"{key}={value}",)), key, "must be below 1e+30")


@pytest.mark.parametrize("key", ["loads.torch.flux", "loads.current.power"])
def test_nothing_does_not_heat(key: str) -> None:
    only(problems_of(sets=(f"{key}=0",)), key, "has no effect, because it is 0", "warning")


def test_a_conductance_for_all_pairs_passes_over_rigid_bodies_without_temperature() -> None:
    heat = "heat={contact: {conductance: 5}}"
    words = "has no effect on contact with 'plate': a rigid body without 'temperature' exchanges no heat"
    only(problems_of(sets=(heat,)), "heat.contact", words, "warning")
    assert problems_of(sets=(heat, "bodies.plate.temperature=300")) == []


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("heat.contact", "insulted", "did you mean 'insulated'?"),
        ("heat.contact.conductance", "-1", "-1 is out of range: must be above 0"),
        ("heat.contact.conductance", "perfct", "did you mean 'perfect'?"),
    ],
)
def test_messages_name_what_is_allowed(path: str, value: str, words: str) -> None:
    only(problems_of(sets=(f"{path}={value}",)), path, words)


@pytest.mark.parametrize("value", ["0", "-3", "'0*t'", "'-20 + t'"])
def test_held_temperatures_are_absolute(value: str) -> None:
    found = problems_of(sets=(f"boundary.cold.value={value}",))
    only(found, "boundary.cold.value", "temperatures are absolute and must be above 0")


def test_two_temperatures_at_a_face_contradict_each_other() -> None:
    second = (
        "  - {{name: hot, kind: temperature, on: {{body: left, face: {{axis: x, side: {}}}}}, value: {}}}\n"
    )

    def found(side: str, value: str) -> list[Problem]:
        return problems_of((HOT, HOT + second.format(side, value)))

    problem = only(
        found("lower", "281"), "boundary.hot.value", "held at another temperature by 'cold' in line 18"
    )
    assert problem.code == "contradiction"
    assert found("lower", "280") == []
    assert found("upper", "281") == []
    assert [p.path for p in found("lower", '"280 + y"')] == ["boundary.hot.value"]
    assert found("lower", '"280 + 0*y"') == []
    assert [p.path for p in found("lower", '"280 + t", from: 0.001')] == ["boundary.hot.value"]
    first = "value: 280}", "value: 280, until: 0.001}"
    assert problems_of((HOT, HOT + second.format("lower", "281, from: 0.001")), first) == []


def test_loads_on_a_held_face_have_no_effect() -> None:
    held = "{body: left, face: {axis: x, side: lower}}"
    words = "has no effect on the body, because 'cold' holds the temperature of this face"
    found = problems_of(("{body: right, face: {axis: x, side: upper}}", held))
    only(found, "loads.torch.on", words, "warning")


# ---------------------------------------------------------------- contact


def test_choices_between_fields_need_fields() -> None:
    heat = ("heat: {}", "heat: {contact: insulated, friction: true}")
    assert problems_of(heat) == []
    alone = ("contact:\n  law: {kind: coulomb, friction: 0.3}\n", "")
    plate = "  - {name: plate, material: tool, region: {kind: box, lower: [-12, -7], upper: [12, -5]}}\n"
    found = problems_of(heat, alone, (plate, ""), ("  tool: {kind: rigid}\n", ""))
    assert [p.path for p in found] == ["heat.contact", "heat.friction"]
    assert {p.severity for p in found} == {"warning"}
    assert "the scene has a single velocity field" in found[0].message


def test_friction_heats_in_every_step() -> None:
    words = "must be 1 or auto, because friction heats bodies in every step; or set heat.friction to false"
    only(problems_of(("heat: {}", "heat: {interval: 10}")), "heat.interval", words)
    for fine in ("{interval: auto}", "{interval: 1}", "{interval: 10, friction: false}"):
        assert problems_of(("heat: {}", f"heat: {fine}")) == []


LAW = "  law: {kind: coulomb, friction: 0.3}\n"
PAIRS = "  pairs: [{{between: [{}], law: {{kind: stick}}, heat: {}}}]\n"


def pair(heat: str, between: str = "left, right") -> list[Problem]:
    """Problems of a pair with an exchange of heat of its own."""
    return problems_of((LAW, LAW + PAIRS.format(between, heat)), ("heat: {}", "heat: {contact: insulated}"))


@pytest.mark.parametrize(
    "heat", ["insulated", "{conductance: 10}", "{conductance: perfect}", "{conductance: 1 kW/(m^2 K)}"]
)
def test_pairs_exchange_heat_in_their_own_way(heat: str) -> None:
    assert pair(heat) == []


@pytest.mark.parametrize(
    ("heat", "path", "words"),
    [
        ("shared", "contact.pairs.0.heat", "'shared' is not allowed"),
        ("{conductance: 0}", "contact.pairs.0.heat.conductance", "must be above 0"),
        ("{conductivity: 1}", "contact.pairs.0.heat.conductivity", "did you mean 'conductance'?"),
    ],
)
def test_other_words_for_pairs_are_refused(heat: str, path: str, words: str) -> None:
    found = pair(heat)
    assert path in {p.path for p in found}
    assert any(words in p.message for p in found)


def test_pairs_have_no_heat_without_conduction() -> None:
    pairs = "[{between: [left, b], law: {kind: stick}, heat: insulated}]"
    body = "  - {name: b, material: steel, region: {kind: box, lower: [0, -5], upper: [9, 5]}}\n"
    text = BARE.replace("time:", f"{body}time:") + f"contact: {{law: {{kind: stick}}, pairs: {pairs}}}\n"
    only(load_scene(text).warnings, "contact.pairs.0.heat", "has no effect without 'heat'", "warning")


BATH = "bodies.plate.temperature=500"


def test_a_rigid_body_is_a_bath_by_a_conductance() -> None:
    words = "has no effect, because the rigid body 'plate' has no 'temperature'"
    only(pair("{conductance: 10}", "left, plate"), "contact.pairs.0.heat", words, "warning")
    assert problems_of(("heat: {}", "heat: {contact: {conductance: 10}}"), sets=(BATH,)) == []
    words = "a rigid body exchanges heat only by"
    only(problems_of(sets=(BATH,)), "bodies.plate.temperature", words, "warning")
    own = (LAW, LAW + PAIRS.format("left, plate", "{conductance: 10}"))
    assert problems_of(own, ("heat: {}", "heat: {contact: insulated}"), sets=(BATH,)) == []


# ---------------------------------------------------------------- the rest of the section


def test_a_fourier_number_has_no_effect_with_given_steps() -> None:
    step = ("time: {end: 0.1}", "time: {end: 0.1, step: 1e-5}")
    found = problems_of(("heat: {}", "heat: {fourier: 0.1}"), step)
    only(found, "heat.fourier", "has no effect, because the time step and the interval are given", "warning")
    assert problems_of(("heat: {}", "heat: {fourier: 0.1, interval: auto}"), step) == []
    assert problems_of(("heat: {}", "heat: {fourier: 0.1}")) == []


def test_a_scene_of_rigid_bodies_says_only_that() -> None:
    source = "loads=[{name: a, kind: heat_source, on: {body: left}, power: 5}]"
    found = bare("materials={steel: {kind: rigid}}", "heat={}", source)
    only(found, "bodies", "every body is rigid; at least one body must be deformable")


@pytest.mark.parametrize("interval", [1, 1000])
def test_runs_of_endless_conduction_are_refused(interval: int) -> None:
    fast = ("materials.steel.conductivity=1e13", f"heat.interval={interval}", "heat.friction=false")
    with pytest.raises(SceneError) as refused:
        load(SCENE, sets=fast)
    found = only(refused.value.problems, "time.end", "(by heat.fourier), but at most 1e+10 are allowed")
    dt = 0.25 / (1e13 / (8e-3 * 460)) / interval
    assert f"the run needs {0.1 / dt:.2g} steps of {dt:.2g}" in found.message
    assert load(SCENE, sets=("materials.steel.conductivity=1e9",)).warnings == []
    assert load(SCENE, sets=(*fast, "time={end: 0.1, step: 1e-3}")).warnings == []


def test_arrays_of_heat_count_as_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene(SCENE).scene
    nodes = 47 * 47  # with three ghost layers on each side

    def limit(numbers: int) -> None:
        monkeypatch.setattr(filling, "available_memory", lambda: nodes * numbers * 8)

    mechanics = 3 * filling.NUMBERS_PER_NODE[2]
    limit(mechanics + 4)
    check_memory(scene)
    limit(mechanics + 3)
    with pytest.raises(SceneError, match="of memory"):
        check_memory(scene)
    heat = "heat: {contact: insulated, transfer: {kind: fmpm, order: 2}}"
    own = load_scene(SCENE.replace("heat: {}", heat)).scene
    limit(mechanics + 3 * 5)
    check_memory(own)
    limit(mechanics + 3 * 5 - 1)
    with pytest.raises(SceneError, match="of memory"):
        check_memory(own)


def test_bodies_that_do_not_fit_the_axes_are_told_and_nothing_else_fails() -> None:
    second = (
        "  - {name: hot, kind: temperature, on: {body: left, face: {axis: x, side: lower}}, value: 281}\n"
    )
    hot = ("heat_capacity: 460 J/(kg K)", "expansion: 1, heat_capacity: 460 J/(kg K)")
    body = ("lower: [-9, -5], upper: [0, 5]}}", "lower: [-9, -5, 0], upper: [0, 5, 1]}, temperature: 400}")
    paths = {p.path for p in problems_of(hot, body, (HOT, HOT + second))}
    assert paths == {"bodies.left.region.lower", "bodies.left.region.upper"}
    found = problems_of(hot, (HOT, HOT + second), sets=("grid={lower: [0], upper: [9], cell: 1}",))
    assert "grid.lower" in {p.path for p in found}
