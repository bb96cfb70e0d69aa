"""Write the tables of docs/verification/materials.md: ``PYTHONPATH=tests python tests/material_tables.py``."""

from pathlib import Path

import examples
import material_elements

from mpmcli.core.analysis import ANALYSES
from mpmcli.materials import MATERIALS


def element_table() -> str:
    """The table of all answers."""
    head = "| material | path | strain or quantity | mpmcli | exact | error |"
    lines = [head, "| --- | --- | --- | --- | --- | --- |"]
    for a in material_elements.answers():
        law, _, part = a.law.partition(", ")
        name = f"`{law}`, `{part}`" if part else f"`{law}`"
        values = f"{a.computed:.6g} | {a.exact:.6g} | {max(a.error, 1e-12):.0e}"
        lines.append(f"| {name} | {a.path} | {a.quantity} | {values} |")
    return "\n".join(lines) + "\n"


def analysis_table() -> str:
    """Which analyses each law allows."""
    lines = ["| material | " + " | ".join(f"`{name}`" for name in ANALYSES) + " |"]
    lines.append("| --- " * (1 + len(ANALYSES)) + "|")
    for kind in sorted(MATERIALS):
        words = examples.material(kind, examples.MATERIALS[kind][0])
        allowed = MATERIALS[kind].model_validate(words).analyses
        marks = " | ".join("yes" if name in allowed else "–" for name in ANALYSES)
        lines.append(f"| `{kind}` | {marks} |")
    return "\n".join(lines) + "\n"


TABLES = {"material_elements": element_table, "material_analyses": analysis_table}
"""What makes the tables of docs/tables."""


if __name__ == "__main__":
    from conftest import _plain_python

    folder = Path(__file__).parents[1] / "docs" / "tables"
    with _plain_python():
        for name, make in TABLES.items():
            (folder / f"{name}.md").write_text(make(), encoding="utf-8")
            print(folder / f"{name}.md")
