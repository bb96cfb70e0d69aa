"""What interface laws have against the rest of a scene: warnings, gaps at the start, resolution."""

from typing import Any

import pytest
import yaml

from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.filling import check_filling
from mpmcli.scene.loader import LoadedScene, load_scene
from mpmcli.solver.simulation import Simulation

LINEAR = {"kind": "linear_interface", "normal": 500.0, "tangential": 200.0}
SOFT = {"kind": "linear_elastic", "density": 1.5e-3, "E": 1000.0, "nu": 0.25}


def box(name: str, lower: list[float], upper: list[float], material: str = "soft") -> dict[str, Any]:
    return {"name": name, "material": material, "region": {"kind": "box", "lower": lower, "upper": upper}}


def cohesive(normal: dict[str, Any], **more: Any) -> dict[str, Any]:
    tangential = {"shape": "triangular", "strength": 5.0, "toughness": 0.2}
    return {"kind": "cohesive", "normal": {"shape": "triangular"} | normal, "tangential": tangential} | more


def load(law: dict[str, Any] | None = LINEAR, bodies: list[Any] | None = None, **contact: Any) -> LoadedScene:
    pairs = [] if law is None else [{"between": ["low", "high"], "law": law}]
    analysis, default = (
        contact.pop("analysis", "plane_strain"),
        contact.pop("default", {"kind": "frictionless"}),
    )
    scene = {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {"lower": [-8, -8], "upper": [8, 8], "cell": 1},
        "materials": {"soft": SOFT, "tool": {"kind": "rigid"}, "stiff": SOFT | {"E": 8000.0}},
        "bodies": bodies or [box("low", [-4, -4], [4, 0]), box("high", [-4, 0], [4, 4])],
        "contact": {"law": default, "pairs": pairs} | contact,
        "time": {"end": 0.1, "courant": 0.2},
    }
    scene["materials"] = {
        name: model
        for name, model in scene["materials"].items()
        if any(body["material"] == name for body in scene["bodies"])
    }
    return load_scene(yaml.safe_dump(scene))


def warnings_of(loaded: LoadedScene) -> list[tuple[str, str]]:
    """Path and message of all warnings."""
    return [(p.path, p.message) for p in (*loaded.warnings, *check_filling(loaded.scene))]


def problems_of(**contact: Any) -> list[Problem]:
    with pytest.raises(SceneError) as caught:
        check_filling(load(**contact).scene)
    return caught.value.problems


def test_blocks_that_touch_have_no_warning() -> None:
    assert warnings_of(load()) == []
    assert warnings_of(load(cohesive({"strength": 5.0, "toughness": 0.2}))) == []
    assert warnings_of(load(LINEAR | {"tangential": "perfect"}, interface={"jump": "extrapolated"})) == []


# ---------------------------------------------------------------------- choices


def test_choices_of_interfaces_have_no_effect_without_an_interface_law() -> None:
    [(path, words)] = warnings_of(load(None, interface={"jump": "edges"}))
    assert path == "contact.interface"
    assert words == "has no effect, because no law of this contact is an interface law"


def test_pairs_at_nodes_of_three_fields_are_always_coupled() -> None:
    bodies = [box("low", [-4, -4], [4, 0]), box("high", [-4, 0], [0, 4]), box("side", [0, 0], [4, 4])]
    assert warnings_of(load(bodies=bodies)) == []
    assert warnings_of(load(bodies=bodies, three_or_more="coupled")) == []
    [(path, words)] = warnings_of(load(bodies=bodies, three_or_more="pairs"))
    assert path == "contact.three_or_more"
    assert "acts as 'coupled'" in words


@pytest.mark.parametrize("increments", ["evolving", "lumped", "after", "combined"])
def test_increments_are_net(increments: str) -> None:
    for contact in ({}, {"law": None, "default": LINEAR}):
        found = [p for p in problems_of(increments=increments, **contact) if p.severity == "error"]
        assert [(p.path, p.code) for p in found] == [("contact.increments", "combination")]


def test_a_stiffness_of_morse_or_linear_shapes_is_no_spring_of_contact() -> None:
    law = cohesive({"strength": 5.0, "toughness": 0.2})
    law["tangential"] = {"shape": "linear", "stiffness": 100.0}
    assert warnings_of(load(law, three_or_more="coupled"))[0][1].startswith(
        "has no effect, because the scene has 2"
    )


# ---------------------------------------------------------------------- at the start


def test_bodies_that_touch_in_part_are_told_the_share() -> None:
    bodies = [
        box("low", [-4, -4], [4, 0]),
        {
            "name": "high",
            "material": "soft",
            "region": {
                "kind": "union",
                "regions": [
                    {"kind": "box", "lower": [-4, 0], "upper": [0, 4]},
                    {"kind": "box", "lower": [0, 0.5], "upper": [4, 4]},
                ],
            },
        },
    ]
    [(path, words)] = warnings_of(load(bodies=bodies))
    assert path == "contact.pairs.0.between"
    assert (
        "'low' and 'high' touch only in part: at 4 of 9 nodes with mass of both bodies the gap is above 0.1 cells"
        in words
    )
    assert "(bonded: 56 %)" in words
    assert warnings_of(load(bodies=bodies, interface={"initial_gap": 0.5})) == []


def test_bodies_that_do_not_touch_are_told_the_gap() -> None:
    bodies = [box("low", [-4, -4], [4, 0]), box("high", [-4, 0.5], [4, 4])]
    [problem] = problems_of(bodies=bodies)
    assert (problem.path, problem.code) == ("contact.pairs.0.between", "untouched")
    assert "do not touch at the start: the gap is 0.5 (0.5 cells)" in problem.message
    assert warnings_of(load(bodies=bodies, interface={"initial_gap": 0.5})) == []


@pytest.mark.parametrize(
    ("gap", "words"), [(1.0, "1 (1 cells)"), (2.5, "2.5 (2.5 cells)"), (5.0, "above 3 cells")]
)
def test_bodies_that_share_no_node_never_meet(gap: float, words: str) -> None:
    bodies = [box("low", [-4, -4], [4, 0]), box("high", [-4, gap], [4, gap + 2])]
    [problem] = problems_of(bodies=bodies)
    assert (problem.path, problem.code) == ("contact.pairs.0.between", "untouched")
    assert f"no node has mass of both bodies at the start, where the gap is {words}" in problem.message


def test_an_interface_for_all_fields_needs_one_pair_that_touches() -> None:
    apart = [box("low", [-4, -4], [4, -2]), box("high", [-4, 4], [4, 8])]
    [problem] = problems_of(law=None, bodies=apart, default=LINEAR)
    assert problem.path == "contact.law"
    assert "too far apart" in problem.message
    third = box("middle", [-4, -2], [4, 0])
    assert warnings_of(load(None, bodies=[*apart, third], default=LINEAR)) == []


def test_a_rigid_body_may_have_an_interface() -> None:
    bodies = [box("low", [-4, -4], [4, 0]), box("high", [-4, 0], [4, 4], "tool")]
    assert warnings_of(load(bodies=bodies)) == []


# ---------------------------------------------------------------------- resolution


def test_openings_above_a_quarter_of_a_cell_are_warned_of() -> None:
    [(path, words)] = warnings_of(load(cohesive({"strength": 2.0, "opening": 0.26})))
    assert path == "contact.pairs.0.law.normal"
    assert words == (
        "fails at an opening of 0.26, 0.26 cells; use cells of at least 1.04 (failure within a quarter of a cell) and "
        "at most 17.3 (4 cells per process zone), or a law that fails earlier"
    )
    assert warnings_of(load(cohesive({"strength": 2.0, "opening": 0.25}))) == []


def test_process_zones_below_four_cells_are_warned_of() -> None:
    """E′G/σ² = 1000/(1 − ν²)·0.2/σ²: four cells at σ = 7.30."""
    assert warnings_of(load(cohesive({"strength": 7.2, "toughness": 0.2}))) == []
    [(path, words)] = warnings_of(load(cohesive({"strength": 7.4, "toughness": 0.2})))
    assert path == "contact.pairs.0.law.normal"
    assert words == (
        "the process zone E'G/σ² is 3.9 long, 3.9 cells; use cells of at most 0.974 (4 cells per zone) and at least "
        "0.216 (failure within a quarter of a cell), or less strength"
    )
    # in plane stress E′ = E, and the softer side decides
    assert warnings_of(load(cohesive({"strength": 7.2, "toughness": 0.2}), analysis="plane_stress"))
    stiff = [box("low", [-4, -4], [4, 0], "stiff"), box("high", [-4, 0], [4, 4], "stiff")]
    assert warnings_of(load(cohesive({"strength": 20.0, "toughness": 0.2}), bodies=stiff)) == []
    mixed = [stiff[0], box("high", [-4, 0], [4, 4])]
    assert len(warnings_of(load(cohesive({"strength": 20.0, "toughness": 0.2}), bodies=mixed))) == 1
    rigid = [stiff[0], box("high", [-4, 0], [4, 4], "tool")]
    assert warnings_of(load(cohesive({"strength": 20.0, "toughness": 0.2}), bodies=rigid)) == []


@pytest.mark.parametrize("shape", ["triangular", "cubic"])
def test_advice_on_cells_never_contradicts_itself(shape: str) -> None:
    """Where no size of cells fits, the law must change; with the strength that is told there is one."""
    law = {"shape": shape, "strength": 50.0, "toughness": 10.0}
    [(path, words)] = warnings_of(load(cohesive(law)))
    assert path == "contact.pairs.0.law.normal"
    assert "no size of cells fits both" in words
    strength = float(words.split("strength of at most ")[1].split()[0])
    assert 30.0 < strength < 50.0
    [(_, words)] = warnings_of(load(cohesive(law | {"strength": 0.99 * strength})))
    least = float(words.split("cells of at least ")[1].split()[0])
    most = float(words.split(" at most ")[1].split()[0])
    assert 1.0 < least < most
    [(_, words)] = warnings_of(load(cohesive(law | {"strength": 1.01 * strength})))
    assert "no size of cells fits both" in words


def test_bonds_of_morse_that_act_over_more_than_a_quarter_of_a_cell_are_warned_of() -> None:
    """Its traction is below 1 % of the peak N from 4 N ln(400)/D on."""
    law = {"kind": "morse_interface", "stiffness": 100.0, "peak": 1.0}
    assert warnings_of(load(law)) == []
    [(path, words)] = warnings_of(load(law | {"peak": 1.1}))
    assert path == "contact.pairs.0.law"
    assert words == (
        "transmits tractions up to an opening of 0.264, 0.26 cells; use cells of at least 1.05 (the law ends within a "
        "quarter of a cell), more stiffness, or a lower peak"
    )


def test_choices_that_no_interface_reads_are_warned_of() -> None:
    """Also where another law is the default, if every pair of fields has an interface."""
    for choice, words in (
        ({"mass_ratio": 1e-4}, "'linear_interface' applies at all nodes"),
        ({"overlap_removal": 0.2}, "'linear_interface' does not remove overlap"),
    ):
        [(path, told)] = warnings_of(load(**choice))
        assert path == f"contact.{next(iter(choice))}"
        assert told.startswith("has no effect, because the law ")
        assert told.endswith(words)
        third = [box("low", [-4, -4], [4, 0]), box("high", [-4, 0], [4, 4]), box("side", [4, -4], [8, 4])]
        assert warnings_of(load(bodies=third, **choice)) == []


# ---------------------------------------------------------------------- in runs


def test_runs_refuse_and_warn_as_validate_does() -> None:
    apart = [box("low", [-4, -4], [4, 0]), box("high", [-4, 0.5], [4, 4])]
    with pytest.raises(SceneError, match="do not touch at the start"):
        Simulation(load(bodies=apart), threads=1)
    part = [box("low", [-4, -4], [4, 0]), box("high", [0, 0], [4, 4]), box("side", [-4, 0.5], [0, 4])]
    part[1]["field"] = part[2]["field"] = "high"
    part[2]["name"], part[1]["name"] = "left half", "right half"
    simulation = Simulation(load(bodies=part), threads=1)
    told = [(problem.path, problem.message) for problem in simulation.setup_warnings]
    assert told == warnings_of(load(bodies=part))
    assert "touch only in part" in told[0][1]


@pytest.mark.parametrize("names", [("soft", "stiff"), ("joined", "stiff")])
def test_pairs_may_be_of_materials_or_of_the_fields_that_they_share(names: tuple[str, str]) -> None:
    bodies = [box("low", [-4, -4], [4, 0]), box("high", [-4, 0.5], [4, 4], "stiff")]
    scene = yaml.safe_load(yaml.safe_dump(load(None, bodies).resolved()))
    scene["materials"]["soft"]["field"] = "joined"
    law = cohesive({"strength": 2.0, "opening": 0.3})
    scene["contact"] = {
        "fields": "material",
        "law": {"kind": "frictionless"},
        "pairs": [{"between": names, "law": law}],
    }
    loaded = load_scene(yaml.safe_dump(scene))
    assert "contact.pairs.0.law.normal" in [w.path for w in loaded.warnings]
    with pytest.raises(SceneError, match="'joined' and 'stiff' do not touch at the start"):
        check_filling(loaded.scene)
