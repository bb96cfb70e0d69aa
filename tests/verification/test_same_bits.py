"""The same scene gives the same bits: with one thread or two, with kernels just compiled or from the cache."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

INPUTS = Path(__file__).parents[2] / "inputs"


def files_of(
    scene: str, directory: Path, threads: int, *options: str, cache: Path | None = None
) -> dict[str, bytes]:
    """Run a scene in a process (and compile cache, if asked) of its own; its tables and archives by name."""
    environment = dict(os.environ)
    if cache is not None:
        environment.pop("NUMBA_CACHE_DIR", None)
        environment["MPMCLI_CACHE_DIR"] = str(cache)
    path = stripes(directory.with_suffix(".yaml")) if scene == "stripes" else INPUTS / scene
    command = [sys.executable, "-m", "mpmcli.cli.main", "run", str(path), "-o", str(directory), "-q"]
    command += ["--threads", str(threads), *options]
    done = subprocess.run(command, cwd=directory.parent, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    found = {p.relative_to(directory).as_posix(): p for p in directory.rglob("*") if p.is_file()}
    return {
        n: p.read_bytes() for n, p in sorted(found.items()) if p.suffix in (".csv", ".vtu", ".pvd", ".npz")
    }


def stripes(path: Path) -> Path:
    """Eight layers of two fields that shake and slide, in contact amid cells: enough nodes for parallel kernels."""
    bodies = [
        f"  - {{name: s{i}, field: {'ab'[i % 2]}, material: soft, velocity: ['{(-1) ** i}*sin(y/2)', 'cos(x/3+{i})'], "
        f"particles_per_axis: 4, region: {{kind: box, lower: [0, {3 * i + 0.5}], upper: [46, {3 * i + 3.5}]}}}}"
        for i in range(8)
    ]
    text = """version: 1
analysis: {kind: plane_strain}
grid: {lower: [-8, -8], upper: [54, 32], cell: 1}
method: {shape: ugimp, transfer: {kind: fmpm, order: 2}}
materials: {soft: {kind: neo_hookean, density: 1, E: 100, nu: 0.3}}
contact: {law: {kind: coulomb, friction: 0.3}}
time: {end: 0.6, courant: 0.2}
archive:
  particles: {every: 0.3, fields: [velocity, stress, contact_normal]}
  grid: {every: 0.3, fields: [mass, velocity]}
  globals: {every: 0.01}
bodies:
"""
    path.write_text(text + "\n".join(bodies) + "\n")
    return path


def least_contact_nodes(files: dict[str, bytes]) -> int:
    """Fewest contact nodes in a row of the table after the first."""
    header, _, *rows = files["globals.csv"].decode().splitlines()
    at = header.split(",").index("contact_nodes")
    return min(int(float(row.split(",")[at])) for row in rows)


SCENES = {
    "block_impact.yaml": ("--until", "0.03", "--set", "archive.grid={every: 0.02}"),
    "shock_nickel_symmetry.yaml": ("--until", "4e-4"),
    "stretched_bar.yaml": (),
    "heat_flying_disk.yaml": (
        *("--until", "3", "-D", "s=0.01", "--set", "grid.cell=0.25", "--set", "archive.particles.every=2"),
        *("--set", "heat.transfer={kind: fmpm, order: 3, every_steps: 2}"),
    ),
    "stripes": (),
}


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_threads_never_change_a_bit(tmp_path, scene):
    first, *others = (
        files_of(scene, tmp_path / name, n, *SCENES[scene])
        for name, n in (("a", 1), ("b", 2), ("c", 2), ("d", 1))
    )
    assert "globals.csv" in first
    assert sum(name.endswith(".vtu") for name in first) >= (4 if scene == "stripes" else 2)
    if scene == "stripes":
        assert least_contact_nodes(first) >= 512
    for other in others:
        assert other.keys() == first.keys()
        assert [name for name in first if first[name] != other[name]] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "options"), [("elastic_sphere_3d.yaml", ("--until", "0.5")), ("stripes", ())]
)
def test_the_run_that_compiles_gives_the_same_bits(tmp_path, scene, options):
    cache = tmp_path / "cache"
    cold, warm, threads = (
        files_of(scene, tmp_path / name, n, *options, cache=cache)
        for name, n in (("cold", 2), ("warm", 2), ("one", 1))
    )
    assert cold == warm
    assert cold == threads
