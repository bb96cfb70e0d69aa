"""``mpmcli new``."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcli.core.suggest import did_you_mean

TEMPLATES = {
    "simple": "a block that falls and lands on a floor",
    "vibrating_bar": "a bar in one dimension, fixed at one end, with a known answer",
    "block_impact": "two blocks that meet at high speed",
    "contact": "a block that slides down rigid ground with friction",
}


def template_text(name: str) -> str:
    """The text of a template."""
    from importlib.resources import files

    return (files("mpmcli.scene") / "templates" / f"{name}.yaml").read_text(encoding="utf-8")


@click.command(
    "new", epilog="Templates: " + "; ".join(f"{name}, {words}" for name, words in TEMPLATES.items())
)
@click.argument("template", default="simple")
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="Write to a new file.")
def command(template: str, output: Path | None) -> None:
    """Print or write a commented scene to start from."""
    if template not in TEMPLATES:
        hint = did_you_mean(template, TEMPLATES) or f" ({', '.join(TEMPLATES)})"
        raise click.BadParameter(f"there is no template '{template}'{hint}", param_hint="TEMPLATE")
    from mpmcli.cli.files import write_or_print

    write_or_print(template_text(template), output, overwrite=False)
