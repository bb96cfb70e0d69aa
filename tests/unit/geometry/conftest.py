"""What the tests of regions and filling share."""

from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from mpmcli.core.registry import OneOf
from mpmcli.geometry import REGIONS

_ANY_REGION = TypeAdapter(Annotated[Any, OneOf(REGIONS)])


@pytest.fixture
def region():
    """A function that makes a region from the words of a scene."""

    def make(kind, context=None, **fields):
        return _ANY_REGION.validate_python({"kind": kind} | fields, context=context)

    return make


@pytest.fixture
def body(region):
    """A function that makes a body with a region."""

    def make(name, *, per_axis=2, along="grid", overlap="error", **words):
        return SimpleNamespace(
            name=name,
            region=region(**words),
            particles_per_axis=per_axis,
            particles_along=along,
            overlap=overlap,
        )

    return make


@pytest.fixture
def grid():
    """A function that makes a grid from corners and cell size."""

    def make(lower, upper, cell):
        lower, upper = np.array(lower, dtype=float), np.array(upper, dtype=float)
        return SimpleNamespace(
            lower=lower, upper=upper, cell=np.broadcast_to(cell, lower.shape).astype(float)
        )

    return make
