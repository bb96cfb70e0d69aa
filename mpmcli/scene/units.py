"""The scene's one consistent set of units: text with a unit becomes a number, and quantities get labels.

Everything derives from length, mass, time and temperature. pint is imported only when a scene holds text with
a unit; it computes with decimal numbers, so that ``"3 g/cc"`` is 3000 in kg and m, not 2999.9999999999995.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from mpmcli.core.suggest import did_you_mean

Exponents = tuple[Fraction, Fraction, Fraction, Fraction]

BASE = ("length", "mass", "time", "temperature")

# words by their exponents of length, mass, time, temperature
_WORDS = {
    (0, 0, 0, 0): "1 angle strain",
    (1, 0, 0, 0): "length",
    (2, 0, 0, 0): "area",
    (3, 0, 0, 0): "volume",
    (0, 1, 0, 0): "mass",
    (0, 0, 1, 0): "time",
    (0, 0, 0, 1): "temperature",
    (0, 0, -1, 0): "frequency rate",
    (1, 0, -1, 0): "velocity",
    (1, 0, -2, 0): "acceleration",
    (1, 1, -1, 0): "momentum",
    (2, 1, -1, 0): "angular_momentum",
    (1, 1, -2, 0): "force",
    (-1, 1, -2, 0): "stress pressure",
    (2, 1, -2, 0): "energy",
    (2, 1, -3, 0): "power",
    (-3, 1, 0, 0): "density",
    (-1, 1, -1, 0): "viscosity",
    (2, 0, -2, -1): "specific_heat gas_constant",
    (2, 0, -2, 0): "specific_energy",
    (1, 1, -3, -1): "conductivity",
    (0, 1, -3, -1): "film_coefficient",
    (0, 1, -3, 0): "heat_flux",
}
DIMENSIONS = {word: exponents for exponents, words in _WORDS.items() for word in words.split()}

# words whose label is a unit of its own where the scale is a power of ten that has a prefix
_NAMED = {"force": "N", "stress": "Pa", "pressure": "Pa", "energy": "J", "power": "W"}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}

_KNOWN = {
    "length": "pm 1e-12, nm 1e-9, um 1e-6, µm 1e-6, mm 1e-3, cm 1e-2, dm 0.1, m 1, km 1e3, in 0.0254, inch 0.0254, "
    "ft 0.3048",
    "mass": "ng 1e-12, ug 1e-9, µg 1e-9, mg 1e-6, g 1e-3, kg 1, t 1e3, tonne 1e3, Mg 1e3, lb 0.45359237",
    "time": "ps 1e-12, ns 1e-9, us 1e-6, µs 1e-6, ms 1e-3, s 1, min 60, h 3600, day 86400",
    "temperature": "K 1, mK 1e-3, degR 5/9",
}
# units a scene may be written in without help from pint: size in m, kg, s, K
KNOWN = {
    base: {name: Fraction(size) for name, size in (unit.split() for unit in units.split(", "))}
    for base, units in _KNOWN.items()
}
_EXAMPLES = (
    *("Pa", "kPa", "MPa", "GPa", "psi", "N", "kN", "J", "kJ", "mJ", "W", "Hz", "rad", "deg"),
    *("m", "cm", "mm", "km", "um", "nm", "kg", "g", "mg", "s", "ms", "us", "ns", "K"),
    *("g/cc", "kg/m^3", "g/cm^3", "m/s", "mm/ms", "m/s^2"),
)

_NUMBER = r"[-+]?(?>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_WITH_UNIT = re.compile(rf"\s*({_NUMBER})\s*((?:(?<=\s)1\s*/\s*)?[^\W\d_].*|[%°Å].*)\s*\Z", re.DOTALL)
_UNIT_TEXT = re.compile(
    r"(?:[^\W\d_]\w{0,30}|[%°Å]\w{0,10}|(?:\^|\*\*)\s*[-+]?(?:[1-9]|[01]\.5)(?![\d.]|\s*\^|\s*\*\*)|[²³](?![²³])"
    r"|1(?=\s*/)|[*/·() ])+\Z"
)


class Dimension(NamedTuple):
    """Exponents of length, mass, time and temperature."""

    exponents: Exponents

    @classmethod
    @cache
    def of(cls, words: str) -> Dimension:
        """Read a product of dimension words, such as ``"pressure/length"`` or ``"energy/mass"``."""
        total = [Fraction(0)] * 4
        for word, power in _factors(words):
            if word not in DIMENSIONS:
                raise ValueError(f"'{word}' is not a dimension{did_you_mean(word, DIMENSIONS)}")
            total = [a + power * b for a, b in zip(total, DIMENSIONS[word], strict=True)]
        return cls((total[0], total[1], total[2], total[3]))


def _factors(words: str) -> list[tuple[str, Fraction]]:
    """Factors of a product with their powers, in the order written."""
    factors: list[tuple[str, Fraction]] = []
    sign = 1
    for part in re.split(r"(\*\*|\^|[*/])", words.replace(" ", "")):
        if part in {"*", "/"}:
            sign = 1 if part == "*" else -1
        elif part in {"^", "**"}:
            sign = 0
        elif sign == 0:
            word, power = factors.pop()
            factors.append((word, power * Fraction(part)))
        else:
            factors.append((part, Fraction(sign)))
    return factors


def split_unit(text: str) -> tuple[str, str] | None:
    """Number and unit of text such as ``"1.5 GPa"``; None if the text is not a number with a unit."""
    found = _WITH_UNIT.match(text) if len(text) < 200 else None
    return (found.group(1), found.group(2).strip()) if found else None


class Units:
    """A consistent set of units, by the names of its base units, None where the scene declares none."""

    def __init__(
        self,
        length: str | None = None,
        mass: str | None = None,
        time: str | None = None,
        temperature: str | None = "K",
    ):
        self.names = {"length": length, "mass": mass, "time": time, "temperature": temperature}

    @property
    def are_declared(self) -> bool:
        """Whether the scene says what its numbers are in."""
        return all(self.names[base] is not None for base in BASE[:3])

    def scale(self, base: str) -> Fraction:
        """Size of a base unit in m, kg, s or K."""
        name = self.names[base]
        if name is None:
            raise ValueError("the scene declares no units")
        return base_unit_size(name, base)

    def number(self, text: str, dimension: str) -> float:
        """The value of text with a unit in this set; ValueError with words for the user."""
        return self._convert(text, Dimension.of(dimension), dimension)

    def any_number(self, text: str) -> float:
        """The value of text with a unit of any dimension in this set."""
        return self._convert(text, None, "")

    def _convert(self, text: str, wanted: Dimension | None, words: str) -> float:
        parts = split_unit(text)
        if parts is None:
            raise ValueError(f"'{text}' is not a number with a unit")
        if not self.are_declared:
            hint = "add units: {length: …, mass: …, time: …}"
            raise ValueError(f"'{text}' has a unit, but the scene declares no units; {hint}")
        number = _number(parts[0], text)
        known = _size_and_dimension(parts[1]) if _UNIT_TEXT.match(parts[1]) else None
        if known is not None and (wanted is None or known[1] == wanted):
            return self._in_own_units(number, *known, text)
        quantity = _quantity(*parts, text)
        found = _dimension(quantity, text)
        if wanted is not None and found != wanted:
            label = self.label(words)
            needed = f"{words} is needed, as in '{label}'" if label != "1" else "a plain number is needed"
            raise ValueError(f"'{text}' has the wrong dimension: {needed}")
        if not quantity._is_multiplicative and found == Dimension.of("temperature"):
            quantity = quantity.to("K")
        elif "delta_" in str(quantity.units) and found == Dimension.of("temperature"):
            raise ValueError(
                f"'{text}' is a temperature difference; give the temperature itself in K or degC"
            )
        if str(quantity.units) in _ANGLES:
            value = float(quantity.to("degree" if words == "angle" else "radian").magnitude)
            if not math.isfinite(value):
                raise ValueError(_TOO_LARGE.format(_shown(text)))
            return value
        size = Fraction(
            quantity.to_root_units().magnitude
        )  # of all of it: a temperature, or a wrong dimension
        return self._in_own_units(Fraction(1), size / raised(_ROOT_MASS, found.exponents[1]), found, text)

    def _in_own_units(self, number: Fraction, size: Fraction, dimension: Dimension, text: str) -> float:
        """So many units of a size in m, kg, s, K as a number of this set."""
        value = number * size
        for base, exponent in zip(BASE, dimension.exponents, strict=True):
            value /= raised(self.scale(base), exponent)
        try:
            return float(value)
        except OverflowError:
            raise ValueError(_TOO_LARGE.format(_shown(text))) from None

    def label(self, words: str) -> str:
        """The unit of a quantity, e.g. ``"MPa"`` in mm, g, ms; the words if none are declared."""
        if not self.are_declared:
            return words
        powers: dict[str, Fraction] = {}
        for word, power in _factors(words):
            for text, exponent in self._label_of(word):
                powers[text] = powers.get(text, Fraction(0)) + exponent * power
        over = [_power(text, power) for text, power in powers.items() if power > 0]
        under = [_power(text, -power) for text, power in powers.items() if power < 0]
        return "/".join(["*".join(over) or "1", *under])

    def _label_of(self, word: str) -> list[tuple[str, Fraction]]:
        if word == "angle":
            return [("deg", Fraction(1))]
        if word in _NAMED and (prefix := self._prefix(word)) is not None:
            return [(prefix + _NAMED[word], Fraction(1))]
        if word in {"specific_heat", "gas_constant", "specific_energy"}:
            parts = [*self._label_of("energy"), (str(self.names["mass"]), Fraction(-1))]
            return parts + [(str(self.names["temperature"]), Fraction(-1))] * (word != "specific_energy")
        order = ("mass", "length", "time", "temperature")
        exponents = dict(zip(BASE, Dimension.of(word).exponents, strict=True))
        return [(str(self.names[base]), exponents[base]) for base in order if exponents[base]]

    def _prefix(self, word: str) -> str | None:
        """The SI prefix that gives this set's unit, or None if there is none."""
        size = Fraction(1)
        for base, exponent in zip(BASE, Dimension.of(word).exponents, strict=True):
            size *= raised(self.scale(base), exponent)
        return next((text for power, text in _PREFIXES.items() if size == Fraction(10) ** power), None)


def raised(size: Fraction, exponent: Fraction) -> Fraction:
    """Power of a size, exact where the exponent is whole (that of a stress intensity is not)."""
    return size**exponent.numerator if exponent.denominator == 1 else Fraction(float(size) ** float(exponent))


@cache
def base_unit_size(name: str, base: str) -> Fraction:
    """Size of a base unit in m, kg, s or K; ValueError with words for the user where it cannot be one."""
    if name in KNOWN[base]:
        return KNOWN[base][name]
    if base == "temperature" and name.lower().strip("°") in {"c", "degc", "celsius", "f", "degf"}:
        raise ValueError(
            f"'{name}' does not start at absolute zero; use K (values such as '20 degC' are converted)"
        )
    if len(name) > MAX_UNIT:
        raise ValueError(f"'{_shown(name)}' is not a unit of {base}")
    others = [
        f"'{unit}' is a {other}" for other in BASE for unit in KNOWN[other] if unit == name and other != base
    ]
    if others:
        raise ValueError(f"{others[0]}, but a {base} is needed")
    try:
        quantity = _quantity("1", name, name)
        found = _dimension(quantity, name)
    except ValueError:
        raise ValueError(f"'{name}' is not a unit of {base}{did_you_mean(name, KNOWN[base])}") from None
    if found != Dimension.of(base) or not quantity._is_multiplicative:
        raise ValueError(f"'{name}' is not a unit of {base}")
    size = Fraction(quantity.to_root_units().magnitude) / (_ROOT_MASS if base == "mass" else 1)
    if not _SMALLEST_BASE <= size <= 1 / _SMALLEST_BASE:
        raise ValueError(
            f"'{name}' is {float(size):.2g} times the SI unit of {base}; use a base unit closer to it"
        )
    return size


_ANGLES = frozenset({"degree", "radian", "turn", "arcminute", "arcsecond", "milliradian", "grade", "gradian"})
_ROOT_MASS = Fraction(1000)  # pint's root unit of mass is the gram
MAX_UNIT = 60  # characters of the name of a base unit
MAX_POWER = 400  # of ten, of a number with a unit: floating point holds 308
MAX_EXPONENT = 100  # of a unit, as in ((m^9)^9)^9
_SMALLEST_BASE = Fraction(1, 10**30)

_shown = "{:.60}".format
_TOO_LARGE = "'{}' is too large in the units of the scene"


def _number(text: str, whole: str) -> Fraction:
    """The number before a unit, exactly; ValueError where it is beyond floating point."""
    try:
        number = Decimal(text)
        if number and not -MAX_POWER <= number.adjusted() <= MAX_POWER:
            raise ArithmeticError
    except ArithmeticError:
        raise ValueError(f"'{_shown(whole)}' exceeds the range of floating-point numbers") from None
    return Fraction(number) if number else Fraction(0)


@cache
def _size_and_dimension(unit: str) -> tuple[Fraction, Dimension] | None:
    """Size of a plain unit in m, kg, s, K, and its dimension; None for angles, temperatures and what is no unit."""
    try:
        quantity = _quantity("1", unit, unit)
        found = _dimension(quantity, unit)
        name = str(quantity.units)
        if not quantity._is_multiplicative or "delta_" in name or name in _ANGLES:
            return None
        return Fraction(quantity.to_root_units().magnitude) / raised(_ROOT_MASS, found.exponents[1]), found
    except (ValueError, ArithmeticError):
        return None


def _power(text: str, exponent: Fraction) -> str:
    return text if exponent == 1 else f"{text}^{float(exponent):g}"


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Decimal, cache_folder=None)


def _quantity(number: str, unit: str, text: str) -> Any:
    """A pint quantity; the unit is checked before, so that nothing in it can take long."""
    if not _UNIT_TEXT.match(unit) or unit.count("(") != unit.count(")"):
        raise ValueError(
            f"'{unit}' is not a unit{_with_powers(unit)}; write units like kg/m^3, and products like 2*v"
        )
    import pint

    registry = _registry()
    try:
        units = registry.parse_units(unit)
        if any(abs(exponent) > MAX_EXPONENT for exponent in units._units.values()):
            raise ValueError("powers of powers")
        quantity = registry.Quantity(Decimal(number), units)
        quantity.to_root_units()  # sizes beyond decimal numbers are found here
        return quantity
    except pint.UndefinedUnitError as error:
        name = str(error.unit_names if isinstance(error.unit_names, str) else error.unit_names[0])
        hint = _with_powers(unit) or did_you_mean(name, _EXAMPLES)
        raise ValueError(f"'{name}' in '{text}' is not a unit{hint}") from None
    except Exception:
        raise ValueError(f"'{text}' is not a number with a unit") from None


def _with_powers(unit: str) -> str:
    """The hint that ``cm3`` is written ``cm^3``, if that makes a unit of it."""
    written = re.sub(r"([^\W\d_]+)(-?[1-9])(?!\w)", r"\1^\2", unit)
    if written == unit or not _UNIT_TEXT.match(written):
        return ""
    try:
        _registry().parse_units(written)
    except Exception:
        return ""
    return f"; did you mean '{written}'?"


def _dimension(quantity: Any, text: str) -> Dimension:
    names = {f"[{base}]": index for index, base in enumerate(BASE)}
    exponents = [Fraction(0)] * 4
    for name, exponent in quantity.dimensionality.items():
        if name not in names:
            hint = "; degrees Celsius are 'degC'" if name == "[current]" else ""
            raise ValueError(f"'{text}' has the dimension {name}, which scenes do not use{hint}")
        exponents[names[name]] = Fraction(exponent)
    return Dimension((exponents[0], exponents[1], exponents[2], exponents[3]))
