"""Translated sources run without an edit and give NairnMPM's published answers.

The answers are facts of the files TwoDisks.txt, TwoDisksMM.txt, MPMDCB.txt and CompressionText.txt of nairn-mpm-fea's
test suite, here in mm, g and ms.
"""

import csv
from pathlib import Path

import numpy as np
import pytest
from commands import spoken

SOURCES = Path(__file__).with_name("sources")


def run(name, folder, *options):
    """Import, validate, run and plot a source; its table of globals."""
    scene, results = folder / f"{name}.yaml", folder / "results"
    for command in (
        ["import", "nairnmpm", str(SOURCES / f"{name}.fmcmd"), "-o", str(scene)],
        ["validate", str(scene)],
        ["run", "-q", str(scene), "-o", str(results), *options],
        ["plot", str(results)],
    ):
        code, written, _ = spoken(command)
        assert code == 0, written
    assert (results / "plots" / "particles.png").exists()
    with (results / "globals.csv").open() as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}, results


def at(table, column, times):
    return np.interp(times, table["time"], table[column])


@pytest.mark.slow
def test_two_disks_rebound_as_published(tmp_path):
    table, _ = run("two_disks", tmp_path, "--until", "12")
    # the published run has the walls 2 mm nearer; they are reached after 14 ms
    assert at(table, "velocity_x[disk_1]", 12.0272) == pytest.approx(-2.370866, rel=0.01)
    assert at(table, "kinetic_energy", 7.03179) == pytest.approx(0.1957111, abs=0.03 * 6.7125)
    assert at(table, "kinetic_energy", 8.01815) == pytest.approx(5.075842, abs=0.03 * 6.7125)
    assert table["kinetic_energy"][0] == pytest.approx(6.7125, rel=1e-12)


@pytest.mark.slow
def test_two_disks_in_contact_rebound_as_published(tmp_path):
    table, _ = run("two_disks_contact", tmp_path, "--until", "12")
    assert at(table, "velocity_x[polymer]", 5.5) == pytest.approx(2.5, rel=1e-9)  # they touch at 6 ms
    assert at(table, "velocity_x[polymer]", 12.0) == pytest.approx(-2.188997, rel=0.05)


@pytest.mark.slow
def test_a_double_cantilever_opens_as_published(tmp_path):
    table, _ = run("double_cantilever", tmp_path)
    times = [0.500069, 0.700298, 1.00014, 1.20037]
    published = np.array([3.62993, 8.90451, 15.1231, 13.54])
    assert at(table, "strain_energy", times) == pytest.approx(published, rel=0.01)
    J = 1e-3 * np.array([177.308, 540.748, 893.980, 871.808])
    assert at(table, "J[crack:start]", times) == pytest.approx(J, rel=0.05)


@pytest.mark.slow
def test_a_block_slides_down_an_inclined_plane(tmp_path):
    table, _ = run("inclined_plane", tmp_path)
    angle, t = np.pi / 6, table["time"][-1]
    speed = 9.80665e-3 * (np.sin(angle) - 0.3 * np.cos(angle)) * t
    assert table["velocity_x[block]"][-1] == pytest.approx(speed * np.cos(angle), rel=0.03)
    assert table["velocity_y[block]"][-1] == pytest.approx(-speed * np.sin(angle), rel=0.03)


@pytest.mark.slow
def test_a_strip_is_compressed_as_published(tmp_path):
    table, _ = run("compression", tmp_path)
    times = [0.4801, 1.00021, 1.60033]
    assert at(table, "stress_xx[strip]", times) == pytest.approx([-4.806381, -10.05462, -10.05726], rel=0.01)
    assert at(table, "strain_xx[strip]", times) == pytest.approx(
        [-4.809151e-3, -1.004892e-2, -1.005397e-2], rel=0.01
    )
    held = table["time"] > 1.2
    # σ = Eε over the section of 100 mm²; the published mean is 1096 N
    assert np.mean(table["contact_force_x[plate]"][held]) == pytest.approx(-1005.5, rel=0.03)


@pytest.mark.slow
def test_a_plastic_strip_is_pulled_to_its_stress(tmp_path):
    table, _ = run("tension", tmp_path)
    # 10 N on 50 mm × 0.02 mm, about which it oscillates; plastic flow keeps the volume
    late = table["time"] > 1.5
    stress, strain = (table[f"{name}_yy[von_mises]"][late] for name in ("stress", "strain"))
    assert np.mean(stress / np.exp(strain)) == pytest.approx(10.0, rel=0.02)
    assert np.min(strain) > (10 - 5) / 200  # above the plastic strain of the slope Ep
