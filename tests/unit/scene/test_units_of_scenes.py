"""Consistent units: conversion of text, refusals, labels."""

import pytest

from mpmcli.scene.units import Dimension, Units, base_unit_size, split_unit

SI = Units("m", "kg", "s")
MM = Units("mm", "g", "ms")


@pytest.mark.parametrize(
    ("text", "dimension", "si", "mm"),
    [
        ("3 g/cc", "density", 3000.0, 3e-3),
        ("1 GPa", "pressure", 1e9, 1000.0),
        ("9.81 m/s^2", "acceleration", 9.81, 9.81e-3),
        ("81.65 m/s", "velocity", 81.65, 81.65),
        ("1e-3kg", "mass", 1e-3, 1.0),
        ("1 in", "length", 0.0254, 25.4),
        ("0.1 µm", "length", 1e-7, 1e-4),
        ("0.1 μm", "length", 1e-7, 1e-4),
        ("1 N*m", "energy", 1.0, 1000.0),
        ("1 J/(kg*K)", "specific_heat", 1.0, 1.0),
        ("5 1/s", "1/time", 5.0, 5e-3),
        ("60 Hz", "1/time", 60.0, 0.06),
        ("10 %", "1", 0.1, 0.1),
        ("20 degC", "temperature", 293.15, 293.15),
        ("20 °C", "temperature", 293.15, 293.15),
        ("-40 degF", "temperature", 233.15, 233.15),
        ("300 K", "temperature", 300.0, 300.0),
        ("2 MPa*s", "pressure*time", 2e6, 2000.0),
        ("1 kg m^2 s^-1", "angular_momentum", 1.0, 1e6),
        ("7 m²", "area", 7.0, 7e6),
        ("0.33 GPa/m", "pressure/length", 3.3e8, 0.33),
        ("1 kJ/m^2", "energy/area", 1000.0, 1.0),
        ("1 N/mm^1.5", "pressure*length^0.5", 1e6 * 0.001**0.5, 1.0),
        ("2 MPa*m^0.5", "pressure*length^0.5", 2e6, 2.0 * 1000.0**0.5),
    ],
)
def test_conversion_is_exact(text: str, dimension: str, si: float, mm: float) -> None:
    assert SI.number(text, dimension) == si
    assert MM.number(text, dimension) == mm
    assert MM.any_number(text) == mm


def test_angles() -> None:
    assert SI.number("30 deg", "angle") == 30.0
    assert SI.number("1 rad", "angle") == pytest.approx(57.29577951308232)
    assert SI.number("180 deg", "1") == pytest.approx(3.141592653589793)


@pytest.mark.parametrize(
    ("text", "dimension", "words"),
    [
        ("1 mm", "pressure", "wrong dimension: pressure is needed, as in 'Pa'"),
        ("1 mm", "1", "a plain number is needed"),
        ("1 Gpa", "pressure", "'Gpa' in '1 Gpa' is not a unit; did you mean 'GPa'?"),
        ("1 flurbs", "length", "'flurbs' in '1 flurbs' is not a unit"),
        ("1 cm3", "volume", "'cm3' in '1 cm3' is not a unit; did you mean 'cm^3'?"),
        ("1 g/cm3", "density", "did you mean 'g/cm^3'?"),
        ("1 mm/s2", "acceleration", "did you mean 'mm/s^2'?"),
        ("1 kg m-3", "density", "did you mean 'kg m^-3'?"),
        ("1 flurbs2", "length", "'flurbs2' in '1 flurbs2' is not a unit"),
        ("1 A", "length", "scenes do not use"),
        ("5 delta_degC", "temperature", "temperature difference"),
        ("1 m**9**9**9", "length", "is not a unit"),
        ("1 m^99999999", "length", "is not a unit"),
        ("1 (m", "length", "is not a number with a unit"),
        ("1 m; import os", "length", "is not a unit"),
        ("2 x", "length", "is not a unit"),
        ("one mm", "length", "not a number with a unit"),
    ],
)
def test_refusal_in_words(text: str, dimension: str, words: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        SI.number(text, dimension)
    assert words in str(caught.value)


def test_units_must_be_declared() -> None:
    with pytest.raises(ValueError, match="the scene declares no units"):
        Units().number("1 mm", "length")


@pytest.mark.parametrize(
    ("dimension", "mm", "si", "cgs"),
    [
        ("force", "N", "N", "g*cm/us^2"),
        ("pressure", "MPa", "Pa", "g/cm/us^2"),
        ("energy", "mJ", "J", "g*cm^2/us^2"),
        ("power", "W", "W", "g*cm^2/us^3"),
        ("velocity", "mm/ms", "m/s", "cm/us"),
        ("acceleration", "mm/ms^2", "m/s^2", "cm/us^2"),
        ("density", "g/mm^3", "kg/m^3", "g/cm^3"),
        ("1", "1", "1", "1"),
        ("1/time", "1/ms", "1/s", "1/us"),
        ("pressure/length", "MPa/mm", "Pa/m", "g/cm^2/us^2"),
        ("energy/area", "mJ/mm^2", "J/m^2", "g/us^2"),
        ("pressure*length^0.5", "MPa*mm^0.5", "Pa*m^0.5", "g/cm^0.5/us^2"),
        ("specific_heat", "mJ/g/K", "J/kg/K", "cm^2/us^2/K"),
        ("length**2", "mm^2", "m^2", "cm^2"),
        ("momentum", "g*mm/ms", "kg*m/s", "g*cm/us"),
        ("temperature", "K", "K", "K"),
        ("angle", "deg", "deg", "deg"),
    ],
)
def test_labels(dimension: str, mm: str, si: str, cgs: str) -> None:
    assert (MM.label(dimension), SI.label(dimension)) == (mm, si)
    assert Units("cm", "g", "us").label(dimension) == cgs


def test_labels_without_units_are_the_words() -> None:
    assert Units().label("pressure") == "pressure"


def test_base_units() -> None:
    for name, base in [
        ("mm", "length"),
        ("t", "mass"),
        ("us", "time"),
        ("K", "temperature"),
        ("slug", "mass"),
    ]:
        base_unit_size(name, base)
    assert Units("parsec", "slug", "s").number("1 parsec", "length") == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("name", "base", "words"),
    [
        ("ms", "length", "'ms' is a time, but a length is needed"),
        ("milimeter", "length", "is not a unit of length"),
        ("degC", "temperature", "does not start at absolute zero"),
        ("N", "mass", "is not a unit of mass"),
        ("", "length", "is not a unit of length"),
    ],
)
def test_bad_base_unit(name: str, base: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        base_unit_size(name, base)


def test_dimension_words() -> None:
    assert Dimension.of("energy/mass/temperature") == Dimension.of("specific_heat")
    assert Dimension.of("force/length^2") == Dimension.of("pressure")
    assert Dimension.of("length*1/time") == Dimension.of("velocity")
    with pytest.raises(ValueError, match="did you mean 'pressure'"):
        Dimension.of("presure")


@pytest.mark.parametrize("text", ["1e3", "1/3", "2*R", "R mm", "", "3"])
def test_text_that_has_no_unit(text: str) -> None:
    assert split_unit(text) is None
