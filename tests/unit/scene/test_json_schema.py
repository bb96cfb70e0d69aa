"""The JSON Schema: draft 7, current, true of every scene that ships."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

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
