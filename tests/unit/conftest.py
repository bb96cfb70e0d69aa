"""A results folder as a run would leave it, without a run."""

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

UNITS = {"length": "mm", "mass": "g", "time": "ms", "temperature": "K"}
TIMES = (0.0, 0.5, 1.0)
ANALYSES = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}


def lattice(d: int, count: int, step: float) -> np.ndarray:
    """(countᵈ, 3) centres of cubes, x fastest."""
    axis = (np.arange(count) + 0.5) * step
    places = np.meshgrid(*[axis] * d, indexing="ij")
    X = np.zeros((count**d, 3))
    for a, place in enumerate(reversed(places)):
        X[:, a] = place.ravel()
    return X


def write_archives(directory: Path, d: int, fields: tuple[str, ...], count: int) -> None:
    """Two bodies that are sheared more and more, half of the particles each."""
    from mpmcli.output.vtu import NINE, SYMMETRIC, Series, VtuWriter

    start = lattice(d, count, 0.5)
    number = len(start)
    owner = (np.arange(number) * 2 // number).astype(np.int32)
    series = Series(directory, "particles")
    for time in TIMES:
        F = np.tile(np.eye(3), (number, 1, 1))
        F[:, 0, 0] = 1.0 + 0.1 * time
        if d > 1:
            F[:, 0, 1] = 0.5 * time
        X = np.einsum("pij,pj->pi", F, start)
        stress = np.zeros((number, 6))
        stress[:, 0], stress[:, 3] = X[:, 0] - 1.0 + time, 2.0
        arrays = {
            "velocity": (np.stack([X[:, 0], 3.0 + 0 * X[:, 0], 0 * X[:, 0]], axis=1), tuple("XYZ")),
            "stress": (stress, SYMMETRIC),
            "deformation_gradient": (F.reshape(number, 9), NINE),
            "J": (np.linalg.det(F), ()),
        }
        always = [("id", np.arange(number), ()), ("body", owner, ()), ("material", owner, ())]
        (path,) = series.next_paths()
        VtuWriter().write(path, time, X, [*always, *((name, *arrays[name]) for name in fields)])
        series.add(time)


def write_table(path: Path, columns: dict[str, Any]) -> None:
    """A table of columns over time."""
    time = np.linspace(0.0, 1.0, 11)
    path.parent.mkdir(exist_ok=True)
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["step", "time", *columns])
        writer.writerows([i, t, *(column(t) for column in columns.values())] for i, t in enumerate(time))


@pytest.fixture
def make_results(tmp_path: Path) -> Callable[..., Path]:
    """Makes a results folder of ``d`` dimensions; ``changes`` replace keys of its manifest."""

    def make(
        d: int = 2,
        fields: tuple[str, ...] = ("velocity", "stress", "deformation_gradient"),
        count: int = 4,
        name: str = "results",
        **changes: Any,
    ) -> Path:
        directory = tmp_path / name
        directory.mkdir()
        write_archives(directory, d, fields, count)
        globals_ = {
            "kinetic_energy": lambda t: 3 - t,
            "stress_work": lambda t: t,
            "energy_error": lambda t: 0.01 * t,
            "momentum_x": lambda t: 1.0,
            "stress_xx[rubber]": lambda t: t,
            "stress_xy[rubber]": lambda t: -t,
            "reaction_x[base]": lambda t: 5 * t,
            "contact_force_x[left|right]": lambda t: t * t,
            "contact_nodes": lambda t: 4,
        }
        write_table(directory / "globals.csv", globals_)
        write_table(directory / "probes" / "tip.csv", {"velocity_x": lambda t: 2 * t})
        energies = dict.fromkeys(("kinetic_energy", "stress_work"), "mJ")
        units = {
            "globals.csv": energies
            | {"time": "ms", "momentum_x": "g*mm/ms", "stress_xx[rubber]": "MPa", "stress_xy[rubber]": "MPa"}
            | {"reaction_x[base]": "N", "contact_force_x[left|right]": "N", "contact_nodes": "1"},
            "probes/tip.csv": {"time": "ms", "velocity_x": "mm/ms"},
            "particles": {"Points": "mm", "velocity": "mm/ms", "stress": "MPa", "J": "1"},
        }
        region = {"kind": "box"}
        manifest = {
            "title": "Two blocks for 5 $ and 3 $",
            "scene": {
                "units": UNITS,
                "constants": {"T": 0.5},
                "analysis": {"kind": ANALYSES[d]},
                "grid": {"cell": [1.0] * d},
                "materials": {"rubber": {"kind": "neo_hookean"}, "steel": {"kind": "neo_hookean"}},
                "bodies": [
                    {"name": name, "region": region, "particles_per_axis": 2} for name in ("left", "_right$")
                ],
            },
            "bodies": ["left", "_right$"],
            "materials": ["rubber", "steel"],
            "units": units,
        }
        (directory / "run.json").write_text(json.dumps(manifest | changes))
        return directory

    return make
