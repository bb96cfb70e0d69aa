"""Figures of papers, made again: one file for each, found by its name ``<paper>_fig<number>.py``."""

from __future__ import annotations

import importlib
import pkgutil
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from figures.base import Figure


def names() -> list[str]:
    """All figures, in the order of papers and numbers."""
    return sorted(module.name for module in pkgutil.iter_modules(__path__) if "_fig" in module.name)


def figure(name: str) -> Figure:
    """A figure by its name."""
    return importlib.import_module(f"figures.{name}").FIGURE
