"""A resumed run gives the same bytes as a straight one, whatever the scene uses and wherever it stopped."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.output.checkpoint import read_checkpoint
from mpmcli.run import run_loop
from mpmcli.run.api import run
from mpmcli.scene.loader import load_scene

MAY_DIFFER = {"run.json", "run.log"}

SOFT = {"kind": "neo_hookean", "density": 1.5, "E": 100.0, "nu": 0.3}
WARM = SOFT | {"heat_capacity": 1.0, "conductivity": 5.0}


def box(lower, upper) -> dict[str, Any]:
    return {"kind": "box", "lower": lower, "upper": upper}


def body(name: str, lower, upper, velocity=(), material="soft", **more: Any) -> dict[str, Any]:
    return {
        "name": name, "material": material, "region": box(lower, upper), "velocity": list(velocity), **more
    }  # fmt: skip


def scene_of(analysis: str, cells: int, transfer: dict[str, Any], **keys: Any) -> dict[str, Any]:
    d = {"uniaxial_stress": 1, "3d": 3}.get(analysis, 2)
    lower = [0] * d if analysis == "axisymmetric" else [-cells] * d
    method = {"shape": "ugimp", "update": "usl", "transfer": transfer} | keys.pop("method", {})
    return {
        "version": 1,
        "analysis": {"kind": analysis},
        "grid": {"lower": lower, "upper": [cells] * d, "cell": 1},
        "method": method,
        "materials": {"soft": SOFT},
        "time": {"end": 10.0, "courant": 0.3, "max_steps": 14},
        **keys,
    }


TWO = [body("left", [-3, -2], [0, 2], [3, "0.5*y"]), body("right", [0, -2], [3, 2], [-3, -1])]
FLOOR = {"name": "floor", "kind": "symmetry", "plane": {"axis": "y", "at": -2}}

SCENES: dict[str, dict[str, Any]] = {
    "bar": scene_of(
        "uniaxial_stress", 6, {"kind": "fmpm", "order": 3},
        method={"shape": "lcpdi", "update": "usl+", "damping": {"particle": 0.1, "grid": 0.1}},
        bodies=[body("bar", [-4], [4], ["2*sin(x)"])],
        boundary=[{"name": "end", "kind": "wall", "normal": [-1], "position": "4 - 2*t", "velocity": -2}],
        loads=[
            {"name": "pull", "kind": "traction", "on": {"body": "bar", "face": {"axis": "x", "side": "lower"}},
             "traction": ["x*cos(t)"]},
            {"name": "push", "kind": "particle_force", "on": {"box": {"lower": [0], "upper": [2]}}, "force": ["1 + t"]},
        ],
        probes=[{"name": "tip", "kind": "particle", "body": "bar", "near": [-4], "columns": ["position", "stress"]}],
    ),
    "contact": scene_of(
        "plane_strain", 6, {"kind": "fmpm", "order": 2},
        materials={"soft": SOFT, "tool": {"kind": "rigid"}},
        bodies=[*TWO, body("tool", [-4, 2], [4, 3], ["sin(t)", "-2 - t"], "tool")],
        contact={"law": {"kind": "coulomb", "friction": 0.3}},
        boundary=[FLOOR],
        loads=[{"name": "weight", "kind": "gravity", "acceleration": [0, "-9.81*t"]}],
        probes=[{"name": "joint", "kind": "point", "at": [0, 0], "columns": ["velocity", "contact_normal"]}],
    ),
    "lost": scene_of(
        "plane_strain", 6, {"kind": "flip"},
        bodies=[body("flying", [-2, -1], [5, 2], ["20 + 5*x", "y"])],
        domain={"on_exit": "delete"},
        probes=[{"name": "gone", "kind": "particle", "body": "flying", "near": [5, 0]}],
    ),
}  # fmt: skip

SLOW: dict[str, dict[str, Any]] = {
    "adhesion": scene_of(
        "plane_strain", 6, {"kind": "xpic", "order": 2, "every_steps": 3},
        bodies=[body("left", [-3, -2], [0, 2], [-2, "0.5*y"]), body("right", [0, -2], [3, 2], [2, 0])],
        contact={"law": {"kind": "adhesion_friction", "normal_strength": 9, "shear_strength": 5, "friction": 0.2},
                 "separation": {"kind": "displacement"}},
        archive={"particles": {"every": 0.02}},
    ),
    "ring": scene_of(
        "axisymmetric", 6, {"kind": "fmpm", "order": 3, "dynamic": {"metric": "means", "tolerance": 0.02}},
        bodies=[body("ring", [0, 1], [3, 4], ["-0.5*x", "1 - x"])],
        boundary=[{"name": "held", "kind": "velocity", "on": {"body": "ring", "face": {"axis": "y", "side": "lower"}},
                   "direction": "y", "value": "1 - t"}],
        loads=[{"name": "spin", "kind": "body_force", "acceleration": ["x", "-y*t"], "coordinates": "initial"}],
    ),
    "space": scene_of(
        "3d", 4, {"kind": "xpic", "order": 3},
        method={"shape": "lcpdi", "update": "usavg+"},
        bodies=[body("low", [-2, -2, -2], [2, 2, 0], ["0.3*y", 1, 2]),
                body("high", [-1, -1, 0], [1, 1, 2], [0, 0, -2])],
        contact={"law": {"kind": "coulomb", "friction": 0.3}, "normal": {"kind": "irls", "reuse": True}},
    ),
    "shock": scene_of(
        "plane_strain", 6, {"kind": "fmpm", "order": 2, "velocity_gradient": True},
        method={"shape": "b2cpdi", "artificial_viscosity": {"linear": 0.4, "quadratic": 4}, "heating": "adiabatic"},
        materials={"soft": {"kind": "mie_gruneisen", "density": 8.87e-3, "K": 188000, "S1": 1.44, "gamma0": 2,
                            "heat_capacity": 0.44e6}},
        bodies=[body("bar", [-4, -2], [4, 2])],
        boundary=[FLOOR, {"name": "piston", "kind": "wall", "normal": [-1, 0.1], "position": ["4 - 800*t", 0],
                          "velocity": -800}],
    ),
    "large": scene_of(
        "plane_strain", 40, {"kind": "fmpm", "order": 2},
        bodies=[body("left", [-30, -9], [0, 9], [3, "0.5*y"]), body("right", [0, -9], [30, 9], [-3, -1])],
        contact={"law": {"kind": "coulomb", "friction": 0.3}},
    ),
    "blend": scene_of(
        "plane_strain", 6, {"kind": "fmpm", "order": 4, "blend": {"order": 2, "fraction": 0.7}, "every_courant": 0.7},
        method={"shape": "lcpdi", "update": "usavg"},
        bodies=TWO,
        contact={"law": {"kind": "velocity_friction", "friction": 0.3, "viscosity": 0.01}, "fields": "body"},
        domain={"on_exit": "stop_at_wall"},
    ),
    "heat": scene_of(
        "plane_strain", 6, {"kind": "fmpm", "order": 2},
        heat={"transfer": {"kind": "fmpm", "order": 3, "every_steps": 2}, "interval": 2},
        materials={"soft": WARM | {"conductivity": [9, 3, 1]}},
        bodies=[body("left", [-3, -2], [0, 2], [9, "5*y"], temperature="300 + 20*x*y"),
                body("right", [0, -2], [3, 2], [-3, -1], temperature=350)],
        boundary=[FLOOR, {"name": "hot", "kind": "temperature", "value": "400 + t",
                          "on": {"plane": {"axis": "x", "at": -2}}}],
        probes=[{"name": "tip", "kind": "particle", "body": "left", "near": [0, 2],
                 "columns": ["temperature", "heat_flux"]}],
    ),
    "warm ring": scene_of(
        "axisymmetric", 6, {"kind": "flip"},
        heat={}, materials={"soft": WARM},
        bodies=[body("ring", [0, 1], [3, 4], ["40 + 9*x", "1 - x"], temperature="300 + 20*x*y")],
        domain={"on_exit": "delete"},
    ),
    "interfaces": scene_of(
        "axisymmetric", 6, {"kind": "fmpm", "order": 2},
        bodies=[body("low", [0, 0], [3, 1.5], ["x", "-1"]), body("middle", [0, 1.5], [3, 3.5]),
                body("high", [0, 3.5], [3, 5], ["0.5*x", 2])],
        contact={"law": {"kind": "coulomb", "friction": 0.3}, "interface": {"jump": "edges"},
                 "pairs": [{"between": ["low", "middle"],
                            "law": {"kind": "linear_interface", "normal": 200, "tangential": 50}},
                           {"between": ["middle", "high"],
                            "law": {"kind": "linear_interface", "normal": 90, "tangential": "perfect"}}]},
        probes=[{"name": "joint", "kind": "pair", "between": ["high", "middle"]},
                {"name": "bottom", "kind": "pair", "between": ["low", "middle"],
                 "columns": ["interface_energy", "interface_area", "contact_force"]},
                {"name": "node", "kind": "point", "at": [1, 3.5], "columns": ["interface_jump", "interface_traction"]}],
        archive={"grid": {"every": 0.05, "fields": ["interface_jump", "interface_traction", "interface_damage"]}},
    ),
    "cohesive": scene_of(
        "plane_strain", 6, {"kind": "fmpm", "order": 2},
        bodies=[body("left", [-3, -2], [0, 2], [-2, "0.5*y"]), body("right", [0, -2], [3, 2], [2, 0])],
        contact={"law": {"kind": "cohesive", "normal": {"shape": "triangular", "strength": 9, "opening": 0.3},
                         "tangential": {"shape": "triangular", "strength": 9, "opening": 0.3},
                         "mixing": {"kind": "power", "exponent": 2}, "closed": {"kind": "coulomb", "friction": 0.2}}},
        probes=[{"name": "joint", "kind": "pair", "between": ["left", "right"],
                 "columns": ["cohesive_work", "broken_area", "jump_normal"]}],
        archive={"particles": {"every": 0.02, "fields": ["damage_of_bond"]},
                 "grid": {"every": 0.05, "fields": ["interface_damage", "interface_traction"]}},
    ),
    "hot metal": scene_of(
        "plane_strain", 6, {"kind": "flip"},
        method={"update": "usavg", "heating": "isothermal"},
        heat={"interval": 3}, archive={"grid": {"every": 0.05, "fields": ["temperature", "heat_capacity"]}},
        materials={"soft": WARM | {"kind": "j2_plastic", "expansion": 1e-3,
                                            "hardening": {"kind": "linear", "yield_stress": 1}}},
        bodies=[body("block", [-3, -2], [3, 2], ["x", "-y"], temperature="300 + 9*x*y")],
    ),
}  # fmt: skip


def load(scene: dict[str, Any]):
    """The scene, with a checkpoint after every step and archives after some."""
    archive = {"particles": {"every": 0.05}, "globals": {"every": 0.02}, "checkpoint": {"every": 2e-5}}
    if "contact" in scene or scene.get("probes"):
        archive["grid"] = {"every": 0.08}
    archive |= scene.get("archive", {})
    return load_scene(yaml.safe_dump(scene | {"archive": archive}))


class Straight:
    """A run without interruption, and its checkpoints by step."""

    def __init__(self, scene: dict[str, Any], directory: Path, monkeypatch: pytest.MonkeyPatch):
        self.directory, self.loaded = directory, load(scene)
        self.saved: dict[int, bytes] = {}
        write = run_loop.write_checkpoint

        def keep(folder, arrays, facts):
            path = write(folder, arrays, facts)
            self.saved[facts["step"]] = path.read_bytes()

        with monkeypatch.context() as patch:
            patch.setattr(run_loop, "write_checkpoint", keep)
            self.outcome = run(self.loaded, directory, progress=False, verbosity=-1, threads=2)
        assert self.outcome.exit_code == 0

    def stopped_after(self, step: int, directory: Path) -> Path:
        """The folder as a crash left it: a checkpoint of this step, and what was written since."""
        shutil.copytree(self.directory, directory)
        (directory / "checkpoint.npz").write_bytes(self.saved[step])
        return directory


def files_of(directory: Path) -> dict[str, bytes]:
    paths = (path for path in directory.rglob("*") if path.is_file())
    return {str(p.relative_to(directory)): p.read_bytes() for p in paths if p.name not in MAY_DIFFER}


def assert_same(directory: Path, other: Path) -> None:
    found, expected = files_of(directory), files_of(other)
    assert sorted(found) == sorted(expected)
    different = [name for name in found if found[name] != expected[name]]
    if "checkpoint.npz" in different:
        one, two = (read_checkpoint(folder / "checkpoint.npz").arrays for folder in (directory, other))
        assert list(one) == list(two)
        different += [name for name in one if one[name].tobytes() != two[name].tobytes()]
    assert not different


def check_resuming(scene: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Straight:
    straight = Straight(scene, tmp_path / "straight", monkeypatch)
    last = straight.outcome.steps
    assert len(straight.saved) == last + 1
    for step in (0, 1, last // 2, last - 1):
        folder = straight.stopped_after(step, tmp_path / f"from_{step}")
        outcome = run(load(scene), folder, resume=True, progress=False, verbosity=-1, threads=1)
        assert (outcome.exit_code, outcome.steps) == (0, last)
        assert_same(folder, straight.directory)
    return straight


@pytest.mark.parametrize("name", [*SCENES, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_a_resumed_run_gives_the_same_bytes(name, tmp_path, monkeypatch):
    straight = check_resuming((SCENES | SLOW)[name], tmp_path, monkeypatch)
    arrays = read_checkpoint(straight.directory / "checkpoint.npz").arrays
    if name == "contact":
        assert arrays["simulation.order.version"] > 1
    if name == "adhesion":
        bond = arrays["simulation.particles.bond"]
        assert 0.0 < bond.mean() < 1.0
    if name == "lost":
        assert arrays["simulation.state.extra.deleted_particles"] > 0
    if name == "space":
        assert len(arrays["simulation.contact.guesses"]) > 0
    if name == "hot metal":
        assert arrays["simulation.state.work.bath_heat"] != 0
        assert np.ptp(arrays["simulation.particles.T_stress"]) > 10
    if name == "cohesive":
        broken = arrays["simulation.particles.interface"][2]
        assert set(broken) == {-1.0, 1.0}  # never bonded, broken
        assert arrays["simulation.contact.interface_broken_area"].sum() > 0.0
    if name == "interfaces":
        assert (arrays["simulation.contact.interface_energy"][[0, 2]] > 0.0).all()
        assert np.isfinite(arrays["simulation.contact.interface_start_gap"][[0, 2]]).all()


def test_resumed_again_and_again_and_after_an_archive(tmp_path, monkeypatch):
    scene = SCENES["bar"]
    straight = Straight(scene, tmp_path / "straight", monkeypatch)
    folder = tmp_path / "again"
    times = {step: read_time(bytes_, tmp_path) for step, bytes_ in straight.saved.items()}
    assert run(load(scene), folder, until=times[3], progress=False, verbosity=-1).steps == 3
    for step in (4, 9, 10, straight.outcome.steps):
        outcome = run(load(scene), folder, until=times[step], resume=True, progress=False, verbosity=-1)
        assert (outcome.exit_code, outcome.steps) == (0, step)
    assert_same(folder, straight.directory)


def read_time(contents: bytes, folder: Path) -> float:
    path = folder / "one.npz"
    path.write_bytes(contents)
    return read_checkpoint(path).time
