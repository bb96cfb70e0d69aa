"""Particles close to sides of the grid where a condition holds them; what is said of those that are gone."""

import numpy as np
import pytest
import yaml

from mpmcli.boundary.exits import MOST_OVERRUN, held_sides, overrun_of
from mpmcli.core.errors import SimulationError
from mpmcli.scene.loader import load_scene
from mpmcli.solver.plan import make_plan
from mpmcli.solver.setup import make_grid

PLANE = {"axis": "y", "at": 0}
FLOOR = {"name": "floor", "kind": "velocity", "on": {"plane": PLANE}, "direction": "y", "value": 0}
CONDITIONS = [  # a condition, the side of the grid that it holds
    (FLOOR, (1, 0)),
    (FLOOR | {"direction": [0, -2]}, (1, 0)),
    (FLOOR | {"on": {"plane": PLANE | {"at": 8}}}, (1, 1)),
    (FLOOR | {"on": {"plane": {"axis": "y", "at": 8, "side": "lower"}}}, (1, 0)),
    (FLOOR | {"direction": "x"}, None),
    (FLOOR | {"direction": [1, 1]}, None),
    (FLOOR | {"on": {"box": {"lower": [-8, 0], "upper": [8, 0]}}}, None),
    ({"name": "floor", "kind": "symmetry", "plane": PLANE}, (1, 0)),
    ({"name": "floor", "kind": "wall", "normal": [0, 1], "position": "0.2*t", "velocity": 0.2}, (1, 0)),
    ({"name": "floor", "kind": "wall", "normal": "y", "position": [0, 0], "velocity": 0}, (1, 0)),
    ({"name": "floor", "kind": "wall", "normal": [-1, 0], "position": 7, "velocity": 0}, (0, 1)),
    ({"name": "floor", "kind": "wall", "normal": [-1, 0], "position": 9, "velocity": 0}, None),
    ({"name": "floor", "kind": "wall", "normal": [1, 1], "position": [0, 0], "velocity": 0}, None),
]


def scene(**changes):
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-8, 0], "upper": [8, 8], "cell": 1},
        "method": {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}},
        "bodies": [
            {
                "name": "block",
                "material": "soft",
                "region": {"kind": "box", "lower": [-2, 0], "upper": [3, 4]},
            }
        ],
        "boundary": [FLOOR],
        "time": {"end": 1.0, "courant": 0.2},
    } | changes


@pytest.mark.parametrize(("condition", "side"), CONDITIONS)
def test_which_side_a_condition_holds(condition, side):
    read = load_scene(yaml.safe_dump(scene(boundary=[condition]))).scene
    grid = make_grid(read, make_plan(read))
    held = held_sides(read.boundary, grid)
    assert held == ({side: "floor"} if side else {})
    overrun = overrun_of(held, grid, "error")
    assert overrun.sum() == (MOST_OVERRUN if side else 0)
    assert not overrun_of(held, grid, "stop_at_wall").any()


def pushed(block, cells: float, **changes):
    """A run after two steps, the lowest particles below the side of the grid at the second."""
    run = block(**(scene() | changes)).steps(1)
    lowest = run.particles.X[1] < 0.5
    run.particles.X[1, lowest] = -cells
    return run.steps(1), lowest


SHAPES = ["ugimp", *(pytest.param(name, marks=pytest.mark.slow) for name in ("linear", "bspline2", "b2gimp"))]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("on_exit", ["error", "delete"])
def test_particles_just_beyond_a_held_side_stay(block, shape, on_exit):
    """Also after they are sorted anew, with all their mass on the grid."""
    method = scene()["method"] | {"shape": shape}
    for cells in (1e-9, 0.3, 0.9):
        run, lowest = pushed(block, cells, method=method, domain={"on_exit": on_exit})
        run.simulation.order.drift = np.inf
        run.steps(3)
        assert run.particles.count == len(lowest)
        assert run.simulation.grid.mp[:, 0].sum() == pytest.approx(run.particles.mass.sum(), rel=1e-12)


@pytest.mark.parametrize(
    ("boundary", "cells", "words"),
    [
        ([FLOOR], 1.1, ["'floor' holds the velocity there", "kind symmetry", "stop_at_wall"]),
        ([FLOOR | {"direction": "x"}], 1e-6, ["the lower side of y", "kind: symmetry", "domain.on_exit"]),
    ],
)
def test_advice_is_what_the_scene_does_not_do_yet(block, boundary, cells, words):
    with pytest.raises(SimulationError, match="left the grid") as found:
        pushed(block, cells, boundary=boundary)
    for word in words:
        assert word in str(found.value)
    assert "hold the body" not in str(found.value)


def test_advice_for_domains_that_stretch_names_shapes_that_do_not(bar):
    run = bar(boundary=[])
    run.simulation.grid.width = run.simulation.transfer.widest
    run.simulation.transfer.sort()
    run.particles.F[0, 20] = 30.0
    with pytest.raises(SimulationError, match="spans more than") as found:
        run.steps(1)
    assert "'lcpdi'" in str(found.value)
    assert "b2gimp" in str(found.value)
