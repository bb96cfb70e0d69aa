"""Surfaces that slide far, or meet only during the run, are in contact: no interface bonds what was not bonded."""

import numpy as np
import pytest
import yaml

from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

FRICTIONLESS = {"kind": "frictionless"}
DEBONDED = {"kind": "bilinear_interface", "tension": 0, "compression": "perfect", "tangential": 0}
SPRING = {"kind": "linear_interface", "normal": 50, "tangential": 0}
FLAT = {"kind": "box", "lower": [-8, -4], "upper": [8, 0]}
STEP = {
    "kind": "union",
    "regions": [
        {"kind": "box", "lower": [-8, -4], "upper": [6, 0]},
        {"kind": "box", "lower": [3, 0], "upper": [6, 4]},
    ],
}


class Slide:
    """A block of kinetic energy 6 on a base: ``work`` of the interface, ``error`` of the balance."""

    def __init__(self, base: dict, law: dict, end: float):
        block = {"kind": "box", "lower": [-6, 0], "upper": [-2, 3]}
        scene = {
            "version": 1,
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [-10, -8], "upper": [14, 8], "cell": 1},
            "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
            "materials": {"soft": {"kind": "neo_hookean", "density": 1, "E": 100, "nu": 0.3}},
            "bodies": [
                {"name": "low", "material": "soft", "region": base},
                {"name": "high", "material": "soft", "region": block, "velocity": [1, 0]},
            ],
            "contact": {"law": law},
            "time": {"end": 20, "courant": 0.3},
        }
        s = Simulation(load_scene(yaml.safe_dump(scene)), threads=1)
        balance = EnergyBalance()
        balance.update(Snapshot(s.state))
        self.error = 0.0
        while s.time < end:
            s.step()
            self.error = max(self.error, abs(balance.update(Snapshot(s.state))))
        p = s.particles
        self.kinetic = 0.5 * float(np.sum(p.mass * p.V**2))
        self.work = s.state.work.get("interface_work", 0.0)
        self.view = s.state.contact.interfaces


@pytest.mark.parametrize(("law", "bound"), [(DEBONDED, 1e-3), (SPRING, 0.02)], ids=["debonded", "spring"])
def test_a_block_slides_off(law, bound):
    """The spring works until half a cell of slip (the normal turns at the ends), then no more."""
    run = Slide(FLAT, law, 9.0)
    assert abs(run.work) < bound * 6.0
    assert run.error < bound
    assert run.kinetic == pytest.approx(6.0, rel=0.02)
    assert run.view.all_lost > 0
    assert run.view.energy.sum() == 0.0


@pytest.mark.parametrize("law", [DEBONDED, SPRING], ids=["debonded", "spring"])
def test_a_block_meets_a_step_later(law):
    """It bounces from a face that it never touched as frictionless bodies do."""
    run, contact = Slide(STEP, law, 9.0), Slide(STEP, FRICTIONLESS, 9.0)
    assert abs(run.work) < 0.02 * 6.0
    assert run.kinetic == pytest.approx(contact.kinetic, abs=0.05 * 6.0)
    assert run.error < 1.2 * contact.error


@pytest.mark.parametrize("separation", ["regression", pytest.param("position_fit", marks=pytest.mark.slow)])
def test_jumps_of_edges_are_those_of_gradients(separation):
    """Blocks drawn apart; contacts whose separation is unknown take the jump by gradients."""
    found = []
    for jump in ("gradient", "edges"):
        scene = {
            "version": 1,
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [-8, -8], "upper": [8, 8], "cell": 1},
            "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
            "materials": {"soft": {"kind": "linear_elastic", "density": 1, "E": 100, "nu": 0.3}},
            "bodies": [
                {
                    "name": n,
                    "material": "soft",
                    "velocity": [0, v],
                    "region": {"kind": "box", "lower": a, "upper": b},
                }
                for n, v, a, b in (("low", -0.2, [-4, -4], [4, 0]), ("high", 0.2, [-4, 0], [4, 4]))
            ],
            "contact": {
                "law": {"kind": "linear_interface", "normal": 50, "tangential": 20, "bonded": "x"},
                "separation": {"kind": separation},
                "interface": {"jump": jump},
            },
            "time": {"end": 1, "courant": 0.2},
        }
        s = Simulation(load_scene(yaml.safe_dump(scene)), threads=1)
        for _ in range(20):
            s.step()
        i = s.contact.interfaces
        assert np.abs(i.jumps.jump[i.rows()]).max() < 1.0
        found.append(i.means().jump_normal[0])
    assert found[1] == pytest.approx(found[0], rel=0.1)
