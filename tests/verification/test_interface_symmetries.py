"""What changes nothing about an interface: order of bodies, mirrors, turns, boosts, units, threads; and its limits."""

from typing import Any

import numpy as np
import pytest
import yaml
from interface_runs import PERFECT, wave_profile

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.slow

STEPS = 60
FLIP, FMPM = {"kind": "flip"}, {"kind": "fmpm", "order": 4}
LAW = {"kind": "linear_interface", "normal": 300.0, "tangential": 80.0}
every_way = pytest.mark.parametrize("transfer", [FLIP, FMPM], ids=["flip", "fmpm"])
MEET = np.array([0.29, 0.13])
"""A point of the interface: no side lies on a grid line."""
BLOCKS = {"a": ((-2.9, -1.77), (0.0, 1.83)), "b": ((0.0, -2.17), (2.6, 1.43))}
"""Corners of blocks that touch along a part of a side, from that point [cells]."""
MIRROR, TURN = np.array([[-1, 0], [0, 1]]), np.array([[0, -1], [1, 0]])


def simulation(
    transfer: dict[str, Any], *, law: dict[str, Any] | None = None, order: str = "ab", turn: Any = None,
    boost: Any = (0.0, 0.0), length: float = 1.0, mass: float = 1.0, time: float = 1.0, threads: int = 1,
    interface: dict[str, Any] | None = None, jumps: bool = True,
) -> Simulation:  # fmt: skip
    """Two blocks in units of their own, which pull at, slide along and press upon their interface."""
    turn = np.eye(2, dtype=int) if turn is None else turn
    bodies = []
    for name in order:
        corners = np.stack([turn @ (np.array(corner) + MEET) for corner in BLOCKS[name]]) * length
        # velocities in the frame of the blocks, turned: each component is linear in the place
        sign = 1.0 if name == "b" else -1.0
        base, gradient = sign * jumps * np.array([0.4, 0.3]), np.array([[0.05, -0.4], [0.1, 0.02]])
        base, gradient = turn @ base + np.array(boost), turn @ gradient @ turn.T
        velocity = [
            f"{float(b * length / time)!r} + {float(row[0] / time)!r}*x + {float(row[1] / time)!r}*y"
            for b, row in zip(base, gradient, strict=True)
        ]
        region = {"kind": "box", "lower": corners.min(axis=0).tolist(), "upper": corners.max(axis=0).tolist()}
        bodies.append({"name": name, "material": "soft", "region": region, "velocity": velocity})
    pressure = mass / (length * time**2)
    law = dict(LAW if law is None else law)
    for side in ("normal", "tangential"):
        if side in law:
            law[side] = law[side] * pressure / length
    soft = {"kind": "neo_hookean", "density": 1.5 * mass / length**3, "E": 100.0 * pressure, "nu": 0.3}
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain", "thickness": length},
        "grid": {"lower": [-10.0 * length] * 2, "upper": [10.0 * length] * 2, "cell": length},
        "method": {"shape": "ugimp", "transfer": transfer},
        "materials": {"soft": soft},
        "bodies": bodies,
        "contact": {"law": law} | ({"interface": interface} if interface else {}),
        "time": {"end": 100.0 * time, "step": 0.02 * time},
    }
    return Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=threads)


def advanced(s: Simulation, steps: int = STEPS) -> Simulation:
    """The same after some steps."""
    for _ in range(steps):
        s.step()
    return s


def state(
    s: Simulation,
    *,
    turn: Any = None,
    boost: Any = (0, 0),
    length: float = 1.0,
    time: float = 1.0,
    by_id: bool = False,
) -> Any:
    """Positions, velocities and J in units of 1 and in the first frame, by place."""
    turn = np.eye(2) if turn is None else turn
    p, boost = s.particles, np.array(boost, dtype=float)[:, None]
    found = {
        "X": turn.T @ (p.X / length - boost * s.time / time),
        "V": turn.T @ (p.V * time / length - boost),
        "J": p.determinant(),
    }
    order = np.argsort(p.id) if by_id else np.lexsort(np.round(found["X"], 6))
    return {name: array[..., order] for name, array in found.items()}


def difference(one: Any, other: Any) -> float:
    """Largest of positions in cells, velocities (of about 1) and J."""
    return max(float(np.abs(one[name] - other[name]).max()) for name in one)


@every_way
def test_the_interface_does_something(transfer):
    s = advanced(simulation(transfer))
    assert s.contact.view.interfaces.energy.sum() > 0.01
    free = state(advanced(simulation(transfer, law=LAW | {"normal": 0.0, "tangential": 0.0})))
    assert difference(state(s), free) > 0.1


@every_way
@pytest.mark.parametrize("jump", ["gradient", "extrapolated"])
@pytest.mark.parametrize("step", ["implicit", "oscillator"])
def test_no_order_mirror_or_turn_matters(transfer, jump, step):
    words = {"jump": jump, "step": step}
    straight = state(advanced(simulation(transfer, interface=words)))
    assert difference(straight, state(advanced(simulation(transfer, order="ba", interface=words)))) < 1e-10
    for turn in (MIRROR, TURN, TURN @ MIRROR):
        other = state(advanced(simulation(transfer, turn=turn, interface=words)), turn=turn)
        assert difference(straight, other) < 1e-10


@every_way
@pytest.mark.parametrize("boost", [(0.37, 0.21), (3.0, 1.0)])
def test_a_boost_changes_no_more_than_of_bodies_that_are_one(transfer, boost):
    """Particles then lie elsewhere in the cells, which moves bodies of one piece by as much."""
    off = []
    for law in (LAW, {"kind": "perfect"}):
        straight = state(advanced(simulation(transfer, law=law)), by_id=True)
        moved = state(advanced(simulation(transfer, law=law, boost=boost)), boost=boost, by_id=True)
        off.append([float(np.sqrt(np.mean((moved[name] - straight[name]) ** 2))) for name in ("X", "V")])
    assert off[0][0] < 0.01
    assert np.all(np.array(off[0]) <= 1.5 * np.array(off[1]))


@every_way
def test_units_by_powers_of_two(transfer):
    units = {"length": 2.0**9, "mass": 2.0**-13, "time": 2.0**6}
    one = state(advanced(simulation(transfer)))
    other = state(advanced(simulation(transfer, **units)), length=units["length"], time=units["time"])
    assert difference(one, other) < 1e-12


@every_way
def test_threads_change_no_bit(transfer, monkeypatch):
    """Of kernels that run in parallel however few particles and contacts there are."""
    monkeypatch.setattr("mpmcli.solver.simulation.PARALLEL_FROM", 0)
    monkeypatch.setattr("mpmcli.contact.nodal_contact.PARALLEL_CONTACTS", 0)
    one, two = (advanced(simulation(transfer, threads=n)) for n in (1, 2))
    for s in (one, two):
        assert s.parallel
        assert s.contact.parallel_from <= s.contact.contacts.count
    assert (one.threads, two.threads) == (1, 2)
    for name in ("X", "V", "F", "tau", "interface"):
        assert np.array_equal(getattr(one.particles, name), getattr(two.particles, name)), name


@every_way
def test_a_run_goes_on_with_the_same_bits(transfer):
    straight = advanced(simulation(transfer), 40)
    first = advanced(simulation(transfer), 17)
    arrays = {name: np.copy(value) for name, value in first.state_arrays().items()}
    again = simulation(transfer)
    again.restore(arrays)
    advanced(again, 23)
    for name in ("X", "V", "F", "tau"):
        assert np.array_equal(getattr(straight.particles, name), getattr(again.particles, name)), name
    assert straight.state.work == again.state.work


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("method", ["FLIP", "FMPM(2)", "FMPM(4)"])
def test_a_huge_stiffness_is_perfect_contact(start, method, shift):
    """A pulse through it: at most 0.2 % of the pulse."""
    found = wave_profile(start, method, 1e6, shift)[1]
    perfect = wave_profile(start, method, 1.0, shift, PERFECT)[1]
    assert np.linalg.norm(found - perfect) < 0.002 * np.linalg.norm(perfect)


@pytest.mark.parametrize("jumps", [False, True])
def test_a_huge_stiffness_is_perfect_contact_in_a_plane(jumps):
    """Positions and velocities of blocks of 3 by 4 cells over the largest difference that the joint makes, six times.

    Where the velocities of the start have no jump, and where bodies meet with one: the spring then gives the impulse to
    the particles beside it.
    """
    nothing = LAW | {"normal": 0.0, "tangential": 0.0}
    laws = ({"kind": "perfect"}, nothing, LAW | {"normal": 1e9, "tangential": 1e9})
    runs = [simulation(FMPM, law=law, jumps=jumps) for law in laws]
    off, signal = np.zeros((2, 6)), np.zeros((2, 6))
    for time in range(6):
        perfect, free, stiff = (state(advanced(s, STEPS // 6), by_id=True) for s in runs)
        for row, name in enumerate("XV"):
            off[row, time] = np.sqrt(np.mean((stiff[name] - perfect[name]) ** 2))
            signal[row, time] = np.abs(perfect[name] - free[name]).max()
    assert np.all(off.max(axis=1) < (0.01, 0.018) * signal.max(axis=1))


@every_way
def test_without_stiffness_bodies_pass_through_each_other(transfer):
    """As each of them alone, to round-off."""
    nothing = LAW | {"normal": 0.0, "tangential": 0.0}
    both = state(advanced(simulation(transfer, law=nothing)))
    for name in "ab":
        alone = advanced(simulation_of_one(transfer, name))
        p = alone.particles
        for x, v in zip(p.X.T, p.V.T, strict=True):
            same = np.argmin(
                np.abs(both["X"] - x[:, None]).sum(axis=0) + np.abs(both["V"] - v[:, None]).sum(axis=0)
            )
            assert np.abs(both["X"][:, same] - x).max() < 1e-12
            assert np.abs(both["V"][:, same] - v).max() < 1e-12


def simulation_of_one(transfer: dict[str, Any], name: str) -> Simulation:
    """One of the blocks by itself."""
    other = {"a": "b", "b": "a"}[name]
    s = simulation(transfer, law=LAW | {"normal": 0.0, "tangential": 0.0}, order=name + other)
    s.remove_particles(s.particles.body == 0)
    return s
