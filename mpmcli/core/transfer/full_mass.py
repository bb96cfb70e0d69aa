"""Task 3.b: nodal values from extensive ones by the FMPM loop, or filtered for XPIC; the same for every nodal field."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from mpmcli.core.step import Step
from mpmcli.core.transfer import nodes
from mpmcli.core.transfer.nodal_field import NodalField

Array = np.ndarray


class OrderRule(NamedTuple):
    """How many increments the full-mass loop adds."""

    largest: int
    """Order k at which it ends."""
    scale: Callable[[int], float]
    """Factor of the increment of an order (Nairn 2026, section 3.3)."""
    dynamic: tuple[str, float] | None
    """Metric and tolerance that may end it before (section 3.4), or None."""


class Passes(Protocol):
    """What the loop needs to know of the transfer between particles and grid."""

    parallel: bool

    def project(self, field: NodalField, v: Array, out: Array, weight: float, first: bool) -> None:
        """out += Sᵀ M S v, completed."""


def add_full_mass_increments(
    field: NodalField, transfer: Passes, step: Step, rule: OrderRule, counts_reactions: bool
) -> int:
    """Turn lumped values v⁺(1) into v⁺(k) (the "FMPM loop", Table 1 of Nairn 2026); overwrites ``field.v``.

    ``counts_reactions`` adds the impulse of the conditions on each increment to their reactions. Returns the order
    that it reached.
    """
    active, parallel = field.nodes.active, transfer.parallel
    increment, order = field.v, 1
    while order < rule.largest:
        order += 1
        scale = rule.scale(order)
        transfer.project(field, increment, field.out, -scale if counts_reactions else 0.0, first=order == 2)
        nodes.next_increment[parallel](active, field.zero, field.mp, field.out, scale, increment, field.dv)
        increment = field.dv
        field.correct(step, counts_reactions)  # (1), (2)
        nodes.add_nodal[parallel](active, field.zero, field.dv, field.v)
        if rule.dynamic is not None and has_converged(field, parallel, *rule.dynamic):  # (3)
            break
    return order


def has_converged(field: NodalField, parallel: bool, metric: str, tolerance: float) -> bool:
    """Whether the last increment is small by the metric (Nairn 2026, section 3.4), all degrees of freedom together."""
    sums = field.sums
    active, chunks = field.nodes.active, field.nodes.active_chunks
    nodes.sum_magnitudes[parallel](active, chunks, field.mp, field.dv, field.v, sums)
    change, size, _, count = sums.sum(axis=0)
    if metric == "means":
        return bool(change <= tolerance * size)
    epsilon = 0.01 * float(sums[:, 2].max())
    nodes.sum_changes[parallel](active, chunks, field.mp, field.dv, field.v, epsilon, sums)
    return bool(epsilon == 0.0 or sums[:, 0].sum() <= tolerance * count)


def add_filtered_values(
    field: NodalField, transfer: Passes, step: Step, order: int, p_start: Array, w: Array, start: Array | None
) -> None:
    """XPIC(m): w = a Δt + u with the filtered value u, from rates a in ``w`` (dofs, c).

    u = Σ_j (I − S⁺S)ʲ v⁰ + (I − S⁺S)^(m−1) Δv for j = 0 … m − 1, with v⁰ extrapolated and Δv = v − v⁰ what contact
    corrected then (Nairn et al. 2020, Eq. 37), by u ← v⁰ + (I − S⁺S) u, which begins with u = v. ``p_start`` (dofs, c)
    are the extensive values of the start of the step; ``start`` (dofs, c), unless None, becomes v⁺ − a Δt.
    """
    active, parallel = field.nodes.active, transfer.parallel
    u, out = field.dv, field.out
    nodes.start_projection[parallel](active, field.mp, p_start, u, out)
    for correction in field.corrections:
        correction.take_out_start(step, p_start)
    for m in range(2, order + 1):
        weight = -1.0 if m == order else 0.0  # what passes filter out gives no momentum
        transfer.project(field, u, out, weight, first=m == 2)
        nodes.next_projection[parallel](active, field.mp, p_start, out, u)
        for correction in field.corrections:
            correction.unite(step, u, m == order)
    nodes.add_projected[parallel](active, step.dt, u, field.v, w, start)
