"""``mpmcli compare A B``."""

from pathlib import Path

import click

from mpmcli.cli.completion import columns_to_compare, offering
from mpmcli.cli.options import RealRange


@click.command("compare")
@click.argument("a", type=click.Path(path_type=Path))
@click.argument("b", type=click.Path(path_type=Path))
@click.option("--rtol", type=RealRange(min=0), default=1e-9, help="Relative tolerance.")
@click.option("--atol", type=RealRange(min=0), default=0.0, help="Absolute tolerance.")
@click.option(
    "--columns",
    metavar="NAME,…",
    multiple=True,
    help="Compare these columns only; * matches any text.",
    shell_complete=offering(columns_to_compare, is_list=True),
)
def command(a: Path, b: Path, rtol: float, atol: float, columns: tuple[str, ...]) -> int:
    """Compare two tables, or all tables of two results folders; exit code 1 if they differ."""
    from mpmcli.results.compare import compare

    names = [name.strip() for text in columns for name in text.split(",") if name.strip()]
    differences = compare(a, b, rtol=rtol, atol=atol, columns=names or None)
    for difference in differences:
        click.echo(str(difference))
    if not differences:
        click.echo(f"{a} and {b} agree")
    return 1 if differences else 0
