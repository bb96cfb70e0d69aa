"""The plane between the particles of two sides, by regression.

With x = (x, y, z, 1), positions relative to the node, and β the plane's normal and offset, a regression fits
f(x·β) to the classes c = −1 (α) and +1 (β), with penalties λ on the components of β:

    β ← β + (Σ w x xᵀ + Λ)⁻¹ (Σ r x − Λ β)

(Nairn et al. 2020, Eqs. 21 and 53–56). Weights w and residuals r are what tells the regressions
apart (``weigh``).

Lengths are measured in cells where equations are solved, h = (cell volume)^(1/d), so that the penalty on the
normal, given as a multiple of h², is a plain number there.
"""

import math
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from mpmcli.contact.neighbours import WORK
from mpmcli.contact.normals.base import DEGENERATE, FOUND, NOT_CONVERGED, BiasedNormalModel
from mpmcli.contact.normals.gradients import (
    VANISHES,
    fall_back,
    length,
    negative,
    set_normal,
    volume_gradients,
)
from mpmcli.contact.normals.sums import NO_SUMS, add_particles
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.exponentials import exponential_1d
from mpmcli.core.model import Model, Quantity

BIAS_FOR_RIGID = 10.0
"""From this rigid bias on, the regressions take the normal from the rigid body."""

CHUNK = WORK // 3
"""Particles whose weights, residuals and errors fit the scratch space of a neighbours."""

NO_PLANE = (0.0, 0.0, 0.0, 0.0)

RIDGE = 1e-12
"""Fraction of its trace added to a matrix that may be singular."""

ROUND_OFF = 1e-12
"""Relative increase of an error that is none."""

TINY = 1e-200
"""Squares and sums of squares below this are zero."""

LARGE = 1e300
"""More than any error or length."""

GUESSED_MARGIN, NARROWEST = 2.0, 0.05
"""x·β at the closest particles where a normal is reused, and how far, in cells, they must be from the plane."""


class Penalty(Model):
    """Penalties of a regression."""

    normal: Annotated[float, Quantity("1", ge=0)] = 1e-7
    """Penalty λ on the components of the normal, as a multiple of the squared cell size."""
    offset: Annotated[float, Quantity("1", ge=0)] = 0.0
    """Penalty λ on the offset; a good value is 5e-4 with none on the normal [nairn2023notes, 3.4.5]."""


class RegressionModel(BiasedNormalModel):
    """Base of the regressions."""

    least_rigid_bias: ClassVar[float] = BIAS_FOR_RIGID

    penalty: Penalty = Penalty()
    """What keeps the fit bounded and single."""


class IteratedPlane(NamedTuple):
    """Numbers of a regression that iterates, a subclass for each: 1/h [1/length], penalties of normal (over h²) and
    offset, rigid bias, tolerance, most passes, and whether (0, 1) the last normal is reused."""

    inverse_cell: float
    penalty: float
    offset_penalty: float
    bias: float
    tolerance: float
    iterations: float
    reuse: float


class IteratedRegressionModel(RegressionModel):
    """Base of the regressions that iterate; ``numbers`` is their class of parameters."""

    numbers: ClassVar[type[IteratedPlane]] = IteratedPlane

    tolerance: Annotated[float, Quantity("1", gt=0)] = 1e-5
    """The normal n is found when 1 − n·n of the last two passes is below this, half the square of the angle
    between them [nairn2020, Eq. 57]."""
    iterations: int = Field(default=15, ge=1, le=1000)
    """The most passes, the first, linear one included; then the last result is used."""
    reuse: bool = False
    """Start from the normal of the last step at this node, if it still separates the particles, instead of
    a linear regression: fewer passes, about the same normals."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> IteratedPlane:
        """Penalties, cell size and what ends the iteration."""
        return self.numbers(
            **plane_numbers(self, cell),
            tolerance=float(self.tolerance),
            iterations=float(self.iterations),
            reuse=float(self.reuse),
        )


def plane_numbers(model: RegressionModel, cell: tuple[float, ...]) -> dict[str, float]:
    """The numbers that all regressions have, by name; ``cell`` is the cell's size per axis [length]."""
    return {
        "inverse_cell": 1.0 / math.prod(c ** (1.0 / len(cell)) for c in cell),
        "penalty": float(model.penalty.normal),
        "offset_penalty": float(model.penalty.offset),
        "bias": float(model.rigid_bias),
    }


@generic
def weigh(plane: Any, right: Any, wrong: Any) -> Any:
    """Weight w, residual r and error of a particle.

    ``right`` = 1/(1 + exp(−c x·β)) is the probability of its class c on its side of the plane, ``wrong`` that
    of the other, 1 − ``right``, times c.
    """


@compiled_too
def direction(beta: Any) -> Any:
    """The unit normal of a plane, or zeros if it has none."""
    size = beta[0] * beta[0] + beta[1] * beta[1] + beta[2] * beta[2]
    r = 1.0 / math.sqrt(size) if size > TINY else 0.0
    return r * beta[0], r * beta[1], r * beta[2]


@compiled_too
def solve(A: Any, b: Any) -> Any:
    """Solve A y = b for the symmetric, positive (semi)definite A of a plane.

    ``A`` holds (xx, xy, xz, yy, yz, zz, x1, y1, z1, 11), ``b`` (x, y, z, 1), with zeros for axes that
    are absent. The offset is eliminated first, which leaves the moments about the centroid. A relative ridge
    at round-off level lets a singular matrix give the solution of least length; one of zeros gives zeros.
    """
    xx, xy, xz, yy, yz, zz, x1, y1, z1, one = A
    x, y, z, c = b
    if not one > TINY:
        return 0.0, 0.0, 0.0, 0.0
    r = 1.0 / one
    mx, my, mz = r * x1, r * y1, r * z1
    xx, xy, xz = xx - mx * x1, xy - mx * y1, xz - mx * z1
    yy, yz, zz = yy - my * y1, yz - my * z1, zz - mz * z1
    x, y, z = x - mx * c, y - my * c, z - mz * c
    trace = max(xx, 0.0) + max(yy, 0.0) + max(zz, 0.0)
    if not trace > TINY:
        return 0.0, 0.0, 0.0, r * c
    ridge = RIDGE * trace
    px = 1.0 / (max(xx, 0.0) + ridge)
    lxy, lxz = px * xy, px * xz
    yy, yz, zz = yy - lxy * xy, yz - lxy * xz, zz - lxz * xz
    py = 1.0 / (max(yy, 0.0) + ridge)
    lyz = py * yz
    zz = zz - lyz * yz
    pz = 1.0 / (max(zz, 0.0) + ridge)
    y = y - lxy * x
    z = z - lxz * x - lyz * y
    z = pz * z
    y = py * y - lyz * z
    x = px * x - lxy * y - lxz * z
    return x, y, z, r * c - mx * x - my * y - mz * z


@compiled_too
def solve_sums(plane: Any, axes: Any, sums: Any, factor: Any, beta: Any) -> Any:
    """The change of β in cells that the sums of a pass at ``beta`` ask for, with penalties times ``factor``."""
    d = len(axes)
    h = plane.inverse_cell
    h2 = h * h
    k, k1 = factor * plane.penalty, factor * plane.offset_penalty
    xx, xy, xz, yy, yz, zz, x1, y1, z1, one, rx, ry, rz, r1 = sums
    A = (
        h2 * xx + k,
        h2 * xy,
        h2 * xz,
        h2 * yy + k if d > 1 else 0.0,
        h2 * yz,
        h2 * zz + k if d > 2 else 0.0,
        h * x1,
        h * y1,
        h * z1,
        one + k1,
    )
    return solve(A, (h * rx - k * beta[0], h * ry - k * beta[1], h * rz - k * beta[2], r1 - k1 * beta[3]))


@compiled_too
def scratch(neighbours: Any) -> Any:
    """Weights, residuals and errors of ``CHUNK`` particles."""
    return neighbours.work[:CHUNK], neighbours.work[CHUNK : 2 * CHUNK], neighbours.work[2 * CHUNK : 3 * CHUNK]


@compiled_too
def linear_plane(plane: Any, axes: Any, neighbours: Any, count: Any, factor: Any) -> Any:
    """Linear regression, with penalties times ``factor`` (Nairn 2023 notes, Eqs. 3.17 and 3.18).

    Returns β in cells as four numbers and whether it has a direction: not where a side is empty or the
    centroids of both sides coincide.
    """
    sums = NO_SUMS
    count, chunk = np.uint64(count), np.uint64(CHUNK)
    weight, residual, _ = scratch(neighbours)
    weight[:] = 1.0
    for start in range(np.uint64(0), count, chunk):
        m = min(chunk, count - start)
        for i in range(m):
            residual[i] = neighbours.side[start + i]
        sums = add_particles(axes, neighbours, start, m, weight, residual, sums)
    xx, _, _, yy, _, zz, x1, y1, z1, one, rx, ry, rz, r1 = sums
    # towards β from the centroid of all, times the number of particles
    if not abs(r1) < one:
        return NO_PLANE, False
    mean = r1 / one
    way = (rx - mean * x1, ry - mean * y1, rz - mean * z1)
    if length(way) <= VANISHES * math.sqrt(one * (xx + yy + zz)):
        return NO_PLANE, False
    return solve_sums(plane, axes, sums, factor, NO_PLANE), True


@compiled_too
def next_plane(plane: Any, axes: Any, neighbours: Any, count: Any, beta: Any) -> Any:
    """One more pass from β in cells, four numbers; returns the next β and the error of the given one."""
    d = len(axes)
    h = plane.inverse_cell
    bx, by, bz, b1 = h * beta[0], h * beta[1], h * beta[2], beta[3]
    sums, error = NO_SUMS, 0.0
    count, chunk = np.uint64(count), np.uint64(CHUNK)
    weight, residual, errors = scratch(neighbours)
    for start in range(np.uint64(0), count, chunk):
        m = min(chunk, count - start)
        for i in range(m):
            p = start + i
            c = neighbours.side[p]
            y = neighbours.x[1, p] if d > 1 else 0.0
            z = neighbours.x[2, p] if d > 2 else 0.0
            e = exponential_1d(-c * (bx * neighbours.x[0, p] + by * y + bz * z + b1))
            q = 1.0 / (1.0 + e)
            weight[i], residual[i], errors[i] = weigh(plane, q, c * (e * q))
        for i in range(m):
            error += errors[i]
        sums = add_particles(axes, neighbours, start, m, weight, residual, sums)
    x, y, z, c = solve_sums(plane, axes, sums, 1.0, beta)
    normal2 = beta[0] * beta[0] + beta[1] * beta[1] + beta[2] * beta[2]
    error += 0.5 * (plane.penalty * normal2 + plane.offset_penalty * b1 * b1)
    return (beta[0] + x, beta[1] + y, beta[2] + z, b1 + c), error


@compiled_too
def guess_plane(plane: Any, axes: Any, neighbours: Any, count: Any, guess: Any) -> Any:
    """A plane normal to ``guess`` in the middle between the closest particles of both sides, β in cells.

    Also returns whether there is such a plane: not where the guess is zero, a side is empty, or the guess
    does not separate the sides: a regression that starts steep among mixed particles may turn around.
    """
    d = len(axes)
    gx = guess[0]
    gy = guess[1] if d > 1 else 0.0
    gz = guess[2] if d > 2 else 0.0
    if gx == 0.0 and gy == 0.0 and gz == 0.0:
        return NO_PLANE, False
    upper, lower = -LARGE, LARGE
    for p in range(np.uint64(count)):
        y = neighbours.x[1, p] if d > 1 else 0.0
        z = neighbours.x[2, p] if d > 2 else 0.0
        t = gx * neighbours.x[0, p] + gy * y + gz * z
        if neighbours.side[p] < 0.0:
            upper = max(upper, t)
        else:
            lower = min(lower, t)
    if upper == -LARGE or lower == LARGE:
        return NO_PLANE, False
    h = plane.inverse_cell
    margin = 0.5 * h * (lower - upper)
    if margin < NARROWEST:
        return NO_PLANE, False
    slope = GUESSED_MARGIN / margin
    return (slope * gx, slope * gy, slope * gz, -0.5 * slope * h * (upper + lower)), True


@compiled_too
def fit_plane(plane: Any, axes: Any, neighbours: Any, count: Any, guess: Any) -> Any:
    """Iterate until the normal stands still or the passes are used up.

    The first pass is linear regression with 4 λ, times 2, which is what the iteration makes of β = 0 (Nairn
    2023 notes, Eq. 3.22); where the last normal is reused, ``guess_plane`` stands for it. A step that made
    the error larger is halved in the pass after it.

    Returns
    -------
    β in cells as four numbers, the number of passes, and ``FOUND``, ``NOT_CONVERGED`` or ``DEGENERATE``.
    """
    has_direction = False
    beta = NO_PLANE
    if plane.reuse > 0.0:
        beta, has_direction = guess_plane(plane, axes, neighbours, count, guess)
    if not has_direction:
        beta, has_direction = linear_plane(plane, axes, neighbours, count, 4.0)
        beta = (2.0 * beta[0], 2.0 * beta[1], 2.0 * beta[2], 2.0 * beta[3])
    if not has_direction:
        return beta, 1, DEGENERATE
    kept, least, halved = beta, LARGE, False
    n = direction(beta)
    passes = 1
    while passes < plane.iterations:
        passes += 1
        following, error = next_plane(plane, axes, neighbours, count, beta)
        if error > least * (1.0 + ROUND_OFF):
            beta = (
                0.5 * (beta[0] + kept[0]),
                0.5 * (beta[1] + kept[1]),
                0.5 * (beta[2] + kept[2]),
                0.5 * (beta[3] + kept[3]),
            )
            halved = True
            continue
        if halved:
            n = direction(beta)
            halved = False
        m = direction(following)
        if m[0] == 0.0 and m[1] == 0.0 and m[2] == 0.0:
            return beta, passes, NOT_CONVERGED
        kept, least = beta, error
        beta = following
        turn = (m[0] - n[0]) ** 2 + (m[1] - n[1]) ** 2 + (m[2] - n[2]) ** 2
        if 0.5 * turn < plane.tolerance:
            return beta, passes, FOUND
        n = m
    return beta, passes, NOT_CONVERGED


@compiled_too
def take_rigid(plane: Any, axes: Any, neighbours: Any, count: Any, rigid: Any, out: Any) -> Any:
    """Take the rigid side's volume gradient for the normal if the bias asks for it; says whether it did."""
    if rigid == 0.0 or plane.bias < BIAS_FOR_RIGID:
        return False
    ga, gb, _, _, size = volume_gradients(axes, neighbours, count)
    v = ga if rigid < 0.0 else negative(gb)
    if length(v) <= VANISHES * size:
        return False
    set_normal(axes, v, out)
    return True


@compiled_too
def find_by_iteration(
    plane: Any, axes: Any, neighbours: Any, count: Any, rigid: Any, order: Any, guess: Any, out: Any
) -> Any:
    """``find_normal`` for the regressions that iterate."""
    if take_rigid(plane, axes, neighbours, count, rigid, out):
        return FOUND
    beta, _, status = fit_plane(plane, axes, neighbours, count, guess)
    if status == DEGENERATE:
        return fall_back(axes, neighbours, count, order, out)
    set_normal(axes, beta, out)
    return status
