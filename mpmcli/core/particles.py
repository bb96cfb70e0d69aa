"""The particles: one contiguous row per component of each field."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from mpmcli.core.analysis import F_COMPONENTS, STRESS_COMPONENTS, Analysis, gradient_rows
from mpmcli.core.compiled.compiler import INLINED, compiled_too

Array = np.ndarray


@dataclass
class Particles:
    """State of N particles in d dimensions (arrays are sorted by cell in memory; ``id`` never changes).

    Attributes
    ----------
    X, V : (d, N) position [length], velocity [velocity]
    F : (nF, N) deformation gradient; rows of ``analysis.F_COMPONENTS`` [-]
    tau : (nT, N) Kirchhoff stress; rows of ``analysis.STRESS_COMPONENTS`` [pressure]
    L : (nL, N) velocity gradient of the last strain update [1/time]
    mass, vol0 : (N,) mass and initial volume (thickness and area included; per radian if axisymmetric)
    size : (d, N) initial half-sizes of the particle's domain along the axes [length]
    id, body, material, velocity_field : (N,) identity from birth; indices into the scene's lists
    H : (n_history, N) history variables of the materials (rows named by each material)
    stress_work : (N,) accumulated work of the stress per particle [energy]
    viscous_pressure, viscous_work : (N,) or None; only with artificial viscosity [pressure], [energy]
    X0 : (d, N) or None; initial position, only where a method of contact needs displacements [length]
    T : (N,) or None; temperature that materials, conditions and archives see; only with conduction, or with materials
        that expand or warm by themselves [temperature]
    T_carried : (N,) or None; temperature that FLIP carries to the grid, which has noise that T does not
        [temperature]
    T_start : (N,) or None; temperature at the start, with conduction if nothing else changes temperatures
        [temperature]
    heat_inflow, entropy : (N,) or None; heat that a particle has received by conduction, from loads, conditions and
        friction, and what its entropy has grown by; only with conduction where work changes temperatures, too
        [energy], [energy/temperature]
    heat_flux : (d, N) or None; flux of heat −κ∇T [power/area]
    T_stress : (N,) or None; temperature of the last stress, only with materials that expand and whose law needs
        increments [temperature]
    bond : (N,) or None; 1 while contact nearby still adheres, else 0; only with adhesive contact [-]
    outward : (d + 1, N) or None; unit normal of the nearest surface of rigid bodies, pointing out of them, and its
        curvature at the particle; zeros where there is none near; only where contact uses it [-], [1/length]
    interface : (3 m, N) or None; history of the interfaces that a particle may belong to, three rows each: largest
        opening so far along the normal and along the surface, −1 before any interface reached it, and 1 where it is
        broken, else 0 [length], [length], [-]
    version : changes whenever an array is replaced by another one, but for ``exchange_positions``
    """

    X: Array
    V: Array
    F: Array
    tau: Array
    L: Array
    mass: Array
    vol0: Array
    size: Array
    id: Array
    body: Array
    material: Array
    velocity_field: Array
    H: Array
    stress_work: Array
    viscous_pressure: Array | None = None
    viscous_work: Array | None = None
    X0: Array | None = None
    T: Array | None = None
    T_carried: Array | None = None
    T_start: Array | None = None
    heat_inflow: Array | None = None
    entropy: Array | None = None
    heat_flux: Array | None = None
    T_stress: Array | None = None
    bond: Array | None = None
    outward: Array | None = None
    interface: Array | None = None

    version: ClassVar[int] = 0

    def __setattr__(self, name: str, value: Any) -> None:
        self.__dict__["version"] = self.version + 1
        self.__dict__[name] = value

    def exchange_positions(self, X: Array) -> Array:
        """Take on the positions ``X`` (d, N) [length]; returns the array of those before. ``version`` stays."""
        before, self.__dict__["X"] = self.X, X
        return before

    @property
    def count(self) -> int:
        """Number of particles."""
        return self.mass.shape[0]

    @classmethod
    def at_rest(
        cls,
        analysis: Analysis,
        X: Array,
        size: Array,
        vol0: Array,
        mass: Array,
        *,
        body: Array,
        material: Array,
        velocity_field: Array,
        history_rows: int = 0,
        artificial_viscosity: bool = False,
    ) -> Particles:
        """Undeformed particles without velocity, identities 0…N−1 in the order given."""
        d, n = X.shape
        F = np.zeros((len(F_COMPONENTS[d]), n))
        for row, name in enumerate(F_COMPONENTS[d]):
            F[row] = float(name[0] == name[1])
        return cls(
            X=np.ascontiguousarray(X, dtype=np.float64),
            V=np.zeros((d, n)),
            F=F,
            tau=np.zeros((len(STRESS_COMPONENTS[d]), n)),
            L=np.zeros((gradient_rows(analysis), n)),
            mass=np.ascontiguousarray(mass, dtype=np.float64),
            vol0=np.ascontiguousarray(vol0, dtype=np.float64),
            size=np.ascontiguousarray(size, dtype=np.float64),
            id=np.arange(n, dtype=np.int64),
            body=np.ascontiguousarray(body, dtype=np.int32),
            material=np.ascontiguousarray(material, dtype=np.int32),
            velocity_field=np.ascontiguousarray(velocity_field, dtype=np.int32),
            H=np.zeros((history_rows, n)),
            stress_work=np.zeros(n),
            viscous_pressure=np.zeros(n) if artificial_viscosity else None,
            viscous_work=np.zeros(n) if artificial_viscosity else None,
        )

    def arrays(self) -> dict[str, Array]:
        """Every allocated array by name (absent ones are left out)."""
        return {name: array for name, array in vars(self).items() if isinstance(array, np.ndarray)}

    def memory(self) -> dict[str, Array]:
        """Return what a checkpoint keeps of them: all arrays."""
        return self.arrays()

    def recall(self, memory: Mapping[str, Array]) -> None:
        """Take it back."""
        for name in self.arrays():
            setattr(self, name, memory[name])

    def copy(self, into: Particles | None = None, names: Collection[str] | None = None) -> Particles:
        """An independent copy of the state; in the arrays of ``into`` if they fit, which spares fresh memory.

        ``names`` are those of the arrays that are copied; the others of the copy are empty.
        """
        arrays = self.arrays()
        if names is not None:
            arrays |= {name: a[..., :0] for name, a in arrays.items() if name not in names}
        there = {} if into is None else into.arrays()
        if into is None or {n: a.shape for n, a in arrays.items()} != {n: a.shape for n, a in there.items()}:
            return replace(self, **{name: array.copy() for name, array in arrays.items()})
        for name, array in arrays.items():
            np.copyto(there[name], array)
        return into

    def keep(self, kept: Array) -> None:
        """Drop all particles but those of the mask ``kept`` (N,)."""
        for name, array in self.arrays().items():
            setattr(self, name, np.ascontiguousarray(array[..., kept]))

    def are_possible(self) -> bool:
        """Return whether positions, velocities, stresses and F are finite, and no particle is inside out."""
        is_finite = all(np.isfinite(array).all() for array in (self.X, self.V, self.F, self.tau))
        return is_finite and bool((self.determinant() > 0.0).all())

    def negligible_mass(self) -> float:
        """Mass of a node [mass] up to which its forces are round-off: 1e-20 of that of the lightest particle."""
        return 1e-20 * float(self.mass.min()) if self.count else 0.0

    def determinant(self) -> Array:
        """J = det F per particle, shape (N,)."""
        return determinant_of_particle(self.F, slice(None))


@partial(compiled_too, options=INLINED | {"fastmath": False})
def determinant_of_particle(F: Any, p: Any) -> Any:
    """J = det F of particle ``p``, or of all of a slice; ``F`` (3 | 5 | 9, N), also where it is not finite."""
    if F.shape[0] == 3:
        return F[0, p] * F[1, p] * F[2, p]
    if F.shape[0] == 5:
        return (F[0, p] * F[3, p] - F[1, p] * F[2, p]) * F[4, p]
    return (
        F[0, p] * (F[4, p] * F[8, p] - F[5, p] * F[7, p])
        - F[1, p] * (F[3, p] * F[8, p] - F[5, p] * F[6, p])
        + F[2, p] * (F[3, p] * F[7, p] - F[4, p] * F[6, p])
    )
