"""The JSON Schema of scenes in draft 7, the dialect that editors understand (pydantic writes 2020-12)."""

import json
from typing import Any

from pydantic.json_schema import models_json_schema

DIALECT = "http://json-schema.org/draft-07/schema#"
_TEXT = {"type": "string"}
TAGS = ("kind", "shape")
"""Keys by which alternatives are told apart."""


def scene_schema() -> dict[str, Any]:
    """The schema of a whole scene."""
    from mpmcli.scene.alternatives import ALTERNATIVES
    from mpmcli.scene.models import Scene

    alternatives = [model for registry in ALTERNATIVES.values() for model in registry.models()]
    asked: Any = [(model, "validation") for model in (Scene, *alternatives)]
    places, written = models_json_schema(asked, by_alias=True)
    schema = _convert(written)
    definitions = schema["definitions"]
    _name_alternatives(definitions)
    for registry in ALTERNATIVES.values():
        branches = [_convert(places[model, "validation"]) for model in registry.models()]
        definitions[_place_of(registry.noun)] = {"oneOf": branches}
    for definition in definitions.values():
        _require_kind(definition)
    _choose_by_kind(definitions, definitions)
    scene = definitions.pop("Scene")
    return {"$schema": DIALECT, **schema, **scene, "title": "Scene of mpmcli"}


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


def _place_of(noun: str) -> str:
    """Name of the definition of all entries of a registry."""
    return f"any_{noun.replace(' ', '_')}"


def _name_alternatives(node: Any) -> None:
    """Refer to all entries of a registry where it is said that one of them may stand."""
    if isinstance(node, dict) and "x-one-of" in node:
        node.pop("type", None)
        node["allOf"] = [{"$ref": f"#/definitions/{_place_of(node.pop('x-one-of'))}"}]
    for member in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        _name_alternatives(member)


def _choose_by_kind(node: Any, definitions: dict[str, Any]) -> None:
    """Turn "one of these" into "if the kind is …, then this one", so that editors blame the branch that is meant."""
    branches: list[Any] = node.get("oneOf", []) if isinstance(node, dict) else []
    for tag in TAGS:
        kinds = [_kind_of(branch, definitions, tag) for branch in branches]
        if not kinds or not all(kinds):
            continue
        del node["oneOf"]
        node["type"] = "object"
        node["required"] = [tag]
        node["properties"] = {
            tag: {"enum": sorted({name for kind in kinds for name in kind.get("enum", [kind.get("const")])})}
        }
        node["allOf"] = [
            {"if": {"properties": {tag: kind}, "required": [tag]}, "then": branch}
            for kind, branch in zip(kinds, branches, strict=True)
        ]
        break
    for member in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        _choose_by_kind(member, definitions)


def _kind_of(branch: Any, definitions: dict[str, Any], tag: str) -> dict[str, Any]:
    """What the schema of an alternative says of its ``kind``, the key ``tag``; nothing if it is none."""
    definition = definitions.get(str(branch.get("$ref", "")).removeprefix("#/definitions/"), {})
    kind = definition.get("properties", {}).get(tag, {})
    return {key: kind[key] for key in ("const", "enum") if key in kind}


def _require_kind(definition: dict[str, Any]) -> None:
    """Alternatives are told apart by ``kind``, which therefore cannot be left out."""
    kind = definition.get("properties", {}).get("kind")
    if kind is not None:
        kind.pop("default", None)
        definition["required"] = list(dict.fromkeys(["kind", *definition.get("required", [])]))
