"""``mpmcli list KIND``."""

from collections.abc import Iterable, Iterator
from typing import Any

import click

KINDS = (
    "materials", "shapes", "regions", "conditions", "loads", "normals", "separations", "laws", "cohesive_shapes",
    "paths", "criteria", "directions", "transfers", "heat_transfers", "updates", "analyses", "quantities",
)  # fmt: skip


@click.command("list")
@click.argument("kind", type=click.Choice(KINDS))
def command(kind: str) -> None:
    """List the alternatives of a kind, with their parameters and defaults."""
    for line in lines(kind):
        click.echo(line)


def lines(kind: str) -> Iterator[str]:
    """The lines that ``list`` prints."""
    if kind == "shapes":
        from mpmcli.shapes import SHAPES

        yield from _aligned(
            (name, f"{entry.description} [{entry.reference}]") for name, entry in SHAPES.items()
        )
    elif kind == "updates":
        from mpmcli.scene.method import UPDATES

        yield from _aligned(UPDATES.items())
    elif kind == "quantities":
        yield from _quantities()
    else:
        for model in _models(kind):
            yield from _describe(model)


def _models(kind: str) -> list[Any]:
    from typing import get_args

    from mpmcli.scene import heat, method, models
    from mpmcli.scene.alternatives import ALTERNATIVES

    if kind in ALTERNATIVES:
        return ALTERNATIVES[kind].models()
    if kind == "cohesive_shapes":
        from mpmcli.interfaces.shapes import AnyShape

        return list(get_args(get_args(AnyShape)[0]))
    unions = {
        "transfers": method.Transfer,
        "heat_transfers": heat.TransferOfHeat,
        "analyses": models.AnalysisKind,
    }
    return list(get_args(get_args(unions[kind])[0]))


def _describe(model: Any) -> Iterator[str]:
    """Name, meaning and parameters of a model."""
    from typing import get_args

    from mpmcli.core.descriptions import field_descriptions
    from mpmcli.core.plugins import plugin_of

    tag = "kind" if "kind" in model.model_fields else "shape"
    kinds = ", ".join(get_args(model.model_fields[tag].annotation))
    yield f"{kinds}: {_first_line(model.__doc__)}"
    if hasattr(model, "analyses"):
        yield f"    for {', '.join(sorted(model.analyses))}"
    if getattr(model, "is_interface", False):
        yield "    interface law: tractions across a jump of displacement"
    if plugin := plugin_of(model):
        yield f"    from the plugin {plugin}"
    words = field_descriptions(model)
    rows = (
        (field.alias or name, _default(field), _first_line(field.description or words.get(name)))
        for name, field in model.model_fields.items()
        if name != tag
    )
    yield from (f"    {line}" for line in _aligned(rows))
    yield ""


def _default(field: Any) -> str:
    if field.is_required():
        return "(required)"
    value = field.get_default(call_default_factory=True)
    value = getattr(value, "kind", value)
    return "-" if value is None or value == () else str(value)


def _first_line(text: str | None) -> str:
    return " ".join((text or "").strip().split("\n\n")[0].split())


def _quantities() -> Iterator[str]:
    from mpmcli.output import columns

    yield from _aligned(
        (each.name, f"{each.rank}, {each.where}", each.dimension, each.description)
        for each in (*columns.QUANTITIES, *columns.extra_quantities())
    )


def _aligned(rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    """Lines of rows of cells, whose columns begin below each other."""
    rows = list(rows)
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)][:-1]
    for *cells, last in rows:
        yield "  ".join([*(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)), last])
