"""Two fields with perfect contact are one: every update and transfer method."""

import numpy as np
import pytest

BLOCKS = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [12, 12], cell: 1}
method: {shape: lcpdi}
materials: {m: {kind: neo_hookean, density: 1, K: 1, G: 0.5}}
bodies:
  - {name: a, material: m, region: {kind: box, lower: [2, 3], upper: [6, 8]}, velocity: ["0.1*(1 - x/6)", "0.02*y"]}
  - {name: b, material: m, region: {kind: box, lower: [6, 4], upper: [10, 9]}, velocity: ["-0.05", "0.03*(x - y)/9"]}
contact: {law: {kind: perfect}}
time: {end: 4, courant: 0.2}
"""
RESULTS = ("X", "V", "J", "stress")


@pytest.mark.parametrize("update", ["usf", "usl", "usl+", "usavg", "usavg+"])
@pytest.mark.parametrize(
    "transfer", ["{kind: flip}", "{kind: fmpm, order: 1}", "{kind: fmpm, order: 4}", "{kind: xpic, order: 5}"]
)
def test_perfect_contact_is_one_field(start, update, transfer):
    """Positions, velocities, volumes and stresses agree to 1e-10."""
    sets = (f"method.update={update}", f"method.transfer={transfer}")
    one, two = start(BLOCKS, "contact=null", *sets), start(BLOCKS, *sets)
    for run in (one, two):
        run.to(4)
    for name in RESULTS:
        a, b = getattr(two, name), getattr(one, name)
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-10 * np.abs(b).max())
    assert np.abs(one.J - 1).max() > 0.02  # not an idle scene
