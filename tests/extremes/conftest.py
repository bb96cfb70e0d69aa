"""Figures of the extremes: each is held to its bound, and can be written to the table of the documentation.

MPMCLI_EXTREMES=docs/verification/extremes.csv pytest -n 0 -m "slow or not slow" tests/extremes
"""

import csv
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROWS: dict[tuple[str, str, str], tuple[list[str], float]] = {}
"""Methods and the largest figure, by what was tried, what was measured, and its bound."""


def note(tried: str, how: str, measured: str, bound: str, figure: float) -> None:
    """Keep a figure for the table."""
    methods, largest = ROWS.get((tried, measured, bound), ([], figure))
    ROWS[tried, measured, bound] = (list(dict.fromkeys([*methods, how])), max(largest, figure))


@pytest.fixture
def hold() -> Callable[..., None]:
    """Function (what was tried, how, what is measured, figure, bound): the figure is at most the bound."""

    def check(tried: str, how: str, measured: str, figure: float, bound: float) -> None:
        note(tried, how, measured, f"{bound:.2g}", figure)
        assert np.isfinite(figure), f"{tried}, {how}: {measured} is {figure}"
        assert figure <= bound, f"{tried}, {how}: {measured} is {figure:.3g}, above {bound:.3g}"

    return check


@pytest.fixture
def breaks() -> Callable[..., None]:
    """Function of the same arguments, for what is known not to hold: the figure is above the bound."""

    def check(tried: str, how: str, measured: str, figure: float, bound: float) -> None:
        note(f"{tried} with {how}", how, measured, f"breaks: above {bound:.2g}", figure)
        assert figure > bound, f"{tried}, {how}: {measured} is {figure:.3g}: it holds by now, say so"

    return check


def pytest_sessionfinish() -> None:
    """Write the table if its file is named."""
    path = os.environ.get("MPMCLI_EXTREMES")
    if path and ROWS:
        with Path(path).open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["what", "with", "measured", "largest", "bound"])
            for (tried, measured, bound), (methods, figure) in ROWS.items():
                shown = "the run fails" if np.isinf(figure) else f"{figure:.2g}"
                writer.writerow([tried, "; ".join(methods), measured, shown, bound])
