"""Draw the bar of ``inputs/drawn_bar.yaml`` by every method: the table of ``docs/choose.md`` and its picture.

    python docs/make_drawn_bar.py [table | picture]

A run for the table ends at the stretch at which the mean stress of the bar is first 1 % off the closed form, or at 2.5.
The 100 runs take some minutes, the five of the picture in ``docs/verification/bars.md`` less than one.
"""

from __future__ import annotations

import argparse
import runpy
from pathlib import Path

from mpmcli.core.errors import SimulationError
from mpmcli.results.pictures.drawing import new_figure
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.study.report import save_picture

HERE = Path(__file__).parent
SCENE = HERE.parent / "inputs" / "drawn_bar.yaml"
TABLE = HERE / "tables" / "drawn_bar.md"
PICTURE = HERE / "images" / "drawn_bar.png"
SHAPES = ("lcpdi", "b2cpdi", "qcpdi", "ugimp", "b2gimp")
UPDATES = ("usl", "usavg", "usf", "usl+", "usavg+")
TRANSFERS = {
    "FLIP": "{kind: flip}",
    "FMPM(2)": "{kind: fmpm, order: 2}",
    "FMPM(4)": "{kind: fmpm, order: 4}",
    "FMPM(8)": "{kind: fmpm, order: 8}",
}
TOLERANCE = 0.01
RATE, MODULUS = 0.01, 0.75
"""Constants of the scene."""
EVERY = 10
"""Steps between two comparisons."""
LONGEST = 2.5


def stretch_of_first_error(shape: str, update: str, transfer: str) -> float | None:
    """Return the stretch at which the mean Cauchy stress is first off by ``TOLERANCE``, None if it never is.

    ``transfer`` is written as in scenes. The closed form of the neo-Hookean bar with ν = 0 is σ = E (λ² − 1)/(2λ).
    """
    depth = 1.5 if shape.startswith("b2") else 1
    sets = [f"method.shape={shape}", f"method.update={update}", f"method.transfer={transfer}"]
    sets += [f"boundary.{side}.depth={depth}" for side in ("left", "right")]
    simulation = Simulation(load_scene(SCENE, sets=sets), 1)
    while (stretch := 1.0 + RATE * simulation.time) < LONGEST:
        try:
            simulation.step()
        except SimulationError:
            return stretch
        if simulation.state.step % EVERY == 0:
            stretch, ratio = stress_ratio(simulation)
            if abs(ratio - 1.0) > TOLERANCE:
                return stretch
    return None


def stress_ratio(simulation: Simulation) -> tuple[float, float]:
    """Return the stretch of the bar, and its mean Cauchy stress over the closed form."""
    p = simulation.particles
    stretch = 1.0 + RATE * simulation.time
    exact = 0.5 * MODULUS * (stretch * stretch - 1.0) / stretch
    mean = float((p.tau[0] * p.vol0).sum() / (p.determinant() * p.vol0).sum())
    return stretch, mean / exact


def draw(path: Path) -> None:
    """Draw the mean stress over the closed form against the stretch, with lcpdi and FMPM(4)."""
    figure = new_figure(7.0, 3.4)
    axes = figure.add_subplot()
    for update, style in zip(UPDATES, ("-", "--", "-", "--", ":"), strict=True):
        simulation = Simulation(load_scene(SCENE, sets=[f"method.update={update}"]), 1)
        found = []
        while simulation.time < (LONGEST - 1.0) / RATE:
            simulation.step()
            if simulation.state.step % EVERY == 0:
                found.append(stress_ratio(simulation))
        axes.plot(*zip(*found, strict=True), style, label=update)
    axes.set(xlabel="stretch", ylabel="mean stress over the closed form")
    save_picture(figure, axes, path)
    runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](path)


def table() -> str:
    """Return the table: a row for each shape function and transfer, a column for each strain update."""
    lines = [
        f"| shape | transfer | {' | '.join(f'`{u}`' for u in UPDATES)} |",
        "| --- " * (2 + len(UPDATES)) + "|",
    ]
    for shape in SHAPES:
        for name, transfer in TRANSFERS.items():
            found = [stretch_of_first_error(shape, update, transfer) for update in UPDATES]
            cells = ["–" if stretch is None else f"{stretch:.2f}" for stretch in found]
            lines.append(f"| `{shape}` | {name} | {' | '.join(cells)} |")
            print(lines[-1], flush=True)
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="?", choices=["table", "picture"], help="both by default")
    what = parser.parse_args().what
    if what != "table":
        draw(PICTURE)
    if what != "picture":
        TABLE.write_text(table(), encoding="utf-8")
