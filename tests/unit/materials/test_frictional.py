"""Mohr–Coulomb and Drucker–Prager: the return against optimisation, softening, accounts, refusals; in plain Python."""

import itertools
import math

import numpy as np
import pytest
from material_point import MaterialPoint
from scipy.linalg import expm
from scipy.optimize import nnls

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import kirchhoff_stress, strain_energy
from mpmcli.materials.drucker_prager import cone_of
from mpmcli.materials.hencky import LAST, STRAIN, WORK
from mpmcli.materials.lateral import lateral_stress, shared_by_trials, stress_of_law
from mpmcli.materials.mohr_coulomb import return_principal, surface_at

E, NU = 3.0, 0.3


def make(kind="mohr_coulomb", **numbers):
    numbers = numbers if kind == "mohr_coulomb" else {"match": "outer"} | numbers
    keys = {"kind": kind, "density": 2.0, "E": E, "nu": NU, "cohesion": 0.02, "friction": 30.0}
    return MATERIALS[kind].model_validate(keys | numbers)


def surfaces(model):
    """Rows a and numbers b with a·τ ≤ b, and the flow of each: of all orders of axes, and the cut-off of each axis."""
    sine, flow = math.sin(math.radians(model.friction)), math.sin(math.radians(model.dilation))
    cohesion = model.cohesion * math.cos(math.radians(model.friction))
    rows, limits, flows = [], [], []
    for i, j in itertools.permutations(range(3), 2):
        for sines, found in ((sine, rows), (flow, flows)):
            row = np.zeros(3)
            row[i], row[j] = 1 + sines, sines - 1
            found.append(row)
        limits.append(2 * cohesion)
    if model.tension is not None:
        for axis in np.eye(3):
            rows.append(axis)
            flows.append(axis)
            limits.append(model.tension)
    return np.array(rows), np.array(limits), np.array(flows)


ELASTIC = E / (1 + NU) * np.eye(3) + E * NU / ((1 + NU) * (1 - 2 * NU)) * np.ones((3, 3))

SURFACES = [
    {},
    {"tension": 0.01},
    {"tension": 0.0},
    {"cohesion": 0.0},
    {"friction": 0.0, "tension": 0.015},
    {"friction": 0.0},
    {"friction": 45.0},
]
SETS = [
    numbers | {"dilation": part * numbers.get("friction", 30.0)}
    for numbers in SURFACES
    for part in (0, 0.3, 1)
]


@pytest.mark.parametrize("numbers", SETS, ids=str)
def test_return_is_admissible_and_flows_along_active_surfaces(numbers):
    """The plastic strain is a sum, with weights that are not negative, of the flows of surfaces that are reached."""
    model = make(**numbers)
    m = model.parameters("3d", False)
    rows, limits, flows = surfaces(model)
    apex = model.cohesion / math.tan(math.radians(model.friction)) if model.friction else math.inf
    rng = np.random.default_rng(1)
    yields = 0
    for _ in range(150):
        trial = np.sort(rng.normal(0, 0.06, 3) + rng.normal(0, 0.05))[::-1]
        tau = np.array(return_principal(m, tuple(trial), surface_at(m, 0.0)))
        assert np.all(rows @ tau - limits < 1e-15)
        assert np.all(np.diff(tau) <= 1e-16)
        drop = np.linalg.solve(ELASTIC, trial - tau)
        if not np.any(drop):
            continue
        yields += 1
        if np.allclose(tau, apex, atol=1e-14):
            # the apex has the cone of its surfaces for associated flow; for less dilation it takes what no edge takes
            assert drop.sum() > 0
            continue
        active = rows @ tau - limits > -1e-14
        _, distance = nnls(flows[active].T, drop)
        assert distance < 1e-14
    assert yields > 50


def test_no_direction_is_lost_where_principal_stresses_are_equal():
    """Trial states on the edges and at the apex, reached by deformations with equal principal stretches."""
    model = make(dilation=10.0)
    m = model.parameters("3d", False)
    for stretches in ([1.1, 1.1, 0.9], [1.1, 0.9, 0.9], [1.1, 1.1, 1.1], [0.9, 0.9, 0.9], [1.0, 1.0, 1.0]):
        H = np.zeros((9, 1))
        F = tuple(np.diag(stretches).ravel())
        tau = kirchhoff_stress(m, F, F, H, 0, 0.1, True)
        order = np.argsort(stretches, kind="stable")
        assert np.all(np.isfinite(tau))
        assert tau[3:] == (0.0, 0.0, 0.0)
        assert np.all(np.diff(np.array(tau[:3])[order]) >= -1e-16)


@pytest.mark.parametrize("kind", ["mohr_coulomb", "drucker_prager"])
def test_a_step_s_plastic_work_and_stored_energy_are_the_work_done(kind):
    """Many small steps of a shear with growing pressure; the work by the trapezoidal rule, as runs count it."""
    model = make(kind, dilation=10.0)
    m = model.parameters("3d", False)
    H, tau, work, last = np.zeros((9, 1)), np.zeros(6), 0.0, 0.0
    L = np.array([[-0.5, 1.0, 0.0], [0.0, -0.1, 0.2], [0.3, 0.0, 0.1]])
    steps, dt = 800, 1e-4
    dF = tuple(expm(L * dt).ravel())
    D = 0.5 * (L + L.T)
    for _ in range(steps):
        new = np.array(kirchhoff_stress(m, dF, dF, H, 0, dt, True))
        mean = 0.5 * (tau + new)
        full = np.array(
            [[mean[0], mean[3], mean[5]], [mean[3], mean[1], mean[4]], [mean[5], mean[4], mean[2]]]
        )
        work += dt * np.sum(full * D)
        assert H[LAST, 0] == pytest.approx(H[WORK, 0] - last, abs=1e-18)
        tau, last = new, H[WORK, 0]
    assert H[STRAIN, 0] > 0.005
    assert H[WORK, 0] > 0.05 * work
    assert strain_energy(m, dF, H, 0) + H[WORK, 0] == pytest.approx(work, rel=2e-3)


def loaded(model, L, steps=400, dt=1e-3, start=(1.0, 1.0, 1.0)):
    """Kirchhoff stress and history after many steps with one velocity gradient; ``start`` are first stretches."""
    m = model.parameters("3d", False)
    H = np.zeros((9, 1))
    F = tuple(np.diag(np.array(start, dtype=float)).ravel())
    kirchhoff_stress(m, F, F, H, 0, dt, True)
    dF = tuple(expm(np.array(L, dtype=float) * dt).ravel())
    for _ in range(steps):
        tau = kirchhoff_stress(m, dF, dF, H, 0, dt, True)
    return np.array(tau), H


def in_mohr_s_circle(x, z, cohesion, phi):
    """(x - z) over what Mohr and Coulomb allow."""
    return (x - z) / (2 * cohesion * math.cos(phi) - (x + z) * math.sin(phi))


@pytest.mark.parametrize("dilation", [0.0, 12.0, 30.0])
@pytest.mark.parametrize("match", ["outer", "inner", "plane_strain"])
def test_cones_have_the_strength_of_mohr_and_coulomb_where_they_should(match, dilation):
    model = make("drucker_prager", match=match, dilation=dilation)
    pressed, flow = (0.97, 0.97, 0.97), math.sin(math.radians(dilation))
    ways = {
        "outer": np.diag([0.5, 0.5, -1.0]),
        "inner": np.diag([1.0, -0.5, -0.5]),
        "plane_strain": np.diag([1.0 + flow, 0.0, flow - 1.0]),  # at which the elastic strain is steady
    }
    tau, _ = loaded(model, ways[match], start=pressed)
    assert tau[:3].max() < 0
    ratio = in_mohr_s_circle(tau[0], tau[2], 0.02, math.radians(30))
    assert ratio == pytest.approx(1.0, abs=1e-3 if match == "plane_strain" else 1e-12)


@pytest.mark.parametrize("numbers", [{}, {"tension": 0.01}, {"cohesion": 0.0}, {"friction": 0.0}], ids=str)
@pytest.mark.parametrize("part", [0.0, 0.4, 1.0])
def test_return_to_the_cone(numbers, part):
    """Admissible, and the plastic strain is a sum of the flows of the cone and the cut-off where they are reached."""
    model = make("drucker_prager", match="inner", **numbers)
    model = make("drucker_prager", match="inner", **numbers | {"dilation": part * model.friction})
    m = model.parameters("3d", False)
    A, a, r = cone_of(1, m.sin_friction, m.sin_dilation)
    B = r * model.cohesion * math.cos(m.friction)
    limit = min(m.tension, B / A if A else math.inf)
    K, G = model.bulk_modulus, model.shear_modulus
    rng = np.random.default_rng(2)
    yields = 0
    for _ in range(100):
        F = np.diag(np.exp(rng.normal(0, 0.02, 3) + rng.normal(0, 0.02)))
        tau = np.array(
            kirchhoff_stress(m, tuple(F.ravel()), tuple(F.ravel()), np.zeros((9, 1)), 0, 0.1, False)
        )
        e = np.log(np.diag(F))
        trial = np.array([K * e.sum(), G * math.sqrt(2 * np.sum((e - e.mean()) ** 2))])
        mean = tau[:3].mean()
        found = np.array([mean, math.sqrt(0.5 * np.sum((tau[:3] - mean) ** 2))])
        assert found[1] + A * found[0] <= B + 1e-15
        assert found[0] <= limit + 1e-15
        drop = (trial - found) / [K, G]
        assert np.all(drop >= -1e-15)
        if drop.max() > 1e-14:
            yields += 1
            cone, cut = found[1] + A * found[0] > B - 1e-14, found[0] > limit - 1e-14
            assert cone or cut
            if not cut:
                assert drop[0] == pytest.approx(a * drop[1], abs=1e-14)
            if not cone:
                assert drop[1] == pytest.approx(0, abs=1e-14)
            assert drop[0] >= a * drop[1] - 1e-14 or not cone
    assert yields > 20


def test_softening_reaches_the_residual_strength():
    model = make(
        friction=30.0, dilation=10.0, residual_cohesion=0.005, residual_friction=20.0, residual_dilation=0.0,
        softening_start=0.01, softening_end=0.05,
    )  # fmt: skip
    m = model.parameters("3d", False)
    trial = (0.1, -0.02, -0.2)
    for alpha, c, phi in (
        (0.0, 0.02, 30),
        (0.01, 0.02, 30),
        (0.03, 0.0125, 25),
        (0.05, 0.005, 20),
        (1, 0.005, 20),
    ):
        x, _, z = return_principal(m, trial, surface_at(m, alpha))
        phi = math.radians(phi)
        assert x - z == pytest.approx(2 * c * math.cos(phi) - (x + z) * math.sin(phi), rel=1e-12)


@pytest.mark.parametrize("kind", ["mohr_coulomb", "drucker_prager"])
@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"dilation": 31.0}, "the angle of dilation.*at most that of friction.*31 and 30 degrees"),
        ({"dilation": 10.0, "residual_friction": 5.0, "softening_end": 0.1}, "softened 10 and 5"),
        ({"residual_cohesion": 0.0}, "residual_cohesion needs softening_end"),
        ({"softening_end": 0.1}, "softening needs one of residual_cohesion"),
        (
            {"residual_cohesion": 0, "softening_start": 0.2, "softening_end": 0.1},
            "larger than softening_start",
        ),
        ({"friction": 90.0}, "less than 90"),
        ({"friction": "30 MPa"}, "is not an angle"),
        ({"cohesion": -1.0}, "greater than or equal to 0"),
    ],
)
def test_strengths_that_make_no_sense_are_refused(kind, numbers, words):
    with pytest.raises(ValueError, match=words):
        make(kind, **numbers)


def test_angles_may_carry_their_unit():
    assert make(friction="0.5 rad").friction == pytest.approx(math.degrees(0.5))


@pytest.mark.parametrize("both", [False, True])
@pytest.mark.parametrize("kind", ["mohr_coulomb", "drucker_prager"])
def test_trials_of_the_thickness_have_the_stress_of_the_law(plain_python, kind, both):
    """Compressed and stretched, sheared unless in a bar, so that z is the first, middle and last principal axis."""
    model = make(kind, tension=0.02, dilation=10.0)
    m, H = model.parameters("plane_stress", False), np.zeros((len(model.history), 1))
    for x, y, shear, z in itertools.product(
        (-0.05, 0.0, 0.03), (-0.04, 0.02), (0.0, 0.02), (-0.06, 0.0, 0.05)
    ):
        dF = (1 + x, shear, 0.0, 0.5 * shear, 1 + y, 0.0, 0.0, 0.0, 1.0)
        if both:
            dF = (1 + x, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
        with plain_python():
            shared = shared_by_trials(m, dF, dF, H, 0, 0.1)
            found, _ = lateral_stress(m, shared, dF, dF, H, 0, 0.1, z, both)
            wanted, _ = stress_of_law(m, None, dF, dF, H, 0, 0.1, z, both)
        assert found == pytest.approx(wanted, rel=1e-10, abs=1e-13)


@pytest.mark.parametrize("match", ["outer", "inner", "plane_strain"])
def test_the_width_of_a_bar_is_found_between_two_plateaus(plain_python, match):
    """Where cone and cut-off meet, the lateral stress does not depend on the width, on either side of the answer."""
    words = make(
        "drucker_prager", match=match, cohesion=0.03, friction=25.0, dilation=0.0, tension=0.01
    ).model_dump()
    for strain in np.linspace(0.01, 0.3, 30):
        with plain_python():
            tau = MaterialPoint("uniaxial_stress", words).step(1.0, strain)
        assert tau[0] == pytest.approx(0.03, rel=1e-9)  # three times the cut-off
        assert np.abs(tau[1:]).max() < 1e-10


@pytest.mark.parametrize("analysis", ["plane_stress", "uniaxial_stress"])
@pytest.mark.parametrize("kind", ["mohr_coulomb", "drucker_prager"])
def test_matter_without_strength_keeps_its_thickness_in_tension(plain_python, kind, analysis):
    """All thicknesses are free of stress then: the search took the largest that it tries, e²⁰ times the last one."""
    for numbers in ({"tension": 0.0}, {"cohesion": 0.0}):
        with plain_python():
            point = MaterialPoint(analysis, make(kind, **numbers).model_dump(exclude_none=True))
            for x, y in ((-0.01, 0.0), (0.03, 0.02), (-0.05, -0.01)):
                point.steps(2, 0.5, *[x, 0.0, 0.0, y][: 4 if analysis == "plane_stress" else 1])
                assert point.F[-1] == pytest.approx(1.0, abs=0.1)
