"""Draw what the verification of cohesive joints shows.

    python docs/make_cohesive.py [NAME]

runs ``peel_apart.yaml`` with every shape, ``delamination.yaml`` and ``two_ply_3d.yaml`` (some minutes
in all) and writes ``cohesive_shapes.png``, ``cohesive_cantilever.png`` and ``cohesive_plies.png`` to ``docs/images``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from mpmcli.core.state import ContactView, InterfaceView
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.study.report import tidy

DOCS = Path(__file__).parent
INPUTS, IMAGES = DOCS.parent / "inputs", DOCS / "images"
sys.path.insert(0, str(DOCS.parent / "tests"))

from exact_cohesion import Mode  # noqa: E402

AREA, STRENGTH, TOUGHNESS = 10.0, 5.0, 0.5
"""Of ``peel_apart.yaml`` [mm², MPa, N/mm]."""
SHAPES: list[dict[str, Any]] = [
    {"shape": "triangular"},
    {"shape": "trilinear", "kink_opening": 0.4, "kink_strength": 0.3},
    {"shape": "cubic"},
    {"shape": "exponential", "alpha": 2.0},
]
BENDING, CORRECTION, NOTCH = 2300.0 / (1.0 - 0.33**2) * 18.0, 0.669 * 6.0, 24.9
"""E'I [N mm²], χh and a₀ [mm] of ``delamination.yaml``."""

Array = np.ndarray


def new_figure(width: float, height: float, rows: int, columns: int) -> tuple[Figure, Array]:
    """Make a figure with several axes (rows columns,)."""
    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, np.ravel(figure.subplots(rows, columns))


def finish(figure: Figure, axes: Array, name: str) -> None:
    """Write a picture to ``docs/images``."""
    for ax in axes:
        tidy(ax)
    figure.savefig(IMAGES / f"{name}.png", dpi=150)


def start(name: str, *sets: str) -> Simulation:
    """Make a simulation of a scene in ``inputs``."""
    return Simulation(load_scene(INPUTS / name, sets=sets))


def seen_in(s: Simulation) -> tuple[ContactView, InterfaceView]:
    """Contact and interfaces of the last step."""
    contact = s.state.contact
    assert contact is not None
    assert contact.interfaces is not None
    return contact, contact.interfaces


def shapes() -> None:
    """Measured tractions of all shapes over the opening, on the envelopes."""
    figure, axes = new_figure(7.0, 5.6, 2, 2)
    for keys, ax in zip(SHAPES, axes, strict=True):
        mode = Mode(keys, STRENGTH, TOUGHNESS)
        words = ", ".join(
            f"{k}: {v}" for k, v in (keys | {"strength": STRENGTH, "toughness": TOUGHNESS}).items()
        )
        s = start(
            "peel_apart.yaml",
            f"contact.law.normal={{{words}}}",
            "constants.turn=0.28",
            "constants.again=0.42",
        )
        seen = []
        while s.time < 1.0:
            s.step()
            contact, interfaces = seen_in(s)
            means = interfaces.means()
            seen.append((means.jump_normal[0], contact.force[0, 1] / AREA, means.area[0]))
        opening, stress, area = np.array(seen).T
        x = np.linspace(0.0, mode.opening, 400)
        ax.plot(x, mode.traction(x), color="0.6", linewidth=3, label="law")
        ax.plot(opening[area > 0.0], stress[area > 0.0], linewidth=1, label="measured")
        ax.set_title(keys["shape"])
        ax.set_xlabel("opening [mm]")
        ax.set_ylabel("traction [MPa]")
    finish(figure, axes, "cohesive_shapes")


def cantilever() -> None:
    """Load over opening of the double cantilever, beside beam theory."""
    s = start("delamination.yaml")
    seen = []
    while s.time < 3.5:
        s.step()
        opening = min(s.time / 2.5, 1.0)
        seen.append((s.time, opening, s.state.reactions["up"][1], seen_in(s)[1].broken_area[0]))
    time, opening, load, broken = np.array(seen).T
    window = round(0.25 / s.state.dt)
    smooth = np.convolve(load, np.full(window, 1.0 / window), mode="same")
    figure, axes = new_figure(8.0, 3.4, 1, 2)
    left, right = axes
    u = np.linspace(0.0, 1.0, 100)
    left.plot(u, 3.0 * BENDING * u / (NOTCH + CORRECTION) ** 3, color="0.6", label="beam, crack of 24.9 mm")
    reach = np.linspace(NOTCH, 34.0, 100) + CORRECTION
    force = np.sqrt(BENDING * 0.2) / reach
    left.plot(
        force * reach**3 / (3.0 * BENDING),
        force,
        "--",
        color="0.3",
        label="beam, energy release rate 0.2 N/mm",
    )
    rising = (time < 2.5 - 0.13) & (time > 0.13)
    left.plot(opening, load, linewidth=0.5, alpha=0.5)
    left.plot(opening[rising], smooth[rising], label="mean over 0.25 ms")
    left.set(xlabel="opening of each arm [mm]", ylabel="load [N]", ylim=(0, 5))
    left.legend(fontsize=7)
    right.plot(time, NOTCH + broken)
    right.axhline(34.0, linestyle="--", color="0.3")
    right.set(xlabel="time [ms]", ylabel="debonded length [mm]")
    finish(figure, axes, "cohesive_cantilever")


def plies() -> None:
    """Damage of the joint of two plies, seen from above, at three times."""
    s = start("two_ply_3d.yaml")
    figure, axes = new_figure(9.0, 3.2, 1, 3)
    shown: Any = None
    for ax, end in zip(axes, (0.01, 0.02, 0.05), strict=True):
        while s.time < end:
            s.step()
        p, view = s.particles, seen_in(s)[1]
        X0 = np.asarray(p.X0)
        near = np.flatnonzero((p.body == 1) & (np.abs(X0[2] + 1.75) < 0.01))
        shown = ax.scatter(
            X0[0, near], X0[1, near], c=view.particle_damage()[near], s=9, marker="s", vmin=0, vmax=1
        )
        ax.set(
            title=f"{1000 * end:.0f} µs, {view.broken_area.sum():.0f} mm²", aspect="equal", xlabel="x [mm]"
        )
    axes[0].set_ylabel("y [mm]")
    figure.colorbar(shown, ax=list(axes), label="damage of the joint")
    finish(figure, axes, "cohesive_plies")


if __name__ == "__main__":
    for draw in (shapes, cantilever, plies):
        if len(sys.argv) < 2 or draw.__name__ == sys.argv[1]:
            draw()
