"""The set-up report."""

import math

import numpy as np
import pytest

from mpmcli.core.analysis import Axisymmetric, PlaneStrain, Solid, UniaxialStress
from mpmcli.geometry import body_report, fill_bodies, report_table
from mpmcli.geometry.report import sampled_measure


def report(bodies, box, analysis, density=2.0, **more):
    filled = fill_bodies(bodies, box, analysis)
    return body_report(bodies, filled, [density] * len(bodies), box, analysis, **more)


def test_plane_bodies_have_their_thickness(body, grid):
    [r] = report(
        [body("block", kind="box", lower=[1, 1], upper=[3, 2])],
        grid([0, 0], [4, 4], 0.5),
        PlaneStrain(),
        thickness=3,
    )
    assert (r.name, r.particles) == ("block", 32)
    assert r.volume == pytest.approx(6)
    assert r.mass == pytest.approx(12)
    assert r.center == pytest.approx([2, 1.5])
    assert r.lower == pytest.approx([1, 1])
    assert r.upper == pytest.approx([3, 2])
    assert r.region_volume == 6
    assert r.exact
    assert r.difference == pytest.approx(0, abs=1e-12)


def test_one_dimensional_bodies_have_their_area(body, grid):
    [r] = report(
        [body("bar", kind="box", lower=[0], upper=[40])],
        grid([0], [40], 1),
        UniaxialStress(),
        0.5,
        thickness=2,
    )
    assert r.volume == pytest.approx(80)
    assert r.mass == pytest.approx(40)


def test_volumes_are_those_of_the_full_ring(body, grid):
    bodies = [
        body("ring", kind="box", lower=[1, 0], upper=[2, 3]),
        body("ball", kind="disk", center=[0, 5], radius=1),
        body("torus", kind="disk", center=[3, 5], radius=0.5),
    ]
    ring, ball, torus = report(bodies, grid([0, 0], [4, 8], 0.1), Axisymmetric(), thickness=7)
    assert ring.volume == pytest.approx(3 * math.pi * 3)
    assert ring.region_volume == pytest.approx(ring.volume)
    assert ring.exact
    assert ball.region_volume == pytest.approx(4 / 3 * math.pi, rel=2e-3)
    assert not ball.exact
    assert ball.volume == pytest.approx(4 / 3 * math.pi, rel=0.02)
    assert torus.region_volume == pytest.approx(2 * math.pi * 3 * math.pi * 0.25)
    assert torus.exact


def test_solid_bodies_and_the_difference(body, grid):
    [r] = report(
        [body("ball", kind="sphere", center=[0, 0, 0], radius=1)], grid([-1] * 3, [1] * 3, 0.2), Solid()
    )
    assert r.difference == pytest.approx(r.volume / (4 / 3 * math.pi) - 1)
    assert abs(r.difference) < 0.02


def test_sizes_without_a_closed_form_are_estimated(body, grid):
    disk = {"kind": "disk", "center": [2, 2], "radius": 1}
    bodies = [
        body("lens", kind="intersection", regions=[disk, disk | {"translate": [1, 0]}]),
        body("ground", kind="half_space", point=[0, 0.5], normal=[0, 1]),
    ]
    lens, ground = report(bodies, grid([0, 0], [4, 4], 0.1), PlaneStrain())
    assert lens.region_volume == pytest.approx(2 * math.pi / 3 - math.sqrt(3) / 2, rel=1e-3)
    assert not lens.exact
    assert ground.region_volume == pytest.approx(2)


def test_sampling_finds_nothing_in_an_empty_box(region):
    disk = region("disk", center=[0, 0], radius=1)
    assert sampled_measure(disk, np.zeros(2), np.array([0.0, 1.0])) == 0
    assert sampled_measure(disk, np.full(2, 2.0), np.full(2, 3.0), samples=100) == 0
    assert sampled_measure(disk, np.full(2, -1.0), np.full(2, 1.0), samples=10_000) == pytest.approx(
        math.pi, rel=0.01
    )


def test_table(body, grid):
    bodies = [
        body("block", kind="box", lower=[0, 0], upper=[1, 1]),
        body("rest", kind="union", regions=[{"kind": "box", "lower": [1, 0], "upper": [2, 1]}]),
    ]
    reports = report(bodies, grid([0, 0], [2, 2], 0.1), PlaneStrain())
    lines = report_table(reports, {"length": "mm", "mass": "g"}).splitlines()
    assert lines[0].split()[:5] == ["body", "particles", "mass", "[g]", "volume"]
    assert "[mm³]" in lines[0]
    assert lines[1].startswith("block")
    assert "+0.000 %" in lines[1].replace("-", "+")
    assert "[0.5, 0.5]" in lines[1]
    assert "~" in lines[2]
    assert len(lines) == 3
    assert "mass " in report_table(reports)


def test_a_rigid_body_has_no_mass(body, grid):
    bodies = [body("tool", kind="box", lower=[0, 0], upper=[1, 1])]
    [tool] = reports = report(bodies, grid([0, 0], [2, 2], 0.1), PlaneStrain(), density=None)
    assert tool.mass is None
    assert tool.volume == pytest.approx(1)
    assert tool.center == pytest.approx([0.5, 0.5])
    assert "rigid" in report_table(reports).splitlines()[1].split()
