"""What a run with a crack leaves behind: files of cracks and sides, and the same bytes after a checkpoint."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from mpmcli.cli.main import call
from mpmcli.output.tables import read_numbers, read_table

pytestmark = pytest.mark.slow

SCENE = """\
version: 1
units: {length: mm, mass: g, time: ms}
analysis: {kind: plane_strain}
grid: {lower: [-3, -9], upper: [13, 9], cell: 1}
method: {shape: ugimp, transfer: {kind: fmpm, order: 2}}
materials: {glue: {kind: linear_elastic, density: 1.0e-3, E: 1000, nu: 0.33}}
bodies: [{name: plate, material: glue, region: {kind: box, lower: [0, -7], upper: [10, 7]}}]
cracks:
  - {name: main, path: {kind: points, points: [[-2, 0.1], [5, 0.1]]}, ends: {start: mouth}}
  - {name: other, path: {kind: points, points: [[4, -1], [4, 2]]}}
fracture: {}
loads:
  - {name: up, kind: traction, on: {body: plate, face: {axis: y, side: upper}}, traction: [0, 1]}
  - {name: down, kind: traction, on: {body: plate, face: {axis: y, side: lower}}, traction: [0, -1]}
time: {end: 0.04, courant: 0.4}
probes:
  - {name: p, kind: crack_tip, crack: main, columns: [position, J, K_I, K_II, length]}
  - {name: q, kind: crack_opening, crack: main, every: 0.01}
archive:
  globals: {every: 0.005, columns: [default, crack_length, "J[main:end]"]}
  cracks: {every: 0.01}
  particles: {every: 0.01, fields: [displacement, crack_side]}
  grid: {every: 0.01, fields: [mass, velocity, mass_side_0, mass_side_1, mass_side_2, mass_side_3, velocity_side_1]}
  checkpoint: {every: 0.02}
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("cracks") / "scene.yaml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def results(scene: Path) -> Path:
    assert call(["run", str(scene), "-o", str(scene.parent / "whole"), "--quiet"]) == 0
    return scene.parent / "whole"


def test_sides_of_nodes_have_the_mass_of_all(results: Path) -> None:
    data = {k: np.squeeze(v) for k, v in meshio.read(results / "grid" / "grid_000002.vtu").point_data.items()}
    sides = [data[f"mass_side_{side}"] for side in range(4)]
    assert sum(sides) == pytest.approx(data["mass"], rel=1e-6)
    assert [np.count_nonzero(side) > 0 for side in sides] == [True] * 4
    assert np.count_nonzero(sides[1]) < 30
    away = sides[1] == 0.0
    assert not data["velocity_side_1"][away].any()


def test_sides_of_particles(results: Path) -> None:
    archive = meshio.read(results / "particles" / "particles_000002.vtu")
    side, points = np.squeeze(archive.point_data["crack_side"]), archive.points
    assert set(np.unique(side)) <= {0, 1, 2, 3}
    near = np.abs(points[:, 1] - 0.1) < 1.0
    assert not side[(np.abs(points[:, 1] - 0.1) > 2.5)].any()
    other = near & (side == 1) & (points[:, 0] < 3.0)
    assert other.any()
    # the row above the crack, whose nearest nodes lie below it at y = 0
    assert (points[other, 1] > 0.1).all()


def test_the_crack_opens_and_its_tip_is_followed(results: Path) -> None:
    header, rows = read_table(results / "probes" / "q.csv")
    opening = read_numbers([row[header.index("opening_normal")] for row in rows]).reshape(5, -1)
    assert (opening[-1, 1:5] > 1e-4).all()
    assert opening[-1, -1] < 0.1 * opening[-1, 1]
    header, rows = read_table(results / "probes" / "p.csv")
    J = read_numbers([row[header.index("J")] for row in rows])
    whole_header, whole = read_table(results / "globals.csv")
    assert J[-1] > 0.0
    assert whole[-1][whole_header.index("J[main:end]")] == rows[-1][header.index("J")]


def test_a_resumed_run_gives_the_same_bytes(scene: Path, results: Path) -> None:
    again = scene.parent / "again"
    assert call(["run", str(scene), "-o", str(again), "--quiet", "--set", "time.end=0.02"]) == 0
    assert call(["run", str(scene), "-o", str(again), "--quiet", "--resume"]) == 0
    names = [
        p.relative_to(results) for p in results.rglob("*") if p.suffix in (".csv", ".vtp", ".vtu", ".pvd")
    ]
    assert len(names) > 20
    assert all((again / name).read_bytes() == (results / name).read_bytes() for name in names)
