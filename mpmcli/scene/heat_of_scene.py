"""What a scene says about heat, as its checks read it."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmcli.core.analysis import ANALYSES
from mpmcli.scene.contact_checks import Fields
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report


class HeatOfScene:
    """The parts of a scene, and what follows from them for temperatures."""

    def __init__(self, parts: Parts, report: Report, fields: Fields):
        self.parts, self.fields = parts, fields
        self.has_heat = report.section("heat") is not None
        heating = None if parts.method is None else parts.method.heating
        self.is_adiabatic = heating != "isothermal" if self.has_heat else heating == "adiabatic"
        self.rigid = {member.name for member in fields.members if member.is_rigid}
        self.used = {body.material for _, body in parts.bodies}
        self.has_fields = len(fields.names) > 1

    def warms(self, material: Any) -> bool:
        """Whether the temperature of a material may change during the run."""
        return self.has_heat or (self.is_adiabatic and getattr(material, "specific_heat", None) is not None)

    def needs_temperature(self, material: Any) -> bool:
        """Whether anything depends on the temperature of a deformable material."""
        return (
            self.warms(material)
            or getattr(material, "expansion", 0.0) > 0.0
            or "temperature" in getattr(material, "history", ())
        )

    def box_of(self, body: Any) -> tuple[np.ndarray, np.ndarray] | None:
        """Corners (d,) of the part of a body's box that is in the grid; None where they do not fit each other."""
        grid, analysis = self.parts.grid, self.parts.analysis
        if grid is None or analysis is None or ANALYSES[analysis.kind]().dimensions != grid.dimensions:
            return None
        if any(body.region.misfits(grid.dimensions)):
            return None
        low, high = (
            np.clip(corner, grid.lower, grid.upper) for corner in body.region.bounds(grid.dimensions)
        )
        return low, high

    def deformable(self) -> Iterator[tuple[str, Any]]:
        """Name and model of each material with mass that a body uses, as far as it can be read."""
        for name, model in self.parts.materials.items():
            if name in self.used and model.kind != "rigid":
                yield name, model

    def acting(self) -> Iterator[tuple[str, Any]]:
        """Path and model of each condition and load that acts on temperatures."""
        return ((path, model) for path, model in self.parts.acting if model.acts_on == "temperature")
