"""Integrals around a tip on particles that carry the exact field of a tip."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tip_fields import STEEL, Plate, strain_of, tip_field

from mpmcli.core.analysis import PlaneStrain, PlaneStress
from mpmcli.cracks.integrals.base import NO_RING, NO_VECTORS, Frame, Matter, Ring, matter_near, weight_at
from mpmcli.cracks.integrals.domain import energy_release_rate
from mpmcli.cracks.integrals.elastic import PlaneElasticity, has_plane_elasticity, plane_elasticity
from mpmcli.cracks.integrals.faces import Faces
from mpmcli.cracks.integrals.modes import modes_by_interaction, modes_by_opening
from mpmcli.materials import MATERIALS

pytestmark = pytest.mark.usefixtures("python_and_compiled")
CELL = 0.1
STRAIN = plane_elasticity(STEEL, plane_stress=False)
angles = st.floats(-np.pi, np.pi)
offsets = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)).map(lambda o: (CELL * o[0], CELL * o[1]))


def found(plate, inner=2.0, outer=6.0, **choices):
    """J, K_I and K_II of a plate, with radii in cells."""
    matter, _ = matter_near(
        plate.particles(), plate.analysis, plate.frame, outer * CELL, plate.thickness, **choices
    )
    radii = inner * CELL, outer * CELL
    return energy_release_rate(matter, *radii), *modes_by_interaction(matter, *radii, plate.elasticity)


@given(angles, offsets, angles)
def test_factors_and_energy_for_all_directions_places_and_mixtures(angle, tip, mixture):
    K_I, K_II = 1e-3 * np.cos(mixture), 1e-3 * np.sin(mixture)
    J, found_I, found_II = found(Plate(K_I, K_II, STRAIN, tip=tip, angle=angle))
    assert J == pytest.approx(1e-6 / STRAIN.modulus, rel=0.01)
    assert (found_I, found_II) == pytest.approx((K_I, K_II), abs=1e-5)


@given(angles, angles, st.booleans())
def test_a_turned_plate_has_the_same(turn, angle, elastic):
    J, K_I, K_II = found(
        Plate(6e-4, -8e-4, STRAIN, tip=(0.01, 0.03), angle=angle, turn=turn), elastic=elastic
    )
    assert J == pytest.approx(1e-6 / STRAIN.modulus, rel=0.01)
    assert (K_I, K_II) == pytest.approx((6e-4, -8e-4), abs=1e-5)


@pytest.mark.parametrize("radii", [(1.0, 4.0), (2.0, 5.0), (3.0, 8.0)])
def test_domains_agree(radii):
    J, K_I, K_II = found(Plate(1e-3, 5e-4, STRAIN, tip=(0.012, 0.031), angle=0.4), *radii)
    assert J == pytest.approx(1.25e-6 / STRAIN.modulus, rel=0.01)
    assert (K_I, K_II) == pytest.approx((1e-3, 5e-4), abs=1e-5)


def test_stress_along_the_crack_changes_nothing():
    plain, stretched = (found(Plate(1e-3, 4e-4, STRAIN, angle=0.3, T=T)) for T in (0.0, 2e-3))
    assert stretched == pytest.approx(plain, rel=0.02)


def test_plane_stress():
    elasticity = plane_elasticity(STEEL, plane_stress=True)
    assert elasticity.modulus == pytest.approx(1000.0)
    J, K_I, K_II = found(Plate(1e-3, 5e-4, elasticity, PlaneStress(), tip=(0.01, 0.02)))
    assert J == pytest.approx(1.25e-6 / 1000.0, rel=0.01)
    assert (K_I, K_II) == pytest.approx((1e-3, 5e-4), abs=1e-5)


def test_half_the_cell_halves_the_error_at_least():
    plates = [Plate(1e-3, 7e-4, STRAIN, tip=(0.013, 0.037), angle=0.7, cell=c) for c in (0.2, 0.1)]
    errors = []
    for plate in plates:
        matter, _ = matter_near(plate.particles(18), plate.analysis, plate.frame, 0.6, plate.thickness)
        errors.append(abs(energy_release_rate(matter, 0.2, 0.6) * STRAIN.modulus / 1.49e-6 - 1.0))
    assert errors[1] < 0.5 * errors[0]


def test_rigid_rotation_gives_nothing():
    plate = Plate(0.0, 0.0, STRAIN, tip=(0.01, 0.02), angle=0.4, turn=2.1)
    assert found(plate) == pytest.approx((0.0, 0.0, 0.0), abs=1e-14)


def test_weights_fall_from_one_to_nothing():
    found = np.array([weight_at(r, 2.0, 6.0) for r in (0.0, 2.0, 4.0, 6.0, 9.0)])
    assert found[:, 0] == pytest.approx([1.0, 1.0, 0.5, 0.0, 0.0])
    assert found[:, 1] == pytest.approx([0.0, 0.0, 0.375, 0.0, 0.0])


def test_rigid_bodies_do_not_count():
    p = Plate(1e-3, 0.0, STRAIN).particles()
    p.body[p.X[0] > 0.2] = 1
    frame = Frame(np.zeros(2), np.array([1.0, 0.0]))
    all_of_it, _ = matter_near(p, PlaneStrain(), frame, 0.6)
    matter, _ = matter_near(p, PlaneStrain(), frame, 0.6, rigid=(1,))
    assert 0 < matter.r.size < all_of_it.r.size
    assert matter.x[0].max() < 0.2


# ---------------------------------------------------------------- the field of a tip


@given(st.floats(0.1, 10.0), angles, st.sampled_from([STRAIN, PlaneElasticity(3.0, 2.1)]))
def test_field_of_a_tip_is_that_of_williams(r, theta, elasticity):
    x = r * np.array([[np.cos(theta)], [np.sin(theta)]])
    root, c, s = np.sqrt(2 * np.pi * r), np.cos(theta / 2), np.sin(theta / 2)
    c3, s3 = np.cos(1.5 * theta), np.sin(1.5 * theta)
    one = tip_field(x, 1.0, 0.0, elasticity).stress[:, 0] * root
    two = tip_field(x, 0.0, 1.0, elasticity).stress[:, 0] * root
    assert one == pytest.approx([c * (1 - s * s3), c * (1 + s * s3), c * s * c3], abs=1e-12)
    assert two == pytest.approx([-s * (2 + c * c3), s * c * c3, c * (1 - s * s3)], abs=1e-12)


@given(st.floats(0.1, 10.0), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0))
def test_slopes_of_the_field_are_those_of_its_displacement(r, theta, K_II):
    x = r * np.array([np.cos(theta), np.sin(theta)])

    def displacement(x1):
        r, t = np.hypot(x1, x[1]), np.arctan2(x[1], x1)
        c, s, k = np.cos(t / 2), np.sin(t / 2), STRAIN.kappa
        one = np.array([c * (k - 1 + 2 * s * s), s * (k + 1 - 2 * c * c)])
        two = np.array([s * (k + 1 + 2 * c * c), -c * (k - 1 - 2 * s * s)])
        return np.sqrt(r / (2 * np.pi)) / (2 * STRAIN.shear) * (one + K_II * two)

    h = 1e-5 * r
    slope = (displacement(x[0] + h) - displacement(x[0] - h)) / (2 * h)
    field = tip_field(x[:, None], 1.0, K_II, STRAIN)
    assert field.slope[:, 0] == pytest.approx(slope, rel=1e-5, abs=1e-8)
    assert field.slope[0, 0] == pytest.approx(strain_of(field.stress, STRAIN)[0, 0], rel=1e-9, abs=1e-12)


def test_moduli_of_materials():
    rubber = MATERIALS["neo_hookean"].model_validate(
        {"kind": "neo_hookean", "density": 1, "K": 10.0, "G": 3.0}
    )
    E, nu = 9 * 10.0 * 3.0 / (30.0 + 3.0), (30.0 - 6.0) / (60.0 + 6.0)
    assert plane_elasticity(rubber, plane_stress=True).modulus == pytest.approx(E)
    assert plane_elasticity(rubber, plane_stress=False).modulus == pytest.approx(E / (1 - nu**2))
    assert plane_elasticity(rubber, plane_stress=False).kappa == pytest.approx(3 - 4 * nu)
    kinds = {kind for kind in MATERIALS if has_plane_elasticity(MATERIALS[kind])}
    assert kinds == {"linear_elastic", "mooney_rivlin", "neo_hookean"}


# ---------------------------------------------------------------- inertia, faces, axes, opening


def still(x, volume, stress, slope, energy, **more):
    return Matter(x, np.hypot(*x), volume, slope, stress, energy, volume, **more)


def lattice(half, step):
    a = np.arange(-half + 0.5 * step, half, step)
    return np.stack([b.ravel() for b in np.meshgrid(a, a)])


def test_inertia_balances_a_field_in_motion():
    """Matter without a tip: u and v are smooth, and σ is in balance with ρ a."""
    x = lattice(1.0, 0.02)
    k, E, nothing = 2.0, 3.0, np.zeros(x.shape[1])
    phase = k * x[0] + 0.5
    strain, rate = k * np.cos(phase), 0.7 * np.cos(x[0] - 0.4)
    volume = np.full(x.shape[1], 4e-4)
    moving = still(
        x, volume, np.stack([E * strain, nothing, nothing]), np.stack([strain, nothing]), 0.5 * E * strain**2,
        velocity=np.stack([0.7 * np.sin(x[0] - 0.4), nothing]),
        acceleration=np.stack([-E * k**2 * np.sin(phase), nothing]),
        rate=np.stack([rate, nothing]),
    )  # fmt: skip
    assert abs(energy_release_rate(moving, 0.3, 0.9)) < 1e-4
    at_rest = moving._replace(velocity=NO_VECTORS, acceleration=NO_VECTORS, rate=NO_VECTORS)
    assert abs(energy_release_rate(at_rest, 0.3, 0.9)) > 0.5


@pytest.mark.parametrize("radii", [(0.1, 0.3), (0.2, 0.55)])
def test_gravity_along_a_crack_changes_nothing(radii):
    """The field of a tip, and that of a plate which hangs from far ahead: both leave the faces free."""
    x, K, g, nothing = lattice(0.6, 0.025), 1e-3, 5e-3, np.zeros(48 * 48)
    field = tip_field(x, K, 0.0, STRAIN)
    weight = np.stack([-g * x[0], nothing, nothing])
    across = strain_of(weight, STRAIN)[1] / x[0]
    stress = field.stress + weight
    strain = strain_of(stress, STRAIN)
    slope = np.stack([strain[0], field.slope[1] + across * x[1]])
    energy = 0.5 * (stress[0] * strain[0] + stress[1] * strain[1] + 2.0 * stress[2] * strain[2])
    volume = np.full(x.shape[1], 0.025**2)
    at_rest = {"velocity": np.zeros(x.shape), "rate": np.zeros(x.shape)}

    def ratios(force):
        b = {"acceleration": np.stack([nothing - force, nothing])}
        matter = still(x, volume, stress, slope, energy, **b, **at_rest)
        J, (K_I, K_II) = energy_release_rate(matter, *radii), modes_by_interaction(matter, *radii, STRAIN)
        return J * STRAIN.modulus / K**2, K_I / K, K_II / K

    assert ratios(g) == pytest.approx((1.0, 1.0, 0.0), abs=0.003)
    J, K_I, _ = ratios(0.0)  # without the force
    assert J > 1.1
    assert K_I > 1.05


def test_faces_that_transmit_tractions_count():
    """A uniform shear field with a slip that grows along a face: J must vanish, since nothing is singular."""
    x = lattice(1.0, 0.02)
    n = x.shape[1]
    tau, growth = 2.0, 0.3
    above = x[1] > 0.0
    slope = np.stack([np.where(above, -growth, 0.0), np.zeros(n)])
    stress = np.stack([np.zeros(n), np.zeros(n), np.full(n, tau)])
    matter = still(x, np.full(n, 4e-4), stress, slope, np.zeros(n))
    a = np.arange(-0.99, 1.0, 0.02)
    k = len(a)
    faces = Faces(
        x=np.stack([a, np.zeros(k)]), normal=np.stack([np.zeros(k), np.ones(k)]), area=np.full(k, 0.02),
        traction=np.stack([np.full(k, -tau), np.zeros(k)]),
        slope=np.stack([np.stack([np.full(k, -growth), np.zeros(k)]), np.zeros((2, k))]),
        stress=np.zeros((2, 3, k)), energy=np.zeros((2, k)), angle=np.zeros((2, k)),
    )  # fmt: skip
    without = energy_release_rate(matter, 0.3, 0.9)
    assert abs(without) > 0.5
    assert energy_release_rate(matter, 0.3, 0.9, faces) == pytest.approx(0.0, abs=2e-3 * abs(without))


def in_frame(frame, xx, yy):
    """Components 11, 12, 21, 22 of tensors with xx and yy only."""
    c, s = frame.ahead
    return np.stack([c * c * xx + s * s * yy, c * s * (yy - xx), c * s * (yy - xx), s * s * xx + c * c * yy])


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, np.pi])
def test_smooth_matter_around_an_axis_has_no_tip(angle):
    """A thick ring under pressure (Lamé): u_r = A r + B/r, ε_zz = C; nothing is singular."""
    A, B, C, tip = 0.02, 0.05, -0.03, 3.0
    ahead = np.array([np.cos(angle), np.sin(angle)])
    frame = Frame(np.array([tip, 0.0]), ahead)
    x = lattice(1.0, 0.02)
    G, nu = STRAIN.shear, (3.0 - STRAIN.kappa) / 4.0
    lame = 2.0 * G * nu / (1.0 - 2.0 * nu)

    def ring_at(x):
        radius = tip + ahead[0] * x[0] - ahead[1] * x[1]
        rr, hoop, trace, nothing = A - B / radius**2, A + B / radius**2, 2.0 * A + C, np.zeros(x.shape[1])
        s_r, s_z = 2.0 * G * rr + lame * trace, nothing + 2.0 * G * C + lame * trace
        stress = in_frame(frame, s_r, s_z)[[0, 3, 1]]
        slope = in_frame(frame, rr, nothing + C)[[0, 2]]
        s_hoop = 2.0 * G * hoop + lame * trace
        energy = 0.5 * (s_r * rr + s_z * C + s_hoop * hoop)
        return radius, stress, slope, energy, Ring(s_hoop, hoop, radius, tip, *ahead)

    radius, stress, slope, energy, ring = ring_at(x)
    matter = still(x, 4e-4 * radius, stress, slope, energy, ring=ring)
    ends = np.sqrt(np.arange(0.0, 0.905, 0.01))  # where the field of a tip jumps, this one presses
    cut = -(0.25 * (ends[1:] + ends[:-1]) ** 2)
    k, line = len(cut), np.stack([cut, np.zeros(len(cut))])
    radius, s, u, W, _ = ring_at(line)
    faces = Faces(
        x=line, normal=np.stack([np.zeros(k), np.ones(k)]), area=0.01 * radius, traction=-s[[2, 1]],
        slope=np.stack([u, u]), stress=np.stack([s, s]), energy=np.stack([W, W]),
        angle=np.stack([np.full(k, np.pi), np.full(k, -np.pi)]),
    )  # fmt: skip
    size = np.abs(stress).max()
    assert abs(energy_release_rate(matter, 0.3, 0.9)) < 2e-4 * energy.max()
    assert np.abs(modes_by_interaction(matter, 0.3, 0.9, STRAIN, faces=faces)).max() < 0.01 * size
    flat = matter._replace(volume=matter.volume / tip, ring=NO_RING)
    flat_faces = faces._replace(area=faces.area / tip)
    assert abs(energy_release_rate(flat, 0.3, 0.9)) > 0.005 * energy.max()
    assert np.abs(modes_by_interaction(flat, 0.3, 0.9, STRAIN, faces=flat_faces)).max() > 0.03 * size


def test_opening_shares_energy_between_modes():
    J = 25.0 / STRAIN.modulus
    assert modes_by_opening(J, 3.0, 4.0, STRAIN) == pytest.approx((3.0, 4.0))
    assert modes_by_opening(J, 1.0, -0.0, STRAIN) == pytest.approx((5.0, 0.0))
    assert modes_by_opening(J, -1e-9, -2.0, STRAIN) == pytest.approx((0.0, -5.0))
    assert modes_by_opening(-1.0, 3.0, 4.0, STRAIN) == (0.0, 0.0)
    assert modes_by_opening(1.0, 0.0, 0.0, STRAIN) == (0.0, 0.0)
