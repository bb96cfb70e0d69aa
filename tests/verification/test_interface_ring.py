"""A disk in a ring, joined by an interface, under pressure (L6)."""

import exact_interfaces as exact
import numpy as np
import pytest

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]

STIFFNESSES = (50, 200, 1000)


def test_exact_pressures():
    found = [exact.ring_pressure(5.0, 10.0, 1.0, D, 1000.0, 0.3) for D in STIFFNESSES]
    assert found == pytest.approx([0.3776, 0.7082, 0.9239], abs=1e-4)


def pressure(start, scene, D, *sets):
    """Pressure on the interface at the end over the exact one, shear over it, and area."""
    run = start(scene, f"constants.D={D}", *sets)
    run.to(0.2)
    means = run.simulation.contact.view.interfaces.means()
    wanted = 0.1 * exact.ring_pressure(5.0, 10.0, 1.0, D, 1000.0, 0.3)
    return -means.traction_normal[0] / wanted, means.traction_tangential[0] / wanted, means.area[0]


@pytest.mark.parametrize("D", STIFFNESSES)
def test_pressure_in_a_cylinder(start, D):
    found, shear, area = pressure(start, "bonded_ring.yaml", D)
    assert found == pytest.approx(1.0, abs=0.01)
    assert shear < 1e-9
    assert area == pytest.approx(5.0 * 0.5, rel=0.003)  # per radian


def test_it_converges(start):
    coarse, fine = (
        abs(pressure(start, "bonded_ring.yaml", 200, f"constants.cell={cell}")[0] - 1.0)
        for cell in (0.5, 0.25)
    )
    assert fine < 0.6 * coarse < 0.008


@pytest.mark.parametrize("D", STIFFNESSES)
def test_pressure_across_the_cells_of_a_plane(start, D):
    """The surface is curved: normals by regression, and areas of nodes that see any part of it."""
    found, shear, area = pressure(start, "bonded_ring_plane.yaml", D)
    assert found == pytest.approx(1.0, abs=0.02)
    assert shear < 0.08  # of normals that follow the steps of the surfaces
    assert area == pytest.approx(0.5 * np.pi * 5.0, rel=0.02)
