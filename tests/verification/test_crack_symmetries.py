"""What changes nothing about a crack: its way, mirrors, turns, shifts, threads; and where the method ends."""

import itertools
from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.slow

STEPS = 80
FLIP, FMPM = {"kind": "flip"}, {"kind": "fmpm", "order": 4}
every_way = pytest.mark.parametrize("transfer", [FLIP, FMPM], ids=["flip", "fmpm"])
CORNERS = np.array([[-4.3, -4.1], [4.2, 3.9]])
"""Lower and upper corner of the body: no side on a grid line."""
PATHS = {
    "straight": [[-2.6, 0.17], [2.4, 0.61]],
    "kinked": [[-6.0, -0.4], [-0.3, 0.2], [0.2, 0.9], [2.1, 0.3]],
    "horizontal": [[-2.5, 0.0], [2.5, 0.0]],
}
MIRROR, TURN = np.array([[-1, 0], [0, 1]]), np.array([[0, -1], [1, 0]])
FRICTION = {"kind": "coulomb", "friction": 0.3}


def simulation(
    transfer: dict[str, Any], path: Any = "kinked", *, law: Any = None, turn: Any = None, shift: Any = (0, 0),
    boost: Any = (0.0, 0.0), reverse: bool = False, threads: int = 1, second: bool = False,
    split: float | None = None, swap: bool = False, contact: bool = False,
) -> Simulation:  # fmt: skip
    """A body that a crack cuts, whose matter above opens, closes and slides.

    With ``split`` it is two bodies that meet at this x, of one velocity field or in contact; the second one comes
    first with ``swap``.
    """
    turn, shift = np.eye(2, dtype=int) if turn is None else turn, np.array(shift)
    corners = CORNERS @ turn.T + shift
    gradient = turn @ np.array([[0.02, -0.24], [-0.18, 0.05]]) @ turn.T
    base = np.array(boost) - gradient @ shift
    wave = turn @ np.array([0.1, 0.25])
    x, y = (f"({axis} - {float(at)!r})" for axis, at in zip("xy", shift, strict=True))
    along = [f"({a}*{x} + {b}*{y})" for a, b in turn.T.tolist()]
    shake = f"cos(0.8*{along[0]})*sin(1.1*{along[1]})"
    velocity = [
        f"{float(b)!r} + {float(row[0])!r}*x + {float(row[1])!r}*y + {float(w)!r}*{shake}"
        for b, row, w in zip(base, gradient, wave, strict=True)
    ]
    lines = [PATHS[path] if isinstance(path, str) else path]
    if second:
        lines.append([[0.4, -2.7], [0.9, 2.8]])
    cracks = []
    for number, line in enumerate(lines):
        points = (np.array(line) @ turn.T + shift).tolist()
        mouth = abs(line[0][0]) > 5.0
        ends = {"start": "mouth"} if mouth else {}
        if reverse:
            points, ends = points[::-1], {"end": "mouth"} if mouth else {}
        cracks.append(
            {
                "name": f"c{number}",
                "path": {"kind": "points", "points": points},
                "ends": ends,
                "faces": {"law": law or FRICTION},
            }
        )
    low, high = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    cuts = [low[0], high[0]] if split is None else [low[0], split, high[0]]
    bodies = [
        {
            "name": f"body {number}",
            "material": "soft",
            "region": {"kind": "box", "lower": [left, low[1]], "upper": [right, high[1]]},
            "velocity": velocity,
            "particles_along": "region",
        }
        for number, (left, right) in enumerate(itertools.pairwise(cuts))
    ]
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-16, -16], "upper": [16, 16], "cell": 1},
        "method": {"shape": "ugimp", "transfer": transfer},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.5, "E": 100, "nu": 0.3}},
        "bodies": bodies[::-1] if swap else bodies,
        **({"contact": {"law": FRICTION}} if contact else {}),
        "cracks": cracks,
        "time": {"end": 100, "step": 0.02},
    }
    return Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=threads)


def advanced(s: Simulation, steps: int = STEPS) -> Simulation:
    """The same after some steps."""
    for _ in range(steps):
        s.step()
    return s


def state(
    s: Simulation, *, turn: Any = None, shift: Any = (0, 0), boost: Any = (0.0, 0.0), by_id: bool = False
) -> Any:
    """Particles and chains in the first frame; particles by place or by identity."""
    turn, p = np.eye(2) if turn is None else turn, s.particles
    moved = np.array(shift, dtype=float)[:, None] + np.array(boost)[:, None] * s.time
    found = {
        "X": turn.T @ (p.X - moved),
        "V": turn.T @ (p.V - np.array(boost)[:, None]),
        "J": p.determinant(),
    }
    order = np.argsort(p.id) if by_id else np.lexsort(np.round(found["X"], 6))
    arrays = {name: array[..., order] for name, array in found.items()}
    for chain in s.cracks.chains:
        arrays[f"chain {chain.index}"] = turn.T @ (chain.X - moved)
        arrays[f"opening {chain.index}"] = turn.T @ (chain.faces[0] - chain.faces[1])
    return arrays


def difference(one: Any, other: Any) -> float:
    """Largest of places in cells, velocities (of about 1) and J; openings up to the sign of the way of the chain."""
    largest = 0.0
    for name, array in one.items():
        off = np.abs(array - other[name]).max()
        if name.startswith("opening"):
            off = min(off, np.abs(array + other[name]).max())
        largest = max(largest, float(off))
    return largest


@every_way
@pytest.mark.parametrize("second", [False, True], ids=["one", "two"])
def test_cracks_do_something(transfer, second):
    """They open, and press elsewhere or at other times."""
    s = simulation(transfer, second=second)
    opened = pressed = 0.0
    for _ in range(STEPS):
        s.step()
        opened = max(opened, float(s.cracks.chains[0].openings[0].max()))
        pressed = max(pressed, float(np.abs(s.cracks.view.force[0]).max()))
    assert opened > 0.1
    assert pressed > 1.0
    assert s.state.work["contact_work"] > 0.0


@every_way
@pytest.mark.parametrize("path", list(PATHS))
@pytest.mark.parametrize("second", [False, True], ids=["one", "two"])
def test_the_way_of_the_chain_changes_no_digit(transfer, path, second):
    """With FMPM increments it is round-off: the signs of impulses are those of the way."""
    ways = (simulation(transfer, path, reverse=way, second=second) for way in (False, True))
    s, other = (advanced(way) for way in ways)
    bound = 0.0 if transfer is FLIP else 1e-10
    for name in ("X", "V", "F", "tau"):
        assert np.abs(getattr(s.particles, name) - getattr(other.particles, name)).max() <= bound, name
    for one, two in zip(s.cracks.chains, other.cracks.chains, strict=True):
        assert np.abs(one.X - two.X[:, ::-1]).max() <= bound
        assert np.abs(one.faces - two.faces[::-1, :, ::-1]).max() <= bound


@every_way
@pytest.mark.parametrize("path", list(PATHS))
def test_no_mirror_turn_or_shift_by_cells_matters(transfer, path):
    straight = state(advanced(simulation(transfer, path)))
    for turn in (MIRROR, TURN, TURN @ MIRROR):
        other = state(advanced(simulation(transfer, path, turn=turn)), turn=turn)
        assert difference(straight, other) < 1e-10
    for shift in ((3, -2), (-5, 4)):
        other = state(advanced(simulation(transfer, path, shift=shift)), shift=shift)
        assert difference(straight, other) < 1e-10


@every_way
def test_two_cracks_under_mirrors_turns_and_shifts(transfer):
    straight = state(advanced(simulation(transfer, second=True)))
    for turn in (MIRROR, TURN):
        other = state(advanced(simulation(transfer, turn=turn, second=True)), turn=turn)
        assert difference(straight, other) < 1e-10
    other = state(advanced(simulation(transfer, shift=(3, -2), second=True)), shift=(3, -2))
    assert difference(straight, other) < 1e-10


@every_way
@pytest.mark.parametrize("beside", [1e-9, -1e-9])
def test_on_a_grid_line_or_hardly_beside_it(transfer, beside):
    on = state(advanced(simulation(transfer, "horizontal")), by_id=True)
    moved = (np.array(PATHS["horizontal"]) + np.array([0.0, beside])).tolist()
    assert difference(on, state(advanced(simulation(transfer, moved)), by_id=True)) < 1e-7


@every_way
@pytest.mark.parametrize("second", [False, True], ids=["one", "two"])
@pytest.mark.parametrize("at", [0.0, 0.3], ids=["grid line", "within cells"])
def test_the_order_of_bodies(transfer, second, at):
    """No digit where they meet on a grid line; where cells hold particles of both, sums have another order."""
    one, two = (advanced(simulation(transfer, second=second, split=at, swap=swap)) for swap in (False, True))
    assert not np.array_equal(one.particles.id, two.particles.id)
    bound = 0.0 if at == 0.0 else 1e-10
    assert difference(state(one), state(two)) <= bound


@every_way
@pytest.mark.parametrize("second", [False, True], ids=["one", "two"])
@pytest.mark.parametrize("split", [None, 0.3], ids=["alone", "in contact"])
def test_threads_change_no_bit(transfer, second, split, monkeypatch):
    """Serial kernels, and parallel ones on two threads."""
    words = {"second": second, "split": split, "contact": split is not None}
    one = simulation(transfer, **words)
    monkeypatch.setattr("mpmcli.solver.simulation.PARALLEL_FROM", 0)
    monkeypatch.setattr("mpmcli.contact.nodal_contact.PARALLEL_CONTACTS", 0)
    two = simulation(transfer, threads=2, **words)
    assert two.parallel
    assert not one.parallel
    for s in (one, two):
        advanced(s)
    for name in ("X", "V", "F", "tau"):
        assert np.array_equal(getattr(one.particles, name), getattr(two.particles, name)), name
    for a, b in zip(one.cracks.chains, two.cracks.chains, strict=True):
        assert np.array_equal(a.faces, b.faces)


@every_way
def test_a_run_goes_on_with_the_same_bits(transfer):
    straight = advanced(simulation(transfer, second=True), 40)
    first = advanced(simulation(transfer, second=True), 17)
    arrays = {name: np.copy(value) for name, value in first.state_arrays().items()}
    again = simulation(transfer, second=True)
    again.restore(arrays)
    advanced(again, 23)
    for name in ("X", "V", "F", "tau"):
        assert np.array_equal(getattr(straight.particles, name), getattr(again.particles, name)), name
    for a, b in zip(straight.cracks.chains, again.cracks.chains, strict=True):
        assert np.array_equal(a.faces, b.faces)
        assert np.array_equal(a.X, b.X)
    assert straight.state.work == again.state.work


@every_way
@pytest.mark.parametrize(("shift", "boost"), [((0.37, 0.21), (0, 0)), ((0, 0), (1.3, 0.4))])
def test_elsewhere_in_the_cells_it_is_that_of_the_method(transfer, shift, boost):
    """A shift by part of a cell, or a boost: root mean squares of places below 0.04 cells of 1."""
    straight = state(advanced(simulation(transfer, "straight")), by_id=True)
    moved = advanced(simulation(transfer, "straight", shift=shift, boost=boost))
    other = state(moved, shift=shift, boost=boost, by_id=True)
    assert np.sqrt(np.mean((straight["X"] - other["X"]) ** 2)) < 0.04
    assert np.sqrt(np.mean((straight["chain 0"] - other["chain 0"]) ** 2)) < 0.08
