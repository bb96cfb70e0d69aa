"""Temperatures held at faces lower the longest stable heat step, the more the more axes have such faces."""

import numpy as np
import pytest
import yaml

from mpmcli.core.errors import SimulationError
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.heat import stable_fourier

KINDS = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}
NOISE = 1e-6


def block(d: int, transfer: dict, cells: int, held: list[tuple[str, str]], step: float) -> dict:
    """A block at rest on grid lines, with D = Δx = 1, some of whose faces are held."""
    solid = {
        "kind": "linear_elastic",
        "density": 1,
        "E": 1e-6,
        "nu": 0,
        "heat_capacity": 1,
        "conductivity": 1,
    }
    return {
        "version": 1,
        "analysis": {"kind": KINDS[d]},
        "grid": {"lower": [-2] * d, "upper": [cells + 3] * d, "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}, "heating": "isothermal"},
        "heat": {"transfer": transfer},
        "materials": {"m": solid},
        "bodies": [{"name": "b", "material": "m", "region": {"kind": "box", "lower": [0] * d, "upper": [cells] * d}}],
        "boundary": [
            {"name": a + s, "kind": "temperature", "on": {"body": "b", "face": {"axis": a, "side": s}}, "value": 300}
            for a, s in held
        ],
        "time": {"end": 1e6, "step": step},
    }  # fmt: skip


def growth(scene: dict, steps: int = 300) -> float:
    """By how much random changes of the temperatures have grown."""
    simulation = Simulation(load_scene(yaml.safe_dump(scene)), 1)
    p = simulation.particles
    noise = np.random.default_rng(1).normal(0.0, NOISE, p.count)
    for T in (p.T, p.T_carried):
        if T is not None:
            T += noise
    try:
        for _ in range(steps):
            simulation.step()
    except SimulationError:  # a temperature is negative by now
        return np.inf
    return float(np.abs(p.T - 300.0).max()) / NOISE


FLIP, FMPM4 = {"kind": "flip"}, {"kind": "fmpm", "order": 4}
CASES = {
    "1D": (1, FLIP, 6, "x", 2),
    "1D, thin": (1, FLIP, 1, "x", 2),
    "2D, one axis": (2, FLIP, 4, "x", 2),
    "2D, two axes": (2, FLIP, 4, "xy", 2),
    "2D, two axes, FMPM": (2, FMPM4, 4, "xy", 2),
    "3D, three axes": (3, FLIP, 3, "xyz", 2),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_random_changes_grow_above_the_limit_only(name):
    d, transfer, cells, axes, sides = CASES[name]
    held = [(axis, side) for axis in axes for side in ("lower", "upper")[:sides]]
    limit = stable_fourier(load_scene(yaml.safe_dump(block(d, transfer, cells, held, 0.1))).scene)[0]
    assert growth(block(d, transfer, cells, held, 0.97 * limit)) < 1.0
    assert growth(block(d, transfer, cells, held, 1.06 * limit)) > 100.0 or limit == 0.5
