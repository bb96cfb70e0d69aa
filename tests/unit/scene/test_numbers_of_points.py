"""Numbers of materials that particles have from columns of their file of points."""

import json
import re
from pathlib import Path

import examples
import numpy as np
import pytest
import yaml

from mpmcli.core import rows
from mpmcli.core.errors import SceneError
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import KINDS, history_at_start
from mpmcli.materials.initial_stress import find_stretches
from mpmcli.scene.loader import load_scene
from mpmcli.scene.own_numbers import (
    can_differ,
    materials_of,
    number_keys,
    numbers_of_columns,
    row_of,
    set_own_numbers,
    with_numbers,
)
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.bodies import largest_wave_speed

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [4, 4], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  m: MATERIAL
bodies:
  - {name: b, material: m, region: {kind: points, file: p.csv}, STRESS velocity: ["0.02*x", "-0.01*y"]}
  - {name: c, material: m, region: {kind: box, lower: [3, 3], upper: [4, 4]}, velocity: ["0.02*x", "-0.01*y"]}
time: {end: 0.1, courant: 0.2}
"""
NEO = "{kind: neo_hookean, E: 10, nu: 0.3, density: 1}"
J2 = "{kind: j2_plastic, E: 10, nu: 0.3, density: 1, hardening: {kind: linear, yield_stress: 0.01, modulus: 1}}"
COULOMB = "{kind: mohr_coulomb, E: 10, nu: 0.3, density: 1, cohesion: 0.02, friction: 30}"
PRAGER = "{kind: drucker_prager, match: inner, E: 10, nu: 0.3, density: 1, cohesion: 0.02, friction: 30}"
RUBBER = "{kind: mooney_rivlin, K: 10, G1: 2, G2: 1, density: 1}"
HENCKY = "{kind: linear_elastic, E: 10, nu: 0.3, density: 1}"
SNOW = "{kind: clamped_neo_hookean, E: 10, nu: 0.2, density: 1, extension: 0.0005}"
CLAY = "{kind: modified_cam_clay, M: 1.2, lambda: 0.2, kappa: 0.04, nu: 0.3, e0: 1, p0: 1, density: 1}"
GRAINS = (
    "{kind: granular, E: 10, nu: 0.3, density: 1, mu_s: 0.4, mu_2: 0.6, I0: 0.3, grain_diameter: 1, "
    "grain_density: 2, critical_density: 1}"
)
WOOD = (
    "{kind: transversely_isotropic, axis: x, E_axial: 10, E_transverse: 2, nu_axial: 0.3, nu_transverse: 0.3, "
    "G_axial: 1, density: 1}"
)
FLUID = "{kind: tait_fluid, K: 10, viscosity: 0.1, density: 1}"
MUD = "{kind: bingham, K: 10, viscosity: 0.1, yield_stress: 0.005, density: 1}"
BRITTLE = "{kind: isotropic_softening, E: 10, nu: 0.3, strength: 0.005, toughness: 0.1, density: 1}"
MAXWELL = "{kind: viscoelastic, G: 2, K: 10, terms: [{time: 0.1, G: 1}, {time: 0.02, K: 4}], density: 1}"
SHEET = (
    "{kind: hill_plastic, E1: 10, E2: 5, E3: 4, G12: 3, G13: 2, G23: 1, nu12: 0.3, nu13: 0.3, nu23: 0.3, density: 1, "
    "anisotropy: {kind: r_values, r0: 0.7, r45: 1.4, r90: 2}, hardening: {kind: swift, yield_stress: 0.005, eps0: 0.1, "
    "n: 0.2}}"
)
GAS = "{kind: ideal_gas, pressure: 1, density: 1}"
PLACES = ("0.25,0.25,0.25", "0.75,0.25,0.25", "0.25,0.75,0.25")


@pytest.fixture
def loaded(tmp_path):
    """Function that reads the scene with a material and rows of further columns."""

    def load(material, names="", rows=("", "", ""), extra="", stress=""):
        heading = f"x,y,volume{',' * bool(names)}{names}"
        points = [f"{place}{',' * bool(row)}{row}" for place, row in zip(PLACES, rows, strict=True)]
        (tmp_path / "p.csv").write_text("\n".join([heading, *points]) + "\n")
        (tmp_path / "scene.yaml").write_text(
            SCENE.replace("MATERIAL", material).replace("STRESS", stress) + extra
        )
        return load_scene(tmp_path / "scene.yaml")

    return load


@pytest.fixture
def in_python(plain_python):
    """Nothing is compiled."""
    with plain_python():
        yield


def state_after(loaded, steps=3):
    """Stresses and energies by identity after some steps of given length."""
    simulation = Simulation(loaded)
    p = simulation.particles
    p.L[:] = np.array([[0.3, 0.1, 0.0, -0.4]]).T
    for _ in range(steps):
        simulation.stress.update(p.L, 0.01)
    order = np.argsort(p.id)
    return p.tau[:, order], simulation.stress.energy_density()[order], simulation.wave_speed


@pytest.mark.parametrize(
    ("material", "column", "values"),
    [
        (NEO, "E", (10, 40, 25)),
        (NEO, "nu", (0.3, 0.1, 0.45)),
        (NEO.replace("0.3,", "0.3, split: isochoric, volumetric: log,"), "E", (10, 40, 25)),
        (HENCKY, "E", (10, 40, 25)),
        (RUBBER, "G1", (2, 3, 1)),
        (SNOW, "hardening", (10, 5, 1)),
        (J2, "E", (10, 40, 25)),
        (J2, "hardening.yield_stress", (0.01, 0.005, 0.1)),
        (COULOMB, "cohesion", (0.02, 0.0, 0.1)),
        (COULOMB, "tension", (0.02, 0.0, 0.01)),
        (PRAGER, "friction", (30, 20, 40)),
        (CLAY, "p0", (1, 0.5, 0.2)),
        (CLAY, "lambda", (0.2, 0.1, 0.3)),
        (GRAINS, "critical_density", (1, 1.01, 1.002)),
        (GRAINS, "mu_s", (0.4, 0.1, 0.2)),
        (WOOD, "E_axial", (10, 5, 20)),
        (FLUID, "K", (10, 20, 5)),
        (FLUID, "viscosity", (0.1, 0, 0.3)),
        (MUD, "yield_stress", (0.005, 0.02, 0.001)),
        (BRITTLE, "strength", (0.005, 0.004, 1)),
        (BRITTLE.replace("0.1,", "0.1, softening: exponential,"), "toughness", (0.1, 0.05, 1)),
        (MAXWELL, "terms.0.time", (0.1, 0.01, 1)),
        (MAXWELL, "terms.1.K", (4, 1, 7)),
        (SHEET, "E1", (10, 15, 7)),
        (SHEET, "hardening.yield_stress", (0.005, 0.01, 1)),
        (SHEET, "anisotropy.r90", (2, 1, 0.7)),
    ],
    ids=lambda value: value.split(",")[0][7:] if isinstance(value, str) and "{" in value else None,
)
def test_each_particle_is_of_its_own_material(loaded, in_python, material, column, values):
    """Stress and energy of a particle are those of a scene whose material has its number."""
    tau, energy, _ = state_after(loaded(material, column, [str(value) for value in values]))
    alone = []
    *parts, last = column.split(".")
    for value in values:
        model = yaml.safe_load(material)
        inner = model
        for part in parts:
            inner = inner[int(part) if part.isdecimal() else part]
        inner[last] = value
        alone.append(state_after(loaded(json.dumps(model))))
    for k, (tau_k, energy_k, _) in enumerate(alone):
        assert np.array_equal(tau[:, k], tau_k[:, k])
        assert energy[k] == energy_k[k]
        assert k == 0 or tau[0, k] != tau[0, 0]
    assert np.array_equal(tau[:, 3:], state_after(loaded(material))[0][:, 3:])


SEVERAL = [
    pytest.param(kind, keys, id=f"{kind}-{i}")
    for kind, several in examples.MATERIALS.items()
    for i, keys in enumerate(several)
    if kind not in ("rigid", "ideal_gas", "mie_gruneisen")
]
SOLVED = ("hill_plastic", "orthotropic", "transversely_isotropic")
"""Kinds of which each different row is evaluated alone."""


@pytest.mark.parametrize(("kind", "keys"), SEVERAL)
def test_all_rows_at_once_have_the_digits_of_each_model(monkeypatch, kind, keys):
    """All numbers of a law vary by some percent; some laws choose by them."""
    material = MATERIALS[kind].model_validate(examples.material(kind, keys))
    random = np.random.default_rng(5)
    columns = {}
    for key in (*number_keys(material), "density"):
        value = material
        for part in key.split("."):
            value = (
                value[int(part)] if part.isdecimal() else getattr(value, part.replace("lambda", "lambda_"))
            )
        if value is not None:
            less = 0.96 if key == "mu_s" else 1.0  # which is at most mu_2
            columns[key] = less * float(value) * (1 + 0.02 * random.random(12))
    if kind not in SOLVED:
        monkeypatch.setattr(rows, "_by_different_rows", None)
    for analysis in sorted(material.analyses):
        found = numbers_of_columns(material, columns, analysis)
        for row in range(12):
            model = with_numbers(material, row_of(columns, row))
            assert np.array_equal(found.table[:, row], model.parameters(analysis, False))
            assert found.speed[row] == model.initial_wave_speed(analysis)
            assert {name: start[row] for name, start in found.history.items()} == model.initial_history()


def test_rows_that_choose_differently_are_evaluated_apart():
    def formula(numbers):
        a, b = numbers["a"], numbers["b"]
        return (max(a, b), b / a if a > 1 else 0.0, rows.sqrt(abs(a - b)) ** 2, 7.0)

    columns = {"a": np.array([1.0, 2.0, 3.0, 0.0]), "b": np.array([2.0, 1.0, 3.0, 0.5])}
    found = rows.by_rows(formula, columns)
    for row in range(4):
        assert np.array_equal(found[:, row], formula(row_of(columns, row)))


@pytest.mark.parametrize(
    "formula",
    [
        lambda numbers: (1 / (numbers["a"] - 2),),
        lambda numbers: (1.0 if numbers["a"] != 2 else rows.log(2 - numbers["a"]),),
        lambda numbers: (1.0 if numbers["a"] != 2 else numbers["a"] ** 5000,),
    ],
)
def test_the_row_that_cannot_be_calculated_is_named(formula):
    with pytest.raises(rows.RowError) as error:
        rows.by_rows(formula, {"a": np.array([3.0, 1e-3, 2.0])})
    assert error.value.row == 2


def test_the_stiffest_particle_gives_the_time_step(loaded, in_python):
    plain = loaded(NEO)
    stiff = loaded(NEO, "E", ("10", "1000", "10"))
    assert largest_wave_speed(stiff.scene) == pytest.approx(10 * largest_wave_speed(plain.scene))
    simulation, other = Simulation(stiff), Simulation(plain)
    assert simulation.wave_speed == pytest.approx(10 * other.wave_speed)
    simulation.step()
    other.step()
    assert simulation.last_step.dt == pytest.approx(0.1 * other.last_step.dt)
    assert simulation.wave_speed == pytest.approx(10 * other.wave_speed, rel=1e-3)


def test_own_density_and_modulus_of_a_particle_belong_together(loaded, in_python):
    both = loaded(NEO, "E,density", ("1000,1000", "10,1", "40,1"))
    plain = loaded(NEO)
    assert largest_wave_speed(both.scene) == pytest.approx(2 * largest_wave_speed(plain.scene))
    assert Simulation(both).wave_speed == pytest.approx(2 * Simulation(plain).wave_speed)
    assert Simulation(both).particles.mass.max() == 250.0


def test_numbers_move_with_particles_and_are_not_shown(loaded, in_python):
    moving = loaded(NEO, "E", ("10", "40", "25"))
    simulation = Simulation(moving)
    p = simulation.particles
    row = materials_of(moving.scene)[0].history.index("own_shear")
    before = p.H[row, np.argsort(p.id)]
    assert before[:3] == pytest.approx(np.array([10, 40, 25]) / 2.6)
    for _ in range(3):
        simulation.step()
    assert np.array_equal(p.H[row, np.argsort(p.id)], before)
    assert simulation.state.material_models[0].history == ()


def test_equal_numbers_are_those_of_the_material(loaded):
    """Compiled: the state is that without the column, to the last digit."""
    plain, given = Simulation(loaded(NEO)), Simulation(loaded(NEO, "E", ("10",) * 3))
    for _ in range(5):
        plain.step()
        given.step()
    assert np.array_equal(plain.particles.V, given.particles.V)
    assert np.array_equal(plain.particles.tau, given.particles.tau)


@pytest.mark.parametrize(
    ("material", "names", "row", "words"),
    [
        (NEO, "E", "-3", "'p.csv', line 3, column 'E': "),
        (NEO, "nu", "nan", "'p.csv', line 3, column 'nu': "),
        (NEO, "G", "3", "give one pair of elastic constants"),
        (
            NEO,
            "expansion",
            "3",
            "column 'expansion' cannot differ from particle to particle, in 'neo_hookean' only",
        ),
        (COULOMB, "dilation", "35", "the angle of dilation"),
        (NEO, "E", "1e200", "too large or too small"),
        (J2, "hardening.modulus", "-1", "'p.csv', line 3, column 'hardening.modulus': "),
        (MAXWELL, "terms.1.K", "-1", "'p.csv', line 3, column 'terms.1.K': "),
        (
            CLAY,
            "kappa",
            "0.3",
            "'p.csv', line 3, column 'kappa': kappa must be less than lambda, given: 0.3 and 0.2",
        ),
        (GAS, "gamma", "1.5", "because 'ideal_gas' is an equation of state, which has one set of numbers"),
    ],
)
def test_rows_that_make_no_material_are_named(loaded, material, names, row, words):
    start = {"E": "10", "nu": "0.3", "G": "4", "dilation": "0", "kappa": "0.1"}.get(names, "1.1")
    with pytest.raises(SceneError) as error:
        loaded(material, names, (start, row, start))
    assert any(words in problem.message for problem in error.value.problems), error.value.problems


def test_heat_needs_one_material(loaded):
    heat = "heat: {}\n"
    with pytest.raises(SceneError, match="heat needs one set of numbers of the material"):
        loaded(
            NEO.replace("density", "heat_capacity: 1, conductivity: 1, density"),
            "E",
            ("10", "20", "30"),
            heat,
        )


def test_stress_at_the_start_is_that_of_the_own_moduli(loaded):
    """Particles of 1 to 40 times the stiffness have the same stress; the stretch that gives it differs."""
    scene = loaded(NEO, "E", ("10", "400", "25"), stress="stress: {kind: components, yy: -0.1},").scene
    body, model = scene.bodies[0], materials_of(scene)[0]
    X = body.region.particles(2)[0]
    H = history_at_start(model, 3)
    set_own_numbers(scene, model, body, X, H)
    m = model.parameters("plane_strain", False)
    stress = np.zeros((6, 3))
    stress[1] = -0.1
    stretch, missed = find_stretches(m, H, stress, False, None)
    assert missed == pytest.approx(0.0, abs=1e-11)
    assert 1 - stretch[1, 0] == pytest.approx(40 * (1 - stretch[1, 1]), rel=0.03)


def test_runs_go_on_with_the_numbers(loaded, in_python):
    """A simulation that takes over the state of another one continues it to the last digit."""
    scene = loaded(J2, "hardening.yield_stress,E", ("0.01,10", "0.002,40", "0.1,25"))
    first, second = Simulation(scene), Simulation(scene)
    for _ in range(3):
        first.step()
    second.particles.H[:] = 0.0
    second.restore({name: np.copy(array) for name, array in first.state_arrays().items()})
    for _ in range(3):
        first.step()
        second.step()
    assert np.array_equal(first.particles.tau, second.particles.tau)
    assert first.wave_speed == second.wave_speed


BAR = """
version: 1
analysis: {kind: uniaxial_strain}
grid: {lower: [-2], upper: [10], cell: 1}
method: {shape: ugimp, transfer: {kind: fmpm, order: 2}}
materials:
  m: {kind: linear_elastic, E: 10, nu: 0.2, density: 1}
  hard: {kind: linear_elastic, E: 40, nu: 0.2, density: 2}
bodies:
BODIES
time: {end: 5, courant: 0.2}
"""


def test_a_bar_of_two_layers_is_one_body_or_two(tmp_path, in_python):
    """Moduli and densities by column give the motion of two bodies with a material each."""
    places = [(0.25 + 0.5 * k, 10 if k < 8 else 40, 1 if k < 8 else 2) for k in range(16)]
    rows = [f"{x},0.5,{E},{rho}" for x, E, rho in places]
    (tmp_path / "p.csv").write_text("\n".join(["x,volume,E,density", *rows]) + "\n")
    one = ['{name: bar, material: m, region: {kind: points, file: p.csv}, velocity: ["0.05*x"]}']
    two = [
        '{name: a, material: m, region: {kind: box, lower: [0], upper: [4]}, velocity: ["0.05*x"]}',
        '{name: b, material: hard, region: {kind: box, lower: [4], upper: [8]}, velocity: ["0.05*x"]}',
    ]
    simulations = []
    for bodies in (one, two):
        (tmp_path / "scene.yaml").write_text(
            BAR.replace("BODIES", "\n".join(f"  - {body}" for body in bodies))
        )
        simulations.append(Simulation(load_scene(tmp_path / "scene.yaml")))
    for simulation in simulations:
        while simulation.time < 3.0:
            simulation.step()
    first, second = ([s.particles.X[0, np.argsort(s.particles.id)], s.time] for s in simulations)
    assert first[1] == pytest.approx(second[1])
    assert first[0] == pytest.approx(second[0], abs=1e-12)
    assert np.ptp(first[0] - [x for x, _, _ in places]) > 0.1


def test_the_laws_with_own_numbers_are_those_of_the_theory_page():
    """Every kind of material says the same as the documentation: all but some."""
    page = (Path(__file__).parents[3] / "docs" / "theory" / "soils.md").read_text(encoding="utf-8")
    words = page.partition("All laws allow this except ")[2].partition("It needs a scene")[0]
    named = set(re.findall(r"`(\w+)`", words))
    found = set()
    for kind, several in examples.MATERIALS.items():
        model = MATERIALS[kind].model_validate(examples.material(kind, several[0]))
        if kind != "rigid" and not can_differ(model, min(model.analyses)):
            found.add(kind)
    assert found == named == {"ideal_gas", "mie_gruneisen"}
    assert set(examples.MATERIALS) >= set(KINDS) - {"rigid"}
