"""Words of heat loads: units, and what is refused."""

import pytest

from mpmcli.core.errors import SceneError
from mpmcli.scene.loader import load_scene

SCENE = """
version: 1
{units}
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [8, 8], cell: 1}}
heat: {{}}
materials:
  rock: {{kind: linear_elastic, density: 1, E: 1, nu: 0.3, heat_capacity: 1, conductivity: 1}}
bodies:
  - {{name: block, material: rock, region: {{kind: box, lower: [2, 2], upper: [4, 4]}}}}
loads:
  - {{name: load, on: {{body: block{face}}}, {keys}}}
time: {{end: 1, step: 0.01}}
"""
FACE = ", face: {axis: x, side: upper}"
SI, MILLI = (
    "units: {length: m, mass: kg, time: s}",
    "units: {length: mm, mass: g, time: ms, temperature: mK}",
)


def load(keys, units=SI, face=FACE):
    return load_scene(SCENE.format(units=units, keys=keys, face=face)).scene.loads[0]


def test_the_constant_of_radiation_is_in_the_units_of_the_scene():
    keys = "kind: radiation, emissivity: 0.8, around: 4 K"
    assert load(keys).stefan_boltzmann == 5.670374419e-8
    assert load(keys, MILLI).stefan_boltzmann == pytest.approx(5.670374419e-8 * 1e-6 * 1e-12, rel=1e-15)
    assert load(f"{keys}, stefan_boltzmann: 2").stefan_boltzmann == 2.0
    plain = "kind: radiation, emissivity: 0.8, around: 4, stefan_boltzmann: 2"
    assert load(plain, "").stefan_boltzmann == 2.0


def test_without_units_radiation_needs_its_constant():
    with pytest.raises(SceneError, match=r"loads\.load +the Stefan.*needs units.*; or give stefan_boltzmann"):
        load("kind: radiation, emissivity: 0.8, around: 4", "")


@pytest.mark.parametrize(
    ("keys", "of", "value"),
    [
        ("kind: heat_flux, flux: 5 kW/m^2", "flux", 5000.0),
        ("kind: film, coefficient: 2 W/(m^2 K), around: 20 degC", "coefficient", 2.0),
        ("kind: film, coefficient: 2 W/(m^2 K), around: 20 degC", "around", 293.15),
        ("kind: heat_source, power: 5 mW/mm^3", "power", 5e6),
        ("kind: heat_source, power: 5 W/g, per: mass", "power", 5000.0),
        ("kind: heat_source, per: total, power: 2 kW", "power", 2000.0),
    ],
)
def test_values_with_units(keys, of, value):
    made = load(keys, face="" if "source" in keys else FACE)
    assert getattr(made, of)() == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("kind: heat_flux, flux: 5 W", r"flux.*'5 W' has the wrong dimension: heat_flux is needed"),
        ("kind: film, coefficient: 5 W/m^2, around: 300", r"coefficient.*wrong dimension: film_coefficient"),
        ("kind: film, coefficient: 0, around: 300", r"coefficient +must be above 0"),
        ("kind: film, coefficient: 5, around: -20", r"around +temperatures are absolute and must be above 0"),
        ("kind: film, coefficient: 5", r"around"),
        ("kind: film, coefficient: 5, around: 300, arround: 2", r"arround.*did you mean 'around'"),
        (
            "kind: radiation, emissivity: 1.2, around: 300",
            r"emissivity.*less than or equal to 1|emissivity.*1",
        ),
        ("kind: heat_source, power: 5 W", r"power.*power/volume is needed"),
        ("kind: heat_source, power: 5 W/m^3, per: total", r"power.*power is needed"),
        ("kind: heat_source, power: z", r"power +'z' does not exist in this analysis"),
        ("kind: heat_source, power: 5, per: gram", r"per.*volume"),
        ("kind: heat_flux, flux: 5, on: {plane: {axis: x, at: 2}}", "on"),
    ],
)
def test_what_is_not_possible_is_refused(keys, words):
    with pytest.raises(SceneError, match=words):
        load(keys, face="" if "source" in keys else FACE)


def test_a_film_on_a_plane_is_refused_with_what_is_allowed():
    text = SCENE.format(units=SI, face=FACE, keys="kind: film, coefficient: 5, around: 300")
    text = text.replace("on: {body: block, face: {axis: x, side: upper}}", "on: {plane: {axis: x, at: 2}}")
    with pytest.raises(SceneError) as error:
        load_scene(text)
    told = str(error.value)
    print(told)
    assert "plane" in told
    assert "body" in told
