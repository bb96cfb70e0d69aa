"""Draw the pressure under Hertz' cylinder, at nodes and as force per area over bins.

    python docs/make_hertz.py

runs ``inputs/hertz_contact.yaml`` with 2 and 4 particles per axis (some minutes) and writes
``docs/images/hertz_pressure.png``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.output.probes import nodal_values
from mpmcli.output.snapshot import Snapshot
from mpmcli.results.pictures.drawing import new_figure
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.study.report import save_picture

DOCS = Path(__file__).parent
SCENE = DOCS.parent / "inputs" / "hertz_contact.yaml"
CELL, HALF_WIDTH, LOAD = 0.6, 4.0, np.pi * 16 * 100 / 0.91 / (4 * 20) / 2
"""Of the scene [mm, mm, N]; the load is that of the half with x > 0."""

HIGHEST = 4 * LOAD / (np.pi * HALF_WIDTH)
"""Pressure in the middle by Hertz [MPa]."""

AVERAGED = 40
"""Steps at the end over which forces are averaged."""

Array = np.ndarray


def press(per_axis: int) -> tuple[Array, Array]:
    """Places x (n,) of the columns of nodes in contact at the end [mm], and the force (n,) on each [N]."""
    sets = (f"bodies.cylinder.particles_per_axis={per_axis}", "time.courant=0.34")
    simulation = Simulation(load_scene(SCENE, sets=sets))
    steps: list[tuple[Array, Array]] = []
    while simulation.time < 2.0:
        simulation.step()
        steps = [*steps[1 - AVERAGED :], nodal_forces(simulation)]
    x = np.unique(np.concatenate([place for place, _ in steps]))
    force = np.zeros(len(x))
    for place, pressed in steps:
        np.add.at(force, np.searchsorted(x, place), pressed / len(steps))  # several rows of nodes
    return x, force


def nodal_forces(simulation: Simulation) -> tuple[Array, Array]:
    """The same node by node in the last step."""
    contact: Any = simulation.contact
    contacts = contact.contacts
    snapshot = Snapshot(simulation.state)
    at = np.abs(nodal_values(snapshot, "contact_normal")).sum(axis=1) > 0.0
    traction = nodal_values(snapshot, "contact_traction")[at, 1]
    nodes = contacts.nodes.node[contacts.fields.slot[: contacts.count]]
    x = simulation.grid.coordinates(nodes)[0]
    real = x > -0.5 * CELL
    x, area = x[real], contacts.geometry.area[: contacts.count][real]
    force = np.abs(traction) * area
    return np.round(x / CELL) * CELL, force


def in_bins(x: Array, force: Array, edges: Array) -> Array:
    """Pressure (bins,) if a node's force is spread evenly over half a cell to both sides of it, but not over x < 0."""
    low, high = np.maximum(x - 0.5 * CELL, 0.0), x + 0.5 * CELL
    shared = np.minimum(high[:, None], edges[1:]) - np.maximum(low[:, None], edges[:-1])
    return (force / (high - low)) @ np.maximum(shared, 0.0) / np.diff(edges)


def hertz(edges: Array) -> Array:
    """Mean pressure (bins,) by Hertz."""
    u = np.minimum(edges / HALF_WIDTH, 1.0)
    return HIGHEST * HALF_WIDTH * np.diff(0.5 * (u * np.sqrt(1.0 - u * u) + np.arcsin(u))) / np.diff(edges)


def edges_of(cells: int) -> Array:
    """Edges of bins of so many cells, from the middle to beyond the contact; single cells lie about their nodes."""
    if cells == 1:
        return CELL * np.concatenate([[0.0], np.arange(11) + 0.5])
    return CELL * cells * np.arange(int(np.ceil(11 / cells)) + 1)


def errors(x: Array, force: Array, cells: int) -> tuple[float, float]:
    """Root mean square and largest difference to Hertz in the bins of the contact, over the highest pressure."""
    edges = edges_of(cells)
    difference = (in_bins(x, force, edges) - hertz(edges))[edges[:-1] < HALF_WIDTH] / HIGHEST
    return float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())


def draw(profiles: dict[int, tuple[Array, Array]], path: Path) -> None:
    """Pressures at nodes and over bins of three cells, for each number of particles per axis."""
    figure = new_figure(7.2, 4.2)
    axes = figure.add_subplot()
    fine = np.linspace(0.0, 1.0, 400)
    axes.plot(fine, np.sqrt(1.0 - fine**2), "k-", lw=1.2, label="Hertz")
    for colour, (per_axis, (x, force)) in zip(("C0", "C3"), profiles.items(), strict=True):
        width = np.where(x < 0.5 * CELL, 0.5 * CELL, CELL)
        axes.plot(
            x / HALF_WIDTH,
            force / width / HIGHEST,
            "o",
            c=colour,
            ms=4,
            alpha=0.6,
            label=f"nodes, {per_axis} per axis",
        )
        edges = edges_of(3)
        mean = in_bins(x, force, edges) / HIGHEST
        axes.stairs(
            mean, edges / HALF_WIDTH, color=colour, lw=1.6, label=f"bins of 3 cells, {per_axis} per axis"
        )
    axes.stairs(
        hertz(edges_of(3)) / HIGHEST, edges_of(3) / HALF_WIDTH, color="k", ls=":", label="Hertz in these bins"
    )
    axes.set(
        xlabel="place over the half width of the contact",
        ylabel="pressure over the highest",
        xlim=(0, 1.4),
        ylim=(0, 1.5),
    )
    save_picture(figure, axes, path)


if __name__ == "__main__":
    found = {per_axis: press(per_axis) for per_axis in (2, 4)}
    for per_axis, profile in found.items():
        for cells in (1, 2, 3, 4, 5):
            print(
                per_axis, "particles per axis, bins of", cells, "cells: rms, largest", errors(*profile, cells)
            )
    draw(found, DOCS / "images" / "hertz_pressure.png")
