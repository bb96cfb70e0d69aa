"""What a hardening law is: a pydantic model (the scene's words), a named tuple of numbers, and one function.

A new law is one new file here, and its row in ``hardening/__init__.py``. ``flow`` is registered for the tuple's class.
A law that changes the elastic moduli too registers ``changes_stiffness`` and ``stiffness_ratio``.
"""

from typing import Annotated, Any, NamedTuple, TypeVar

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.model import Model, Quantity

Law = TypeVar("Law", bound=type)

SMALLEST_STRAIN = 1e-12
"""Slopes of powers are those at this plastic strain, or above it."""


class HardeningModel(Model):
    """Base of all hardening laws."""

    def parameters(self) -> NamedTuple:
        """The numbers of the law."""
        raise TypeError(f"{type(self).__name__} gives no parameters")


class RateModel(HardeningModel):
    """Base of laws whose flow stress may grow with a power of the rate of plastic strain."""

    m: Annotated[float, Quantity("1", ge=0)] = 0.0
    """Exponent of the rate; 0 is independent of the rate."""
    eps0_dot: Annotated[float, Quantity("rate", gt=0)] = 1.0
    """Reference rate of plastic strain."""


@generic
def flow(h: Any, alpha: Any, rate: Any, T: Any, dt: Any) -> Any:
    """Flow stress Y(α, α̇, T), and dY/dα of a step in which the rate is Δα/``dt`` [pressure].

    Where the law changes the stiffness, both are over ``stiffness_ratio``.
    """


@compiled_too
def flow_stress(h: Any, alpha: Any, rate: Any, T: Any) -> Any:
    """The first of ``flow``."""
    return flow(h, alpha, rate, T, 1.0)[0]


@generic
def changes_stiffness(h: Any) -> Any:
    """Whether shear modulus and flow stress change by a common factor."""


@generic
def stiffness_ratio(h: Any, bulk: Any, log_J: Any, T: Any) -> Any:
    """Shear modulus over that at rest, and the derivative of this ratio by ln J; ``bulk`` is K [pressure]."""


def keeps_stiffness(h: Any) -> Any:
    """The moduli are constant."""
    return False


def whole(h: Any, bulk: Any, log_J: Any, T: Any) -> Any:
    """The modulus at rest."""
    return 1.0, 0.0


def of_constant_stiffness(law: Law) -> Law:
    """Class decorator of a law's tuple: the elastic moduli are constant."""
    changes_stiffness.register(law)(keeps_stiffness)
    stiffness_ratio.register(law)(whole)
    return law


@inline
def with_rate(h: Any, static: float, slope: float, rate: float, dt: float) -> Any:
    """``flow`` of ``static`` flow stress and its ``slope`` times (α̇/ε̇₀)^m, at least 1; ``h`` has ``m`` and ``rate``."""
    if h.m == 0.0 or rate <= h.rate:
        return static, slope
    factor = (rate / h.rate) ** h.m
    return static * factor, (slope + static * h.m / (rate * dt)) * factor
