"""Ground that starts with the stress of its weight stays at rest."""

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

HEIGHT, WEIGHT, K0 = 4.0, 2000.0 * 9.81, 3.0 / 7.0
FALL = 0.01
"""Speed [m/s]; without stress at the start the column reaches 0.45 m/s."""

WEIGHT_LOAD = "{name: weight, kind: gravity, acceleration: [0, -g]}"

MATERIALS = {
    "linear_elastic": "{kind: linear_elastic, E: 10 MPa, nu: 0.3, density: rho}",
    "neo_hookean": "{kind: neo_hookean, E: 10 MPa, nu: 0.3, density: rho}",
    "j2_plastic": "{kind: j2_plastic, E: 10 MPa, nu: 0.3, density: rho, hardening: {kind: linear, yield_stress: 1e6}}",
}


@pytest.mark.slow
@pytest.mark.parametrize("transfer", ["{kind: flip}", "{kind: fmpm, order: 4}"])
@pytest.mark.parametrize("material", list(MATERIALS))
def test_a_column_at_rest_stays_at_rest(start, material, transfer):
    """For a period of its first mode: no stress is off by more than a row of particles weighs; nothing moves."""
    sets = (f"materials.soil={MATERIALS[material]}", f"method.transfer={transfer}")
    simulation = start("geostatic_column.yaml", *sets).simulation
    particles, largest, fastest = simulation.particles, 0.0, 0.0
    exact = -WEIGHT * (HEIGHT - particles.X[1])
    J = particles.determinant()
    np.testing.assert_allclose(particles.tau[1] / J, exact, rtol=1e-10)
    np.testing.assert_allclose(particles.tau[0] / J, K0 * exact, rtol=1e-10)
    np.testing.assert_allclose(particles.mass.sum(), 2000.0 * 8.0, rtol=1e-12)
    while simulation.time < 0.4:
        simulation.step()
        off = np.abs(particles.tau[1] / particles.determinant() + WEIGHT * (HEIGHT - particles.X[1])).max()
        largest, fastest = max(largest, off), max(fastest, simulation.particle_speed)
    assert largest < WEIGHT * 0.125 * 1.1
    assert fastest < FALL


@pytest.mark.slow
def test_a_column_in_water_stays_at_rest(start):
    """Below the water table the effective stress is that of the buoyant weight; no speed differs from the dry one."""
    load = "{name: water, kind: buoyancy, level: 2.7, density: 1000}"
    simulation = start("geostatic_column.yaml", f"loads=[{WEIGHT_LOAD}, {load}]").simulation
    particles, fastest = simulation.particles, 0.0
    uplift = 1000 * 9.81 * np.maximum(2.7 - particles.X[1], 0)
    exact = uplift - WEIGHT * (HEIGHT - particles.X[1])
    np.testing.assert_allclose(particles.tau[1] / particles.determinant(), exact, rtol=1e-10)
    while simulation.time < 0.4:
        simulation.step()
        fastest = max(fastest, simulation.particle_speed)
    assert fastest < FALL


BAR = """
version: 1
analysis: {{kind: uniaxial_strain}}
grid: {{lower: [-1], upper: [11], cell: 0.1}}
materials: {{steel: {{kind: {kind}, K: 1, G: 0.75, density: 1}}}}
bodies:
  - {{name: bar, material: steel, region: {{kind: box, lower: [0], upper: [10]}}, stress: {{kind: strain, xx: 1e-4}}}}
method: {{transfer: {{kind: fmpm, order: 4}}}}
time: {{end: 10, courant: 0.5}}
"""


@pytest.mark.parametrize("kind", ["linear_elastic", pytest.param("neo_hookean", marks=pytest.mark.slow)])
def test_a_strained_bar_swings_when_it_is_free(tmp_path, kind):
    """Waves from both ends meet after L/2c, when all of the energy moves the bar; after L/c it is pressed."""
    path = tmp_path / "bar.yaml"
    path.write_text(BAR.format(kind=kind))
    simulation = Simulation(load_scene(path))  # the speed of waves is √(K + 4G/3) = √2
    particles, modulus = simulation.particles, 2.0
    half = 10.0 / (2.0 * np.sqrt(modulus))
    energy = 0.5 * modulus * 1e-4**2 * 10.0

    def strain():
        return np.log(particles.F[0])

    np.testing.assert_allclose(strain(), 1e-4, rtol=1e-9)
    stored = simulation.stress.energy_density() @ particles.vol0
    assert stored == pytest.approx(energy, rel=1e-3)
    while simulation.time < half:
        simulation.step()
    moving = 0.5 * (particles.mass * particles.V[0] ** 2).sum()
    assert moving == pytest.approx(energy, rel=0.03)
    assert np.abs(strain().mean()) < 0.03e-4
    while simulation.time < 2.0 * half:
        simulation.step()
    assert strain()[40:-40].mean() == pytest.approx(-1e-4, rel=0.02)
