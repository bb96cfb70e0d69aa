"""The JSON Schema of scenes in draft 7, the dialect that editors understand (pydantic writes 2020-12)."""

from __future__ import annotations

import json
from typing import Any

DIALECT = "http://json-schema.org/draft-07/schema#"
_TEXT = {"type": "string"}


def scene_schema() -> dict[str, Any]:
    """The schema of a whole scene."""
    from mpmcli.scene.models import Scene

    schema = _convert(Scene.model_json_schema(by_alias=True, mode="validation"))
    definitions = schema["definitions"]
    any_region = definitions["Body"]["properties"]["region"]
    for definition in definitions.values():
        _name_regions(
            definition, {key: any_region[key] for key in ("oneOf", "$ref", "allOf") if key in any_region}
        )
        _require_kind(definition)
    return {"$schema": DIALECT, **schema, "title": "Scene of mpmcli"}


def schema_text() -> str:
    """The schema as it stands in a file."""
    return json.dumps(scene_schema(), indent=1, ensure_ascii=False) + "\n"


def _convert(node: Any) -> Any:
    """Draft 7 for a schema of draft 2020-12."""
    if isinstance(node, list):
        return [_convert(member) for member in node]
    if not isinstance(node, dict):
        return node
    made: dict[str, Any] = {}
    for key, value in node.items():
        if key in {"properties", "$defs"}:
            made["definitions" if key == "$defs" else key] = {name: _convert(v) for name, v in value.items()}
        elif key == "prefixItems":
            made["items"] = [_convert(member) for member in value]
            made["additionalItems"] = False
        elif key == "$ref":
            made[key] = value.replace("#/$defs/", "#/definitions/")
        elif key in {"default", "const", "enum", "examples"}:
            made[key] = value
        elif key not in {"discriminator", "title"}:
            made[key] = _convert(value)
    if "$ref" in made and len(made) > 1:  # draft 7 ignores what stands beside a reference
        made["allOf"] = [{"$ref": made.pop("$ref")}]
    if made.get("type") == "integer":
        number = {key: made.pop(key) for key in list(made) if key not in {"description", "default"}}
        made["anyOf"] = [number, _TEXT]
    return made


def _name_regions(node: Any, any_region: dict[str, Any]) -> None:
    """Put the regions where a room that does not know them said that one may stand."""
    members = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    for member in list(members):
        if isinstance(member, dict) and member.get("x-model") == "region":
            member.clear()
            member.update(any_region)
        else:
            _name_regions(member, any_region)


def _require_kind(definition: dict[str, Any]) -> None:
    """Alternatives are told apart by ``kind``, which therefore cannot be left out."""
    kind = definition.get("properties", {}).get("kind")
    if kind is not None:
        kind.pop("default", None)
        definition["required"] = list(dict.fromkeys(["kind", *definition.get("required", [])]))
