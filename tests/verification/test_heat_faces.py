"""Faces of bodies that are held, heated by a flux, behind a film, or radiate, against exact solutions."""

from itertools import pairwise, product

import exact_heat as exact
import numpy as np
import pytest
from heat_runs import rms, scaled, table, transfer

SLOW = pytest.mark.slow
METHODS = ("FLIP", "FLIP(4)", "FMPM(1)", "FMPM(2)", "FMPM(4)", "FMPM(8)")
OFFSETS = (0.0, 0.1, 0.3, 0.5, 0.9)
OFF_GRID = {
    (row["method"], int(row["cells"]), float(row["offset"])): row
    for row in table("slab_off_grid")
    if row["condition"] == "face"
}
FLUX = {(row["method"], int(row["cells"])): row for row in table("slab_flux")}


def errors(run, end, wanted):
    """Errors (root mean square) of the temperature that is seen and of the one that is carried."""
    run.to(end)
    return rms(scaled(run) - wanted), rms(scaled(run, "T_carried") - wanted)


def check_errors(run, end, wanted, row, method):
    """The errors are those of an independent code, which shows FLIP(k) by nodal values of the lumped capacity."""
    run.simulation.step()
    run.to(end - 1.5 * run.simulation.state.dt)
    kept = {name: np.copy(array) for name, array in run.simulation.state_arrays().items()}
    seen, carried = errors(run, end, wanted)
    assert carried == pytest.approx(float(row["rms error"]), rel=0.02)
    if method.startswith("FLIP("):
        full = seen
        run.simulation.restore(kept)
        run.simulation.heat.choices.order = 1  # in the last step
        seen, _ = errors(run, end, wanted)
        assert full < 1.15 * seen
    assert seen == pytest.approx(float(row["rms error seen"]), rel=0.02)


def heat_in_is_heat_stored(run):
    """Heat of the loads and conditions, and that of the particles, of the whole run: round-off is that of Σ C T."""
    work, p, heat = run.simulation.state.work, run.particles, run.simulation.heat
    given, stored = work["boundary_heat"] + work["source_heat"], float(run.received("heat_inflow").sum())
    assert abs(given) > 0.0
    assert stored == pytest.approx(given, rel=1e-12, abs=1e-12 * float(heat.capacity() @ p.T))


def held_at_faces(cells, offset):
    """Settings by which the slab is held at its faces, ``offset`` cells beside the grid lines."""
    return (
        f"constants.cells={cells}",
        "bodies.slab.particles_along=region",
        f"bodies.slab.region.lower=[{offset / cells!r}]",
        f"bodies.slab.region.upper=[{1 + offset / cells!r}]",
        "boundary.left.on={body: slab, face: {axis: x, side: lower}}",
        "boundary.right.on={body: slab, face: {axis: x, side: upper}}",
    )


def some_quick(cases, *quick):
    """Parameters of which only ``quick`` ones are not slow."""
    return [pytest.param(*case, marks=() if case in quick else SLOW) for case in cases]


@pytest.mark.parametrize(
    ("method", "cells", "offset"),
    some_quick(product(METHODS, (10, 20, 40), OFFSETS), ("FLIP", 10, 0.3), ("FMPM(4)", 10, 0.9)),
)
def test_errors_of_a_slab_held_at_its_faces(start, method, cells, offset):
    run = start("heat_slab.yaml", transfer(method), *held_at_faces(cells, offset))
    x = run.X0[0] - offset / cells
    check_errors(run, 0.1, exact.slab_step(x, 0.1), OFF_GRID[method, cells, offset], method)
    heat_in_is_heat_stored(run)


@pytest.mark.parametrize(
    ("method", "cells"), some_quick(product(METHODS, (10, 20, 40, 80)), ("FLIP", 10), ("FMPM(4)", 10))
)
def test_errors_of_a_slab_under_a_flux(start, method, cells):
    run = start("heat_slab_flux.yaml", transfer(method), f"constants.cells={cells}")
    x = run.X0[0]
    check_errors(run, 0.2, exact.slab_flux(x, 0.2), FLUX[method, cells], method)
    heat_in_is_heat_stored(run)
    state = run.simulation.state
    assert state.work["boundary_heat"] == pytest.approx(100.0 * 0.2, rel=1e-11)  # a sum over all steps
    assert state.powers["lamp"] == pytest.approx(100.0, rel=1e-13)


FILM = (
    "loads.lamp={name: lamp, kind: film, on: {body: slab, face: {axis: x, side: upper}}, coefficient: 1, around: 300}",
    "bodies.slab.temperature=400",
    "time.end=0.5",
)


def behind_film(start, method, cells, *sets):
    run = start("heat_slab_flux.yaml", transfer(method), f"constants.cells={cells}", *FILM, *sets)
    x = run.X0[0]
    found = errors(run, 0.5, exact.slab_film(x, 0.5, 1.0))
    heat_in_is_heat_stored(run)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("method", "error"), [("FLIP", 7.3e-5), ("FMPM(4)", 1.54e-3)])
def test_a_slab_behind_a_film(start, method, error):
    assert behind_film(start, method, 20)[0] == pytest.approx(error, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "order"), [("FLIP", 1.9), ("FMPM(4)", 1.3)])
def test_a_slab_behind_a_film_converges(start, method, order):
    found = [behind_film(start, method, cells)[0] for cells in (10, 20, 40)]
    assert all(np.log2(coarse / fine) > order for coarse, fine in pairwise(found))


@pytest.mark.slow
@pytest.mark.parametrize("cells", [1, 2])
@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
def test_a_cooling_fin(start, method, cells):
    run = start("heat_fin.yaml", transfer(method), f"constants.cells={cells}")
    run.to(20.0)
    x, T, powers = run.X0[0], scaled(run), run.simulation.state.powers
    assert T[x == x.max()].mean() == pytest.approx(exact.fin_tip(1.5), rel=0.01)
    # 200 W/(m K) * 2 mm * 1.5/30 mm * 100 K through each mm of width, in g mm²/s³
    assert powers["foot"] == pytest.approx(2e8 * 2.0 * 1.5 / 30 * 100.0 * exact.fin_heat(1.5), rel=0.01)
    assert powers["air"] == pytest.approx(-powers["foot"], rel=2e-3)
    heat_in_is_heat_stored(run)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
def test_a_radiating_plate(start, method):
    """The temperature is that of a thin body but for its finite conductivity, 0.0011 of it."""
    run = start("heat_radiation.yaml", transfer(method))
    run.to(158.19)
    beta = 0.8 * 5.670374419e-8 * 1000.0**3 * run.time / (7800 * 460 * 0.01)
    mean = float(run.ordered("T").mean()) / 1000.0
    assert mean == pytest.approx(exact.radiating(beta), rel=0.0013)
    heat_in_is_heat_stored(run)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "most"), [("FLIP", (5.5e-3, 1.35e-3)), ("FMPM(4)", (1.3e-2, 5e-3))])
def test_a_cylinder_held_at_its_face(start, method, most):
    on = "boundary.surface.on={body: cylinder, face: {axis: x, side: upper}}"
    for cells, bound in zip((10, 20), most, strict=True):
        run = start("heat_cylinder.yaml", transfer(method), f"constants.cells={cells}", on)
        r = run.X0[0]
        assert errors(run, 0.1, exact.cylinder_step(r, 0.1))[0] < bound
        heat_in_is_heat_stored(run)


SPHERE = (
    "boundary=["
    + ", ".join(
        f"{{name: {axis}0, kind: symmetry, plane: {{axis: {axis}, at: 0}}}}, {{name: {axis}1, kind: temperature, "
        f"on: {{body: sphere, face: {{axis: {axis}, side: upper}}}}, value: 300}}"
        for axis in "xyz"
    )
    + "]",
    "bodies.sphere.temperature=400",
    "time.end=0.1",
)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "most"), [("FLIP", 0.006), ("FMPM(4)", 0.016)])
def test_a_sphere_held_at_the_steps_of_its_surface(start, method, most):
    run = start("heat_sphere_3d.yaml", transfer(method), *SPHERE)
    r = np.linalg.norm(run.X0, axis=0)
    assert errors(run, 0.1, exact.sphere_step(r, 0.1))[0] < most
    T = scaled(run)
    for radius, wanted in ((0.0, 0.707100), (0.5, 0.474487)):
        assert T[np.abs(r - radius) < 0.06].mean() == pytest.approx(wanted, rel=0.03)
    powers = run.simulation.state.powers
    assert powers["x1"] == pytest.approx(powers["y1"], rel=1e-12)
    assert powers["x1"] == pytest.approx(powers["z1"], rel=1e-12)
    heat_in_is_heat_stored(run)
