"""Conduction with held surfaces against series: slab, cylinder, sphere, two materials."""

from itertools import pairwise

import exact_heat as exact
import numpy as np
import pytest
from heat_runs import heat, j0_of, rms, scaled, table, transfer

SLOW = pytest.mark.slow
METHODS = ("FLIP", "FLIP(4)", "FMPM(1)", "FMPM(2)", "FMPM(4)", "FMPM(8)")
SLAB = {(row["method"], int(row["cells"])): row for row in table("slab_step") if row["shape"] == "ugimp"}
CYLINDER = {(row["method"], int(row["cells"])): row for row in table("cylinder_step")}


def errors(run, solution, fourier):
    """Errors (root mean square) of the temperature that is seen and of the one that is carried."""
    x = run.X0[0]
    run.to(fourier)
    wanted = solution(x, fourier)
    return rms(scaled(run) - wanted), rms(scaled(run, "T_carried") - wanted)


def slab(start, method, cells, *sets):
    return errors(
        start("heat_slab.yaml", f"constants.cells={cells}", transfer(method), *sets), exact.slab_step, 0.1
    )


def check(found, row, tolerance=0.02):
    assert found == pytest.approx((float(row["rms error seen"]), float(row["rms error"])), rel=tolerance)


@pytest.mark.parametrize("cells", [10, 20, pytest.param(40, marks=SLOW), pytest.param(80, marks=SLOW)])
@pytest.mark.parametrize("method", METHODS)
def test_errors_of_the_slab_are_those_of_an_independent_code(start, method, cells):
    check(slab(start, method, cells), SLAB[method, cells])


@pytest.mark.slow
@pytest.mark.parametrize("method", [method for method in METHODS if method != "FMPM(1)"])
def test_what_the_slab_shows_converges_at_second_order(start, method):
    found = [slab(start, method, cells)[0] for cells in (10, 20, 40)]
    assert all(1.95 < np.log2(coarse / fine) < 2.15 for coarse, fine in pairwise(found))


SHORT = {
    row["method"]: row for row in table("nairnmpm_slab") if (row["D dt/dx^2"], row["offset"]) == ("0.01", "0")
}


@pytest.mark.slow
@pytest.mark.parametrize("method", SHORT)
def test_ten_times_as_many_steps(start, method):
    """NairnMPM imposes conditions once per step, not on increments: with FMPM(4) its error is 42 times larger."""
    row = SHORT[method]
    run = start("heat_slab.yaml", transfer(method), "constants.s=0.01", "time.end=1")
    _, carried = errors(run, exact.slab_step, float(row["Fo"]))
    assert carried == pytest.approx(float(row["reference_heat_1d"]), rel=0.02)
    if method == "FMPM(4)":
        assert carried < float(row["rms error NairnMPM"]) / 30.0


PLANE = (
    "analysis={kind: plane_strain}",
    "grid.lower=[-0.2, 0]",
    "grid.upper=[1.2, 0.2]",
    "bodies.slab.region.lower=[0, 0]",
    "bodies.slab.region.upper=[1, 0.2]",
)


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_the_slab_in_a_plane_is_that_of_one_dimension(start, method):
    check(slab(start, method, 20, *PLANE), SLAB[method, 20])


def cylinder(start, method, cells):
    """Errors of the cylinder, and how much temperatures differ along the axis."""
    run = start("heat_cylinder.yaml", f"constants.cells={cells}", transfer(method))
    found = errors(run, exact.cylinder_step, 0.1)
    radius, T = np.round(run.X0[0], 9), run.ordered("T")
    return found, max(np.ptp(T[radius == r]) for r in np.unique(radius))


@pytest.mark.slow
@pytest.mark.parametrize("cells", [10, 20, 40])
@pytest.mark.parametrize("method", METHODS)
def test_errors_of_the_cylinder_are_those_of_an_independent_code(start, method, cells):
    found, along = cylinder(start, method, cells)
    check(found, CYLINDER[method, cells])
    assert along < 1e-10


INSULATED = (
    "boundary=[{name: low, kind: symmetry, plane: {axis: y, at: 0}}, "
    "{name: high, kind: symmetry, plane: {axis: y, at: 0.2}}]",
    f"bodies.cylinder.temperature='300 + 100*{j0_of(f'{exact.CYLINDER_MODE**2!r}*x*x')}'",
)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
def test_the_slowest_mode_of_an_insulated_cylinder(start, method):
    """J0(ζ r/R) keeps exp(−ζ² Fo), at second order; heat stays."""
    off = []
    for cells in (10, 20):
        run = start("heat_cylinder.yaml", f"constants.cells={cells}", transfer(method), *INSULATED)
        before = heat(run)
        mode = exact.cylinder_mode(run.X0[0])
        assert rms(scaled(run, "T_carried") - mode) < 1e-12
        run.to(0.05)
        found = exact.amplitude(scaled(run), mode)
        off.append(found / exact.mode_amplitude(exact.CYLINDER_MODE, 0.05) - 1)
        assert abs(heat(run) / before - 1) < 1e-13
    assert abs(off[0]) < 0.03
    assert abs(off[1]) < 0.3 * abs(off[0])


def sphere(start, method, cells):
    """What is left of the mode of the insulated sphere over the exact amplitude, less 1."""
    run = start("heat_sphere_3d.yaml", f"constants.cells={cells}", transfer(method))
    before, mode = heat(run), exact.sphere_mode(np.linalg.norm(run.X0, axis=0))
    run.to(0.05)
    assert abs(heat(run) / before - 1) < 1e-13
    return exact.amplitude(scaled(run), mode) / exact.mode_amplitude(exact.SPHERE_MODE, 0.05) - 1


@pytest.mark.slow
@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
def test_the_slowest_mode_of_an_insulated_sphere(start, method):
    coarse, middle, fine = (abs(sphere(start, method, cells)) for cells in (5, 10, 15))
    assert middle < 0.04
    assert np.log(coarse / fine) / np.log(3) > 0.8


def two_materials(start, method, cells, shift=0.0):
    """Error of what is seen of two materials that touch, over the jump."""
    run = start(
        "heat_two_materials.yaml", f"constants.cells={cells}", f"constants.shift={shift}", transfer(method)
    )
    x = run.X0[0] - shift / cells
    run.to(0.0049)
    return rms(scaled(run) - exact.two_half_spaces(x, run.time, (1.0, 4.0), (1.0, 1.0), (1.0, 0.0)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "shift", "wanted"),
    [("FLIP", 0, 0.0053), ("FLIP", 0.5, 0.016), ("FMPM(4)", 0, 0.0087), ("FMPM(4)", 0.5, 0.016)],
)
def test_two_materials_in_one_field(start, method, shift, wanted):
    coarse, fine = (two_materials(start, method, cells, shift) for cells in (20, 40))
    assert coarse < 1.01 * wanted
    assert np.log2(coarse / fine) > (1.1 if shift == 0 else 0.9)


def two_fields(start, method, way, law="perfect", shift=0.0, gap=0.0):
    """The two materials as two velocity fields, at the end."""
    contact = f"{{law: {{kind: {law}}}, normal: {{kind: specified, vector: [1]}}, separation: {{kind: position_fit}}}}"
    places = f"constants.shift={shift}", f"constants.gap={gap}"
    run = start(
        "heat_two_materials.yaml", *places, transfer(method), f"contact={contact}", f"heat.contact={way}"
    )
    run.to(0.0049)
    return run


@pytest.mark.slow
@pytest.mark.parametrize("shift", [0.0, 0.5])
@pytest.mark.parametrize("method", METHODS)
def test_two_fields_in_perfect_contact_are_one(start, method, shift):
    run = start("heat_two_materials.yaml", f"constants.shift={shift}", transfer(method))
    run.to(0.0049)
    for way in ("shared", "{conductance: perfect}"):
        two = two_fields(start, method, way, shift=shift)
        assert np.abs(scaled(two) - scaled(run)).max() < 1e-12
        assert np.abs(scaled(two, "T_carried") - scaled(run, "T_carried")).max() < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_heat_across_a_gap_of_half_a_cell(start, method, shift):
    """Only ``shared`` nodes conduct across a gap; insulated bodies that touch exchange nothing."""

    def left_heat(way, gap, law="frictionless"):
        run = two_fields(start, method, way, law, shift, gap)
        return float(run.received("heat_inflow")[run.ordered("body") == 0].sum())

    across = left_heat("shared", 0.0)
    assert across < -1.0
    assert left_heat("shared", 0.5) < 0.5 * across
    for way, gap in (
        ("insulated", 0.0),
        ("insulated", 0.5),
        ("{conductance: perfect}", 0.5),
        ("{conductance: 10}", 0.5),
    ):
        assert abs(left_heat(way, gap)) < 1e-12
