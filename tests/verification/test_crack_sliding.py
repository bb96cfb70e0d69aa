"""A block slides on a crack (L9)."""

import numpy as np
import pytest

pytestmark = pytest.mark.slow

G = 10.0


def slide(start, friction, angle, rise=0.0):
    """Speed and path of the block over those of a rigid one; without friction if that would not move."""
    sets = (f"constants.friction={friction}", f"constants.angle={angle}*pi/180", f"constants.rise={rise}")
    run = start("sliding_on_crack.yaml", *sets)
    run.to(0.5)
    t, block = run.time, run.ordered("body") == 1
    angle = np.radians(angle)
    a = G * (np.sin(angle) - friction * np.cos(angle))
    if a < 0.0:
        a = G * np.sin(angle)
    speed, path = a * (t - rise / 2), a * (t**2 / 2 - rise * t / 2 + rise**2 / 6)
    return run.V[0, block].mean() / speed, (run.X - run.X0)[0, block].mean() / path


def test_with_friction(start):
    speed, path = slide(start, 0.3, 40)
    assert speed == pytest.approx(1.0, abs=0.02)
    assert path == pytest.approx(1.0, abs=0.02)  # gravity at once makes it bounce


def test_without_friction(start):
    assert slide(start, 0, 40) == pytest.approx((1.0, 1.0), abs=1e-4)


@pytest.mark.parametrize(("friction", "angle"), [(0.3, 10), (0.7, 30)])
def test_below_the_angle_of_friction_it_stays(start, friction, angle):
    speed, path = slide(start, friction, angle, rise=0.1)
    assert abs(path) < 0.01
    assert abs(speed) < 0.01
