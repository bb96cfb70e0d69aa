"""Probes follow their particle through re-sorting and deletion, and read linear fields exactly."""

from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.core.errors import SceneError
from mpmcli.output.probes import linear_weights, make_probe, nearest_particle
from mpmcli.output.quantities import Context
from mpmcli.output.snapshot import Snapshot

CONTEXT = Context("plane_strain", ("left", "right"), ("rubber", "steel"))


def particle_probe(**changes):
    words = {
        "kind": "particle",
        "name": "tip",
        "body": "left",
        "near": (1.0, 1.0),
        "columns": ("position", "J"),
    }
    return SimpleNamespace(**(words | changes))


def point_probe(**changes):
    return SimpleNamespace(
        **({"kind": "point", "name": "eye", "at": (1.3, 1.9), "columns": ("velocity",)} | changes)
    )


def test_follows_the_nearest_particle_of_its_body(make_state):
    state = make_state()
    probe = make_probe(particle_probe(), state, CONTEXT, "probes.0")
    p = state.particles
    left = np.flatnonzero(p.body == 0)
    nearest = left[np.argmin(np.linalg.norm(p.X[:, left] - 1.0, axis=0))]
    assert probe.id == p.id[nearest]
    assert probe.columns == ["position_x", "position_y", "J"]
    assert probe.dimensions == ["length", "length", "1"]
    assert probe.look(Snapshot(state)) == [*p.X[:, nearest], p.determinant()[nearest]]
    p.X[:, nearest] += 100.0
    for name, values in p.arrays().items():
        setattr(p, name, values[..., ::-1].copy())  # as sorting by cell does
    assert probe.look(Snapshot(state))[0] == pytest.approx(p.X[0, 5 - nearest])


def test_deleted_particle_gives_nan(make_state):
    state = make_state()
    probe = make_probe(particle_probe(), state, CONTEXT, "probes.0")
    state.particles.id[state.particles.id == probe.id] = 77
    assert np.isnan(probe.look(Snapshot(state))).all()


def test_equally_near_particles_are_decided_by_identity(make_state):
    state = make_state()
    state.particles.X[:] = 1.0
    assert nearest_particle(state, None, (0.0, 0.0)) == 0


def test_body_without_particles_is_an_error(make_state):
    state = make_state()
    state.particles.body[:] = 1
    with pytest.raises(SceneError, match="no particles"):
        make_probe(particle_probe(), state, CONTEXT, "probes.0")


@pytest.mark.parametrize("d", [1, 2, 3])
def test_point_reads_linear_fields_exactly(make_state, make_grid, d):
    kind = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}[d]
    state = make_state(kind, grid=make_grid(d), step=1)
    at = np.array([1.3, 1.9, 3.7])[:d]
    context = Context(kind, ("left", "right"), ("rubber", "steel"))
    probe = make_probe(point_probe(at=tuple(at)), state, context, "probes.0")
    slope = np.arange(1.0, d * d + 1.0).reshape(d, d)
    assert probe.look(Snapshot(state)) == pytest.approx(slope @ at + 1.0)
    assert probe.columns == [f"velocity_{axis}" for axis in "xyz"[:d]]


def test_point_on_the_last_node_is_inside(make_grid):
    grid = make_grid(2)
    nodes, weights = linear_weights(grid, np.array([4.0, 2.5]))
    assert weights.sum() == 1.0
    assert nodes[np.argmax(weights)] == 19


def test_point_without_mass_or_grid_gives_nan(make_state, make_grid):
    state = make_state()
    probe = make_probe(point_probe(), state, CONTEXT, "probes.0")
    assert np.isnan(probe.look(Snapshot(state))).all()
    assert np.isnan(probe.look(Snapshot(make_state(grid=make_grid(2))))).all()
    grid = make_grid(2)
    grid.fields["mass"] = lambda: np.zeros(20)
    state.grid, state.step = grid, 1
    assert np.isnan(probe.look(Snapshot(state))).all()


def test_empty_nodes_take_no_part(make_state, make_grid):
    grid = make_grid(2)
    mass = np.zeros(20)
    nodes, _ = linear_weights(grid, np.array([1.3, 1.9]))
    mass[nodes[0]] = 1.0
    grid.fields["mass"] = lambda: mass
    probe = make_probe(point_probe(), make_state(), CONTEXT, "probes.0")
    state = make_state(grid=grid, step=1)
    assert probe.look(Snapshot(state)) == pytest.approx(grid.fields["velocity"]()[nodes[0]])


def test_wrong_words_are_scene_errors(make_state):
    with pytest.raises(SceneError, match="did you mean 'position'"):
        make_probe(particle_probe(columns=("positon",)), make_state(), CONTEXT, "probes.0")
    with pytest.raises(SceneError, match="'pressure' is not a field of the grid"):
        make_probe(point_probe(columns=("pressure",)), make_state(), CONTEXT, "probes.0")
    with pytest.raises(SceneError, match="not a valid file name"):
        make_probe(point_probe(name="../up"), make_state(), CONTEXT, "probes.0")
