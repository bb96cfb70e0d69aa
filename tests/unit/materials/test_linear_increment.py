"""Linear increments of deformation gradients, and the motion that they belong to."""

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mpmcli.core.exponentials import exponential_3d
from mpmcli.materials.linear_increment import find_linear_rates
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

PLACES = {1: [0], 4: [0, 1, 3, 4], 5: [0, 1, 3, 4, 8], 9: list(range(9))}
"""Components of a tensor in space that the rows of a velocity gradient are."""


@pytest.mark.parametrize("rows", list(PLACES))
@given(A=arrays(float, (9, 1), elements=st.floats(-4e-3, 4e-3)))
def test_exponential_of_the_rates_is_linear(rows, A):
    dt = 0.25
    rates = np.zeros((rows, 1))
    find_linear_rates.versions[False].py_func(A[PLACES[rows]] / dt, dt, rates)
    exponent, linear = np.zeros(9), np.eye(3).ravel()
    exponent[PLACES[rows]] = rates[:, 0] * dt
    linear[PLACES[rows]] += A[PLACES[rows], 0]
    np.testing.assert_allclose(exponential_3d(tuple(exponent)), linear, rtol=0, atol=1e-11)


MOTION = np.array([[0.1, 0.2, -0.1], [-0.15, 0.05, 0.1], [0.05, -0.1, 0.2]])


@pytest.mark.parametrize("kind", ["uniaxial_strain", "plane_strain", "axisymmetric", "3d"])
@pytest.mark.parametrize(("increment", "tolerance"), [("linear", 1e-9), ("exponential", 0.1)])
def test_free_motion_has_its_gradient(plain_python, kind, increment, tolerance):
    """Without forces particles fly straight, and F is I + H t; by exponentials with an error of first order."""
    d = {"uniaxial_strain": 1, "3d": 3}.get(kind, 2)
    H = MOTION[:d, :d] * (np.eye(d) if kind == "axisymmetric" else 1.0)
    scene = {
        "version": 1,
        "analysis": {"kind": kind},
        "grid": {
            "lower": [0 if kind == "axisymmetric" else -4] + [-4] * (d - 1),
            "upper": [4] * d,
            "cell": 1,
        },
        "method": {
            "shape": "ugimp",
            "deformation_increment": increment,
            "transfer": {"kind": "flip", "velocity_gradient": True},
        },
        "materials": {"dust": {"kind": "neo_hookean", "density": 1, "E": 1e-12, "nu": 0}},
        "bodies": [
            {
                "name": "cloud",
                "material": "dust",
                "region": {"kind": "box", "lower": [0] * d, "upper": [1] * d},
                "velocity": [" + ".join(f"{h}*{x}" for h, x in zip(row, "xyz", strict=False)) for row in H],
            }
        ],
        "time": {"end": 10, "step": 0.1},
    }
    with plain_python():
        s = Simulation(load_scene(yaml.safe_dump(scene)))
        for _ in range(10):
            s.step()
    F = s.particles.F
    exact = np.eye(3)
    exact[:d, :d] += H * s.time
    if kind == "axisymmetric":
        exact[2, 2] += H[0, 0] * s.time
    places = {1: [0, 4, 8], 2: [0, 1, 3, 4, 8], 3: list(range(9))}[d]
    error = np.abs(F - exact.ravel()[places][:, None]).max()
    assert error < tolerance
    assert error > 1e-4 or increment == "linear"
