"""Write the reference of scenes and of quantities from the models and registries of the program itself.

    python docs/generate_reference.py

writes Markdown into ``docs/_generated``; the build of the documentation calls it by itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "_generated"
Schema = dict[str, Any]

NOUNS = {
    "analysis": "Analysis",
    "materials": "Material",
    "boundary": "Boundary condition",
    "loads": "Load",
    "probes": "Probe",
    "region": "Region",
    "transfer": "Transfer",
    "hardening": "Hardening",
    "normal": "Contact normal",
    "separation": "Contact separation",
    "law": "Contact law",
    "path": "Path of a crack",
    "criterion": "Growth criterion",
    "direction": "Growth direction",
}
"""What the alternatives below a key are called in headings."""

WORDS = {"string": "text", "integer": "whole number", "boolean": "`true` or `false`", "number": "number"}
"""Types of JSON in words."""


def write(folder: Path = FOLDER) -> list[Path]:
    """Write all pages and return their paths; files whose text would not change are left alone."""
    folder.mkdir(parents=True, exist_ok=True)
    pages = {
        "reference.md": reference(),
        "shapes.md": shapes(),
        "particle_quantities.md": quantities("particle"),
        "global_quantities.md": quantities(
            "global", "material", "body", "reaction", "heat", "pair", "field", "crack", "tip"
        ),
        "grid_quantities.md": grid_fields(),
    }
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    return [folder / name for name in pages]


def reference() -> str:
    """The page about everything that a scene can say."""
    from mpmcli.scene.schema import scene_schema

    schema = scene_schema()
    return "\n".join(Reference(schema).lines()) + "\n"


def introduction() -> str:
    """What holds for every value of a scene."""
    from mpmcli.core.expression_functions import FUNCTIONS, USES

    lines = [
        "The program generates this page from the models that read a scene. A number may be text with a unit",
        '(`"1 GPa"`; the scene must declare its `units`) or an expression of the `constants` (`2*R`). Values that',
        "may vary are expressions of `x`, `y`, `z` or `t`, as stated in their meaning. Expressions may contain",
        f"`+ - * / **`, comparisons (1 if true, 0 if false), `pi` and `{' '.join(FUNCTIONS)}`.",
        *("`{}` is {}.".format(*use.split(" is ", 1)) for use in USES.values()),
        "`interpolate(t, t0, v0, t1, v1)` is linear between points and constant beyond them. In values that may vary,",
        '`interpolate(t, "file.csv")` reads the points from a file beside the scene: two columns under a line with',
        "their names, increasing arguments, plain numbers in the units of the scene.",
        "`mpmcli schema` prints the JSON Schema for editors.",
    ]
    return "\n".join(lines)


class Reference:
    """Walks through the schema of a scene, one section per key and one per model, each model once."""

    def __init__(self, schema: Schema):
        self.schema = with_alternatives(schema, schema["definitions"])
        self.definitions: dict[str, Schema] = self.schema["definitions"]
        self.written: set[str] = set()
        self.models = {**analyses_of_materials(), **axes_of_regions()}
        self.made = defaults_made_when_needed()

    def lines(self) -> Iterator[str]:
        """The lines of the page."""
        yield from ("# Scene reference", "", introduction(), "")
        yield from ("## Top level", "")
        yield from self.table("", self.schema)
        for key, node in self.schema["properties"].items():
            names = list(references(node))
            if names:
                yield from (f"## `{key}`", "", sentence(node.get("description", "")), "")
            for name in names:
                yield from self.section(name, NOUNS.get(key, ""))

    def section(self, name: str, noun: str) -> Iterator[str]:
        """A model and the models that it leads to."""
        if name in self.written:
            return
        self.written.add(name)
        definition = self.definitions[name]
        yield from (f"({anchor(name)})=", f"### {self.title(name, noun)}", "")
        yield from (prose(definition.get("description", "")), "")
        if name in self.models:
            yield from (self.models[name], "")
        yield from self.table(name, definition)
        for key, node in definition["properties"].items():
            for other in references(node):
                yield from self.section(other, NOUNS.get(key, noun if self.has_kind(other) else ""))

    def table(self, name: str, model: Schema) -> Iterator[str]:
        """The keys of the model ``name``: what may stand there, the default, the meaning."""
        required = model.get("required", ())
        yield "| key | value | default | meaning |"
        yield "| --- | --- | --- | --- |"
        for key, node in sorted(model["properties"].items(), key=lambda entry: entry[0] != "kind"):
            default = "required" if key in required else default_of(node)
            if default == "–":
                default = self.made.get((name, key), default)
            cells = (f"`{key}`", self.words(node), default, sentence(node.get("description", "")))
            yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"
        yield ""

    def title(self, name: str, noun: str) -> str:
        """Heading of a model: its kinds, or its name in words."""
        kinds = kinds_of(self.definitions[name])
        if kinds:
            return f"{noun or 'Kind'} {', '.join(f'`{kind}`' for kind in kinds)}"
        plain = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.split("__")[-1])
        return plain.capitalize()

    def has_kind(self, name: str) -> bool:
        """Whether a model is one of several alternatives."""
        return bool(kinds_of(self.definitions[name]))

    def link(self, name: str) -> str:
        """A link to the section of a model."""
        kinds = kinds_of(self.definitions[name])
        text = ", ".join(f"`{kind}`" for kind in kinds) if kinds else self.title(name, "").lower()
        return f"[{text}](#{anchor(name)})"

    def words(self, node: Schema) -> str:
        """What may stand at a key, in words."""
        names = list(references(node, deep=False))
        if names:
            return (
                " or ".join([self.link(name) for name in names])
                if len(names) < 3
                else ", ".join(self.link(name) for name in names)
            )
        if "const" in node:
            return f"`{plain(node['const'])}`"
        if "enum" in node:
            return ", ".join(f"`{plain(value)}`" for value in node["enum"])
        options = [option for option in node.get("anyOf", ()) if option.get("type") != "null"]
        if "x-dimension" in node:
            return quantity_words(node["x-dimension"], options or [node])
        if len(options) > 1 and {option.get("type") for option in options} >= {"string"}:
            # text may be an expression wherever a number may stand
            options = [option for option in options if option.get("type") != "string"]
        if options:
            return " or ".join(dict.fromkeys(self.words(option) for option in options))
        if node.get("type") == "array":
            return self.list_words(node)
        if node.get("type") == "object":
            members = node.get("additionalProperties")
            inner = self.words(members) if isinstance(members, dict) else "anything"
            return f"mapping of names to: {inner}"
        words = {
            "string": "text",
            "integer": "whole number",
            "boolean": "`true` or `false`",
            "number": "number",
        }
        return words.get(node.get("type", ""), "value") + bounds(node)

    def list_words(self, node: Schema) -> str:
        """A list in words."""
        items = node.get("items", {})
        if isinstance(items, list):
            return f"list of {len(items)}: {', '.join(dict.fromkeys(self.words(item) for item in items))}"
        return f"list of: {self.words(items)}"


def with_alternatives(node: Any, definitions: dict[str, Schema]) -> Any:
    """The schema in which "if the kind is …, then this model" reads "one of these models", where each may stand."""
    if isinstance(node, list):
        return [with_alternatives(member, definitions) for member in node]
    if not isinstance(node, dict):
        return node
    target = definitions.get(node.get("$ref", "").rsplit("/", 1)[-1], {})
    branches = [branch["then"] for branch in (target or node).get("allOf", ()) if "then" in branch]
    if branches:
        return {"oneOf": branches} | {key: node[key] for key in ("description", "default") if key in node}
    return {key: with_alternatives(member, definitions) for key, member in node.items()}


def references(node: Any, deep: bool = True) -> Iterator[str]:
    """Names of the models that stand at a key, in their order; ``deep``: inside lists and mappings too."""
    if not isinstance(node, dict):
        return
    if "$ref" in node:
        yield node["$ref"].rsplit("/", 1)[-1]
        return
    for key in ("allOf", "oneOf", "anyOf"):
        for option in node.get(key, ()):
            yield from references(option, deep)
    if deep:
        items = node.get("items", ())
        for item in items if isinstance(items, list) else [items]:
            yield from references(item)
        yield from references(node.get("additionalProperties"))


def kinds_of(definition: Schema) -> list[str]:
    """Names under which a scene chooses a model, if it is one of several."""
    kind = definition.get("properties", {}).get("kind", {})
    return [kind["const"]] if "const" in kind else list(kind.get("enum", ()))


def quantity_words(dimension: str, options: list[Schema]) -> str:
    """A number with a dimension, and its bounds."""
    limits = next((bounds(option) for option in options if bounds(option)), "")
    name = "number" if dimension == "1" else f"{dimension}"
    return name + limits


def bounds(node: Schema) -> str:
    """The bounds of a number."""
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    found = [f"{sign} {node[key]:g}" for key, sign in signs.items() if key in node]
    return f" {', '.join(found)}" if found else ""


def default_of(node: Schema) -> str:
    """The default in words; a dash where leaving the key out means that there is nothing."""
    value = node.get("default")
    if isinstance(value, dict) and not any(value.values()):
        value = None
    return "–" if value in (None, "", [], {}) else f"`{plain(value)}`"


def plain(value: Any) -> str:
    """A value as YAML writes it."""
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {plain(member)}" for key, member in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(plain(member) for member in value) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def anchor(name: str) -> str:
    """The target of links to a model."""
    return f"model-{name.lower().replace('__', '-')}"


def prose(text: str) -> str:
    """A docstring as Markdown: citations become links, and signs that Markdown would take are kept."""
    parts = re.split(r"(``.*?``|`.*?`)", text)
    return "".join(part if part.startswith("`") else cited(part.replace("*", r"\*")) for part in parts)


def cited(text: str) -> str:
    """``[nairn2026, Eq. 7]`` as a citation."""
    return re.sub(r"\[([a-z]+\d{4}[a-z]*)((?:, [^\]]*)?)\]", r"({cite:t}`\1`\2)", text)


def sentence(text: str) -> str:
    """A description on one line."""
    return prose(" ".join(text.split()))


def analyses_of_materials() -> dict[str, str]:
    """For each material the analyses that it can be used in."""
    from mpmcli.core.analysis import ANALYSES
    from mpmcli.materials import MATERIALS

    lines = {}
    for model in MATERIALS.models():
        names = [f"`{name}`" for name in ANALYSES if name in model.analyses]  # type: ignore[attr-defined]
        words = "all analyses" if len(names) == len(ANALYSES) else ", ".join(names)
        history = ", ".join(f"`{name}`" for name in model.history)  # type: ignore[attr-defined]
        lines[model.__name__] = f"For {words}." + (f" History variables: {history}." if history else "")
    return lines


def axes_of_regions() -> dict[str, str]:
    """For each region the numbers of axes that it is defined for."""
    from mpmcli.geometry import REGIONS

    lines = {}
    for model in REGIONS.models():
        axes = sorted(model.dimensions)  # type: ignore[attr-defined]
        name = model.__name__
        if name == "Box":  # shares its name with the box of boundary conditions
            name = "mpmcli__geometry__box__Box"
        lines[name] = f"For analyses with {', '.join(str(n) for n in axes)} axes." if len(axes) < 3 else ""
    return {name: line for name, line in lines.items() if line}


def defaults_made_when_needed() -> dict[tuple[str, str], str]:
    """Defaults by model and key that the schema does not know, because they are made when needed."""
    from mpmcli.contact.model import Contact
    from mpmcli.scene.heat import Heat
    from mpmcli.scene.method import Method

    contact = Contact.model_validate({"law": {"kind": "frictionless"}})
    return {
        ("Method", "transfer"): f"`{plain(Method().transfer.model_dump())}`",
        ("Heat", "transfer"): f"`{plain({'kind': Heat().transfer.kind})}`",
        ("Contact", "normal"): f"`{plain({'kind': contact.normal.kind})}`",
        ("Contact", "separation"): f"`{plain({'kind': contact.separation.kind})}`",
    }


def shapes() -> str:
    """The table of shape functions."""
    from mpmcli.shapes import SHAPES

    lines = ["| shape | nodes per axis | what it is | reference |", "| --- | --- | --- | --- |"]
    for name, entry in SHAPES.items():
        lines.append(f"| `{name}` | {entry.width} | {entry.description} | {entry.reference} |")
    return "\n".join(lines) + "\n"


def quantities(*places: str) -> str:
    """The table of quantities that live at some places."""
    from mpmcli.output.columns import QUANTITIES, extra_quantities

    lines = ["| name | of | rank | dimension | meaning |", "| --- | --- | --- | --- | --- |"]
    for quantity in (*QUANTITIES.at(*places), *(extra_quantities() if "global" in places else ())):
        meaning = sentence(quantity.description).replace("|", r"\|")
        lines.append(
            f"| `{quantity.name}` | {quantity.where} | {quantity.rank} | {quantity.dimension} | {meaning} |"
        )
    return "\n".join(lines) + "\n"


def grid_fields() -> str:
    """The table of fields of the grid."""
    from mpmcli.output.probes import GRID_FIELDS

    lines = ["| name | rank | dimension | meaning |", "| --- | --- | --- | --- |"]
    for name, field in GRID_FIELDS.items():
        rank = "vector" if field.is_vector else "scalar"
        where = " (scenes with contact)" if name.startswith("contact_") else ""
        lines.append(f"| `{name}` | {rank} | {field.dimension} | {sentence(field.description)}{where} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for written in write():
        print(written)
