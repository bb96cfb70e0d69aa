"""What loads that heat a face of a body have in common."""

from typing import Any, ClassVar

import numpy as np
from pydantic import field_validator

from mpmcli.boundary.base import Array, LoadModel
from mpmcli.boundary.place import Face, Surface, check_axis
from mpmcli.boundary.velocity import check_variables, evaluate
from mpmcli.core.errors import SimulationError
from mpmcli.core.expressions import Expression


class FaceHeat(LoadModel):
    """Base of loads that heat a face of a body."""

    acts_on: ClassVar[str] = "temperature"
    positive: ClassVar[tuple[str, ...]] = ()
    """Keys whose values are positive, such as absolute temperatures."""

    on: Surface
    """Body and face."""

    @field_validator("on", mode="before")
    @classmethod
    def _is_face(cls, value: Any) -> Any:
        for place in ("plane", "box", "region"):
            if isinstance(value, dict) and place in value:
                raise ValueError(f"needs a face of a body, not a {place}: give body and face")
        return value

    def loaded_face(self) -> tuple[str, Face]:
        """Return body and face."""
        return self.on.body, self.on.face

    def value(self, key: str, points: Array, time: float) -> Any:
        """Return the value of an expression at points (d, n) of the face."""
        values = evaluate(getattr(self, key), points, time)
        if key in self.positive and np.any(values <= 0.0):
            lowest = float(np.min(values))
            raise SimulationError(f"load '{self.name}': {key} is {lowest:g} at time {time:g}; {_BOUNDS[key]}")
        return values

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes, and values that are not possible."""
        found = check_axis("on.face", self.on.face, dimensions)
        for key in type(self).model_fields:
            value = getattr(self, key)
            if isinstance(value, Expression):
                found += check_variables(key, value, dimensions)
                if key in self.positive and value.is_constant and value() <= 0.0:
                    found.append((key, _BOUNDS[key]))
        return found


_BOUNDS = {"around": "temperatures are absolute and must be above 0", "coefficient": "must be above 0"}
