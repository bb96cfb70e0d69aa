"""Materials whose numbers differ from particle to particle: rows of the history hold the numbers of the law.

The particles of such a material have, after the rows of its history, one row for each member of the parameter tuple of
its law. The tuple's twin, made by ``with_own_numbers``, says where these rows start; its functions collect the numbers
of a particle and call those of the law. Scenes without such materials never come here.
"""

import functools
import sys
from collections import namedtuple
from typing import Any, NamedTuple, TypeVar

from mpmcli.core.compiled.compiler import compiled_as, compiled_too
from mpmcli.materials.base import (
    absorb_heat,
    absorb_work,
    bulk_slope,
    bulk_speed_squared,
    dissipated_heat,
    isentropic_growth,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.lateral import free_stress, lateral_stretch, thickness_stretch

Parameters = TypeVar("Parameters", bound=type)

TWINS: dict[type, Any] = {}
"""The tuple of a material with own numbers for that of its law."""


def column_of(rows: Any, first: Any, count: Any, p: Any) -> Any:
    """Return ``count`` numbers of column ``p`` of ``rows``, from row ``first`` on, as a tuple."""
    return tuple(rows[first : first + count, p])


@compiled_as(column_of)
def _choose_column(rows: Any, first: Any, count: Any, p: Any) -> Any:
    length = getattr(count, "literal_value", 0)
    half, rest = length // 2, length - length // 2

    def one(rows: Any, first: Any, count: Any, p: Any) -> Any:
        return (rows[first, p],)

    def two_halves(rows: Any, first: Any, count: Any, p: Any) -> Any:
        return column_of(rows, first, half, p) + column_of(rows, first + half, rest, p)

    if length == 0:
        return None  # the compiler asks again, with the number
    return one if length == 1 else two_halves


def with_own_numbers(law: Parameters) -> Parameters:
    """Class decorator of a parameter tuple of plain numbers: particles may have numbers of their own.

    It comes after ``needs_increment`` of the law is registered. The twin is an attribute of the law's module, where the
    compiler's cache finds it.
    """
    twin = namedtuple(f"Own{law.__name__}", ("first",), module=law.__module__)  # type: ignore[misc]
    setattr(sys.modules[law.__module__], twin.__name__, twin)
    TWINS[law] = twin
    count = len(law._fields)  # type: ignore[attr-defined]

    @compiled_too
    def own(m: Any, H: Any, p: Any) -> Any:
        return law(*column_of(H, m.first, count, p))

    # no number of a law may matter to functions that take no particle
    needs_increment.register(twin)(needs_increment.implementations[law])
    isentropic_growth.register(twin)(isentropic_growth.implementations[law])

    @kirchhoff_stress.register(twin)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
        return kirchhoff_stress(own(m, H, p), F, dF, H, p, dt, commit)

    @thickness_stretch.register(twin)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        return thickness_stretch(own(m, H, p), F, dF, H, p, dt)

    @lateral_stretch.register(twin)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        return lateral_stretch(own(m, H, p), F, dF, H, p, dt)

    @free_stress.register(twin)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
        return free_stress(own(m, H, p), F, dF, H, p, dt, both)

    @strain_energy.register(twin)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return strain_energy(own(m, H, p), F, H, p)

    @wave_speed_squared.register(twin)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return wave_speed_squared(own(m, H, p), F, H, p)

    @bulk_speed_squared.register(twin)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return bulk_speed_squared(own(m, H, p), F, H, p)

    @bulk_slope.register(twin)
    def _(m: Any, F: Any, H: Any, p: Any) -> Any:
        return bulk_slope(own(m, H, p), F, H, p)

    @absorb_work.register(twin)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
        return absorb_work(own(m, H, p), F, dF, H, p, work, viscous)

    @absorb_heat.register(twin)
    def _(m: Any, H: Any, p: Any, dT: Any) -> Any:
        return absorb_heat(own(m, H, p), H, p, dT)

    @dissipated_heat.register(twin)
    def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
        return dissipated_heat(own(m, H, p), F, dF, H, p, dt)

    return law


class OwnMaterial:
    """A material whose particles have numbers of their own; all else is that of its model.

    Parameters
    ----------
    model : of the scene
    fastest : wave speed at rest of the particle with the fastest waves [velocity]
    analysis : name of the kind of analysis
    """

    def __init__(self, model: Any, fastest: float, analysis: str):
        self._model, self._fastest, self._analysis = model, fastest, analysis

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)

    @functools.cached_property
    def history(self) -> tuple[str, ...]:
        """Names of the history variables, then of the law's numbers."""
        names = type(self._model.parameters(self._analysis, False))._fields
        return (*self._model.history, *(f"own_{name}" for name in names))

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """Where the numbers of particles start."""
        found: NamedTuple = TWINS[type(self._model.parameters(analysis, False))](len(self._model.history))
        return found

    def initial_wave_speed(self, analysis: str) -> float:
        """That of the particle with the fastest waves [velocity]."""
        return self._fastest
