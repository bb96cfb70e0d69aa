"""Columns of grains that collapse on a rough floor: run-out and height of the deposit."""

from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.materials.hencky import WORK
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = Path(__file__).parents[1] / "inputs" / "granular_column.yaml"
SAND = "density: rho, E: 1.0e+6, nu: 0.3"
LAWS = {
    "granular": None,
    "mohr_coulomb": f"{{kind: mohr_coulomb, {SAND}, friction: 30}}",
    "drucker_prager": f"{{kind: drucker_prager, {SAND}, friction: 30, match: plane_strain}}",
}
"""Material of the column; None is that of the scene. All have the same strength in slow plane strain."""


def collapse(law: str, aspect: float, cells: int = 10, **words: str) -> dict[str, float]:
    """Run a column to rest and return its run-out and height over its width, and what the energies say."""
    text = SCENE.read_text(encoding="utf-8")
    material = LAWS[law]
    if material is not None:
        start, end = text.index("  sand:"), text.index("bodies:")
        text = f"{text[:start]}  sand: {material}\n{text[end:]}"
    for old, new in words.items():
        assert old in text
        text = text.replace(old, new)
    loaded = load_scene(text, defines=[f"aspect={aspect}", f"cells={cells}"])
    s = Simulation(loaded, threads=1)
    balance, steps = EnergyBalance(), 0
    while s.time < loaded.scene.time.end:
        if steps % 50 == 0:
            balance.update(Snapshot(s.state))
        s.step()
        steps += 1
    error = balance.update(Snapshot(s.state))
    particles = s.state.particles
    plastic = float(particles.vol0 @ particles.H[WORK])
    stored = float(particles.vol0 @ s.state.strain_energy_density())
    found = {"energy_error": error, "accounted": (plastic + stored) / float(particles.stress_work.sum())}
    return found | {"steps": steps} | measure(s.state.particles.X, 0.1, cells)


def measure(X: Any, width: float, cells: int) -> dict[str, float]:
    """Run-out (front − width)/width and height/width; the front is where the first empty cell on the floor begins."""
    cell = width / cells
    occupied = np.bincount((X[0] / cell).astype(int))
    empty = np.flatnonzero(occupied == 0)
    last = empty[0] if len(empty) else len(occupied)
    front = X[0][X[0] < last * cell].max() + cell / 4
    return {"run_out": front / width - 1, "height": (X[1].max() + cell / 4) / width}
