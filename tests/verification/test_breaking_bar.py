"""A bar that softens and breaks at a weak place: what the crack dissipates does not depend on the cells."""

from typing import Any

import numpy as np
import pytest
import yaml

TOUGHNESS = 0.01


def bar(cell: float, per_cell: int, analysis: str = "uniaxial_stress", softening: str = "linear") -> str:
    """A bar of length 10 that is drawn slowly; one layer of its particles has 0.7 of the strength."""
    across = 0 if analysis == "uniaxial_stress" else 1
    H, speed = 2 * cell, 0.01
    whole: dict[str, Any] = {"kind": "box", "lower": [0, 0][: 1 + across], "upper": [10, H][: 1 + across]}
    weak = {"kind": "box", "lower": [5, 0][: 1 + across], "upper": [5 + cell / per_cell, H][: 1 + across]}
    material = {
        "kind": "isotropic_softening", "density": 1.0, "E": 1000.0, "nu": 0.2, "strength": 1.0,
        "toughness": TOUGHNESS, "softening": softening,
    }  # fmt: skip
    keys = {"particles_per_axis": per_cell, "velocity": [f"{speed}*x/10", "0"][: 1 + across]}
    rest = {"kind": "difference", "region": whole, "subtract": [weak]}
    scene = {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {"lower": [-2, -cell][: 1 + across], "upper": [14, H + cell][: 1 + across], "cell": cell},
        "method": {"shape": "lcpdi", "transfer": {"kind": "flip"}},
        "materials": {"strong": material, "weak": material | {"strength": 0.7}},
        "bodies": [
            {"name": "bar", "material": "strong", "region": rest} | keys,
            {"name": "flaw", "material": "weak", "region": weak} | keys,
        ],
        "boundary": [
            {"name": "left", "kind": "velocity", "on": {"plane": {"axis": "x", "at": 0}}, "direction": "x", "value": 0},
            {"name": "right", "kind": "wall", "normal": [-1, 0][: 1 + across], "position": f"10+{speed}*t",
             "velocity": speed},
        ],
        "time": {"end": 10.0, "courant": 0.4},
    }  # fmt: skip
    return yaml.safe_dump(scene, sort_keys=False)


def dissipated(run, end: float) -> float:
    """Energy that the bar has dissipated until it is apart, per area of its section."""
    run.to(end)
    p = run.particles
    section = p.vol0.sum() / 10
    return float(p.H[-1] @ p.vol0) / section


@pytest.mark.slow
@pytest.mark.parametrize("per_cell", [1, 2])
@pytest.mark.parametrize("cell", [1.0, 0.5, 0.25])
def test_energy_of_a_crack(start, cell, per_cell):
    assert dissipated(start(bar(cell, per_cell), threads=1), 3.8) == pytest.approx(TOUGHNESS, rel=0.01)


@pytest.mark.slow
def test_energy_of_a_crack_in_the_plane(start):
    assert dissipated(start(bar(1.0, 2, "plane_strain"), threads=1), 3.8) == pytest.approx(
        TOUGHNESS, rel=0.01
    )


@pytest.mark.slow
def test_the_crack_between_two_notches(start):
    """Every particle of the ligament is apart, and its cells have dissipated the toughness; others hardly."""
    run = start("notched_plate.yaml")
    run.to(0.11)
    energy = run.ordered("H")[-1] * run.ordered("vol0")
    cracked = np.abs(run.X0[0]) < 0.5
    assert energy[cracked].sum() == pytest.approx(0.05 * 18, rel=1e-3)
    assert energy[~cracked].sum() < 0.08 * energy[cracked].sum()
    assert np.all(run.ordered("H")[-3, cracked] > 0.99)
