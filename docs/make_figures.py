"""Draw the pictures of README and documentation from the archives of runs.

    mpmcli run inputs/block_impact.yaml --overwrite
    python docs/make_figures.py results/block_impact

Needs matplotlib and pandas (the extra "test" has both).
"""

from __future__ import annotations

import argparse
import xml.etree.ElementTree as xml
from io import BytesIO
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from PIL import Image
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

IMAGES = Path(__file__).parent / "images"
TIMES = (0.0, 0.04, 0.08, 0.12, 0.2)
"""Times of the block impact that are shown [ms]."""


def read_series(pvd: Path) -> dict[float, Path]:
    """The files of a ParaView time series by their time."""
    entries = xml.parse(pvd).getroot().iter("DataSet")
    return {float(entry.attrib["timestep"]): pvd.parent / entry.attrib["file"] for entry in entries}


def read_particles(vtu: Path, field: str) -> tuple[np.ndarray, np.ndarray]:
    """Positions (N, 3) and one field (N,) or (N, components) of an archive."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(vtu))
    reader.Update()
    grid = reader.GetOutput()
    return (vtk_to_numpy(grid.GetPoints().GetData()), vtk_to_numpy(grid.GetPointData().GetArray(field)))


def draw_block_impact(folder: Path, picture: Path) -> None:
    """Pressure of the particles at some times, above the energies over time."""
    series = read_series(folder / "particles.pvd")
    table = pd.read_csv(folder / "globals.csv")
    figure = plt.figure(figsize=(8.0, 9.4), dpi=90, layout="constrained")
    rows = figure.add_gridspec(
        len(TIMES) + 1, 2, height_ratios=[1.0] * len(TIMES) + [1.7], width_ratios=[40, 1]
    )
    for row, time in enumerate(TIMES):
        shown = min(series, key=lambda t: abs(t - time))
        X, pressure = read_particles(series[shown], "pressure")
        axes = figure.add_subplot(rows[row, 0])
        dots = axes.scatter(
            X[:, 0], X[:, 1], c=pressure, s=3.2, marker="s", cmap="RdBu_r", vmin=-100, vmax=100, linewidths=0
        )
        axes.set(aspect="equal", xlim=(-66, 66), ylim=(-12.5, 12.5), yticks=[-10, 0, 10], ylabel="y [mm]")
        axes.set_facecolor("0.85")
        axes.set_title(f"{shown:.2f} ms", loc="left", fontsize=9, pad=2)
        axes.tick_params(labelbottom=row == len(TIMES) - 1)
    axes.set_xlabel("x [mm]")
    figure.colorbar(dots, cax=figure.add_subplot(rows[: len(TIMES), 1]), label="pressure [MPa]")
    energies = figure.add_subplot(rows[-1, :])
    kinetic, work = table["kinetic_energy"], table["stress_work"]
    energies.plot(table["time"], kinetic, label="kinetic energy")
    energies.plot(table["time"], work, label="stress work")
    energies.plot(table["time"], kinetic + work, color="black", label="sum")
    energies.set(xlabel="time [ms]", ylabel="energy [mJ]", xlim=(0, table["time"].iloc[-1]), ylim=(0, None))
    energies.legend(frameon=False, ncols=3, loc="center right")
    save(figure, picture)


def save(figure: Figure, picture: Path) -> None:
    """Write a picture with a palette of 256 colours, which keeps it small."""
    picture.parent.mkdir(parents=True, exist_ok=True)
    drawn = BytesIO()
    figure.savefig(drawn, format="png")
    plt.close(figure)
    Image.open(drawn).convert("RGB").quantize(256).save(picture, optimize=True)


def main() -> None:
    """Draw all pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="results of inputs/block_impact.yaml")
    arguments = parser.parse_args()
    draw_block_impact(arguments.folder, IMAGES / "block_impact.png")


if __name__ == "__main__":
    main()
