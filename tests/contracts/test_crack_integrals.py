"""What every way to find J is held to."""

from types import SimpleNamespace
from typing import get_args

import numpy as np
import pytest
from tip_fields import STEEL, Plate

from mpmcli.contact.laws import LAWS
from mpmcli.core.state import State
from mpmcli.cracks.chain import END
from mpmcli.cracks.fracture import Fracture
from mpmcli.cracks.integrals.elastic import plane_elasticity
from mpmcli.cracks.tips import Tips

pytestmark = pytest.mark.usefixtures("python_and_compiled")
CELL = 0.1
STRAIN = plane_elasticity(STEEL, plane_stress=False)


@pytest.fixture(params=get_args(Fracture.model_fields["integral"].annotation))
def integral(request):
    return request.param


def J_of(integral, K_I, K_II, **plate):
    plate = Plate(K_I, K_II, STRAIN, tip=(0.013, 0.028), **plate)
    law = LAWS["frictionless"].model_validate({"kind": "frictionless"})
    grid = SimpleNamespace(lower=np.array([-1.2, -1.2]), cell=np.array([CELL, CELL]))
    state = State(plate.analysis, plate.particles(12), ["plate"], ["steel"], [STEEL])
    models = [SimpleNamespace(faces=SimpleNamespace(law=law), pressure=None, traction=())]
    tips = Tips(Fracture(integral=integral), [plate.crack()], models, state, grid, plate.thickness)
    return tips.values(0, END).J


def test_exact(integral):
    assert J_of(integral, 8e-4, 6e-4) == pytest.approx(1e-6 / STRAIN.modulus, rel=0.06)


def test_quadratic(integral):
    assert J_of(integral, 2e-5, 1e-5) == pytest.approx(4.0 * J_of(integral, 1e-5, 5e-6), rel=1e-4)


def test_nothing_without_load(integral):
    assert J_of(integral, 0.0, 0.0, turn=0.4) == pytest.approx(0.0, abs=1e-15)


def test_a_quarter_turn_changes_nothing(integral):
    turned = J_of(integral, 8e-4, 6e-4, turn=np.pi / 2)
    assert turned == pytest.approx(J_of(integral, 8e-4, 6e-4), rel=0.02)
