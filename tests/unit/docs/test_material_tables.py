"""The tables of one-element answers and of analyses hold every material and sub-model, and what is computed."""

from pathlib import Path
from typing import get_args

import material_elements
import material_tables
import pytest

from mpmcli.materials.base import KINDS
from mpmcli.materials.hardening import Hardening

FOLDER = Path(__file__).parents[3] / "docs" / "tables"
LIMITS = {
    "hill_plastic": 1e-3,
    "mooney_rivlin": 1e-4,
    "orthotropic": 1e-5,
    "transversely_isotropic": 1e-5,
    "bingham": 1e-3,
    "viscoelastic": 3e-3,
}
"""Largest errors of laws whose closed form is a limit (small strain, no change of volume); of the others 1e-8."""


def rows(name: str) -> list[list[str]]:
    """The cells of a table, without its head."""
    lines = (FOLDER / f"{name}.md").read_text(encoding="utf-8").splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def hardenings() -> list[str]:
    """The hardening laws that there are."""
    models = get_args(get_args(Hardening)[0])
    return [get_args(model.model_fields["kind"].annotation)[0] for model in models]


def test_every_material_and_hardening_has_all_paths():
    found = {(row[0], row[1]) for row in rows("material_elements")}
    laws = {f"`{kind}`" for kind in KINDS if kind not in {"rigid", "j2_plastic"}}
    laws |= {f"`j2_plastic`, `{kind}`" for kind in hardenings()}
    assert found == {(law, path) for law in laws for path in material_elements.PATHS}


@pytest.mark.parametrize("kind", sorted(material_elements.LAWS))
def test_answers_are_exact_and_those_of_the_table(kind, plain_python):
    with plain_python():
        answers = list(material_elements.answers([kind]))
    for answer in answers:
        assert answer.error < LIMITS.get(kind, 1e-8), answer
    shown = [row for row in rows("material_elements") if row[0].startswith(f"`{kind}`")]
    assert [(row[1], row[2]) for row in shown] == [(a.path, a.quantity) for a in answers]
    for row, answer in zip(shown, answers, strict=True):
        values = [float(cell) for cell in row[3:5]]
        assert values == pytest.approx([answer.computed, answer.exact], rel=1e-5, abs=1e-12)


def test_analyses_are_those_that_laws_allow():
    assert (FOLDER / "material_analyses.md").read_text(encoding="utf-8") == material_tables.analysis_table()
