"""The impulse of a contact: what its two sides exchange, once normal, separation and area are known.

A contact law is a tuple of numbers that says how large a traction its sliding sides feel (``sliding_traction``);
everything else is here. In the names of the equations: dp0 is Δp_α(0), the momentum that would bring α to the centre
of mass velocity, n̂ points from α to β, and the result Δp_α is added to α and taken from β. Impulses are compared
rather than tractions wherever a law allows it, so that a contact without area needs no special care.
"""

import math
from typing import Any, TypeVar

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline

APART, SLIDING, STICKING, BROKEN = 0, 1, 2, 3
"""What ``law_impulse`` found; ``BROKEN``: adhesion that broke in this call."""

INTACT = 0.5
"""A contact is bonded while more than this share of its volume is."""

LEAST, MOST = 1e-140, 1e140
"""Numbers between these can be squared and added."""
NARROWEST = 1e-150
"""Smallest ratio of area or mass to momentum that a division is trusted with."""
TINIEST = 1e-300
"""No division by less."""

PARTING = 1e-8
"""Sides that move apart at no more than this share of their relative speed slide along each other: normals are not
known better, so that round-off would decide."""

HARD = 0.25 * math.pi * math.pi
"""φ² from which a stiff contact counts as rigid: φ = π/2 (Nairn 2023, 5.7)."""

Parameters = TypeVar("Parameters", bound=type)


@generic
def sliding_traction(law: Any, N: Any, stick: Any, speed: Any) -> Any:
    """S_slide, the shear traction between sliding sides (Nairn et al. 2020, Eq. 9) [pressure], never negative.

    ``N`` is the normal compression, ``stick`` the traction that makes the sides stick (both never negative),
    ``speed`` the sliding speed [velocity]. A result of ``stick`` or more means that they stick. Laws registered
    without ``area`` must be homogeneous, S(cN, c·stick) = c S(N, stick), and may be handed impulses; those without
    ``speed`` must not read it.
    """


@generic
def law_impulse(
    law: Any, axes: Any, dp0: Any, n: Any, separation: Any, area: Any, reduced_mass: Any, dt: Any,
    displacement_only: Any, bond: Any, out: Any,
) -> Any:  # fmt: skip
    """Find the momentum Δp_α that a contact gives to α, into ``out`` (d,); returns APART, SLIDING, STICKING or BROKEN.

    ``axes`` is a tuple of d numbers, whose length compiled code knows; ``dp0`` (d,) is Δp_α(0) [momentum], ``n`` (d,)
    the unit normal from α to β; only the sign of ``separation`` matters. There is contact if the sides do not part,
    dp0·n < ``PARTING`` |dp0|, and the separation is negative; with ``displacement_only`` if the latter is. ``area`` is
    the contact area, ``bond`` the intact share of its volume. ``out`` must not share memory with ``dp0``.
    """


@generic
def law_impulse_at_end(
    law: Any, axes: Any, dp0: Any, n: Any, separation: Any, force: Any, area: Any, reduced_mass: Any, dt: Any,
    displacement_only: Any, bond: Any, out: Any,
) -> Any:  # fmt: skip
    """``law_impulse`` for the calculation after the momentum update, where the forces of the step are known.

    ``separation`` is that at the start of the step [length] and ``force`` the normal part of
    m_red (f_β/m_β − f_α/m_α), contact apart [force]; ``dp0`` includes what it did (Nairn 2023, 5.7). A law with
    finite stiffness replaces the normal part of dp0 by the impulse of its spring; all others use dp0 as it is and the
    separation at the end of the step. Arguments and result are otherwise those of ``law_impulse``.
    """


@generic
def is_soft(law: Any) -> Any:
    """Whether the law has a finite stiffness, so that ``law_impulse_at_end`` needs the force."""


@generic
def uses_speed(law: Any) -> Any:
    """Whether ``sliding_traction`` depends on the sliding speed: known to the compiler."""


@generic
def uses_area(law: Any) -> Any:
    """Whether ``sliding_traction`` needs true tractions rather than impulses: known to the compiler."""


def yes(law: Any) -> Any:
    """It does."""
    return True


def no(law: Any) -> Any:
    """It does not."""
    return False


def contact_law(*, speed: bool = False, area: bool = False) -> Any:
    """Class decorator of a law's parameter tuple: register what follows from its ``sliding_traction``.

    Parameters
    ----------
    speed
        The traction depends on the sliding speed: Eq. 10 is solved for it. Other laws pay nothing.
    area
        The traction is not homogeneous in compression and stick traction, so that it needs the contact area.
    """

    def add(parameters: Parameters) -> Parameters:
        law_impulse.register(parameters)(pressed_impulse)
        law_impulse_at_end.register(parameters)(hard_impulse_at_end)
        is_soft.register(parameters)(no)
        uses_speed.register(parameters)(yes if speed else no)
        uses_area.register(parameters)(yes if area else no)
        return parameters

    return add


@inline
def dot(axes, a, b):
    """a·b over the axes."""
    total = 0.0
    for i in range(len(axes)):
        total += a[i] * b[i]
    return total


@inline
def length(axes, a):
    """|a|, also where its square would be no number."""
    largest = 0.0
    for i in range(len(axes)):
        largest = max(largest, abs(a[i]))
    if LEAST < largest < MOST:
        return math.sqrt(dot(axes, a, a))
    if largest == 0.0:
        return 0.0
    square = 0.0
    for i in range(len(axes)):
        square += (a[i] / largest) ** 2
    return largest * math.sqrt(square)


@inline
def leave(axes, out):
    """No momentum."""
    for i in range(len(axes)):
        out[i] = 0.0
    return APART


@inline
def hold(axes, dp0, out):
    """All of dp0: the sides move on together."""
    for i in range(len(axes)):
        out[i] = dp0[i]
    return STICKING


@inline
def take_tangent(axes, dp0, n, normal, out):
    """Write the tangential part of dp0, whose normal part is ``normal``, into ``out``; returns its length."""
    for i in range(len(axes)):
        out[i] = dp0[i] - normal * n[i]
    return length(axes, out)


@inline
def solve_slip(law, N, stick, start):
    """Traction S that agrees with the sliding speed it leaves (Nairn et al. 2020, Eq. 10): S = S_slide(v).

    ``start`` is the speed without friction, so that v = start (1 − S/stick). With x = S/stick the root of
    S_slide(N, start (1 − x)) − stick x lies between 0 and 1, or the sides stick (x = 1). It is bracketed and found by
    inverse quadratic steps or bisection (Chandrupatla 1997). The sides stick if the law lets sides at rest do so.
    """
    f2 = sliding_traction(law, N, stick, 0.0) - stick
    if f2 >= 0.0:
        return stick
    f1 = sliding_traction(law, N, stick, start)
    if f1 <= 0.0:
        return 0.0
    x1, x2 = 0.0, 1.0
    x3, f3 = 1.0, f2
    t = f1 / (f1 - f2)
    x, f = x1, f1
    for _ in range(100):
        x = x1 + t * (x2 - x1)
        f = sliding_traction(law, N, stick, start * (1.0 - x)) - stick * x
        if (f > 0.0) == (f1 > 0.0):
            x3, f3 = x1, f1
        else:
            x3, f3 = x2, f2
            x2, f2 = x1, f1
        x1, f1 = x, f
        if abs(f2) < abs(f1):
            x, f = x2, f2
        tolerance = 1e-15 * abs(x)
        width = abs(x2 - x1)
        if width <= 2.0 * tolerance or abs(f) <= 2e-16 * stick * x:
            break
        t = 0.5
        xi = (x1 - x2) / (x3 - x2)
        phi = (f1 - f2) / (f3 - f2)
        if phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi:
            t = f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        t = min(max(t, tolerance / width), 1.0 - tolerance / width)
    return stick * x


@inline
def slide(law, axes, dp0, n, found, normal, area_time, reduced_mass, out):
    """Δp_α of sides in contact, by their law: (Δp·n̂) n̂ + S_slide A_c Δt t̂ (Nairn 2026, Eq. 18).

    ``found`` is dp0·n; ``normal`` is what becomes of it: the same, unless the contact is soft.
    """
    stick = take_tangent(axes, dp0, n, found, out)
    N = max(0.0, -normal)
    per_area = 1.0
    if uses_area(law):
        per_area = 1.0 / max(area_time, NARROWEST * (N + stick), TINIEST)
    limit = stick * per_area
    if uses_speed(law):
        speed = stick / max(reduced_mass, NARROWEST * stick, TINIEST)
        traction = solve_slip(law, N * per_area, limit, speed)
    else:
        traction = sliding_traction(law, N * per_area, limit, 0.0)
    if traction >= limit:
        for i in range(len(axes)):
            out[i] = dp0[i] + (normal - found) * n[i]
        return STICKING
    share = traction / limit
    for i in range(len(axes)):
        out[i] = normal * n[i] + share * out[i]
    return SLIDING


@inline
def traction_impulse(
    law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, out
):  # fmt: skip
    """``law_impulse`` for sides that are not bonded."""
    normal = dot(axes, dp0, n)
    if separation >= 0.0:
        return leave(axes, out)
    if normal < 0.0 or displacement_only:
        return slide(law, axes, dp0, n, normal, normal, area * dt, reduced_mass, out)
    if normal < PARTING * length(axes, dp0):
        return slide(law, axes, dp0, n, normal, 0.0, area * dt, reduced_mass, out)
    return leave(axes, out)


def pressed_impulse(law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, bond, out):
    """``law_impulse`` for laws without adhesion."""
    return traction_impulse(law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, out)


@inline
def end_separation(separation, normal, force, reduced_mass, dt):
    """Separation at the end of the step without contact, δ_n(Δt) (Nairn 2023, Eq. 5.148) [length]."""
    reach = (normal - 0.5 * force * dt) * dt
    return separation + reach / max(reduced_mass, NARROWEST * abs(reach), TINIEST)


# fmt: off
def hard_impulse_at_end(law, axes, dp0, n, separation, force, area, reduced_mass, dt, displacement_only, bond, out):
    """``law_impulse_at_end`` for laws without a finite stiffness."""
    end = end_separation(separation, dot(axes, dp0, n), force, reduced_mass, dt)
    return law_impulse(law, axes, dp0, n, end, area, reduced_mass, dt, displacement_only, bond, out)
# fmt: on


@inline
def slip_work(axes, n, impulse, before, after):
    """Energy that the tangential part of a contact's impulse takes out of its two sides; positive if it does.

    The pair loses Δp_α · ½(v + v′) with v = v_β − v_α before (``before``) and after (``after``) the impulse
    ``impulse`` = Δp_α acted, both (d,): the impulse pulls α along with β. With FMPM(k) it is the final net impulse,
    once. Zero where the sides stick at rest; the normal part, lost in any impact of nodes, is left out.
    """
    pressed = dot(axes, impulse, n)
    work = 0.0
    along = 0.0
    for i in range(len(axes)):
        mean = 0.5 * (before[i] + after[i])
        along += mean * n[i]
        work += impulse[i] * mean
    return work - pressed * along
