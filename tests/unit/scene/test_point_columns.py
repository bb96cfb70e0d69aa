"""Columns of files of points: densities of particles, and columns that nothing reads."""

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.bodies import largest_wave_speed

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [4, 4], cell: 0.5}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1.0e+7, nu: 0.3, density: 2000}
bodies:
  - {name: b, material: m, region: {kind: points, file: p.csv}}
  - {name: c, material: m, region: {kind: box, lower: [2, 2], upper: [3, 3]}}
loads: [{name: w, kind: gravity, acceleration: [0, -10]}]
time: {end: 0.01, courant: 0.2}
"""


@pytest.fixture
def loaded(tmp_path):
    """Function that reads the scene with a file of points."""

    def load(points):
        (tmp_path / "p.csv").write_text(points)
        (tmp_path / "scene.yaml").write_text(SCENE)
        return load_scene(tmp_path / "scene.yaml")

    return load


def warnings_with(loaded, columns):
    row = ",".join(["1.25,0.25,0.25", *("1" for _ in columns.split(","))])
    scene = loaded(f"# made by hand\nx,y,volume,{columns}\n{row}\n")
    return [(each.path, each.message) for each in scene.warnings]


def test_columns_that_nothing_reads_are_named(loaded):
    [(path, words)] = warnings_with(loaded, "desnity,temprature")
    assert path == "bodies.b.region.file"
    assert words == (
        "'p.csv', line 2: nothing reads columns 'desnity', 'temprature'; did you mean 'density'?"
    )
    [(_, words)] = warnings_with(loaded, "stress_yy")
    assert "nothing reads column 'stress_yy'; give the body 'stress: {kind: points}'" in words
    assert warnings_with(loaded, "density") == []


def test_particles_have_the_densities_of_their_file(loaded):
    given = loaded("x,y,volume,density\n1.25,0.25,0.25,500\n1.75,0.25,0.25,2000\n")
    simulation = Simulation(given)
    p = simulation.particles
    order = np.argsort(p.id)
    assert p.mass[order][:2].tolist() == [125.0, 500.0]
    assert p.mass[order][2:] == pytest.approx(2000 * 0.0625)
    line = next(line for line in simulation.setup_report.splitlines() if line.startswith("b "))
    assert " 625 " in line
    assert "[1.65, 0.25]" in line


def test_the_time_step_is_that_of_the_lightest_particle(loaded):
    plain = loaded("x,y,volume\n1.25,0.25,0.25\n1.75,0.25,0.25\n")
    light = loaded("x,y,volume,density\n1.25,0.25,0.25,500\n1.75,0.25,0.25,2000\n")
    assert largest_wave_speed(light.scene) == pytest.approx(2 * largest_wave_speed(plain.scene))
    simulation, other = Simulation(light), Simulation(plain)
    for _ in range(2):
        simulation.step()
        other.step()
        assert simulation.wave_speed == pytest.approx(2 * other.wave_speed)
        assert simulation.last_step.dt == pytest.approx(0.5 * other.last_step.dt)


def test_equal_densities_are_those_of_the_material(loaded):
    plain = Simulation(loaded("x,y,volume\n1.25,0.25,0.25\n1.75,0.25,0.25\n"))
    given = Simulation(loaded("x,y,volume,density\n1.25,0.25,0.25,2000\n1.75,0.25,0.25,2000\n"))
    for _ in range(5):
        plain.step()
        given.step()
    assert np.array_equal(plain.particles.V, given.particles.V)
