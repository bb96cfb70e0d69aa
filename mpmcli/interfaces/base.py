"""What an interface law is: a pydantic model (the scene's words), a named tuple of numbers, and compiled functions.

An interface law transmits tractions across the jump δ = u_β − u_α of displacement between two fields. A new law is
one new file here and its row in ``contact.laws.base.KINDS``: a model that derives from ``InterfaceModel``, and a
parameter tuple with implementations of the generic functions below. Laws whose directions are independent of each
other take ``independent.Independent`` and give a spring per direction.
"""

from typing import Annotated, Any, ClassVar, NamedTuple

from mpmcli.contact.laws.base import LawModel
from mpmcli.contact.laws.frictionless import Frictionless
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Varying

MOST_NORMAL, MOST_TANGENTIAL, BREAKS = 0, 1, 2
"""Columns of a history: the largest opening so far along the normal and along the surface [length], 1 if broken."""
OPENINGS = 2
"""How many openings there are; they come first."""
HISTORY = OPENINGS + 1
"""How many columns there are."""


class InterfaceModel(LawModel):
    """Base of all interface laws."""

    is_interface: ClassVar[bool] = True
    screened: ClassVar[bool] = False
    needs_area: ClassVar[bool] = True
    keeps_history: ClassVar[bool] = False
    """Openings of the past matter: particles near the interface remember them."""

    bonded: Annotated[Expression, Varying("1", ("x", "y", "z"))] | None = None
    """Where the sides are bonded at the start: where this is positive (``"x > 25"``); everywhere they touch if left
    out. Elsewhere they are in contact as broken ones are, as is matter that meets later, and what slips by more than
    half a cell."""

    @property
    def drives_apart(self) -> bool:
        """Tractions take care of overlap."""
        return False

    @property
    def closed_law(self) -> LawModel:
        """The contact law where the interface is broken, or never was."""
        return Frictionless(kind="frictionless")

    @property
    def slopes(self) -> tuple[float, float]:
        """Largest slopes of the traction along the normal and along the surface [pressure/length]; 0 if perfect."""
        raise TypeError(f"{type(self).__name__} gives no slopes")

    @property
    def has_perfect_direction(self) -> bool:
        """Whether there is no jump along the normal, or none along the surface."""
        return False

    @property
    def last_opening(self) -> float:
        """Opening at which it has failed at the latest [length]; infinite if it never fails."""
        return float("inf")

    def parameters(self) -> NamedTuple:
        """The numbers that the compiled functions need."""
        raise TypeError(f"{type(self).__name__} gives no parameters")


@generic
def held_impulse(law: Any, axes: Any, dp: Any, n: Any, out: Any) -> Any:
    """Part of ``dp`` (d,) along the law's perfect directions, into ``out`` (d,); returns APART or STICKING.

    It is all that an interface does to momenta that are only extrapolated.
    """


@generic
def jump_impulse(
    law: Any, axes: Any, dp: Any, n: Any, jump: Any, force: Any, area: Any, reduced_mass: Any, dt: Any, history: Any,
    oscillates: Any, out: Any,
) -> Any:  # fmt: skip
    """Find the momentum Δp_α that an interface gives to α in a step, into ``out`` (d,); returns APART or STICKING.

    Parameters
    ----------
    law, axes
        Parameters of the law, and a tuple of d numbers, whose length compiled code knows.
    dp
        (d,) Δp⁺ = m_red (v⁺_β − v⁺_α), without the interface [momentum].
    n, jump
        (d,) unit normal from α to β, and jump δ(0) at the start of the step [length].
    force
        (d,) m_red (f_β/m_β − f_α/m_α) without the interface [force]; read only with ``oscillates``.
    area, reduced_mass, dt
        Contact area, m_red and time step.
    history
        (3,) largest openings so far and whether it is broken: see ``MOST_NORMAL``.
    oscillates
        Springs follow their own motion within the step (Nairn 2023, 5.3); else the traction is that of its end.
    out
        (d,) must not share memory with ``dp``.
    """


@generic
def tangents(law: Any, axes: Any, n: Any, jump: Any, history: Any) -> Any:
    """Slopes of the traction along the normal and along the surface at the jump ``jump`` (d,) [pressure/length].

    Zero where it softens, where it is closed by contact, and along perfect directions.
    """


@generic
def traction(law: Any, axes: Any, n: Any, jump: Any, history: Any, out: Any) -> Any:
    """Traction on α at the jump ``jump`` (d,), into ``out`` (d,) [pressure]; zero along perfect directions."""


@generic
def stored_energy(law: Any, axes: Any, n: Any, jump: Any, history: Any) -> Any:
    """Energy per area that the interface gives back when it closes [energy/area]."""


@generic
def openings(law: Any, axes: Any, n: Any, jump: Any, now: Any) -> Any:
    """What the history remembers of the jump ``jump`` (d,), into ``now`` (2,): openings, never negative."""


@generic
def remember(law: Any, axes: Any, n: Any, jump: Any, history: Any) -> Any:
    """Let ``history`` (3,) know of the jump; returns the energy per area that this has spent [energy/area]."""


@generic
def damage(law: Any, history: Any) -> Any:
    """Share of its stiffness that the interface has lost, 0 to 1."""
