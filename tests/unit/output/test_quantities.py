"""Values of the quantities against direct sums and definitions."""

import numpy as np
import pytest

from mpmcli.core.analysis import ANALYSES, F_COMPONENTS, STRESS_COMPONENTS
from mpmcli.output.columns import PLACES, all_columns, evaluate, fields_of
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.quantities import QUANTITIES, Context, Quantity
from mpmcli.output.snapshot import Snapshot, logarithmic_strain

KINDS = list(ANALYSES)


def context_for(kind: str, **more) -> Context:
    return Context(kind, ("left", "right"), ("rubber", "steel"), reactions=("base",), **more)


def table_of(state, kind: str, **more) -> dict[str, float]:
    columns = all_columns(context_for(kind, **more))
    return dict(zip([c.name for c in columns], evaluate(columns, Snapshot(state)), strict=True))


def full(rows: np.ndarray, names) -> np.ndarray:
    """Stored rows of one particle as a 3 × 3 tensor."""
    tensor = np.zeros((3, 3))
    for value, name in zip(rows, names, strict=True):
        tensor["xyz".index(name[0]), "xyz".index(name[1])] = value
    return tensor


@pytest.mark.parametrize("kind", KINDS)
def test_every_quantity_is_finite_and_of_its_shape(make_state, kind):
    state = make_state(kind)
    snapshot, context = Snapshot(state), context_for(kind, history=("plastic_work", "temperature"))
    table = table_of(state, kind)
    assert np.isfinite(list(table.values())).all()
    for quantity in fields_of(context).values():
        values = quantity.compute(snapshot)
        rows = quantity.rows(context)
        assert values.shape == ((len(rows), 6) if rows else (6,)), quantity.name
        assert np.isfinite(values).all()


def test_energies_and_momenta(make_state):
    state = make_state()
    p, table = state.particles, table_of(state, "plane_strain")
    assert table["kinetic_energy"] == pytest.approx(0.5 * np.sum(p.mass * (p.V**2).sum(axis=0)))
    assert table["strain_energy"] == pytest.approx(2.0 * p.vol0.sum())
    assert table["stress_work"] == pytest.approx(p.stress_work.sum())
    assert table["mass"] == pytest.approx(p.mass.sum())
    assert table["momentum_y"] == pytest.approx(p.mass @ p.V[1])
    assert table["angular_momentum_z"] == pytest.approx(np.sum(p.mass * (p.X[0] * p.V[1] - p.X[1] * p.V[0])))
    assert table["largest_speed"] == pytest.approx(np.linalg.norm(p.V, axis=0).max())
    assert table["smallest_J"] == pytest.approx(p.determinant().min())
    assert table["boundary_work"] == 0.5
    assert table["viscous_work"] == 0.0
    assert table["reaction_y[base]"] == 2.0
    right = p.body == 1
    assert table["center_x[right]"] == pytest.approx(np.average(p.X[0, right], weights=p.mass[right]))
    assert table["velocity_y[right]"] == pytest.approx(np.average(p.V[1, right], weights=p.mass[right]))
    moved = Snapshot(state).displacement
    assert table["displacement_x[right]"] == pytest.approx(np.average(moved[0, right], weights=p.mass[right]))
    assert table["displacement"] == pytest.approx(np.linalg.norm(moved, axis=0).max())


def test_history_energies_belong_to_the_materials_that_have_them(make_state):
    state = make_state()
    steel = state.particles.material == 1
    expected = np.sum(state.particles.vol0[steel] * state.particles.H[0, steel])
    assert table_of(state, "plane_strain")["plastic_work"] == pytest.approx(expected)
    temperature = Snapshot(state).history("temperature")
    assert np.array_equal(temperature, np.where(steel, state.particles.H[1], 0.0))


def test_kinetic_energy_summed_in_chunks_is_that_of_all_particles(make_state):
    state = make_state("3d")
    count = state.particles.count
    assert count > 5
    state.chunks = lambda: np.array([0, 0, 2, 3, 3, count, count])
    expected = sum(
        Snapshot(state).kinetic_energy[part].sum() for part in (slice(2), slice(2, 3), slice(3, None))
    )
    assert Snapshot(state).total_kinetic_energy == pytest.approx(expected, rel=1e-15)


def test_totals_are_sums_of_the_sums_of_chunks(make_state):
    """A number that is lost beside a large one is not lost where it stands in another chunk."""
    state = make_state("plane_strain")
    count = state.particles.count
    values = np.zeros((2, count))
    values[:, 0], values[0, -2:] = 1.0, 1e-16
    assert Snapshot(state).total(values)[0] == pytest.approx(1.0)
    state.chunks = lambda: np.array([0, 1, count])
    np.testing.assert_array_equal(Snapshot(state).total(values), [1.0 + 2e-16, 1.0])
    state.chunks = lambda: np.array([0, 1, count + 1])  # of another number of particles
    assert Snapshot(state).total(values[1]) == 1.0
    state.chunks, state.rigid = lambda: np.array([0, 1, count]), (0,)
    is_rigid = state.particles.body == 0
    assert Snapshot(state).total(values[0]) == values[0, ~is_rigid].sum()


def test_sums_over_bodies_are_made_by_chunks(make_state):
    state = make_state("plane_strain")
    count, values = state.particles.count, np.random.default_rng(3).random(state.particles.count)
    expected = [values[state.particles.body == body].sum() for body in (0, 1)]
    for edges in ([0, count], [0, 0, 3, count]):
        state.chunks = lambda edges=edges: np.array(edges)
        np.testing.assert_allclose(Snapshot(state).sum_over("body", values), expected, rtol=1e-14)


def test_angular_momentum_in_3d_is_the_cross_product(make_state):
    state = make_state("3d")
    p, table = state.particles, table_of(state, "3d")
    expected = (p.mass[:, None] * np.cross(p.X.T, p.V.T)).sum(axis=0)
    assert [table[f"angular_momentum_{axis}"] for axis in "xyz"] == pytest.approx(expected)


@pytest.mark.parametrize("kind", KINDS)
def test_averages_are_weighted_by_current_volume(make_state, kind):
    state = make_state(kind)
    p, table = state.particles, table_of(state, kind)
    J = np.array([np.linalg.det(full(F, F_COMPONENTS[len(p.X)])) for F in p.F.T])
    volume, rubber = p.vol0 * J, p.material == 0
    stress = np.average((p.tau / J)[:, rubber], axis=1, weights=volume[rubber])
    for value, name in zip(stress, STRESS_COMPONENTS[len(p.X)], strict=True):
        assert table[f"stress_{name}[rubber]"] == pytest.approx(value)
    left = p.body == 0
    strain = np.average(logarithmic_strain(p.F)[0, left], weights=volume[left])
    assert table["strain_xx[left]"] == pytest.approx(strain)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [1e-9, 0.1, 0.4])
def test_logarithmic_strain_is_half_the_logarithm_of_the_left_tensor(kind, size):
    d = ANALYSES[kind]().dimensions
    names = F_COMPONENTS[d]
    F = size * np.random.default_rng(3).normal(size=(len(names), 20))
    F += np.array([float(name[0] == name[1]) for name in names])[:, None]
    strain = logarithmic_strain(F)
    for column in range(F.shape[1]):
        gradient = full(F[:, column], names)
        values, vectors = np.linalg.eigh(gradient @ gradient.T)
        expected = (vectors * (0.5 * np.log(values))) @ vectors.T
        found = full(strain[:, column], STRESS_COMPONENTS[d])
        found = found + np.triu(found, 1).T
        assert found == pytest.approx(expected, abs=2e-14 + 1e-13 * np.abs(expected).max())


def test_logarithmic_strain_of_rotation_and_of_broken_gradients():
    angle = 0.3
    rotation = np.array([[np.cos(angle)], [-np.sin(angle)], [np.sin(angle)], [np.cos(angle)], [1.0]])
    assert logarithmic_strain(rotation) == pytest.approx(np.zeros((4, 1)), abs=1e-15)
    broken = np.tile(np.eye(3).reshape(9, 1), (1, 3))
    broken[4, 1] = np.nan
    strain = logarithmic_strain(broken)
    assert np.isnan(strain[:, 1]).all()
    assert np.array_equal(strain[:, [0, 2]], np.zeros((6, 2)))


def test_axisymmetric_quantities_are_those_of_the_full_ring(make_state):
    state = make_state("axisymmetric")
    p, table = state.particles, table_of(state, "axisymmetric")
    ring = 2.0 * np.pi
    assert table["mass"] == pytest.approx(ring * p.mass.sum())
    assert table["kinetic_energy"] == pytest.approx(0.5 * ring * np.sum(p.mass * (p.V**2).sum(axis=0)))
    assert table["momentum_y"] == pytest.approx(ring * p.mass @ p.V[1])
    assert table["reaction_y[base]"] == pytest.approx(2.0 * ring)
    assert table["external_work"] == pytest.approx(0.25 * ring)
    assert "momentum_x" not in table
    assert not any(name.startswith("angular_momentum") for name in table)


def test_stress_measures(make_state):
    state = make_state()
    p, snapshot = state.particles, Snapshot(state)
    for column in range(p.count):
        tensor = full(snapshot.stress[:, column], STRESS_COMPONENTS[2])
        tensor = tensor + np.triu(tensor, 1).T
        pressure = -np.trace(tensor) / 3.0
        deviator = tensor + pressure * np.eye(3)
        assert snapshot.pressure[column] == pytest.approx(pressure)
        assert snapshot.von_mises[column] == pytest.approx(np.sqrt(1.5 * np.sum(deviator * deviator)))
    density = fields_of(context_for("plane_strain"))["density"].compute(snapshot)
    assert density == pytest.approx(p.mass / (p.vol0 * p.determinant()))


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_without_particles_has_no_number_that_is_infinite(make_state, kind):
    state = make_state(kind)
    state.particles.keep(np.zeros(state.particles.count, dtype=bool))
    table = table_of(state, kind)
    assert np.isnan(table["smallest_J"])
    assert not np.isinf(list(table.values())).any()


def test_groups_without_particles_give_nan(make_state):
    state = make_state()
    state.particles.body[:] = 0
    table = table_of(state, "plane_strain")
    assert np.isnan(table["center_x[right]"])
    assert np.isfinite(table["center_x[left]"])


def test_energy_error_follows_its_definition(make_state):
    state = make_state()
    p, balance = state.particles, EnergyBalance()
    first = balance.update(Snapshot(state))
    assert first == 0.0
    kinetic = 0.5 * np.sum(p.mass * (p.V**2).sum(axis=0))
    start, largest = kinetic + p.stress_work.sum() + 0.125 - 0.5 - 0.25, kinetic + p.stress_work.sum()
    p.V *= 0.5
    state.work = {"boundary_work": 0.7, "external_work": 0.2, "damping_work": 0.3, "contact_work": 0.4}
    snapshot = Snapshot(state)
    error = balance.update(snapshot)
    now = 0.25 * kinetic + p.stress_work.sum() + 0.4 + 0.3 - 0.7 - 0.2
    assert error == pytest.approx((now - start) / largest)
    assert snapshot.energy_error == error


def test_energy_error_of_a_scene_at_rest_is_zero(make_state):
    state = make_state(work={})
    state.particles.V[:] = 0.0
    state.particles.stress_work[:] = 0.0
    assert EnergyBalance().update(Snapshot(state)) == 0.0


def test_energy_error_is_relative_to_the_strain_energy_of_stress_at_the_start(make_state):
    """Round-off in a body in balance is no error, however small all other energies are."""
    state = make_state(work={})
    p, balance = state.particles, EnergyBalance()
    p.V[:] = 0.0
    p.stress_work[:] = 0.0
    state.strain_energy_density = lambda: np.full(p.count, 3.0)
    balance.update(Snapshot(state))
    p.stress_work[:] = 1e-15
    assert balance.update(Snapshot(state)) == pytest.approx(p.stress_work.sum() / (3.0 * p.vol0.sum()))


def test_registry_entries_are_complete_and_unique():
    entries = list(QUANTITIES)
    assert len({(q.where, q.name) for q in entries}) == len(entries)
    for quantity in entries:
        assert quantity.symbol
        assert quantity.description
        assert quantity.rank in ("scalar", "vector", "tensor", "gradient")
        assert quantity.where in ("particle", *PLACES)
    with pytest.raises(ValueError, match="registered twice"):
        QUANTITIES.add(Quantity("mass", "M", "mass", "scalar", "global", lambda s: 0.0, "again"))


def test_dimensions_are_known_to_the_units():
    from mpmcli.scene.units import Units

    labels = Units("mm", "g", "ms")
    assert {q.name: labels.label(q.dimension) for q in QUANTITIES.at("global")}["kinetic_energy"] == "mJ"
    for quantity in [
        *QUANTITIES,
        *fields_of(context_for("3d", history=("temperature", "heat_energy"))).values(),
    ]:
        assert labels.label(quantity.dimension)


def test_no_particles_at_all(make_state):
    state = make_state(count=0)
    table = table_of(state, "plane_strain")
    assert table["mass"] == 0.0
    assert table["largest_speed"] == 0.0
    assert np.isnan(table["smallest_J"])
