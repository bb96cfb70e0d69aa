"""The elastic state of bodies that have stress at the start."""

import examples
import numpy as np
import pytest

from mpmcli.core.tensors import IDENTITY
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import history_at_start, keeps_strain, kirchhoff_stress
from mpmcli.materials.initial_stress import find_stretches, stiffness_at_rest

CASES = [
    pytest.param(
        MATERIALS[kind].model_validate(examples.material(kind, numbers)),
        id=f"{kind}-{i}",
        marks=pytest.mark.slow if i else (),
    )
    for kind in MATERIALS
    if kind != "rigid"
    for i, numbers in enumerate(examples.MATERIALS[kind])
]


@pytest.mark.parametrize("model", CASES)
def test_the_state_found_has_the_stress_asked_for(model):
    """A thousandth of the stiffness, in compression; of materials without shear stiffness a pressure."""
    m, H = model.parameters("3d", False), history_at_start(model, 1)
    at_rest, slope = stiffness_at_rest(m, H[:, :1], keeps_strain(model))
    shear = slope[3, 3] > 1e-9 * np.abs(slope).max()
    size = 1e-3 * max(np.abs(slope).max(), np.abs(at_rest).max())
    asked = np.outer(
        [-1.0, -0.9, -0.8, 0.02, 0.01, 0.03] if shear else [-1.0, -1.0, -1.0, 0.0, 0.0, 0.0], [1.0]
    )
    asked = size * asked + at_rest[:, None]
    V, missed = find_stretches(m, H, asked, keeps_strain(model), None)
    assert missed.max() < 1e-11
    xx, yy, zz, xy, yz, xz = map(float, V[:, 0])
    F = (xx, xy, xz, xy, yy, yz, xz, yz, zz)
    J = np.linalg.det(np.reshape(F, (3, 3)))
    if keeps_strain(model):
        F, J = IDENTITY, 1.0
    tau = kirchhoff_stress(m, F, IDENTITY, H, 0, 0.0, False)
    np.testing.assert_allclose(np.array(tau) / J, asked[:, 0], rtol=0, atol=1e-9 * np.abs(asked).max())


def test_what_a_material_cannot_carry_is_missed():
    metal = MATERIALS["j2_plastic"].model_validate(
        {
            "kind": "j2_plastic",
            "E": 1,
            "nu": 0.3,
            "density": 1,
            "hardening": {"kind": "linear", "yield_stress": 1e-3},
        }
    )
    asked = np.array([[-2e-3, -0.5e-3], [0.0, 0.0], [0.0, 0.0], *np.zeros((3, 2))])
    _, missed = find_stretches(metal.parameters("3d", False), history_at_start(metal, 2), asked, True, None)
    assert missed[0] > 0.1
    assert missed[1] < 1e-11


def test_stiffness_may_differ_from_that_at_rest():
    """Clay, whose stiffness follows the pressure, at pressures of a hundredth to five times that at rest."""
    words = {
        "M": 1.2,
        "lambda": 0.2,
        "kappa": 0.04,
        "nu": 0.3,
        "e0": 1,
        "p0": 20.0,
        "pressure": 1.0,
        "density": 1,
    }
    clay = MATERIALS["modified_cam_clay"].model_validate(words | {"kind": "modified_cam_clay"})
    asked = np.outer([-1.3, -0.7, -0.8, 0.1, 0.0, 0.2], [0.01, 0.1, 1.0, 5.0])
    _, missed = find_stretches(clay.parameters("3d", False), history_at_start(clay, 4), asked, True, None)
    assert missed.max() < 1e-11
