"""Directions of growth against closed forms."""

import math

import pytest

from mpmcli.cracks.directions import DIRECTIONS
from mpmcli.cracks.tip_state import TipState, hoop_angle


def degrees(kind, keys=None, **values):
    model = DIRECTIONS[kind].model_validate({"kind": kind, **(keys or {})})
    return math.degrees(model.angle(TipState(**({"time": 0.0, "length": 1.0} | values))))


@pytest.mark.parametrize(
    ("K_I", "K_II", "angle"),
    [
        (1.0, 0.0, 0.0),
        (0.0, 1.0, -70.528779),
        (0.0, -1.0, 70.528779),
        (1.0, 1.0, -53.130102),
        (1.0, -1.0, 53.130102),
        (-2.0, 1.0, -70.528779),
        (0.0, 0.0, 0.0),
    ],
)
def test_hoop(K_I, K_II, angle):
    assert degrees("hoop", K_I=K_I, K_II=K_II) == pytest.approx(angle, abs=1e-6)


def test_hoop_stress_is_largest_there():
    for K_I, K_II in ((1.0, 0.3), (0.1, -2.0), (5.0, 1e-9)):
        at = hoop_angle(K_I, K_II)

        def stress(a, K_I=K_I, K_II=K_II):
            return math.cos(a / 2) * (K_I * math.cos(a / 2) ** 2 - 1.5 * K_II * math.sin(a))

        assert stress(at) >= max(stress(at - 1e-3), stress(at + 1e-3))


def test_directions_in_space():
    turned = {"angle": math.radians(30.0), "angle0": math.radians(10.0)}
    assert degrees("self_similar", **turned) == 0.0
    assert degrees("initial", **turned) == pytest.approx(-20.0)
    assert degrees("given", {"along": [0, 3]}, **turned) == pytest.approx(60.0)


@pytest.mark.parametrize(
    ("opening", "slip", "angle"), [(1, 0, 0), (1, 1, -45), (0, 1, -90), (-1, -1, 90), (0, 0, 0)]
)
def test_normal_to_opening(opening, slip, angle):
    assert degrees("normal_to_opening", opening=opening, slip=slip) == pytest.approx(angle)


def test_weak_plane():
    weak = {"plane": [1, 1], "ratio": 0.1}
    assert degrees("weak_plane", weak, K_I=1.0, K_II=0.0) == pytest.approx(45.0, abs=6.0)
    assert degrees("weak_plane", {"plane": [-1, -1], "ratio": 0.1}, K_I=1.0, K_II=0.0) == pytest.approx(
        degrees("weak_plane", weak, K_I=1.0, K_II=0.0)
    )
    # as tough everywhere: along the largest J of a kink, near that of the hoop stress
    even = {"plane": [1, 0], "ratio": 1.0}
    assert degrees("weak_plane", even, K_I=1.0, K_II=0.0) == pytest.approx(0.0, abs=1e-5)
    assert degrees("weak_plane", even, K_I=1.0, K_II=0.1) == pytest.approx(-11.2, abs=0.6)
    along = {"plane": [0, 1], "ratio": 0.05}
    assert degrees("weak_plane", along, K_I=1.0, K_II=0.0, angle=math.pi / 2) == pytest.approx(0.0, abs=1e-5)
