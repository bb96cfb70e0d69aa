"""How the modes of a cohesive law act together."""

from __future__ import annotations

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.model import Model, Quantity


class NoMixing(Model):
    """Either mode fails by itself; with it the interface breaks."""

    kind: Literal["none"]

    def parameters(self) -> Apart:
        """Nothing."""
        return Apart()


class PowerMixing(Model):
    """The interface breaks where (G_I/G_Ic)ⁿ + (G_II/G_IIc)ⁿ reaches 1, with what each mode has spent."""

    kind: Literal["power"]
    exponent: Annotated[float, Quantity("1", gt=0)] = 1.0
    """n."""

    def parameters(self) -> Power:
        """The exponent."""
        return Power(self.exponent)


class CoupledMixing(Model):
    """One damage for both modes, by λ² = (δ_n/δ_nc)² + (δ_t/δ_tc)²."""

    kind: Literal["coupled"]


Mixing = Annotated[NoMixing | PowerMixing | CoupledMixing, Field(discriminator="kind")]


class Apart(NamedTuple):
    """Modes fail by themselves; the value is never read."""

    nothing: float = 0.0


class Power(NamedTuple):
    """n."""

    exponent: float


@generic
def fail_together(mixing: Any, normal: Any, tangential: Any) -> Any:
    """Whether both modes fail, of which these shares of their toughness are spent."""


@fail_together.register(Apart)
def _(mixing, normal, tangential):
    return False


@fail_together.register(Power)
def _(mixing, normal, tangential):
    return normal**mixing.exponent + tangential**mixing.exponent >= 1.0
