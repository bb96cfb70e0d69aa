"""Ellipses pressed together in a box (Nairn et al. 2020, section 4.2): a short, coarse run of the scene."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from overlap import find_overlapping
from PIL import Image

ROOT = Path(__file__).parents[2]


def test_the_picture_is_the_one_that_the_script_draws():
    spec = importlib.util.spec_from_file_location("draw_ellipses", ROOT / "docs" / "draw_ellipses.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    with Image.open(ROOT / "inputs" / "ellipse_compaction.png") as image:
        np.testing.assert_array_equal(np.array(image), script.draw())


@pytest.mark.slow
def test_ellipses_keep_out_of_each_other(start):
    """60 particles high, pressed by a fifth: 20 fields, nodes with several of them, no centre in another body."""
    run = start("ellipse_compaction.yaml", "constants.cell=1/15", "constants.compression=0.2", threads=1)
    s = run.simulation
    most = 0

    def look(run):
        nonlocal most
        most = max(most, int(np.diff(s.contact.contacts.nodes.first).max(initial=0)))

    run.to(0.004, look)
    p = run.particles
    assert p.count == 1089
    assert most >= 3
    assert (p.F[:4] != p.F[:4].round()).any()
    F = np.stack([p.F[0:2], p.F[2:4]])
    assert not find_overlapping(p.X, F, p.size, p.body).any()
    stress = np.average(run.stress[1], weights=run.ordered("vol0") * run.J)
    assert -1500 < stress < -700
    assert s.state.work["boundary_work"] > run.kinetic_energy + run.stress_work


FMPM = (
    "method.transfer={kind: fmpm, order: 4, every_courant: 1}",
    "time.courant=0.2",
    "contact.overlap_removal=0.05",
)


@pytest.mark.long
@pytest.mark.timeout(7200)
@pytest.mark.parametrize(("sets", "stress"), [((), -97), (FMPM, -109)], ids=["xpic", "fmpm"])
def test_bodies_keep_apart_at_a_quarter_of_the_height(start, sets, stress):
    """280 particles high, a quarter of an hour each: fewer than one centre in 1000 is in another body."""
    run = start("ellipse_compaction.yaml", *sets, threads=1)
    run.to(0.015)
    p = run.particles
    assert p.count == 23824
    assert find_overlapping(p.X, np.stack([p.F[0:2], p.F[2:4]]), p.size, p.body).mean() < 1e-3
    mean = 1e-3 * np.average(run.stress[1], weights=run.ordered("vol0") * run.J)
    assert mean == pytest.approx(stress, abs=2)
    assert not run.simulation.contact.view.momentum_error.any()
