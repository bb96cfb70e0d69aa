"""An interface with a huge stiffness tends to bodies in perfect contact, wherever it lies in the cells."""

from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.slow

SIZE = 4.0
"""Two blocks of SIZE by 2 SIZE side by side, which a smooth velocity pulls at, presses upon and shears."""
END = 0.4
"""Waves run through 4.6 of these units of length until then."""


def final_state(cell: float, shift: float, transfer: dict[str, Any], law: dict[str, Any]) -> np.ndarray:
    """Positions and velocities at the end (2, 2, N), by identity; the joint lies ``shift`` cells off a grid line."""
    s, up = shift * cell, 0.31 * cell
    wave = f"(1 + cos({np.pi / SIZE!r}*(x - {s!r})))*(1 + cos({np.pi / SIZE!r}*(y - {up!r})))"
    velocity = [
        f"0.025*{wave}*(1 + 0.5*sin({np.pi / SIZE!r}*(y - {up!r})))",
        f"0.0175*{wave}*(1 - 0.5*sin({np.pi / SIZE!r}*(x - {s!r})))",
    ]
    bodies = [
        {
            "name": name,
            "material": "soft",
            "particles_along": "region",
            "region": {"kind": "box", "lower": [low + s, up - SIZE], "upper": [low + SIZE + s, up + SIZE]},
            "velocity": velocity,
        }
        for name, low in (("left", -SIZE), ("right", 0.0))
    ]
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-SIZE - 2.0] * 2, "upper": [SIZE + 2.0] * 2, "cell": cell},
        "method": {"shape": "ugimp", "transfer": transfer},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}},
        "bodies": bodies,
        "contact": {"law": law},
        "time": {"end": END, "courant": 0.2},
    }
    run = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)
    while run.time < END * (1.0 - 1e-9):
        run.step()
    p = run.particles
    order = np.argsort(p.id)
    return np.stack([p.X[:, order], p.V[:, order]])


def differences(cell: float, shift: float, transfer: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Of positions and of velocities: root mean squares over that of the effect of the joint, and over its largest."""
    spring = {"kind": "linear_interface", "normal": 1e9, "tangential": 1e9}
    stiff, perfect, free = (
        final_state(cell, shift, transfer, law)
        for law in (spring, {"kind": "perfect"}, spring | {"normal": 0.0, "tangential": 0.0})
    )
    off = np.sqrt(np.mean((stiff - perfect) ** 2, axis=(1, 2)))
    effect = perfect - free
    return off / np.sqrt(np.mean(effect**2, axis=(1, 2))), off / np.abs(effect).max(axis=(1, 2))


@pytest.mark.parametrize("shift", [0, 0.1, 0.2, 0.37])
def test_with_fmpm(shift):
    """Below 1 % of the effect with 32 cells per wave, and converging; also where a node has little mass of a side."""
    transfer = {"kind": "fmpm", "order": 4}
    (coarse, _), (fine, _) = (differences(cell, shift, transfer) for cell in (0.5, 0.25))
    print(shift, coarse, fine)
    assert np.all(fine < 0.01)
    assert np.all(fine < 0.7 * coarse)


@pytest.mark.parametrize("shift", [0, 0.2])
def test_with_flip(shift):
    """Velocities of FLIP have noise, that of the particles beside the joint: below 1 % of the largest effect."""
    of_effect, of_largest = differences(0.25, shift, {"kind": "flip"})
    print(shift, of_effect, of_largest)
    assert of_effect[0] < 0.01
    assert np.all(of_largest < 0.01)
