"""Two equal blocks, one on the other, compressed as one (Nairn et al. 2020, section 4.1)."""

import numpy as np
import pytest

SPEED, HEIGHT = 9.622, 100.0
FMPM4 = "method.transfer={kind: fmpm, order: 4}"
AVERAGE = "contact.normal={kind: average_gradient}"


def mean_stress(run) -> float:
    """Axial stress, mean over the volume."""
    p = run.particles
    J = p.determinant()
    return float(np.sum(p.vol0 * p.tau[1]) / np.sum(p.vol0 * J))


def compress(start, strain: float, *sets: str):
    """Nominal strains and axial stresses of every step up to ``strain``."""
    run = start("axial_compression.yaml", *sets)
    seen = run.to(strain * HEIGHT / SPEED, lambda r: (r.time * SPEED / HEIGHT, mean_stress(r)))
    return np.array(seen).T


def largest_error(two, one, low: float, high: float) -> float:
    """Largest difference of two stress-strain curves between two strains, over the second."""
    strain, stress = two
    error = np.abs(stress / np.interp(strain, *one) - 1.0)
    return float(error[(strain >= low) & (strain <= high)].max())


@pytest.mark.slow
def test_contact_stress_across_a_grid_line(start):
    """Until the interface has passed a grid line (at 10 % strain): within 0.6 % of one field (measured: 0.5 %)."""
    one = compress(start, 0.106, "contact=null")
    two = compress(start, 0.106)
    assert largest_error(two, one, 0.007, 0.05) < 0.001
    assert largest_error(two, one, 0.05, 0.106) < 0.007


def test_filtered_velocities_move_contact_as_one_field(start):
    """XPIC(5) to 5 % strain: within 0.1 % (measured: 0.04 %; 1.1 % if positions miss what contact corrects)."""
    xpic = "method.transfer={kind: xpic, order: 5}"
    one = compress(start, 0.05, "contact=null", xpic)
    two = compress(start, 0.05, xpic)
    assert largest_error(two, one, 0.007, 0.05) < 0.001


@pytest.mark.parametrize("below", [50, 52.5])
def test_gap_closes_when_it_should(start, below):
    """A gap of 1.5 cells that closes on a grid line, or amid cells: the first force comes in the step it closes."""
    run = start("axial_compression.yaml", "constants.gap=7.5", f"constants.below={below}", "time.courant=0.4")
    contact = run.simulation.state.contact
    while run.time < 1.1 * 7.5 / SPEED:
        before = run.time
        run.simulation.step()
        if np.any(contact.force):
            break
    dt = run.time - before
    assert abs(before - 7.5 / SPEED) <= 1.01 * dt


@pytest.mark.slow
@pytest.mark.parametrize(("sets", "allowed"), [((), (0.01, 0.014)), ((FMPM4,), (0.01, 0.02))])
def test_contact_stress_to_large_strain(start, sets, allowed):
    """Logistic regression: up to 15 and 20 % strain."""
    one = compress(start, 0.2, "contact=null", *sets)
    two = compress(start, 0.2, *sets)
    assert largest_error(two, one, 0.007, 0.15) < allowed[0]
    assert largest_error(two, one, 0.007, 0.2) < allowed[1]


@pytest.mark.slow
def test_extrapolated_methods_are_worse(start):
    """The average gradient with a position offset of 0.8 is off by more than 10 %, the position fit by less."""
    one = compress(start, 0.2, "contact=null")
    offset = compress(start, 0.2, AVERAGE, "contact.separation={kind: position_offset, offset: 0.8}")
    fit = compress(start, 0.2, AVERAGE, "contact.separation={kind: position_fit}")
    worst, between = (largest_error(two, one, 0.007, 0.2) for two in (offset, fit))
    assert worst > 0.1
    assert 0.014 < between < worst
