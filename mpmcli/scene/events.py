"""Criteria in terms of results, and what happens when they come true."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from mpmcli.core.model import Model, Quantity
from mpmcli.scene.values import Name


class Criterion(Model):
    """An expression of columns that comes true; text alone is the ``condition``.

    It is evaluated after every time step. A value other than 0 counts as true, one that is not finite as false.
    """

    condition: Annotated[str, Field(min_length=1, max_length=2000)]
    """Expression of columns such as `kinetic_energy`, `reaction_y[top]`, of `time` and `step`, and of constants.

    A probe's column has the probe's name before it: `corner.velocity_x`. Multiply comparisons to combine them.
    """
    after: Annotated[float, Quantity("time", ge=0)] = 0.0
    """It does not count before this time."""
    lasts: Annotated[float, Quantity("time", ge=0)] = 0.0
    """How long it must have been true without interruption."""

    @model_validator(mode="before")
    @classmethod
    def _from_text(cls, value: Any) -> Any:
        return {"condition": value} if isinstance(value, str) else value


def _or_text(schema: dict[str, Any]) -> None:
    """Allow text beside the mapping in a field's JSON Schema."""
    branches = schema.setdefault("anyOf", [])
    if "$ref" in schema:
        branches.append({"$ref": schema.pop("$ref")})
    branches.insert(0, {"type": "string"})


When = Annotated[Criterion, Field(json_schema_extra=_or_text)]


class Event(Model):
    """What happens once, at the end of the step in which a criterion comes true.

    Conditions, loads and rigid bodies follow their expressions of t by a clock. It can stop, run backwards to the
    start, and go on. Their velocities are multiplied by its rate: 1, 0 or −1.
    """

    name: Name
    """Name of the event, used in messages."""
    when: When
    """Criterion."""
    do: Literal["hold", "reverse", "continue", "stop"]
    """Let clocks stop, run backwards, or go on; or end the run."""
    to: Annotated[tuple[Name, ...], Field(min_length=1)] | None = None
    """Names of the velocity conditions, loads and rigid bodies whose clock it is; all of them by default."""

    @model_validator(mode="after")
    def _stops_all(self) -> Event:
        if self.do == "stop" and self.to is not None:
            raise ValueError("'do: stop' ends the run and takes no 'to'")
        return self
