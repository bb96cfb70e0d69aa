"""The window of time in which a condition or load acts."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field, ValidationInfo, field_validator

from mpmcli.core.model import Model, Quantity
from mpmcli.core.times import is_reached


class Windowed(Model):
    """Base of what acts on bodies within a window of time: conditions and loads."""

    name: str = Field(min_length=1)
    """Name, used in tables and messages."""
    begin: Annotated[float, Quantity("time", ge=0), Field(alias="from")] = 0.0
    """It acts in steps that start at this time or later."""
    until: Annotated[float, Quantity("time", gt=0)] | None = None
    """It acts in steps that start before this time; to the end by default."""

    @field_validator("until")
    @classmethod
    def _is_after_begin(cls, until: float | None, info: ValidationInfo) -> float | None:
        begin = info.data.get("begin", 0.0)
        if until is not None and is_reached(begin, until):
            raise ValueError(f"must be later than 'from', which is {begin:g}")
        return until

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What is wrong in an analysis with so many axes: pairs of key (``direction``) and message."""
        raise TypeError(f"{type(self).__name__} checks nothing")

    def bodies(self) -> list[tuple[str, str]]:
        """Names of bodies that it refers to: pairs of key and name."""
        body = getattr(getattr(self, "on", None), "body", None)
        return [] if body is None else [("on.body", body)]

    @property
    def acts_always(self) -> bool:
        """Whether it acts in every step."""
        return self.begin == 0.0 and self.until is None

    def acts_at(self, time: float) -> bool:
        """Whether it acts in a step that starts at ``time``."""
        return is_reached(time, self.begin) and not (self.until is not None and is_reached(time, self.until))

    def acts_within(self, other: Windowed) -> bool:
        """Whether it acts only in steps in which ``other`` acts, too."""
        end = math.inf if other.until is None else other.until
        return other.begin <= self.begin and (math.inf if self.until is None else self.until) <= end

    def first_with(self, other: Windowed) -> float | None:
        """Return the first time at which both act, or None if there is none."""
        time = max(self.begin, other.begin)
        return time if self.acts_at(time) and other.acts_at(time) else None
