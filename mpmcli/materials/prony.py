"""Maxwell elements of a Prony series: their numbers and history, a component of all elements in one register."""

import math
from typing import Any, NamedTuple

from mpmcli.core.compiled.compiler import compiled_as, compiled_too
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.compiled.registers import each, pack, positive_part, zeros
from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.materials.own_numbers import column_of
from mpmcli.materials.planar import in_space_and_plane, is_planar

MOST_TERMS = 8
ROWS = ("xx", "yy", "zz", "xy", "yz", "xz", "volume")
"""History of a Maxwell element: its tensor minus the identity, and the logarithm of its volume."""
XX, YY, ZZ, XY, YZ, XZ, VOLUME, TEMPERATURE = range(len(ROWS) + 1)
HEAT, STORED = 1, 2
"""Rows after that of the temperature, which follows the terms."""


class Network(NamedTuple):
    """Numbers of a viscoelastic material but those of its terms; all are floats, so that an index may choose."""

    form: float
    """Volumetric form (``volumetric.FORMS``)."""
    bulk: float
    shear: float
    density: float
    rest2: float
    """Square of the wave speed at rest [velocity²]."""
    lateral: float
    """Wave stiffness of the analysis over that of uniaxial strain."""
    free: float
    """Number of free widths: 1 of sheets, 2 of bars."""
    heating: float
    """1/(ρ₀c_v), or 0 where the temperature is held [temperature/pressure]."""


FIRST = len(Network._fields)
LARGE_EXCESS = 0.05


def _with_terms(name: str, count: int, more: tuple[str, ...] = ()) -> dict[bool, Any]:
    """Tuple classes of the network's numbers, then times, G and K of all terms, then others."""
    terms = (f"{word}{k}" for word in ("time", "G", "K") for k in range(count))
    return in_space_and_plane(f"{name}{count}", (*Network._fields, *terms, *more), __name__)


COUNTS = range(1, MOST_TERMS + 1)
MAXWELL = {
    (count, planar): made for count in COUNTS for planar, made in _with_terms("Maxwell", count).items()
}
"""The parameter tuple for each number of terms, in space (False) and in the plane (True)."""
SHIFTED = {
    (count, planar): made
    for count in COUNTS
    for planar, made in _with_terms("ShiftedMaxwell", count, ("C1", "C2", "T_ref")).items()
}
"""The same for relaxation times that depend on temperature."""


@generic
def terms_of(m: Any) -> Any:
    """Number of terms."""


@generic
def relaxations_of(m: Any, half: Any) -> Any:
    """exp(half/t) of all terms, in a register."""


@generic
def numbers_of(m: Any, place: Any) -> Any:
    """A number of all terms in a register: G for ``place`` 1, K for 2."""


@generic
def rows_of(m: Any, H: Any, row: Any, p: Any) -> Any:
    """A row of the history of all terms in a register."""


@generic
def no_rows(m: Any) -> Any:
    """Zeros in a register."""


@generic
def keep_rows(m: Any, H: Any, row: Any, p: Any, values: Any) -> None:
    """Write it."""


@generic
def haste(m: Any, T: Any) -> Any:
    """1/a_T, by which relaxation is faster than at T_ref."""


def relaxations(m: Any, half: Any, k: Any, count: Any) -> Any:
    """exp(half/t) of ``count`` terms from term ``k`` on, as a tuple."""
    return tuple(exponential_1d(half / m[FIRST + i]) for i in range(k, k + count))


@compiled_as(relaxations)
def _choose_relaxations(m: Any, half: Any, k: Any, count: Any) -> Any:
    # written out term by term: what does not depend on the particle then leaves the loop over particles
    first, length = getattr(k, "literal_value", 0), getattr(count, "literal_value", 0)
    place, middle, part, rest = FIRST + first, first + length // 2, length // 2, length - length // 2

    def one(m: Any, half: Any, k: Any, count: Any) -> Any:
        return (exponential_1d(half / m[place]),)

    def two_halves(m: Any, half: Any, k: Any, count: Any) -> Any:
        return relaxations(m, half, first, part) + relaxations(m, half, middle, rest)

    if length == 0:
        return None  # the compiler asks again, with the number
    return one if length == 1 else two_halves


def numbers(m: Any, place: Any, count: Any) -> Any:
    """The numbers at ``place`` (1 for G, 2 for K) of all terms, as a tuple."""
    return tuple(m[FIRST + place * count : FIRST + (place + 1) * count])


@compiled_as(numbers)
def _choose_numbers(m: Any, place: Any, count: Any) -> Any:
    which, length = getattr(place, "literal_value", 0), getattr(count, "literal_value", 0)
    begin, end = FIRST + which * length, FIRST + (which + 1) * length

    def part(m: Any, place: Any, count: Any) -> Any:
        return m[begin:end]

    return part if which * length > 0 else None


@compiled_too
def excess(m: Any, H: Any, p: Any) -> Any:
    """a − I of all Maxwell elements."""
    yz = no_rows(m) if is_planar(m) else rows_of(m, H, YZ, p)
    xz = no_rows(m) if is_planar(m) else rows_of(m, H, XZ, p)
    return rows_of(m, H, XX, p), rows_of(m, H, YY, p), rows_of(m, H, ZZ, p), rows_of(m, H, XY, p), yz, xz


@compiled_too
def volumes(m: Any, H: Any, p: Any) -> Any:
    """Logarithms of the volumes of all Maxwell elements."""
    return rows_of(m, H, VOLUME, p)


@compiled_too
def keep(m: Any, H: Any, p: Any, B: Any, v: Any) -> None:
    """Write ``excess`` and ``volumes``."""
    keep_rows(m, H, XX, p, B[0])
    keep_rows(m, H, YY, p, B[1])
    keep_rows(m, H, ZZ, p, B[2])
    keep_rows(m, H, XY, p, B[3])
    if not is_planar(m):
        keep_rows(m, H, YZ, p, B[4])
        keep_rows(m, H, XZ, p, B[5])
    keep_rows(m, H, VOLUME, p, v)


@compiled_too
def stretched(B: Any, s: Any) -> Any:
    """I + sB."""
    return 1.0 + s * B[0], 1.0 + s * B[1], 1.0 + s * B[2], s * B[3], s * B[4], s * B[5]


@compiled_too
def smaller(a: Any, b: Any) -> Any:
    """The smaller one of each component."""
    return a - positive_part(a - b)


@inline
def logarithmic_excess(y: Any) -> Any:
    """y − ln(1 + y), also where y is small."""
    if abs(y) > LARGE_EXCESS:
        return y - logarithm(1.0 + y)
    return small_logarithmic_excess(y)


@compiled_too
def small_logarithmic_excess(y: Any) -> Any:
    """The same of numbers or registers up to ``LARGE_EXCESS``."""
    z = y / (2.0 + y)
    s = z * z
    return y * z - 2.0 * z * s * (1.0 / 3.0 + s * (0.2 + s * (1.0 / 7.0 + s * (1.0 / 9.0 + s / 11.0))))


for _Maxwell in MAXWELL.values():

    @haste.register(_Maxwell)
    def _(m: Any, T: Any) -> Any:
        return 1.0


for _Maxwell in SHIFTED.values():

    @haste.register(_Maxwell)
    def _(m: Any, T: Any) -> Any:
        above = m.C2 + T - m.T_ref
        if above <= 0.0:
            return 0.0
        return exponential_1d(math.log(10.0) * m.C1 * (T - m.T_ref) / above)


for (_count, _), _Maxwell in (*MAXWELL.items(), *SHIFTED.items()):

    @terms_of.register(_Maxwell)
    def _(m: Any, count: int = _count) -> Any:
        return count

    @relaxations_of.register(_Maxwell)
    def _(m: Any, half: Any, count: int = _count) -> Any:
        return pack(relaxations(m, half, 0, count))

    @numbers_of.register(_Maxwell)
    def _(m: Any, place: Any, count: int = _count) -> Any:
        return pack(numbers(m, place, count))

    @rows_of.register(_Maxwell)
    def _(m: Any, H: Any, row: Any, p: Any, count: int = _count) -> Any:
        return pack(column_of(H, row * count, count, p))

    @no_rows.register(_Maxwell)
    def _(m: Any, count: int = _count) -> Any:
        return zeros(numbers(m, 1, count))

    @keep_rows.register(_Maxwell)
    def _(m: Any, H: Any, row: Any, p: Any, values: Any, count: int = _count) -> Any:
        numbers = each(values)
        for k in range(count):
            H[row * count + k, p] = numbers[k]
