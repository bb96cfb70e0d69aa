"""The particle loop: increments, lateral conditions, energies, artificial viscosity, and what it reports."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
import scipy.linalg
from material_point import particles_of

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.exponentials import SMALL_INCREMENT, TINY_INCREMENT
from mpmcli.core.tensors import IDENTITY as UNDEFORMED
from mpmcli.materials import MATERIALS
from mpmcli.materials.strain import (
    BLOCK,
    ArtificialViscosity,
    block_count,
    stored_energy,
    update_strain_and_stress,
)

E, NU, RHO, Y = 200.0, 0.3, 2.0, 0.4
G, K = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
ELASTIC = {"kind": "linear_elastic", "density": RHO, "E": E, "nu": NU}
RUBBER = {"kind": "neo_hookean", "density": RHO, "E": E, "nu": NU}
METAL = {
    "kind": "j2_plastic",
    "density": RHO,
    "E": E,
    "nu": NU,
    "hardening": {"kind": "linear", "yield_stress": Y, "modulus": 10.0},
}


few = pytest.mark.usefixtures("python_and_compiled")


class Run:
    """Some particles of one material under velocity gradients of our choice."""

    def __init__(self, analysis, material, count=1, viscosity=None, adiabatic=False):
        self.model = MATERIALS[material["kind"]].model_validate(material)
        self.analysis = ANALYSES[analysis]()
        self.m = self.model.parameters(analysis, adiabatic)
        self.p = p = particles_of(self.model, self.analysis, count, 0.5, viscosity is not None)
        self.viscous = None
        if viscosity is not None:
            self.viscous = ArtificialViscosity(*viscosity, p.viscous_pressure, p.viscous_work)
        self.thermal = None
        self.limits = (0.0, math.inf)
        self.speed2 = np.zeros(block_count(count))
        self.bad = np.zeros(block_count(count), dtype=np.int64)

    def step(self, dt, *L, index=0, parallel=False):
        p = self.p
        for row, value in enumerate(L):
            p.L[row] = value
        update_strain_and_stress[parallel](
            self.analysis, self.m, index, p.F, p.L, p.tau, p.H, p.mass, p.vol0, p.material, p.stress_work,
            self.viscous, self.thermal, self.limits, self.speed2, self.bad, np.zeros(2), dt,
        )  # fmt: skip
        return p

    def energy(self):
        out = np.zeros(self.p.count)
        stored_energy[False](self.analysis, self.m, 0, self.p.F, self.p.H, self.p.material, self.thermal, out)
        return out

    def history(self, name):
        return self.p.H[self.model.history.index(name)]


@few
@pytest.mark.parametrize("size", [0.02, 0.5])
def test_plane_strain_increment_is_the_exponential(size):
    run = Run("plane_strain", ELASTIC, count=7)
    L = np.random.default_rng(1).uniform(-size, size, (4, 7))
    run.p.L[:] = L
    run.step(1.0)
    run.step(1.0)
    for i in range(7):
        expected = scipy.linalg.expm(2 * L[:, i].reshape(2, 2))
        assert np.allclose(run.p.F[:4, i], expected.ravel(), rtol=0, atol=1e-15 * 5)
    assert np.all(run.p.F[4] == 1)


@few
@pytest.mark.parametrize("size", [1e-4, TINY_INCREMENT, 0.003, SMALL_INCREMENT, 0.06, 0.5])
def test_3d_increment_is_the_exponential(size):
    """Round-off up to the last member that each series is for, and beyond; with the largest norm that members allow."""
    run = Run("3d", ELASTIC, count=7)
    rng = np.random.default_rng(2)
    rate = rng.uniform(-size, size, (9, 7)) / 0.125
    rate[:, 0], rate[:, 1] = size / 0.125, -size / 0.125
    start = np.array(UNDEFORMED)[:, None] + rng.uniform(-0.1, 0.1, (9, 7))
    run.p.L[:], run.p.F[:] = rate, start
    run.step(0.125)
    for i in range(7):
        growth = scipy.linalg.expm(0.125 * rate[:, i].reshape(3, 3))
        expected = growth @ start[:, i].reshape(3, 3)
        error = np.abs(run.p.F[:, i] - expected.ravel()).max()
        assert error <= (1e-15 if size <= SMALL_INCREMENT else 2e-14) * np.linalg.norm(growth)


@few
@pytest.mark.parametrize("size", [0.02, 0.5])
def test_hoop_strain_of_axisymmetric_analysis(size):
    p = Run("axisymmetric", ELASTIC).step(1.0, 0, 0, 0, 0, size)
    assert p.F[4, 0] == pytest.approx(math.exp(size), rel=1e-15)
    lame = K - 2 * G / 3
    assert p.tau[:, 0] == pytest.approx([lame * size, lame * size, (lame + 2 * G) * size, 0], rel=1e-12)


@few
@pytest.mark.parametrize("strain", [-0.2, 1e-6, 0.3])
def test_uniaxial_stress_follows_youngs_modulus(strain):
    p = Run("uniaxial_stress", ELASTIC).step(1.0, strain)
    assert p.tau[:, 0] == pytest.approx([E * strain, 0, 0], rel=1e-12, abs=1e-13)
    assert p.F[1:, 0] == pytest.approx(math.exp(-NU * strain), rel=1e-14)


@few
@pytest.mark.parametrize("material", [RUBBER, METAL, RUBBER | {"split": "isochoric", "volumetric": "log"}])
def test_plane_stress_and_uniaxial_stress_start_with_youngs_modulus(material):
    e = 1e-7
    biaxial = [E * e / (1 - NU**2), NU * E * e / (1 - NU**2), 0]
    plane = Run("plane_stress", material).step(1.0, e, 0, 0, 0)
    assert plane.tau[:3, 0] == pytest.approx(biaxial, rel=1e-5, abs=1e-12 * E)
    bar = Run("uniaxial_stress", material).step(1.0, e)
    assert bar.tau[:, 0] == pytest.approx([E * e, 0, 0], rel=1e-5, abs=1e-12 * E)


@few
def test_plane_stress_of_rubber_has_a_closed_form():
    lame = K - 2 * G / 3
    run = Run("plane_stress", RUBBER)
    for _ in range(10):
        run.step(0.1, 0.3, 0.2, 0.0, 0.1)
    area = math.exp(0.4)
    thickness2 = (0.5 * lame + G) / (0.5 * lame * area**2 + G)
    assert run.p.F[4, 0] == pytest.approx(math.sqrt(thickness2), rel=1e-12)
    assert abs(run.p.tau[2, 0]) < 1e-12 * E


@few
def test_plastic_bar_follows_its_hardening_line():
    run = Run("uniaxial_stress", METAL)
    total, modulus = 0.05, 10.0
    for _ in range(20):
        run.step(0.05, total)
        assert np.abs(run.p.tau[1:, 0]).max() < 1e-11
    # total = Y/E + (τ - Y)/E + α, τ = Y + Hα
    alpha = (total - Y / E) / (1 + modulus / E)
    assert run.p.tau[0, 0] == pytest.approx(Y + modulus * alpha, rel=1e-11)
    assert run.history("equivalent_plastic_strain")[0] == pytest.approx(alpha, rel=1e-10)
    assert run.history("plastic_work")[0] == pytest.approx(Y * alpha + modulus * alpha**2 / 2, rel=1e-10)


@few
def test_plastic_bar_in_uniaxial_strain_yields_at_the_hugoniot_elastic_limit():
    run = Run("uniaxial_strain", METAL | {"hardening": {"kind": "linear", "yield_stress": Y}})
    limit = Y * (1 - NU) / (1 - 2 * NU)
    strain = limit / (K + 4 * G / 3)
    run.step(1.0, -strain)
    assert run.p.tau[0, 0] == pytest.approx(-limit, rel=1e-12)
    assert run.history("equivalent_plastic_strain")[0] == pytest.approx(0, abs=1e-15)
    run.step(1.0, -9 * strain)
    # beyond it the slope is that of the bulk modulus, and the stress difference stays Y
    assert run.p.tau[0, 0] == pytest.approx(-10 * K * strain - 2 * Y / 3, rel=1e-12)
    assert run.p.tau[1, 0] - run.p.tau[0, 0] == pytest.approx(Y, rel=1e-12)
    run.step(1.0, strain)
    assert run.p.tau[0, 0] == pytest.approx(-9 * K * strain - 2 * Y / 3 + 4 * G / 3 * strain, rel=1e-12)


@few
def test_plastic_flow_keeps_volume_and_energy_balances():
    run = Run("plane_strain", METAL)
    n = 400
    for _ in range(n):
        run.step(1.0 / n, 0.05, 0.3, -0.1, -0.05)
    J = run.p.determinant()[0]
    assert run.p.tau[:3, 0].sum() / 3 == pytest.approx(K * math.log(J), abs=1e-10)
    spent = run.history("plastic_work")[0] + run.energy()[0]
    assert run.p.stress_work[0] / 0.5 == pytest.approx(spent, rel=1e-3)


@few
@pytest.mark.parametrize("name", ["plane_strain", "plane_stress", "axisymmetric", "3d", "uniaxial_strain"])
def test_stress_work_is_the_stored_energy_of_rubber(name):
    run = Run(name, RUBBER)
    rows = run.p.L.shape[0]
    L = [0.2, 0.1, -0.1, 0.05, 0.1, 0.0, 0.1, -0.1, 0.1][:rows]
    n = 200
    for _ in range(n):
        run.step(1.0 / n, *L)
    assert run.p.stress_work[0] == pytest.approx(0.5 * run.energy()[0], rel=2e-5)


@few
def test_simple_shear_of_neo_hookean():
    gamma = 0.6
    run = Run("plane_strain", RUBBER)
    for _ in range(6):
        run.step(0.1, 0, 1.0, 0, 0)
    assert run.p.tau[:, 0] == pytest.approx([G * gamma**2, 0, 0, G * gamma], rel=1e-13, abs=1e-12)


@few
def test_artificial_viscosity_is_equation_52_and_acts_in_compression_only():
    rate, cell, dt = 0.3, 0.25, 0.01
    run = Run("plane_strain", ELASTIC, viscosity=(0.4, 4.0, cell))
    run.step(dt, -rate, 0, 0, 0)
    J = math.exp(-rate * dt)
    q = RHO / J * cell * rate * (0.4 * math.sqrt(K / RHO) + 4.0 * cell * rate)
    assert run.p.viscous_pressure[0] == pytest.approx(q, rel=1e-13)
    plain = Run("plane_strain", ELASTIC)
    plain.step(dt, -rate, 0, 0, 0)
    assert run.p.tau[:3, 0] == pytest.approx(plain.p.tau[:3, 0] - J * q, rel=1e-12)
    first = 0.5 * J * q * rate * dt * 0.5
    assert run.p.viscous_work[0] == pytest.approx(first, rel=1e-13)
    assert run.p.stress_work[0] == pytest.approx(plain.p.stress_work[0] + first, rel=1e-12)
    run.step(dt, rate, 0, 0, 0)
    assert run.p.viscous_pressure[0] == 0
    assert run.p.viscous_work[0] == pytest.approx(0, abs=1e-16)
    assert run.p.tau[:, 0] == pytest.approx([0, 0, 0, 0], abs=1e-12)


@few
def test_artificial_viscosity_leaves_free_surfaces_free():
    run = Run("plane_stress", ELASTIC, viscosity=(0.4, 4.0, 0.25))
    run.step(0.01, -0.3, 0, 0, -0.3)
    assert run.p.viscous_pressure[0] > 0
    assert abs(run.p.tau[2, 0]) < 1e-12


def test_other_materials_are_left_alone():
    run = Run("plane_strain", ELASTIC, count=3 * BLOCK)
    run.p.material[:] = np.random.default_rng(5).integers(0, 3, run.p.count)
    run.p.material[BLOCK : 2 * BLOCK] = 2
    run.step(0.1, 0.2, 0.1, 0, 0, index=1)
    mine = run.p.material == 1
    assert np.all(run.p.F[0, ~mine] == 1)
    assert np.all(run.p.tau[0, ~mine] == 0)
    assert np.ptp(run.p.tau[0, mine]) < 1e-14
    assert run.p.tau[0, mine][0] != 0
    assert run.speed2[1] == 0
    assert run.speed2[0] == pytest.approx((K + 4 * G / 3) / RHO, rel=1e-14)
    assert run.bad.tolist() == [-1, -1, -1]


@pytest.mark.parametrize("poison", [math.nan, math.inf, -math.inf, 1e300])
@pytest.mark.parametrize("material", [ELASTIC, RUBBER])
def test_a_particle_that_is_not_finite_is_found(poison, material):
    run = Run("plane_strain", material, count=2 * BLOCK + 10)
    run.p.L[:] = 0.01
    run.p.L[2, BLOCK + 17] = poison
    run.step(0.1)
    assert run.bad.tolist() == [-1, BLOCK + 17, -1]


def test_poison_in_the_state_is_found():
    for field, row in (("F", 3), ("F", 4)):
        run = Run("plane_strain", RUBBER, count=10)
        getattr(run.p, field)[row, 6] = math.nan
        run.step(0.1)
        assert run.bad.tolist() == [6]
    run = Run("plane_strain", RUBBER, count=10)
    run.p.F[0, 4] = -0.5
    run.step(0.1)
    assert run.bad.tolist() == [4]


def test_serial_and_parallel_give_the_same_bits():
    results = []
    for parallel in (False, True):
        run = Run("plane_strain", RUBBER, count=5 * BLOCK + 3)
        run.p.L[:] = np.random.default_rng(9).normal(size=run.p.L.shape)
        for dt in (0.01, 0.3):
            run.step(dt, parallel=parallel)
        results.append([run.p.F, run.p.tau, run.p.stress_work, run.speed2])
    for serial, threads in zip(*results, strict=True):
        assert np.array_equal(serial, threads)


@few
def test_a_step_of_no_time_sets_the_initial_stress():
    run = Run("plane_strain", {"kind": "ideal_gas", "density": RHO, "pressure": 3.0})
    run.step(0.0, 0, 0, 0, 0)
    assert run.p.tau[:, 0] == pytest.approx([-3, -3, -3, 0])
    assert run.p.stress_work[0] == 0


SCRIPT = """
import re
import yaml
from mpmcli.materials.strain import update_strain_and_stress
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

scene = {
    "version": 1,
    "analysis": {"kind": "3d"},
    "grid": {"lower": [0, 0, 0], "upper": [10, 10, 10], "cell": 1},
    "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
    "materials": {"rubber": {"kind": "neo_hookean", "density": 1, "E": 1000, "nu": 0.3}},
    "bodies": [{"name": "block", "material": "rubber",
                "region": {"kind": "box", "lower": [1, 1, 1], "upper": [9, 9, 9]}}],
    "time": {"end": 1, "courant": 0.2},
}
Simulation(load_scene(yaml.safe_dump(scene)), threads=2).step()
(code,) = update_strain_and_stress[True].inspect_llvm().values()
print(len(re.findall(r"fdiv[^\\n]*<\\d+ x double>", code)))
"""


@pytest.mark.slow
def test_stresses_of_several_particles_are_computed_at_once(tmp_path):
    """The compiler divides numbers of several particles by J in one instruction; small changes of the loop undo it."""
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | {
        "MPMCLI_CACHE_DIR": str(tmp_path)
    }
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 0
