"""Bodies that fly at a large share of the wave speed: FMPM lets noise grow there far below its usual limits."""

from __future__ import annotations

import math

import pytest

from mpmcli.stability.growth import FLIGHT_GROWTH
from mpmcli.study.trial import march_trial

pytestmark = pytest.mark.slow

SCENE = """
version: 1
analysis: {{kind: uniaxial_stress, area: 1}}
grid: {{lower: [-5], upper: [{end}], cell: 1}}
method: {{shape: {shape}, update: usl, transfer: {transfer}}}
materials:
  elastic: {{kind: linear_elastic, density: 1, E: 1, nu: 0}}
bodies:
  - {{name: bar, material: elastic, region: {{kind: box, lower: [0], upper: [60]}}, velocity: [{speed}]}}
time: {{end: 300, courant: 0.2}}
archive: {{particles: {{every: 300, fields: [velocity]}}, globals: {{every: 100}}}}
"""


def growth(tmp_path, courant, speed=0.4, shape="lcpdi", transfer="{kind: fmpm, order: 4}"):
    """Growth per step, of the logarithm of a disturbance in flight."""
    path = tmp_path / "flight.yaml"
    end = math.ceil(300 * speed + 80)
    path.write_text(SCENE.format(end=end, shape=shape, transfer=transfer, speed=speed))
    job = {"scene": str(path), "courant": courant, "bound": 0.05, "threads": 1, "is_disturbed": True}
    found = march_trial(job)
    assert found["ended"] == "finished"
    return math.log(found["growth"]) / found["steps"]


def test_noise_grows_in_fast_flight(tmp_path):
    assert growth(tmp_path, 0.45) > 3.0 * FLIGHT_GROWTH
    assert growth(tmp_path, 0.45, speed=0.05) < 0.2 * FLIGHT_GROWTH
    assert growth(tmp_path, 0.45, transfer="{kind: flip}") < 0.2 * FLIGHT_GROWTH


@pytest.mark.parametrize(("speed", "order"), [(0.2, 4), (0.4, 4), (0.8, 4), (0.4, 8), (0.4, 2)])
def test_auto_lets_little_grow(tmp_path, speed, order):
    assert growth(tmp_path, "auto", speed, transfer=f"{{kind: fmpm, order: {order}}}") < FLIGHT_GROWTH
