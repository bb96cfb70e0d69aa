"""Figures of the extremes: each is held to its bound, and can be written to the table of the documentation.

MPMCLI_EXTREMES=docs/extremes.csv pytest -n 0 -m "slow or not slow" tests/extremes
"""

from __future__ import annotations

import csv
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROWS: list[tuple[str, str, str, str, str]] = []


@pytest.fixture
def hold() -> Callable[..., None]:
    """Function (what was tried, how, what is measured, figure, bound): the figure is at most the bound."""

    def check(tried: str, how: str, measured: str, figure: float, bound: float) -> None:
        ROWS.append((tried, how, measured, f"{figure:.2g}", f"{bound:.2g}"))
        assert np.isfinite(figure), f"{tried}, {how}: {measured} is {figure}"
        assert figure <= bound, f"{tried}, {how}: {measured} is {figure:.3g}, above {bound:.3g}"

    return check


def pytest_sessionfinish() -> None:
    """Write the table if its file is named."""
    path = os.environ.get("MPMCLI_EXTREMES")
    if path and ROWS:
        with Path(path).open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["what", "with", "measured", "figure", "held below"])
            writer.writerows(ROWS)
