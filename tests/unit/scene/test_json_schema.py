"""The JSON Schema: draft 7, current, true of every scene that ships."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from mpmcli.boundary.base import CONDITIONS, LOADS
from mpmcli.core.descriptions import field_descriptions
from mpmcli.scene.schema import schema_text
from mpmcli.scene.tree import compose

ROOT = Path(__file__).parents[3]
SCENES = sorted([*ROOT.glob("inputs/*.yaml"), *ROOT.glob("mpmcli/scene/templates/*.yaml")])
REFUSED = (
    "unknown_key",
    "misspelt_key",
    "misspelt_kind",
    "misspelt_region",
    "misspelt_analysis",
    "misspelt_shape",
    "misspelt_choice",
    "misspelt_top_key",
    "missing_key",
    "missing_kind",
    "missing_section",
    "number_for_list",
    "true_for_number",
    "negative_density",
    "poisson_at_half",
    "order_below_one",
    "order_not_whole",
    "no_is_text",
    "region_unknown_in_condition",
    "wrong_version",
    "checkpoint",
    "contact_law_missing",
    "contact_law_misspelt",
    "contact_law_as_text",
    "contact_unknown_key",
    "contact_fields_misspelt",
    "contact_is_a_list",
    "contact_mass_ratio_of_one",
    "pair_of_three",
    "pair_without_law",
    "field_is_a_number",
    "rigid_with_density",
)


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    """The schema as the models give it now."""
    return json.loads(schema_text())


def test_file_is_current() -> None:
    stored = (ROOT / "schemas" / "scene.schema.json").read_text(encoding="utf-8")
    assert stored == schema_text(), "run: mpmcli schema -o schemas/scene.schema.json"


def test_dialect(schema: dict[str, Any]) -> None:
    jsonschema.Draft7Validator.check_schema(schema)
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    text = json.dumps(schema)
    for word in ("$defs", "prefixItems", "discriminator", "unevaluated", "x-model"):
        assert f'"{word}"' not in text


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scenes_that_ship_are_accepted(schema: dict[str, Any], path: Path) -> None:
    plain = compose(path.read_text(encoding="utf-8"), path.name).plain()
    assert [error.message for error in jsonschema.Draft7Validator(schema).iter_errors(plain)] == []


@pytest.mark.parametrize("name", REFUSED)
def test_broken_scenes_are_refused(schema: dict[str, Any], name: str) -> None:
    path = ROOT / "tests" / "broken_scenes" / f"{name}.yaml"
    plain = compose(path.read_text(encoding="utf-8"), path.name).plain()
    assert not jsonschema.Draft7Validator(schema).is_valid(plain)


def test_every_key_has_a_description(schema: dict[str, Any]) -> None:
    silent = [
        f"{name}.{key}"
        for name, definition in [("Scene", schema), *schema["definitions"].items()]
        for key, value in definition.get("properties", {}).items()
        if key != "kind" and not any(word in json.dumps(value) for word in ("description", "$ref"))
    ]
    assert not silent


SCENE_OF_KINDS = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 8], cell: 1}
method: {transfer: {kind: fmpm, order: 4}}
materials:
  soft: {kind: neo_hookean, density: 1, E: 1, nu: 0.3}
bodies:
  - {name: a, material: soft, region: {kind: disk, center: [3, 3], radius: 1}}
  - {name: b, material: soft, region: {kind: union, regions: [{kind: box, lower: [5, 5], upper: [6, 6]}]}}
contact:
  law: {kind: coulomb, friction: 0.3}
  normal: {kind: logistic_regression}
boundary: [{name: s, kind: symmetry, plane: {axis: x, at: 0}}]
loads: [{name: g, kind: gravity, acceleration: [0, -1]}]
probes: [{name: p, kind: particle, body: a, near: [3, 3]}]
time: {end: 1}
"""
BRANCHES = [  # path of an alternative
    ("analysis",),
    ("method", "transfer"),
    ("materials", "soft"),
    ("bodies", 0, "region"),
    ("bodies", 1, "region", "regions", 0),
    ("contact", "law"),
    ("contact", "normal"),
    ("boundary", 0),
    ("loads", 0),
    ("probes", 0),
]


def deepest(schema: dict[str, Any], plain: Any) -> jsonschema.ValidationError:
    """The error that an editor shows: of values that may also be absent that of the value that is there."""
    found = list(jsonschema.Draft7Validator(schema).iter_errors(plain))
    while len(found) == 1 and found[0].validator == "anyOf":
        found = [error for error in found[0].context if error.validator != "type"]
    (error,) = found
    return error


def changed(path: tuple[Any, ...], key: str, value: Any) -> Any:
    plain = compose(SCENE_OF_KINDS, "scene").plain()
    node = plain
    for part in path:
        node = node[part]
    node[key] = value
    return plain


@pytest.mark.parametrize("path", BRANCHES, ids=lambda path: "-".join(map(str, path)))
def test_a_misspelt_key_is_blamed_on_the_branch_of_its_kind(schema: dict[str, Any], path: Any) -> None:
    error = deepest(schema, changed(path, "misspelt", 1))
    assert tuple(error.absolute_path) == path
    assert "'misspelt' was unexpected" in error.message
    assert "then" in error.absolute_schema_path


@pytest.mark.parametrize("path", BRANCHES, ids=lambda path: "-".join(map(str, path)))
def test_a_misspelt_kind_is_blamed_on_the_kind(schema: dict[str, Any], path: Any) -> None:
    error = deepest(schema, changed(path, "kind", "misspelt"))
    assert tuple(error.absolute_path) == (*path, "kind")
    assert error.validator == "enum"


def test_no_alternatives_are_told_apart_by_trial(schema: dict[str, Any]) -> None:
    assert '"oneOf"' not in json.dumps(schema)
    assert [
        e.message
        for e in jsonschema.Draft7Validator(schema).iter_errors(compose(SCENE_OF_KINDS, "s").plain())
    ] == []


@pytest.mark.parametrize("model", [*CONDITIONS.models(), *LOADS.models()], ids=lambda model: model.__name__)
def test_descriptions_are_those_of_the_fields(model: Any) -> None:
    """Not those of the types of the fields, such as a direction."""
    properties = model.model_json_schema()["properties"]
    words = field_descriptions(model)
    names = {field.alias or name: name for name, field in model.model_fields.items()}
    assert {key: node["description"] for key, node in properties.items()} == {
        key: words[names[key]] for key in properties
    }
