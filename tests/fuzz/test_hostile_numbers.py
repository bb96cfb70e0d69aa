"""Every number of small scenes takes hostile values: ``validate`` answers with 0 or 3, in words, within a second.

A sample of those that are valid runs a step in plain Python, in which divisions by zero raise.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from commands import answered
from numbers_of_scenes import numbers_in, with_number

HOSTILE = [
    *(0, -1, 5e-324, 1e300, -1e300, 1e18, 3.7e-9, 1e9, math.nan, math.inf, True, None),
    *("1e400", "x", "t", "1/t", "sin(1e300*t)", "9" * 400),
    *([], {}),
]
SECONDS = 10.0
"""Ten times the second that is promised, for machines are busy."""
RUNS = 12
"""Valid scenes that run, of each base."""
FACE = {"axis": "x", "side": "upper"}
GRAVITY = {"name": "g", "kind": "gravity", "acceleration": [0.0, -1.0]}
CAM_CLAY = {"kind": "modified_cam_clay", "density": 1.0, "M": 1.2, "lambda": 0.8, "kappa": 0.2, "nu": 0.3}


def scene(stress: dict[str, Any] | None = None, material: dict[str, Any] | None = None, **keys: Any) -> Any:
    """A block of four cells in plane strain, with other keys."""
    block = {
        "name": "a",
        "material": "m",
        "particles_per_axis": 1,
        "region": {"kind": "box", "lower": [2.0, 2.0], "upper": [4.0, 4.0]},
        "velocity": [0.1, "0.1*x"],
    }
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain", "thickness": 1.0},
        "grid": {"lower": [0.0, 0.0], "upper": [6.0, 6.0], "cell": 1.0},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
        "materials": {"m": material or {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}},
        "bodies": [block | ({"stress": stress} if stress else {})],
        "time": {"end": 0.01, "step": 0.01},
        "archive": {"globals": {"every": 0.02}},
    } | keys


def wall(**keys: Any) -> dict[str, Any]:
    """A condition of a wall."""
    return {"name": "w", "kind": "wall", "normal": [1.0, 0.0], "position": 2.2, "velocity": 0.1} | keys


SCENES: dict[str, Any] = {
    "plain": scene(),
    "nodal_force": scene(loads=[{"name": "n", "kind": "nodal_force", "at": [3.0, 3.0], "force": [1.0, "t"]}]),
    "buoyancy": scene(loads=[{"name": "n", "kind": "buoyancy", "level": 3.0, "density": 0.5}, GRAVITY]),
    "absorbing": scene(
        loads=[
            {"name": "n", "kind": "absorbing", "on": {"body": "a", "face": FACE}}
            | {"pressure_wave": 10.0, "shear_wave": 5.0}
        ]
    ),
    "strain": scene({"kind": "strain", "xx": 0.01, "xy": 0.01}),
    "components": scene({"kind": "components", "xx": 0.01, "yy": -0.02, "xy": 0.01}),
    "geostatic": scene({"kind": "geostatic", "surface": 4.0, "surcharge": 1.0, "K0": 0.5}, loads=[GRAVITY]),
    "clay": scene(
        {"kind": "components", "xx": -0.2, "yy": -0.2, "zz": -0.2},
        CAM_CLAY | {"e0": 1.0, "p0": 0.4, "pressure": 0.2},
    ),
    "slurry": scene(
        None, {"kind": "bingham", "density": 1.0, "K": 10.0, "yield_stress": 0.01, "viscosity": 0.1}
    ),
    "soil": scene(
        {"kind": "strain", "xx": -0.001, "yy": -0.001},
        {"kind": "mohr_coulomb", "density": 1.0, "E": 100.0, "nu": 0.3, "friction": 30.0, "cohesion": 1.0},
    ),
    "wall": scene(boundary=[wall(gradient=0.01, depth=1.0, friction=0.3, cohesion=0.1)]),
    "periodic": scene(grid={"lower": [0.0, 0.0], "upper": [6.0, 6.0], "cell": 1.0, "periodic": ["x"]}),
    "damping": scene(
        method={
            "shape": "lcpdi",
            "transfer": {"kind": "fmpm", "order": 3},
            "artificial_viscosity": {"linear": 0.2, "quadratic": 2.0},
            "damping": {"grid": 1.0, "local": 0.5, "feedback": {"damps": "grid", "gain": 1.0, "target": 1.0}},
        }
    ),
    "limits": scene(
        domain={"on_exit": "delete", "volume_ratio": [0.5, 2.0]},
        probes=[{"name": "q", "kind": "point", "at": [3.0, 3.0], "columns": ["velocity"], "every": 0.02}],
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_hostile_numbers(name: str, tmp_path: Path, monkeypatch, plain_python):
    monkeypatch.setenv("MPMCLI_DEBUG", "1")
    base, path = SCENES[name], tmp_path / "scene.yaml"
    common = set() if name in ("plain", "periodic") else set(numbers_in(scene()))
    own = [place for place in numbers_in(base) if place not in common]
    assert own
    findings, valid = [], []
    for place in own:
        for value in HOSTILE:
            text = yaml.safe_dump(with_number(base, place, value), sort_keys=False)
            path.write_text(text, encoding="utf-8")
            code, wrong = answered(["validate", str(path)], {0, 3}, SECONDS)
            if wrong:
                findings.append(f"{place} = {value!r:.30}: {wrong}")
            elif code == 0:
                valid.append((place, value, text))
    assert valid
    for k in np.random.default_rng(7).permutation(len(valid))[:RUNS]:
        place, value, text = valid[k]
        path.write_text(text, encoding="utf-8")
        with plain_python():
            command = ["run", str(path), "-q", "-o", str(tmp_path / "out"), "--overwrite"]
            _, wrong = answered(command, {0, 3, 4})
        if wrong:
            findings.append(f"run with {place} = {value!r:.30}: {wrong}")
    assert findings == []
