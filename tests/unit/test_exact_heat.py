"""The exact solutions of conduction satisfy their equations and have the printed numbers of the literature."""

import csv
from pathlib import Path

import exact_heat as exact
import numpy as np
import pytest

DATA = Path(__file__).parents[1] / "data" / "heat"
NUMBERS = [
    (exact.slab_step(0.5, 0.1), 0.474487),
    (exact.slab_step(0.25, 0.1), 0.335597),
    (exact.slab_step_mean(0.1), 0.302118),
    (exact.slab_flux(0.0, 0.2), 0.061464),
    (exact.slab_flux(1.0, 0.2), 0.505165),
    (exact.slab_film(0.0, 0.5, 1.0), 0.772526),
    (exact.slab_film(1.0, 0.5, 1.0), 0.504522),
    (exact.fin_tip(1.5), 0.425096),
    (exact.fin_heat(1.5), 0.905148),
    (exact.radiating(0.2), 0.854988),
    (exact.cylinder_step(0.0, 0.1), 0.848355),
    (exact.cylinder_step(0.5, 0.1), 0.610247),
    (exact.mode_amplitude(exact.CYLINDER_MODE, 0.05), 0.479938),
    (exact.mode_amplitude(exact.SPHERE_MODE, 0.05), 0.364388),
    (exact.mode_amplitude(exact.DISK_MODE, 0.2), 0.507636),
    (exact.mode_amplitude(np.pi, 0.1), 0.372708),
    (exact.sphere_step(0.0, 0.1), 0.707100),
    (exact.sphere_step(0.5, 0.1), 0.474487),
    (exact.equalised((300, 400), (1, 1))[0], 350.0),
    (exact.equalised((300, 400), (1, 1))[1], 0.0206193),
    (exact.zener_damping(0.02, 1.0), 0.01),
    (exact.zener_damping(0.02, 0.1), 0.00198020),
]


@pytest.mark.parametrize(("value", "number"), NUMBERS)
def test_printed_numbers(value, number):
    assert float(value) == pytest.approx(number, rel=5e-6)


def second(function, x, h=1e-3):
    """Second derivative."""
    return (function(x + h) - 2 * function(x) + function(x - h)) / h**2


def rate(function, fourier, h=1e-4):
    """Derivative by the Fourier number."""
    return (function(fourier + h) - function(fourier - h)) / (2 * h)


@pytest.mark.parametrize("name", ["slab_step", "slab_flux", "slab_film", "cylinder_step", "sphere_step"])
def test_series_solve_the_equation_of_conduction(name):
    """∂T/∂Fo = T″ + n T′/x, n = 0 for slabs, 1 for cylinders, 2 for spheres; and their conditions at both ends."""
    solution, extra = getattr(exact, name), ([0.7] if name == "slab_film" else [])
    n = {"cylinder_step": 1, "sphere_step": 2}.get(name, 0)
    x, fo, h = np.linspace(0.1, 0.9, 9), 0.13, 1e-3
    slope = (solution(x + h, fo, *extra) - solution(x - h, fo, *extra)) / (2 * h)
    right = second(lambda z: solution(z, fo, *extra), x, h) + n * slope / x
    assert np.abs(rate(lambda f: solution(x, f, *extra), fo) - right).max() < 1e-4
    end, before = solution(np.array([1.0, 1.0 - 1e-5]), fo, *extra)
    flux = (end - before) / 1e-5
    wanted = {"slab_flux": flux - 1.0, "slab_film": flux + 0.7 * end}.get(name, end)
    assert abs(wanted) < 1e-4
    if name != "slab_step":
        middle = solution(np.array([0.0, 1e-4]), fo, *extra)
        assert abs(middle[1] - middle[0]) < 1e-7


def test_half_spaces_share_temperature_and_flux_where_they_touch():
    k, c, T, t, h = (1.0, 4.0), (2.0, 3.0), (1.0, 0.2), 0.3, 1e-6
    left, right = exact.two_half_spaces(np.array([-h, h]), t, k, c, T)
    assert abs(left - right) < 1e-5
    far = exact.two_half_spaces(np.array([-2 * h, 2 * h]), t, k, c, T)
    assert k[0] * (left - far[0]) == pytest.approx(k[1] * (far[1] - right), rel=1e-4)
    assert exact.two_half_spaces(np.zeros(1), t, (1.0, 4.0), (1.0, 1.0), (1.0, 0.0))[0] == pytest.approx(
        1 / 3
    )


MODES = {
    "cylinder": exact.cylinder_mode,
    "sphere": exact.sphere_mode,
    "disk": lambda r: exact.disk_mode(0.6 * r, 0.8 * r),
}


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
def test_modes_have_no_flux_at_the_surface(mode):
    assert abs(mode(1 + 1e-6) - mode(1 - 1e-6)) < 1e-11
    assert abs(mode(0.9 + 1e-6) - mode(0.9)) > 1e-9


@pytest.mark.parametrize("conductivity", [0.01, 0.1])
def test_thermoelastic_root_is_that_of_the_table(conductivity):
    with (DATA / "thermoelastic_bar.csv").open() as file:
        row = next(row for row in csv.DictReader(file) if float(row["kappa"]) == conductivity)
    root = exact.thermoelastic_root(np.pi, conductivity, 0.5)
    assert -root.real == pytest.approx(float(row["damping exact"]), rel=1e-5)
    assert root.imag == pytest.approx(float(row["frequency exact"]), rel=1e-5)
    assert np.exp(root.real * 8 * np.pi / root.imag) == pytest.approx(float(row["exact"]), rel=1e-5)


def test_filters_are_those_of_the_table():
    with (DATA / "filter_per_step.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12
    for row in rows:
        loss = exact.spline_loss if row["shape"] == "b2gimp" else exact.hat_loss
        a = loss(float(row["cells per wave"]))
        assert a == pytest.approx(float(row["a"]), rel=1e-5)
        for order in (1, 2, 4, 8):
            assert 1 - exact.filtered(a, order, 1) == pytest.approx(
                float(row[f"k={order}"]), rel=2e-5, abs=2e-15
            )
