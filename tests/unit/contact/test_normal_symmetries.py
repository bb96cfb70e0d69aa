"""What no normal may depend on: order of particles, swapped sides, mirrors, right angles, size of volumes."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mpmcli.contact.neighbours import allocate_neighbours
from mpmcli.contact.normals import DEGENERATE, NORMALS, find_normal
from mpmcli.contact.normals.plane import fit_plane

KINDS = sorted(kind for kind in NORMALS if kind != "specified")
SHARED = [kind for kind in KINDS if NORMALS[kind].shares_normal]
ITERATED = ("irls", "logistic_regression")


@st.composite
def neighbourhoods(draw):
    """Positions (d, n), sides, volumes, S and G of linear functions; nothing about them is regular."""
    d = draw(st.integers(1, 3))
    n = draw(st.integers(2, 24))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    x = rng.uniform(-0.98, 0.98, (d, n))
    side = np.where(rng.random(n) < 0.5, -1.0, 1.0)
    if draw(st.booleans()):
        side = np.where(rng.normal(size=d) @ x < 0.1, -1.0, 1.0)
    volume = rng.uniform(0.1, 0.3, n)
    hats = 1 - abs(x)
    S = np.prod(hats, axis=0)
    G = np.array([-np.sign(x[a]) * np.prod(np.delete(hats, a, axis=0), axis=0) for a in range(d)])
    return x, side, volume, S, G


def fill(x, side, volume, S, G):
    d, n = x.shape
    neighbours = allocate_neighbours(d, n, False, False)
    neighbours.x[:], neighbours.side[:], neighbours.volume[:], neighbours.S[:], neighbours.G[:] = (
        x,
        side,
        volume,
        S,
        G,
    )
    return neighbours


def normal_of(kind, particles, order=1.0):
    d, n = particles[0].shape
    normal = NORMALS[kind].model_validate({"kind": kind}).parameters(d, (1.0,) * d)
    out = np.full(d, np.nan)
    status = find_normal(normal, (0.0,) * d, fill(*particles), n, 0.0, order, np.zeros(d), out)
    assert np.linalg.norm(out) == pytest.approx(1.0, rel=1e-13)
    return out, status


def stays_still(kind, particles):
    """Whether one pass more or less changes little, so that round-off cannot decide where it ends."""
    if kind not in ITERATED:
        return True
    d, n = particles[0].shape
    model = NORMALS[kind].model_validate({"kind": kind})
    normal, neighbours = model.parameters(d, (1.0,) * d), fill(*particles)
    ends = [
        fit_plane(
            normal._replace(tolerance=factor * normal.tolerance), (0.0,) * d, neighbours, n, np.zeros(d)
        )
        for factor in (0.999, 1.001)
    ]
    return ends[0][1] == ends[1][1] and np.linalg.norm(ends[0][0]) < 1e4


@pytest.mark.parametrize("kind", KINDS)
@given(particles=neighbourhoods(), seed=st.integers(0, 1000))
def test_order_of_particles_does_not_matter(kind, particles, seed):
    assume(stays_still(kind, particles))
    shuffled = np.random.default_rng(seed).permutation(particles[0].shape[1])
    n, status = normal_of(kind, particles)
    m, again = normal_of(kind, tuple(a[..., shuffled] for a in particles))
    assert again == status
    assert m == pytest.approx(n, abs=1e-6)


@pytest.mark.parametrize("kind", SHARED)
@given(particles=neighbourhoods())
def test_swapped_sides_turn_the_normal(kind, particles):
    assume(stays_still(kind, particles))
    x, side, volume, S, G = particles
    n, status = normal_of(kind, particles)
    m, again = normal_of(kind, (x, -side, volume, S, G), -1.0)
    assert again == status
    assert m == pytest.approx(-n, abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@given(particles=neighbourhoods(), axis=st.integers(0, 2))
def test_mirrors(kind, particles, axis):
    assume(stays_still(kind, particles))
    x, side, volume, S, G = particles
    sign = np.ones((len(x), 1))
    sign[axis % len(x)] = -1.0
    n, status = normal_of(kind, particles)
    assume(status != DEGENERATE)
    m, again = normal_of(kind, (sign * x, side, volume, S, sign * G))
    assert again == status
    assert m == pytest.approx(sign[:, 0] * n, abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@given(particles=neighbourhoods(), axes=st.permutations(range(3)))
def test_right_angles(kind, particles, axes):
    """With the mirrors these are all turns by right angles."""
    assume(stays_still(kind, particles))
    x, side, volume, S, G = particles
    order = [a for a in axes if a < len(x)]
    n, status = normal_of(kind, particles)
    assume(status != DEGENERATE)
    m, again = normal_of(kind, (x[order], side, volume, S, G[order]))
    assert again == status
    assert m == pytest.approx(n[order], abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@given(particles=neighbourhoods(), factor=st.sampled_from([1e-30, 1e-9, 1e12]))
def test_size_of_volumes_does_not_matter(kind, particles, factor):
    x, side, volume, S, G = particles
    n, status = normal_of(kind, particles)
    m, again = normal_of(kind, (x, side, factor * volume, S, G))
    assert again == status
    assert m == pytest.approx(n, abs=1e-9)


@pytest.mark.parametrize("kind", KINDS)
@given(particles=neighbourhoods(), digits=st.integers(0, 1), same=st.booleans())
def test_awkward_neighbours_give_unit_normals(kind, particles, digits, same):
    """Rounded positions coincide, line up and lie symmetric about the node."""
    x, side, volume, S, G = particles
    volume = np.full_like(volume, 0.25) if same else volume
    normal_of(kind, (np.round(x, digits), side, volume, S, np.round(G, digits)))
