"""Faces and grid planes that absorb waves at normal incidence: what is left of the energy of a pulse."""

import numpy as np
import pytest
import yaml
from particle_sums import energy

from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

E, NU, RHO = 2.0, 0.25, 0.5
M = E * (1 - NU) / (1 + NU) / (1 - 2 * NU)
G = E / 2 / (1 + NU)


FACES = {side: {"body": "bar", "face": {"axis": "x", "side": side}} for side in ("lower", "upper")}
PLANES = {side: {"plane": {"axis": "x", "at": at}} for side, at in (("lower", 0.0), ("upper", 40.0))}


def pulse(analysis, transfer, axis, speed, loads, places=FACES):
    """A column whose pulse of velocity runs towards its upper end along x; periodic or free sides do not matter."""
    d = 1 if analysis.startswith("uniaxial") else 2
    size = [40.0, 4.0][:d]
    shape = "0.001*exp(-((x - 20)/3)**2)"
    velocity = ["0"] * d
    velocity[axis] = shape
    rollers = []
    if d == 2:  # no wave spreads sideways
        rollers = [
            {
                "name": f"{name}{a}",
                "kind": "velocity",
                "on": {"plane": {"axis": "y", "at": at, "side": name}},
                "direction": a,
                "value": 0,
            }
            for name, at in (("lower", 0), ("upper", 4))
            for a in ["xy"[1 - axis]]
        ]
    return {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {"lower": [-3.0, 0.0][:d], "upper": [43.0, 4.0][:d], "cell": 0.5},
        "method": {"shape": "lcpdi", "transfer": transfer},
        "materials": {"m": {"kind": "linear_elastic", "density": RHO, "E": E, "nu": NU}},
        "bodies": [
            {
                "name": "bar",
                "material": "m",
                "region": {"kind": "box", "lower": [0] * d, "upper": size},
                "velocity": velocity,
            }
        ],
        "boundary": rollers,
        "loads": [{"name": side, "kind": "absorbing", "on": place} | loads for side, place in places.items()],
        "time": {"end": float(2 * 40.0 / speed), "courant": 0.2},
    }


@pytest.mark.slow
@pytest.mark.parametrize("places", [FACES, PLANES], ids=["faces", "planes"])
@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}])
@pytest.mark.parametrize(
    ("analysis", "axis", "speed"),
    [
        ("uniaxial_strain", 0, np.sqrt(M / RHO)),
        ("uniaxial_stress", 0, np.sqrt(E / RHO)),
        ("plane_strain", 0, np.sqrt(M / RHO)),
        ("plane_strain", 1, np.sqrt(G / RHO)),
    ],
)
def test_pulses_leave(analysis, axis, speed, transfer, places):
    """The pulse splits in two, which leave at both ends: a 10⁻⁵ of the energy remains at most, and the books close."""
    s = Simulation(load_scene(yaml.safe_dump(pulse(analysis, transfer, axis, speed, {}, places))))
    balance, error = EnergyBalance(), 0.0
    start = energy(s)
    while s.time < 2 * 40.0 / speed:
        s.step()
        error = max(error, abs(balance.update(Snapshot(s.state))))
    assert energy(s) < 1e-5 * start
    assert -s.state.work["external_work"] == pytest.approx(start, rel=0.02)
    assert error < 0.02


def test_what_comes_to_a_plane_later_leaves():
    """A bar flies to an absorbing plane and stops after a wave has gone to its free end and back."""
    words = pulse("uniaxial_strain", {"kind": "flip"}, 0, 1.0, {}, {"upper": PLANES["upper"]})
    words["bodies"][0] |= {"region": {"kind": "box", "lower": [29], "upper": [39]}, "velocity": [0.1]}
    words["time"]["end"] = 40.0
    s = Simulation(load_scene(yaml.safe_dump(words)))
    p = s.particles
    while s.time < 4.5:
        s.step()
    assert p.V == pytest.approx(0.1)
    while s.time < 30.0:
        s.step()
    assert np.abs(p.V).max() < 0.01
    assert 40.0 < p.X.max() < 40.6


def test_speeds_may_be_given():
    words = pulse("uniaxial_strain", {"kind": "flip"}, 0, 1.0, {"pressure_wave": 3.0})
    scene = load_scene(yaml.safe_dump(words)).scene
    load, material = scene.loads[0], scene.materials["m"]
    assert load.impedance_of(material, "plane_strain", 2) == pytest.approx([RHO * 3.0, np.sqrt(RHO * G)])
