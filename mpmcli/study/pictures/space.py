"""Particles in space as lit spheres, drawn off-screen by pyvista where it is installed and can draw."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from functools import cache
from typing import Any

import numpy as np

from mpmcli.output.results import Frame, Results
from mpmcli.study.pictures.drawing import new_figure
from mpmcli.study.pictures.particles import Extent, Palette, ParticlePicture, directions, draw_axes
from mpmcli.study.pictures.quantities import domains_of

WINDOW = (1000, 800)
PATIENCE = 60.0
"""Seconds after which a trial picture counts as failed."""
TRIAL = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere(), color="red")
picture = plotter.screenshot(return_img=True)
raise SystemExit(0 if picture.std() > 1 else 1)
"""
NOT_INSTALLED = "pyvista is not installed, so particles are drawn as discs; for spheres: pip install pyvista"
CANNOT_DRAW = (
    "pyvista cannot draw on this system, so particles are drawn as discs; without a screen it needs a software "
    "renderer (on Debian and Ubuntu the packages libegl1 and libgl1-mesa-dri)"
)


@cache
def why_not() -> str | None:
    """Why pyvista cannot draw here, in words; None if it can.

    The trial is another process: a system without a renderer may end the process that asks it to draw.
    """
    if importlib.util.find_spec("pyvista") is None:
        return NOT_INSTALLED
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        # without a screen vtk would ask for one first, and complain
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    try:
        trial = subprocess.run([sys.executable, "-c", TRIAL], capture_output=True, timeout=PATIENCE)
    except (OSError, subprocess.TimeoutExpired):
        return CANNOT_DRAW
    return None if trial.returncode == 0 else CANNOT_DRAW


class SpacePicture(ParticlePicture):
    """Particles as spheres of their size; title, colours and names are drawn around them by matplotlib."""

    def __init__(self, results: Results, palette: Palette, extent: Extent, view: str = "iso"):
        super().__init__(results, palette, extent)
        import pyvista

        self._pyvista = pyvista
        across, up, towards = directions(view)
        centre = 0.5 * (extent.lower + extent.upper)
        reach = 0.55 * float(np.linalg.norm(extent.upper - extent.lower)) or 0.5
        self.plotter = pyvista.Plotter(off_screen=True, window_size=WINDOW)
        self.plotter.set_background("white")
        camera = self.plotter.camera
        camera.parallel_projection = True
        camera.focal_point, camera.position = tuple(centre), tuple(centre + 4.0 * reach * towards)
        camera.up = tuple(up)
        corners = (
            np.array(np.meshgrid(*zip(extent.lower, extent.upper, strict=True))).reshape(3, -1).T - centre
        )
        half_width, half_height = np.abs(corners @ across).max(), np.abs(corners @ up).max()
        self._scale = 1.08 * max(half_height, half_width * WINDOW[1] / WINDOW[0]) or 0.5
        camera.parallel_scale = self._scale
        self._cloud: Any = None
        self.figure = new_figure(9.0, 6.6)
        self.axes = self.figure.add_subplot()
        self.axes.set_axis_off()
        palette.explain(self.figure, self.axes, is_wide=False)
        self._image = self.axes.imshow(np.full((WINDOW[1], WINDOW[0], 3), 255, dtype=np.uint8))
        draw_axes(self.axes, (across, up, towards))

    def update(self, frame: Frame) -> None:
        kept = self._note_lost(frame)
        edges = domains_of(self.results, frame).edges[kept]
        width = 2.0 * float(np.median(np.sqrt((edges**2).sum(axis=(1, 2)) / 3.0))) if len(edges) else 0.0
        if self._cloud is not None:
            self.plotter.remove_actor(self._cloud, render=False)
        if kept.any():
            points = self._pyvista.PolyData(frame.X[kept])
            points["colors"] = (self.palette.colors(frame)[kept, :3] * 255).round().astype(np.uint8)
            self._cloud = self.plotter.add_mesh(
                points,
                scalars="colors",
                rgb=True,
                style="points",
                render_points_as_spheres=True,
                point_size=max(2.0, 1.1 * width * WINDOW[1] / (2.0 * self._scale)),
                reset_camera=False,
                render=False,
            )
        self.plotter.renderer.reset_camera_clipping_range()
        self._image.set_data(self.plotter.screenshot(return_img=True))
        self._set_title(frame)

    def close(self) -> None:
        self.plotter.close()
