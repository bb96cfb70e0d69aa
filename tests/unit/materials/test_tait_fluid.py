"""Tension of a Tait fluid."""

import numpy as np
import pytest

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import kirchhoff_stress, strain_energy

NONE = np.zeros((1, 1))


def fluid(**keys):
    words = {"kind": "tait_fluid", "density": 1.0, "K": 7.0} | keys
    return MATERIALS["tait_fluid"].model_validate(words).parameters("3d", False)


def swollen(J):
    return (J, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def pressure(m, J):
    return -kirchhoff_stress(m, swollen(J), swollen(1.0), NONE, 0, 0.0, False)[0] / J


@pytest.mark.parametrize("limit", [0.0, 0.3, 0.9])
def test_the_tension_is_limited_and_the_compression_is_not(limit):
    free, bounded = fluid(), fluid(tension_limit=limit)
    for J in (0.5, 0.9, 0.99, 1.0, 1.01, 1.5, 4.0, 100.0):
        assert pressure(bounded, J) == pytest.approx(max(pressure(free, J), -limit), abs=1e-14)
    assert pressure(bounded, 100.0) == pytest.approx(-limit)


@pytest.mark.parametrize("limit", [0.0, 0.3, 0.9])
def test_the_energy_is_the_work_of_the_pressure(limit):
    """Out and back: no energy is kept beyond that of the constant tension."""
    m = fluid(tension_limit=limit)
    J = np.linspace(0.8, 3.0, 4001)
    p = np.array([pressure(m, j) for j in J])
    work = np.concatenate([[0.0], np.cumsum(-0.5 * (p[1:] + p[:-1]) * np.diff(J))])
    energy = np.array([strain_energy(m, swollen(j), NONE, 0) for j in J])
    np.testing.assert_allclose(energy - energy[0], work, rtol=0, atol=1e-5)


@pytest.mark.parametrize("limit", [1.0, 5.0])
def test_a_limit_that_is_never_reached_changes_no_bit(limit):
    """p > −K/n at any J."""
    free, bounded = fluid(), fluid(tension_limit=limit)
    for J in (0.9, 1.2, 30.0, 1e3):
        assert pressure(free, J) == pressure(bounded, J)
        assert strain_energy(free, swollen(J), NONE, 0) == strain_energy(bounded, swollen(J), NONE, 0)
