"""Benchmarks of CB-Geo through import, validate, run and plot without an edit; exact and published answers."""

from pathlib import Path

import numpy as np
import pytest
from commands import spoken
from outside.cbgeo.sources import BENCHMARKS, Benchmark, absorbing_column, dam_break

from mpmcli.results.reading import Results

pytestmark = pytest.mark.slow

GRAVITY, DENSITY, HEIGHT = 9.81, 1800.0, 0.1


def run(given: Benchmark, folder: Path, *options: str) -> Results:
    """All four commands."""
    source, scene, out = given.write(folder / "source"), folder / "scene.yaml", folder / "out"
    for words in (
        ["import", "cbgeo", str(source), "-o", str(scene)],
        ["validate", str(scene)],
        ["run", str(scene), "-o", str(out), "-q", *options],
        ["plot", str(out), "-o", str(folder / "pictures")],
    ):
        code, written, _ = spoken(words)
        assert code == 0, (words, written)
    assert list((folder / "pictures").glob("*.png"))
    return Results(out)


def at_end(results: Results, component: str) -> np.ndarray:
    """A component of the stress of all particles at the end."""
    frame = results.particles()
    return frame["stress"][:, frame.components["stress"].index(component)]


@pytest.mark.parametrize("name", ["uniaxial_stress", "uniaxial_stress_usl", "uniaxial_stress_3d"])
def test_one_cell_is_compressed(name, tmp_path):
    """Published: −1 Pa after ten steps of 0.1 % (E = 1000 Pa), by increments of small strain."""
    results = run(BENCHMARKS[name](), tmp_path)
    np.testing.assert_allclose(at_end(results, "YY"), -1.0, rtol=2e-3)
    np.testing.assert_allclose(at_end(results, "XX"), 0.0, atol=1e-9)


def test_a_bar_is_pulled_by_its_nodes(tmp_path):
    """Published: smallest and largest; CB-Geo names a file by the step before."""
    given = BENCHMARKS["uniaxial_traction_nodes"]()
    given.main["post_processing"]["output_steps"] = 1
    results = run(given, tmp_path)
    for time, *published in (
        (0.301, 0.5925210678182377, 0.5974539476363379),
        (0.511, 1.0026665338366039, 1.0112231542459431),
        (0.751, 1.0000053000532143, 1.0000225119807862),
        (0.991, 0.9999990078443788, 0.9999990292713694),
    ):
        stress = results.particles(time)["stress"][:, 0]
        np.testing.assert_allclose([stress.min(), stress.max()], published, rtol=3e-7)


def test_a_bar_is_pulled_by_its_face(tmp_path):
    results = run(BENCHMARKS["uniaxial_traction"](), tmp_path)
    np.testing.assert_allclose(at_end(results, "XX"), 1.0, rtol=1e-5)


def test_a_base_absorbs(tmp_path):
    """The base of a column on Kelvin-Voigt elements sinks by σ δ/M = 0.1 mm."""
    results = run(absorbing_column(20), tmp_path, "--until", "0.1")
    frame = results.particles()
    lowest = frame.X[:, 1] < 0.0004
    np.testing.assert_allclose(frame["displacement"][lowest, 1], -1.0e-4, rtol=1e-2)
    top = frame["displacement"][:, 1].min()
    assert top == pytest.approx(-1.0e-4 - 100 / 1e5 * 0.02, rel=1e-2)


@pytest.mark.parametrize("name", ["hydrostatic_column", "hydrostatic_fluid"])
def test_a_column_settles(name, tmp_path):
    """σ_yy = −ρg(H − y) at the middles of cells; published at the lowest particles: −1680.2 Pa, exact −1765.8."""
    results = run(BENCHMARKS[name](), tmp_path, "--until", "0.03")
    frame = results.particles()
    middle = (np.floor(frame.X[:, 1] / 0.01) + 0.5) * 0.01
    exact = -DENSITY * GRAVITY * (HEIGHT - middle)
    np.testing.assert_allclose(at_end(results, "YY"), exact, atol=0.01 * DENSITY * GRAVITY * HEIGHT)
    assert at_end(results, "YY").min() == pytest.approx(-1680.2, rel=3e-3)
    across = at_end(results, "XX")
    np.testing.assert_allclose(across, exact if name == "hydrostatic_fluid" else 0.0, atol=20.0)


def test_a_column_settles_in_3d(tmp_path):
    results = run(BENCHMARKS["hydrostatic_column_3d"](), tmp_path)
    frame = results.particles()
    middle = (np.floor(frame.X[:, 2] / 0.01) + 0.5) * 0.01
    exact = -DENSITY * GRAVITY * (HEIGHT - middle)
    np.testing.assert_allclose(at_end(results, "ZZ"), exact, atol=0.01 * DENSITY * GRAVITY * HEIGHT)


def test_unconfined_compression(tmp_path):
    """The strength of a cohesive soil is 2c cos φ/(1 − sin φ) = 500 Pa."""
    results = run(BENCHMARKS["mohr_coulomb_compression"](), tmp_path)
    assert results["stress_yy[soil]"][-1] == pytest.approx(-500.0, rel=6e-3)
    assert results["stress_zz[soil]"][-1] == pytest.approx(-0.2 * 500.0, rel=2e-2)
    early = np.interp(1e-3, results["time"], results["stress_yy[soil]"])
    assert early == pytest.approx(-1e7 / (1 - 0.2**2) * 0.002 * 1e-3 / 0.05, rel=1e-2)


@pytest.mark.parametrize(
    ("name", "friction", "end"), [("level_block_frictionless", 0.0, 0.1), ("sliding_block", 0.1, 0.3)]
)
def test_a_block_slides(name, friction, end, tmp_path):
    """(g sin 30° − μ g cos 30°) t²/2."""
    results = run(BENCHMARKS[name](), tmp_path, "--until", str(end))
    way = results["center_x[body]"][-1] - 2.5
    slope = np.radians(30.0)
    assert way == pytest.approx(GRAVITY * (np.sin(slope) - friction * np.cos(slope)) * end**2 / 2, rel=1.5e-3)


def test_a_dam_breaks(tmp_path):
    """The front against Martin and Moyce (1952), Fig. 3, with cells of twice the published size."""
    width, half = 0.114, 0.0114 / 2
    results = run(dam_break(2), tmp_path, "--until", "0.155")
    time, front = np.array([[0.832, 1.217], [1.219, 1.474], [1.997, 2.292]]).T
    ours = np.interp(time * np.sqrt(width / (2 * 9.814)), results.times, fronts(results)) + half
    np.testing.assert_allclose(ours / width, front, atol=0.08)


def fronts(results: Results) -> list[float]:
    """How far the water reaches in each archive."""
    return [float(results.particles(time).X[:, 0].max()) for time in results.times]
