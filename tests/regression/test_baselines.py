"""Short scenes against tables of earlier runs; MPMCLI_REWRITE_BASELINES=1 writes the tables anew."""

import os
import shutil
from pathlib import Path

import pytest

from mpmcli.results.compare import compare
from mpmcli.run.api import run
from mpmcli.scene.loader import load_scene

HERE = Path(__file__).parent
INPUTS = HERE.parents[1] / "inputs"
COARSE = ("grid.cell=2", "time.end=0.16", "archive.particles=null", "archive.globals={every: 0.01}")

# name, scene, changes; energies to 1e-6 of their size, sums that cancel to round-off by an absolute tolerance
CASES = [
    ("block_impact_flip", "block_impact.yaml", ("method.transfer={kind: flip}", *COARSE)),
    ("block_impact_fmpm4", "block_impact.yaml", COARSE),
    (
        "vibrating_bar_fmpm4",
        "vibrating_bar.yaml",
        ("time.courant=0.5", "time.end=80", "archive.particles=null"),
    ),
    ("heat_slab_flip", "heat_slab.yaml", ("archive.particles=null", "archive.globals={every: 0.01}")),
    pytest.param(
        "taylor_bar_fmpm2",
        "taylor_bar.yaml",
        ("time.end=0.02", "archive.particles=null", "archive.globals={every: 0.002}"),
        marks=pytest.mark.slow,
    ),
]
TOLERANCES = {
    "momentum_*": (1e-6, 1e-9),
    "angular_momentum*": (1e-6, 1e-6),
    "center_*": (1e-7, 1e-9),
    "velocity_*": (1e-6, 1e-7),
    "stress_*": (1e-6, 1e-6),
    "reaction_*": (1e-5, 1e-6),
    "energy_error": (0.0, 1e-8),
    "heat_error": (0.0, 1e-10),
    "*_work": (1e-6, 1e-7),
    "*_energy": (1e-6, 1e-7),
}


@pytest.mark.parametrize(("name", "scene", "sets"), CASES)
def test_table_is_that_of_an_earlier_run(tmp_path, name, scene, sets):
    outcome = run(load_scene(INPUTS / scene, sets=sets), tmp_path / "run", progress=False, verbosity=-1)
    assert outcome.exit_code == 0
    table, baseline = tmp_path / "run" / "globals.csv", HERE / "baselines" / f"{name}.csv"
    if os.environ.get("MPMCLI_REWRITE_BASELINES"):
        baseline.parent.mkdir(exist_ok=True)
        shutil.copyfile(table, baseline)
    assert [str(d) for d in compare(table, baseline, rtol=1e-6, tolerances=TOLERANCES)] == []
