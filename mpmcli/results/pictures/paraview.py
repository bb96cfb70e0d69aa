"""A script with which ParaView opens a result, coloured and sized right."""

from pathlib import Path

import numpy as np

from mpmcli.output.files import PARAVIEW
from mpmcli.results.pictures.drawing import shorten
from mpmcli.results.pictures.extent import Extent, color_range
from mpmcli.results.pictures.quantities import GROUPS, Coloring, domains_of, unit_of
from mpmcli.results.pictures.space import directions
from mpmcli.results.reading import Frame, Results, unit_in_brackets

SCRIPT = '''\
"""{title}

Run it by "paraview --script={script}", or in ParaView by View > Python Shell > Run Script.
"""

from paraview.simple import *

particles = PVDReader(registrationName={name!r}, FileName={pvd!r})
{source}scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.AnimationTime = {time!r}
view = GetActiveViewOrCreate("RenderView")

shown = Show(particles, view)
shown.SetRepresentationType("Point Gaussian")
shown.ShaderPreset = {shader!r}
shown.GaussianRadius = {radius!r}
ColorBy(shown, {color!r})
colors = GetColorTransferFunction({array!r})
colors.ApplyPreset({preset!r}, True)
colors.RescaleTransferFunction({low!r}, {high!r})  # 1 to 99 % of the particles at this time
colors.AutomaticRescaleRangeMode = "Never"
shown.SetScalarBarVisibility(view, True)
{cracks}bar = GetScalarBar(colors, view)
bar.Title = {label!r}
bar.ComponentTitle = {component!r}

view.InteractionMode = {mode!r}
view.AxesGrid.Visibility = 1
view.AxesGrid.XTitle, view.AxesGrid.YTitle, view.AxesGrid.ZTitle = {axes!r}
view.CameraFocalPoint = {focus!r}
view.CameraPosition = {eye!r}
view.CameraViewUp = {up!r}
Render(view)
ResetCamera(view)
Render(view)
'''
CALCULATOR = """\
particles = Calculator(registrationName={name!r}, Input=particles)
particles.ResultArrayName = {name!r}
particles.Function = {formula!r}
"""
CRACKS = """\
cracks = PVDReader(registrationName={name!r}, FileName={pvd!r})
lines = Show(cracks, view)
ColorBy(lines, None)
lines.DiffuseColor = [0.0, 0.0, 0.0]
lines.LineWidth = 2.0
"""
OVERLAP = 1.25
"""Radius of flat discs over half a particle: they cover the plane, or nearly."""
SIGNED, UNSIGNED = "Cool to Warm", "Viridis (matplotlib)"


def paraview_script(
    results: Results,
    frame: Frame,
    coloring: Coloring,
    limits: tuple[float, float] | None = None,
    view: str = "iso",
) -> str:
    """The text of the script.

    Parameters
    ----------
    frame : the archive to begin with; all of a series hold the same arrays
    coloring : by what the particles are coloured, as in pictures
    limits : numbers of the first and the last colour; those of the picture of this archive if absent
    view : from where three dimensions are seen
    """
    d = results.dimensions(frame)
    low, high = color_range(Extent.of([frame], coloring, results), limits)
    edges = domains_of(results, frame).edges
    radius = float(np.median(np.linalg.norm(edges, axis=1).min(axis=1))) if len(edges) else 0.5
    if d < 3:
        radius *= OVERLAP
    units = results.units_of("particles")
    letters = "rzt" if results.is_axisymmetric else "xyz"
    array = coloring.name if coloring.formula else coloring.array
    names = results.names(GROUPS[coloring.name]) if coloring.is_group else []
    _, up, towards = directions(view if d == 3 else "xy")
    source = CALCULATOR.format(name=array, formula=coloring.formula) if coloring.formula else ""
    pvd = results.directory / "cracks.pvd"
    return SCRIPT.format(
        cracks=CRACKS.format(name="cracks", pvd=str(pvd.resolve())) if pvd.exists() else "",
        title=shorten(ascii(results.title)[1:-1], 110).replace('"', "'").replace("\\", "/"),
        script=PARAVIEW,
        name=results.directory.resolve().name,
        pvd=str((results.directory / "particles.pvd").resolve()),
        source=source,
        time=frame.time,
        shader="Sphere" if d == 3 else "Plain circle",
        radius=float(f"{radius:.6g}"),
        color=("POINTS", array, coloring.component) if coloring.component else ("POINTS", array),
        array=array,
        preset=SIGNED if low < 0.0 < high else UNSIGNED,
        low=float(f"{low:.6g}"),
        high=float(f"{high:.6g}"),
        label=f"{array}{unit_in_brackets(unit_of(coloring, results))}"
        + (f": {shorten(', '.join(f'{i} {name}' for i, name in enumerate(names)))}" if names else ""),
        component=coloring.component,
        mode="3D" if d == 3 else "2D",
        axes=tuple(f"{letter}{unit_in_brackets(units.get('Points', '1'))}" for letter in letters),
        focus=[0.0, 0.0, 0.0],
        eye=[round(float(x), 6) for x in towards],
        up=[round(float(x), 6) for x in up],
    )


def default_path(results: Results) -> Path:
    """Where the script is written without being asked."""
    return results.directory / PARAVIEW
