"""Particles in particles of other bodies: the way out."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcli.contact.clouds import NEAREST
from mpmcli.contact.shift import EDGE, find_shifts

AXES = (0.0, 0.0)


def shifts(X, field, share=1.0, F=None, mass=None, rigid=(False, False), law=0, pushed=True, near=None):
    """Displacements (2, N) of particles of half size 1 that one node sees."""
    X = np.array(X, dtype=float).T
    n = X.shape[1]
    F = np.tile([[1.0], [0.0], [0.0], [1.0], [1.0]], n) if F is None else np.array(F, dtype=float).T
    out = np.zeros((2, n))
    flag = np.array([NEAREST if near is None or p in near else 0 for p in range(n)])
    farthest = find_shifts(
        AXES, 1, np.array([n - 1]), np.arange(n) - 1, np.arange(n), flag, np.array(field), np.array(rigid),
        np.array([[-1, law], [law, -1]]), np.array([pushed]), X, F, np.ones((2, n)),
        np.ones(n) if mass is None else np.array(mass), share, np.zeros((4, n)), np.zeros(n, dtype=np.int64),
        np.zeros(n, dtype=bool), out,
    )  # fmt: skip
    assert farthest == pytest.approx(np.abs(out).max())
    return out


def test_a_centre_leaves_the_other_particle_on_the_shortest_line_and_the_mass_centre_stays():
    X, mass = [[0.0, 0.0], [0.5, 0.25]], [1.0, 3.0]
    once = shifts(X, [0, 1], mass=mass)
    np.testing.assert_allclose(X[1] + once[:, 1] - once[:, 0], [EDGE, EDGE / 2])
    np.testing.assert_allclose(once @ mass, 0.0, atol=1e-15)
    np.testing.assert_allclose(shifts(X, [0, 1], 0.2, mass=mass), 0.2 * once)
    np.testing.assert_allclose(2 * shifts(X, [0, 1], mass=mass, near=[1]), once)  # each is in the other


def test_only_what_is_inside_another_body_moves():
    assert not shifts([[0, 0], [0.5, 0.25]], [0, 0]).any()
    assert not shifts([[0, 0], [EDGE + 1e-9, 0]], [0, 1]).any()
    assert not shifts([[0, 0], [0.5, 0.25]], [0, 1], law=-1).any()
    assert not shifts([[0, 0], [0.5, 0.25]], [0, 1], pushed=False).any()
    assert not shifts([[0, 0], [0.5, 0.25]], [0, 1], near=[]).any()


def test_the_domain_is_the_deformed_one():
    flat = [1.0, 0.0, 0.0, 0.2, 1.0]
    assert not shifts([[0, 0], [0, 0.25]], [0, 1], F=[flat, flat]).any()
    assert shifts([[0, 0], [0, 0.2]], [0, 1], F=[flat, flat]).any()
    sheared = [1.0, 1.0, 0.0, 1.0, 1.0]
    assert shifts([[0, 0], [1.4, 0.9]], [0, 1], F=[sheared, sheared]).any()


def test_a_rigid_particle_stays_and_the_other_goes_all_the_way():
    found = shifts([[0.0, 0.0], [0.5, 0.0]], [0, 1], rigid=(True, False))
    np.testing.assert_allclose(found, [[0.0, EDGE - 0.5], [0.0, 0.0]])


def test_a_centre_on_a_centre_moves_nowhere():
    assert not shifts([[0, 0], [0, 0]], [0, 1]).any()
