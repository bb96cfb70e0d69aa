"""Cut particles: some of the nodes that they see lie on other sides, so that each sight has a degree of freedom.

Which degree of freedom a particle feeds is a property of the pair particle and node, a *sight*. An ordinary particle
feeds the degrees of freedom behind the first node of its field, all on side 0. A cut particle carries a row of degrees
of freedom and of weights, and runs through the same sums after the ordinary particles of its band or chunk.
"""

from typing import Any, NamedTuple, Protocol

import numpy as np

from mpmcli.core.compiled.compiler import compiled_as

Array = np.ndarray


class Cut(NamedTuple):
    """The cut particles of a step, by ascending place in memory; m nodes per stencil.

    mask : (N,) 1 for particles that are cut, uint8
    particle : (C,) their places in memory, unsigned
    bands, chunks : first row of each band and of each chunk, and the end, unsigned
    corner : (C,) first node of each stencil, unsigned
    S : (C, m) shape function values
    G : (C, d·m) their gradients, axis by axis
    dof : (C, m) degree of freedom of each node of the stencil, unsigned
    """

    mask: Array
    particle: Array
    bands: Array
    chunks: Array
    corner: Array
    S: Array
    G: Array
    dof: Array


def is_cut(cut: Any, p: Any) -> bool:
    """Whether particle ``p`` is cut; compiled code does not ask where ``cut`` is None."""
    return cut is not None and bool(cut.mask[p])


@compiled_as(is_cut)
def _(cut, p):
    if str(cut) == "none":
        return lambda cut, p: False
    return lambda cut, p: cut.mask[p] != 0


class Sights(Protocol):
    """What tells the sides of nodes on which particles are: cracks."""

    def sorted(self) -> Array:
        """Note that particles were sorted; returns the nodes (n,), sorted, that may have further sides from now on."""

    def find_cut(self, transfer: Any, F: Array) -> Cut | None:
        """Find the cut particles of a step; None without any.

        ``F`` (nF, N) are the deformation gradients that the stencils of the step are built from; ``transfer`` is the
        ``Transfer`` of a simulation.
        """
