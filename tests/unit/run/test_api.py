"""The library: ``from mpmcli import load, run``."""

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import mpmcli
from mpmcli.core.errors import ArchiveError, RequestError, SceneError
from mpmcli.run import api

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 8], cell: 1}
materials:
  rock: {kind: linear_elastic, density: 1, E: 10, nu: 0.3}
bodies:
  - {name: block, material: rock, region: {kind: box, lower: [2, 2], upper: [4, 4]}}
time: {end: 0.1}
"""


def test_the_names_of_the_library():
    for name in mpmcli.__all__:
        assert callable(getattr(mpmcli, name)), name
    assert mpmcli.load is api.load
    with pytest.raises(AttributeError, match="'mpmcli' has no attribute 'lode'"):
        mpmcli.lode  # noqa: B018


def test_run_is_a_room_and_a_function_in_whatever_order():
    code = "from mpmcli import load, run\nfrom mpmcli.run.api import run as same\nfrom mpmcli import run as again\n"
    code += (
        "assert run is again and callable(run) and callable(same)\nimport mpmcli; assert mpmcli.run is run"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


def test_the_package_alone_imports_nothing():
    code = "import mpmcli, sys; print([m for m in ('numba', 'numpy', 'pydantic') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


def test_load_checks_names_of_columns_too():
    assert mpmcli.load(SCENE, sets=["time.end=2"]).scene.time.end == 2.0
    with pytest.raises(SceneError, match=r"scene:11:\d+ .*kinetic_energi"):
        mpmcli.load(SCENE + "archive: {globals: {every: 0.05,\n  columns: [kinetic_energi]}}\n")


def test_run_reads_scenes_itself_and_says_what_is_doubtful(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def loop(loaded, directory, *rest):
        return SimpleNamespace(run=lambda max_walltime: (loaded, directory))

    monkeypatch.setattr(api, "RunLoop", loop)
    monkeypatch.setattr(api, "_solver", lambda: lambda loaded, threads: None)
    monkeypatch.setattr(api, "_calls_of", lambda simulation, loaded: [])
    rock = "rock: {kind: linear_elastic, density: 1, E: 10, nu: 0.3}"
    text = SCENE.replace(rock, f"{rock}\n  spare: {{kind: tait_fluid, density: 1, K: 1}}")
    loaded, directory = mpmcli.run(text)
    assert list(loaded.scene.materials) == ["rock", "spare"]
    assert directory.as_posix() == "results/scene"
    assert "no body uses this material" in capsys.readouterr().err
    path = tmp_path / "block.yaml"
    path.write_text(SCENE)
    assert mpmcli.run(path)[1].as_posix() == "results/block"


def test_results_are_arrays(loaded, simulation, tmp_path):
    results = api.run(loaded, tmp_path / "out", make_simulation=simulation, progress=False).results
    assert repr(results) == f"<Results of 'Flight' in {tmp_path / 'out'}: finished>"
    assert results.globals.time == pytest.approx(np.arange(11) / 10)
    assert results["kinetic_energy"] == pytest.approx(np.full(11, 1.0))
    assert results.times == pytest.approx([0.0, 0.5, 1.0])
    last = results.particles()
    assert (last.time, last.count) == (pytest.approx(1.0), 2)
    assert last.X[:, 0] == pytest.approx([1.0, 2.0])
    assert results.particles(0.4)["velocity"].shape == (2, 3)
    with pytest.raises(RequestError, match="has no column 'kinetic_energi'; did you mean 'kinetic_energy'"):
        results["kinetic_energi"]
    with pytest.raises(RequestError, match="no array 'stress_xx'; did you mean 'stress'"):
        last["stress_xx"]
    assert ("mass" in results, "mass" in results.globals, "velocity" in last) == (True, True, True)
    assert ("masss" in results, "masss" in results.globals, "masss" in last) == (False, False, False)
    with pytest.raises(RequestError, match="time 3 is outside"):
        results.particles(3.0)


def test_resume_tells_why_it_cannot(tmp_path):
    with pytest.raises(ArchiveError, match="is not a results folder"):
        mpmcli.resume(tmp_path / "nowhere")
