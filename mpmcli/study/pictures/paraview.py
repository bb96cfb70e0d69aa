"""A script with which ParaView opens a result, coloured and sized right."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.output.files import PARAVIEW
from mpmcli.output.results import Frame, Results, unit_in_brackets
from mpmcli.study.pictures.drawing import shorten
from mpmcli.study.pictures.errors import PictureError
from mpmcli.study.pictures.quantities import DEFAULTS, domains_of

SCRIPT = '''\
"""{title}

Run it in ParaView by Macros > Import New Macro, or by View > Python Shell > Run Script.
"""

from paraview.simple import *

particles = PVDReader(registrationName={name!r}, FileName={pvd!r})
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
view = GetActiveViewOrCreate("RenderView")

shown = Show(particles, view)
shown.SetRepresentationType("Point Gaussian")
shown.ShaderPreset = {shader!r}
shown.GaussianRadius = {radius!r}  # half a particle
scene.GoToLast()
ColorBy(shown, {color!r})
shown.RescaleTransferFunctionToDataRange(False, True)
shown.SetScalarBarVisibility(view, True)
bar = GetScalarBar(GetColorTransferFunction({array!r}), view)
bar.Title = {label!r}
bar.ComponentTitle = {component!r}

view.InteractionMode = {mode!r}
view.AxesGrid.Visibility = 1
view.AxesGrid.XTitle, view.AxesGrid.YTitle, view.AxesGrid.ZTitle = {axes!r}
ResetCamera(view)
Render(view)
'''


def paraview_script(results: Results, frame: Frame, color: str | None = None) -> str:
    """The text of the script.

    Parameters
    ----------
    frame
        Any archive of the series; all hold the same arrays.
    color
        An array of the archive, or a component (``stress_xx``) or magnitude of one.

    Raises
    ------
    PictureError
        If the archive has no such array.
    """
    d = results.dimensions(frame)
    array, component = _array_of(frame, color)
    edges = domains_of(results, frame).edges
    width = float(np.median(np.linalg.norm(edges, axis=1).min(axis=1))) if len(edges) else 0.5
    units = results.units_of("particles")
    letters = "rzt" if results.is_axisymmetric else "xyz"
    return SCRIPT.format(
        title=shorten(ascii(results.title)[1:-1], 110).replace('"', "'").replace("\\", "/"),
        name=results.directory.resolve().name,
        pvd=str((results.directory / "particles.pvd").resolve()),
        shader="Sphere" if d == 3 else "Plain circle",
        radius=float(f"{width:.6g}"),
        color=("POINTS", array, component) if component else ("POINTS", array),
        array=array,
        label=f"{array}{unit_in_brackets(units.get(array, '1'))}",
        component=component,
        mode="3D" if d == 3 else "2D",
        axes=tuple(f"{letter}{unit_in_brackets(units.get('Points', '1'))}" for letter in letters),
    )


def _array_of(frame: Frame, color: str | None) -> tuple[str, str]:
    """Array and component (``Magnitude`` of vectors) that a quantity is in ParaView."""
    known: dict[str, tuple[str, str]] = {}
    for name in frame.arrays:
        components = frame.components.get(name, ())
        known[name] = (name, "Magnitude" if len(components) == 3 else components[0] if components else "")
        known |= {f"{name}_{part.lower()}": (name, part) for part in components}
    if color is None:
        color = next((name for name in DEFAULTS if name in known), "body" if "body" in known else "id")
    if color not in known:
        raise PictureError(
            f"ParaView colours by arrays of the archives, which hold no '{color}'{did_you_mean(color, known)} "
            f"({listing(frame.arrays, 40)})"
        )
    return known[color]


def default_path(results: Results) -> Path:
    """Where the script is written without being asked."""
    return results.directory / PARAVIEW
