"""The kinds of analysis: how many axes the grid has, and which tensor components a particle carries.

Storage of particle tensors, one contiguous row per component:

=====  ===========================================  ============================  =========================
axes   deformation gradient ``F``                   stress ``tau``                velocity gradient ``L``
=====  ===========================================  ============================  =========================
1      xx, yy, zz                                   xx, yy, zz                    xx
2      xx, xy, yx, yy, zz                           xx, yy, zz, xy                xx, xy, yx, yy (, zz hoop)
3      xx, xy, xz, yx, yy, yz, zx, zy, zz           xx, yy, zz, xy, yz, xz        as F
=====  ===========================================  ============================  =========================

In axisymmetric analyses x is r, y is z and zz is the hoop direction.
"""

import math
from typing import NamedTuple


class UniaxialStrain(NamedTuple):
    """1D, no lateral strain. Fields are dummies: numba tells the classes apart, the values are never read."""

    dimensions: int = 1


class UniaxialStress(NamedTuple):
    """1D, lateral stress zero."""

    dimensions: int = 1


class PlaneStrain(NamedTuple):
    """2D, F_zz = 1."""

    dimensions: int = 2


class PlaneStress(NamedTuple):
    """2D, tau_zz = 0."""

    dimensions: int = 2


class Axisymmetric(NamedTuple):
    """2D in (r, z), hoop strain u_r/r; masses, volumes and forces inside are per radian."""

    dimensions: int = 2


class Solid(NamedTuple):
    """3D."""

    dimensions: int = 3


Analysis = UniaxialStrain | UniaxialStress | PlaneStrain | PlaneStress | Axisymmetric | Solid

ANALYSES: dict[str, type[Analysis]] = {
    "uniaxial_strain": UniaxialStrain,
    "uniaxial_stress": UniaxialStress,
    "plane_strain": PlaneStrain,
    "plane_stress": PlaneStress,
    "axisymmetric": Axisymmetric,
    "3d": Solid,
}

F_COMPONENTS = {
    1: ("xx", "yy", "zz"),
    2: ("xx", "xy", "yx", "yy", "zz"),
    3: ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"),
}
STRESS_COMPONENTS = {
    1: ("xx", "yy", "zz"),
    2: ("xx", "yy", "zz", "xy"),
    3: ("xx", "yy", "zz", "xy", "yz", "xz"),
}


def gradient_rows(analysis: Analysis) -> int:
    """How many rows the velocity gradient of a particle has."""
    return {1: 1, 2: 4, 3: 9}[analysis.dimensions] + isinstance(analysis, Axisymmetric)


def full_ring(analysis: Analysis) -> float:
    """Return 2π in axisymmetric analyses, which calculate per radian and whose users give full rings, else 1."""
    return 2 * math.pi if isinstance(analysis, Axisymmetric) else 1.0
