"""What the tests of conduction share: transfers by name, reference tables, errors of a run."""

import csv
import re
from pathlib import Path
from typing import Any

import numpy as np

DATA = Path(__file__).parent / "data" / "heat"


def table(name: str) -> list[dict[str, str]]:
    """Rows of a reference table."""
    with (DATA / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def transfer(method: str, every: int = 1) -> str:
    """The setting of ``FLIP``, ``FLIP(k)`` or ``FMPM(k)``."""
    kind, order = re.fullmatch(r"(\w+?)(?:\((\d+)\))?", method).groups()
    words = [
        f"kind: {kind.lower()}",
        f"order: {order}" if order else "",
        f"every_steps: {every}" if every > 1 else "",
    ]
    return "heat.transfer={" + ", ".join(word for word in words if word) + "}"


def scaled(run: Any, name: str = "T") -> np.ndarray:
    """(T − 300)/100 of the particles by identity, (N,); ``T_carried`` is T where FLIP carries no other one."""
    found = name if getattr(run.particles, name) is not None else "T"
    return (run.ordered(found) - 300.0) / 100.0


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def heat(run: Any) -> float:
    """Σ M T of the temperature that goes to the grid; heat capacities are equal."""
    name = "T" if run.particles.T_carried is None else "T_carried"
    return float(run.mass @ run.ordered(name))


def horner(ratios: list[float], square: str) -> str:
    """1 − r₁ q(1 − r₂ q(…)) as an expression of a scene, q = ``square``."""
    text = "1"
    for ratio in reversed(ratios):
        text = f"(1 - {ratio!r}*({square})*{text})"
    return text


def j0_of(z_squared: str, terms: int = 22) -> str:
    """J0(z) as an expression, from z²."""
    return horner([0.25 / m**2 for m in range(1, terms)], z_squared)
