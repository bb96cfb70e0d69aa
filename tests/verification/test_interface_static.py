"""Two bars in series with the interface that joins them (L3)."""

import exact_interfaces as exact
import numpy as np
import pytest
from interface_runs import transfer

pytestmark = pytest.mark.slow

STIFFNESSES = (0.02, 0.1, 0.5)
"""D Δx/E."""
EXTRAPOLATED = "contact.interface={jump: extrapolated}"
L, E = 10.0, 1000.0


def stress(start, method, k, cells, shift, *sets, strain=1e-4):
    """Stress of the bars at rest over that of a bar without an interface, and means of the interface."""
    run = start(
        "interface_static.yaml",
        f"constants.k={k}",
        f"constants.cells={cells}",
        f"constants.shift={shift}",
        f"constants.strain={strain}",
        transfer(method),
        *sets,
    )
    run.to(0.15)
    x, cell = run.X[0], 0.5 * L / cells
    within = (np.abs(x) > 2 * cell) & (np.abs(x) < 0.5 * L - 2 * cell)
    means = run.simulation.contact.view.interfaces.means()
    return run.stress[0][within].mean() / (strain * E), means


def wanted(k, cells):
    return exact.series_stress(L, L, k * E / (0.5 * L / cells), E) / E


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("k", STIFFNESSES)
@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
def test_stress_of_bars_in_series(start, method, k, shift):
    """1/E_eff = 1/E + 1/(D L) at ten cells for each bar; the interface knows its area, traction and jump."""
    found, means = stress(start, method, k, 10, shift)
    assert found == pytest.approx(wanted(k, 10), rel=3e-4)
    assert means.area[0] == pytest.approx(1.0, abs=1e-5)
    assert means.traction_normal[0] == pytest.approx(found * 1e-4 * E, rel=1e-4)
    assert means.jump_normal[0] == pytest.approx(found * 1e-4 * E / (k * E / 0.5), rel=1e-4)


@pytest.mark.parametrize("k", STIFFNESSES)
def test_it_needs_few_cells(start, k):
    """Only finite strain is left of the error, 1.5 times the strain of the bars."""
    for cells in (5, 10, 20):
        for strain in (1e-4, 1e-3):
            found, _ = stress(start, "FLIP", k, cells, 0, strain=strain)
            bars = wanted(k, cells) * strain
            assert found / wanted(k, cells) - 1.0 == pytest.approx(-1.5 * bars, abs=1e-5 + 0.2 * strain)


@pytest.mark.parametrize(("cells", "opening"), [(5, 0.042), (10, 0.071), (20, 0.111)])
def test_the_area_does_not_shrink_when_it_opens(start, cells, opening):
    """Within 0.3 % at an opening of a tenth of a cell; by volumes it is smaller by the opening."""
    cell = 0.5 * L / cells
    found, means = stress(start, "FLIP", 0.02, cells, 0, strain=5e-3)
    assert means.jump_normal[0] / cell == pytest.approx(opening, rel=0.02)
    assert means.area[0] == pytest.approx(1.0, abs=0.004)
    assert found == pytest.approx(wanted(0.02, cells), rel=0.001)
    old, old_means = stress(start, "FLIP", 0.02, cells, 0, "contact.interface={area: volumes}", strain=5e-3)
    assert abs(old_means.area[0] - 1.0) > 3.0 * abs(means.area[0] - 1.0)
    assert abs(old / wanted(0.02, cells) - 1.0) > 3.0 * abs(found / wanted(0.02, cells) - 1.0)


@pytest.mark.parametrize("k", STIFFNESSES)
@pytest.mark.parametrize("cells", [5, 10, 20])
def test_an_extrapolated_jump_takes_strain_for_an_opening(start, cells, k):
    """Of 0.75 cells of the bar if the interface is on a grid line, of some more off it."""
    known = exact.series_stress_of_extrapolated_jump(L, L, k * cells / 5 * E / 1.0, E, 0.5 * L / cells) / E
    found, _ = stress(start, "FLIP", k, cells, 0, EXTRAPOLATED)
    right = wanted(k, cells)
    assert found / right - 1.0 == pytest.approx(known / right - 1.0, rel=0.03)
    found, _ = stress(start, "FLIP", k, cells, 0.37, EXTRAPOLATED)
    assert 1.1 * (known - right) < found - right < 1.2 * (known - right)
