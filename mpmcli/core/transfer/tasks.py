"""What a scatter adds to the nodes: one tuple of arrays per task. Nodal arrays come flat (see ``gather_scatter``)."""

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class MassAndMomentum(NamedTuple):
    """Task 1: m = Sᵀ M and p = Sᵀ M V (Nairn 2026, section 2.1), or another capacity and what it carries."""

    M: Array
    """(N,) capacity of each particle: of velocities its mass."""
    V: Array
    """(c, N)"""
    mp: Array
    """(n·(1 + c),) capacity and extensive value of the nodes."""


class InternalForces(NamedTuple):
    """Task 2: f = −Gᵀ Ω τ, with Ω the initial volumes."""

    vol0: Array
    tau: Array
    f: Array
    """(n·d,) forces on the nodes."""


class StateAndForces(NamedTuple):
    """Tasks 1 and 2 at once, where stress does not change between them: one stencil serves both."""

    M: Array
    V: Array
    vol0: Array
    tau: Array
    mp: Array
    f: Array


class Projection(NamedTuple):
    """One pass of the FMPM loop: out = Sᵀ M S v, so that out/m = S⁺S v."""

    M: Array
    v: Array
    """(n·c,) nodal velocities, or other values."""
    out: Array
    """(n·c,)"""


class VectorSum(NamedTuple):
    """out = Sᵀ M V for particle vectors: accelerations (task 2) or new velocities (task 4.a)."""

    M: Array
    V: Array
    """(c, N)"""
    out: Array
    """(n·c,)"""


class AffineMassAndMomentum(NamedTuple):
    """``MassAndMomentum`` with velocity gradients: p_i = Σ S_i M (V + L·(x_i − X)) (Wallstedt and Guilkey 2007)."""

    M: Array
    V: Array
    L: Array
    """(nL, N) velocity gradients."""
    mp: Array


class AffineStateAndForces(NamedTuple):
    """``StateAndForces`` with velocity gradients."""

    M: Array
    V: Array
    L: Array
    vol0: Array
    tau: Array
    mp: Array
    f: Array


class AffineProjection(NamedTuple):
    """``Projection`` with the velocity gradient of ``v``, which passes through ``L`` (nL, N)."""

    M: Array
    v: Array
    L: Array
    out: Array


class AffineVectorSum(NamedTuple):
    """``VectorSum`` of velocities with their gradients."""

    M: Array
    V: Array
    L: Array
    out: Array
