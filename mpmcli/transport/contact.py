"""Heat between bodies in contact, and the heat of their friction."""

from collections.abc import Sequence
from typing import NamedTuple, cast

import numpy as np

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.contacts import ContactRows, TellsContacts
from mpmcli.core.dofs import field_of, node_of
from mpmcli.core.step import Step
from mpmcli.core.transfer.nodal_field import Correction, NodalField

Array = np.ndarray

SWEEPS = 60
"""Most rounds in which perfect contacts that share a degree of freedom take turns."""
CONVERGED = 1e-15
"""Rounds end when none changes its values by more than this share."""


class Exchange(NamedTuple):
    """Contacts that exchange heat in a step, one row each.

    alpha, beta : (k,) degrees of freedom
    capacity : (k,) heat that goes to α per difference θ_β − θ_α [energy/temperature]
    inverse_alpha, inverse_beta : (k,) one over the capacities of the sides; 0 for baths
    is_perfect : (k,) both sides get one temperature
    pair : (k,) number of the pair of fields
    weight : (k,) share of the contact that real particles have; negative where α is the second field of the pair
    """

    alpha: Array
    beta: Array
    capacity: Array
    inverse_alpha: Array
    inverse_beta: Array
    is_perfect: Array
    pair: Array
    weight: Array


@inline
def exchange(contacts, theta, heat):
    """Exchange heat at all contacts, each in turn; adds what the first field of each pair gets to ``heat`` (pairs,).

    ``theta`` (dofs, 1) are nodal values, overwritten. Perfect contacts go on until all sides at a node agree. Returns
    the heat that baths gave.
    """
    from_baths = 0.0
    for sweep in range(SWEEPS):
        change, size = 0.0, 0.0
        for k in range(contacts.alpha.shape[0]):
            if sweep > 0 and not contacts.is_perfect[k]:
                continue
            i, j = contacts.alpha[k], contacts.beta[k]
            given = contacts.capacity[k] * (theta[j, 0] - theta[i, 0])
            theta[i, 0] += given * contacts.inverse_alpha[k]
            theta[j, 0] -= given * contacts.inverse_beta[k]
            heat[contacts.pair[k]] += contacts.weight[k] * given
            if contacts.inverse_beta[k] == 0.0:
                from_baths += abs(contacts.weight[k]) * given
            elif contacts.inverse_alpha[k] == 0.0:
                from_baths -= abs(contacts.weight[k]) * given
            if contacts.is_perfect[k]:
                change = max(change, abs(given) * max(contacts.inverse_alpha[k], contacts.inverse_beta[k]))
                size = max(size, abs(theta[i, 0]))
        if change <= CONVERGED * size:
            break
    return from_baths


class HeatContact(Correction):
    """Exchange of heat where velocity fields touch.

    The sides of a contact exchange C_r (θ_β − θ_α)(1 − exp(−h A Δt/C_r)) with the reduced capacity C_r = C_α C_β/(C_α +
    C_β), which is stable for any conductance h; perfect contact gives the sides their mean by capacity. It acts on
    θ⁺(1) and on every increment of the full-capacity loop, so that perfect contact is that of one field at any order.

    Parameters
    ----------
    contact : tells who touches
    nodal : the nodal field, with values for each velocity field
    names : of the pairs of fields
    conductance : (pairs,) by pair of fields; 0: none, infinite: perfect [power/area/temperature]
    is_bath : (fields,) whether a velocity field keeps its temperature
    node_count : nodes of the grid

    Attributes
    ----------
    heat : (pairs,) heat that the first field of each pair got in the step [energy]
    bath_heat : what of it came from baths [energy]
    """

    def __init__(
        self, contact: TellsContacts, nodal: NodalField, names: Sequence[str], conductance: Array, is_bath: Array,
        node_count: int,
    ):  # fmt: skip
        self._contact, self._nodal, self._names = contact, nodal, list(names)
        self._conductance, self._is_bath, self._node_count = conductance, is_bath, node_count
        self.heat = np.zeros(len(conductance))
        self.bath_heat = 0.0
        self._exchange: Exchange | None = None

    def join(self, theta: Array, counts: bool) -> None:
        """Give sides in perfect contact one value at the start of the step, before gradients are found of them.

        What baths would give acts on these gradients alone. ``counts``: particles take on nodal values in this step,
        so that what the sides exchange here is heat.
        """
        self.heat[:] = 0.0
        self.bath_heat = 0.0
        if not np.isinf(self._conductance).any():
            return
        self.begin(0.0)
        joined, mp = cast(Exchange, self._exchange), self._nodal.mp
        is_free = (joined.inverse_alpha > 0.0) & (joined.inverse_beta > 0.0)
        free, to_bath = (Exchange(*(row[chosen] for row in joined)) for chosen in (is_free, ~is_free))
        exchange(free, theta, self.heat if counts else self.heat.copy())
        for dofs in (free.alpha, free.beta):
            mp[dofs, 1] = mp[dofs, 0] * theta[dofs, 0]
        exchange(to_bath, theta, self.heat.copy())

    def begin(self, dt: float) -> None:
        """Find who touches now, for exchanges over ``dt``."""
        rows = self._contact.contact_rows()
        h = self._conductance[rows.pair]
        chosen = _one_row_each(rows, (h > 0.0) & rows.touches)
        alpha, beta = rows.alpha[chosen], rows.beta[chosen]
        inverse = [self._inverse_capacity(dofs) for dofs in (alpha, beta)]
        both = inverse[0] + inverse[1]
        reduced = np.divide(1.0, both, out=np.zeros_like(both), where=both > 0.0)
        h = h[chosen]
        is_perfect = np.isinf(h)
        flow = np.where(is_perfect, 0.0, h) * rows.area[chosen] * dt
        self._exchange = Exchange(
            alpha,
            beta,
            capacity=reduced * np.where(is_perfect, 1.0, -np.expm1(-flow * both)),
            inverse_alpha=inverse[0],
            inverse_beta=inverse[1],
            is_perfect=is_perfect,
            pair=rows.pair[chosen],
            weight=rows.weight[chosen] * rows.sign[chosen],
        )

    def powers(self, dt: float) -> dict[str, float]:
        """Return the power into the first field of each pair in the step, of ``dt``, by name of the pair."""
        return {name: float(heat) / dt for name, heat in zip(self._names, self.heat, strict=True)}

    def _inverse_capacity(self, dofs: Array) -> Array:
        c = self._nodal.mp[dofs, 0]
        is_bath = self._is_bath[field_of(dofs, self._node_count, len(self._is_bath))]
        return np.divide(1.0, c, out=np.zeros_like(c), where=(c > 0.0) & ~is_bath)

    def exchange(self, theta: Array) -> None:
        """Let nodal values ``theta`` (dofs, 1) that touch exchange heat."""
        if self._exchange is not None and len(self._exchange.alpha):
            self.bath_heat += exchange(self._exchange, theta, self.heat)

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Exchange on an increment of the full-capacity loop."""
        self.exchange(dv)


def _one_row_each(rows: ContactRows, kept: Array) -> Array:
    """Places of the chosen contacts; of two rows of a pair, one for each of its sides, the first."""
    places = np.flatnonzero(kept)
    ends = np.sort(np.stack([rows.alpha[places], rows.beta[places]]), axis=0)
    _, first = np.unique(ends, axis=1, return_index=True)
    return np.asarray(places[np.sort(first)])


class FrictionHeat:
    """What friction takes out becomes heat of both sides, in proportion to their effusivities; none of rigid sides.

    Parameters
    ----------
    contact : tells of friction
    nodal : the nodal field
    effusivity : (fields,) √(κ ρ c) of each velocity field; 0 of rigid ones
    takes_none : (fields,) whether a velocity field is rigid
    node_count : nodes of the grid

    Attributes
    ----------
    heat : heat of friction in the step [energy]
    """

    def __init__(
        self, contact: TellsContacts, nodal: NodalField, effusivity: Array, takes_none: Array, node_count: int
    ):
        self._contact, self._nodal = contact, nodal
        self._effusivity, self._takes_none, self._node_count = effusivity, takes_none, node_count
        self.heat = 0.0

    def find(self) -> tuple[Array, Array, Array]:
        """Return nodes (m,), what their values rise by (m,), and the share (m,) of it that real particles have."""
        rows = self._contact.contact_rows()
        alpha_share, beta_share = self._shares(rows)
        self.heat = float((rows.weight * rows.friction).sum())
        dofs = np.concatenate([rows.alpha, rows.beta])
        heat = np.concatenate([rows.friction * alpha_share, rows.friction * beta_share])
        weight = np.concatenate([rows.weight, rows.weight])
        rubs = heat != 0.0
        dofs, heat, weight = dofs[rubs], heat[rubs], weight[rubs]
        if not self._nodal.nodes.by_field:
            dofs = node_of(dofs, self._node_count)
        c = self._nodal.mp[dofs, 0]
        return dofs, np.divide(heat, c, out=np.zeros_like(c), where=c > 0.0), weight

    def _shares(self, rows: ContactRows) -> tuple[Array, Array]:
        a, b = (self._field_of(dofs) for dofs in (rows.alpha, rows.beta))
        first, second = self._effusivity[a], self._effusivity[b]
        total = first + second
        share = np.divide(first, total, out=np.full(len(total), 0.5), where=total > 0.0)
        share = np.where(self._takes_none[b], 1.0, np.where(self._takes_none[a], 0.0, share))
        return share, 1.0 - share

    def _field_of(self, dofs: Array) -> Array:
        return np.asarray(field_of(dofs, self._node_count, len(self._effusivity)))
