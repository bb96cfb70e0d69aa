"""The list of shape functions."""

import pytest

from mpmcli.shapes import SHAPES
from mpmcli.shapes.base import ShapeEntry


def test_every_shape_function_of_the_scene_language_is_there():
    assert set(SHAPES) == {"linear", "ugimp", "lcpdi", "qcpdi", "bspline2", "b2gimp", "b2cpdi"}


@pytest.mark.parametrize("name", SHAPES)
def test_entries_explain_themselves(name):
    entry = SHAPES[name]
    assert isinstance(entry, ShapeEntry)
    assert entry.name == name
    assert entry.description
    assert any(year.isdigit() for year in entry.reference.replace("(", " ").replace(")", " ").split())
    assert entry.follows_deformation == name.endswith("cpdi")


def test_each_shape_function_has_a_class_of_its_own():
    """Numba tells shape functions apart by the type of their parameters."""
    assert len({type(entry.parameters) for entry in SHAPES.values()}) == len(SHAPES)


def test_ghost_layers_hold_a_stencil_at_the_wall():
    for entry in SHAPES.values():
        assert entry.pad >= entry.width - 1
