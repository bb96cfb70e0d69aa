"""Hencky elasticity with the elastic left Cauchy–Green tensor in the history: what soils share.

The first rows hold bᵉ − I. A step takes bᵉ to dF bᵉ dFᵀ; a return mapping then shortens ε = ½ ln bᵉ. Three more rows
count plastic strain and work.
"""

from typing import Any

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_symmetric, log_symmetric, logarithm_1p
from mpmcli.core.tensors import push_forward
from mpmcli.materials.base import bulk_speed_squared, dissipated_heat, strain_energy, wave_speed_squared
from mpmcli.materials.planar import in_space_and_plane, is_planar

HISTORY = (
    *(f"elastic_{component}" for component in ("xx", "yy", "zz", "xy", "yz", "xz")),
    "equivalent_plastic_strain",
    "plastic_work",
    "plastic_work_of_step",
)
"""Names of the first rows of the history."""
STRAIN, WORK, LAST = 6, 7, 8
"""The rows after those of the elastic strain."""


@inline
def elastic_tensor(m: Any, H: Any, p: Any) -> Any:
    """bᵉ of particle ``p``, 6-tuple."""
    yz, xz = (0.0, 0.0) if is_planar(m) else (H[4, p], H[5, p])
    return 1.0 + H[0, p], 1.0 + H[1, p], 1.0 + H[2, p], H[3, p], yz, xz


@inline
def keep_tensor(m: Any, H: Any, p: Any, b: Any) -> None:
    """Write bᵉ of particle ``p``."""
    H[0, p], H[1, p], H[2, p], H[3, p] = b[0] - 1.0, b[1] - 1.0, b[2] - 1.0, b[3]
    if not is_planar(m):
        H[4, p], H[5, p] = b[4], b[5]


@inline
def trial_tensor(m: Any, dF: Any, H: Any, p: Any) -> Any:
    """dF bᵉ dFᵀ: bᵉ of particle ``p`` after an elastic step."""
    return push_forward(dF, elastic_tensor(m, H, p))


@inline
def split_strain(b: Any) -> Any:
    """Trace of ε = ½ ln b, and its deviator, 6-tuple."""
    return split_logarithm(log_symmetric(b))


@inline
def split_logarithm(e: Any) -> Any:
    """The same from e = ln b."""
    mean = (e[0] + e[1] + e[2]) / 3.0
    deviator = (
        0.5 * (e[0] - mean), 0.5 * (e[1] - mean), 0.5 * (e[2] - mean), 0.5 * e[3], 0.5 * e[4], 0.5 * e[5]
    )  # fmt: skip
    return 1.5 * mean, deviator


@inline
def tensor_of_strain(scale: float, e: Any, third: float) -> Any:
    """b of ε with the deviator ``scale`` e, and ``third`` of the trace."""
    return exponential_symmetric(
        (
            2.0 * (scale * e[0] + third), 2.0 * (scale * e[1] + third), 2.0 * (scale * e[2] + third),
            2.0 * scale * e[3], 2.0 * scale * e[4], 2.0 * scale * e[5],
        )
    )  # fmt: skip


@inline
def double_contraction(a: Any) -> float:
    """a:a of a symmetric tensor."""
    return (
        a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + 2.0 * (a[3] * a[3] + a[4] * a[4] + a[5] * a[5])
    )  # fmt: skip


@inline
def excess_volume(m: Any, H: Any, p: Any) -> float:
    """det bᵉ − 1 of particle ``p``."""
    b = elastic_tensor(m, H, p)
    xx, yy, zz, xy, yz, xz = b[0] - 1.0, b[1] - 1.0, b[2] - 1.0, b[3], b[4], b[5]
    pairs = xx * yy + yy * zz + xx * zz - xy * xy - yz * yz - xz * xz
    triple = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return xx + yy + zz + (pairs + triple)


@inline
def elastic_volume(m: Any, H: Any, p: Any) -> float:
    """tr ε = ½ ln det bᵉ of particle ``p``."""
    return 0.5 * logarithm_1p(excess_volume(m, H, p))


@inline
def hencky_energy(m: Any, H: Any, p: Any) -> float:
    """½K tr²ε + G dev ε : dev ε of particle ``p`` [pressure]."""
    trace, deviator = split_strain(elastic_tensor(m, H, p))
    return 0.5 * m.bulk * trace * trace + m.shear * double_contraction(deviator)


@inline
def hencky_stiffness(m: Any, H: Any, p: Any) -> float:
    """ρ₀c² = K + 4G/3 − τ of particle ``p``, of τ only the mean [pressure]."""
    return m.bulk + 4.0 / 3.0 * m.shear - m.bulk * min(0.0, elastic_volume(m, H, p))


@inline
def keep_plastic(H: Any, p: Any, strain: float, work: float) -> None:
    """Add a step's equivalent plastic strain and plastic work."""
    H[STRAIN, p] += strain
    H[WORK, p] += work
    H[LAST, p] = work


def hencky_plastic(name: str, fields: tuple[str, ...], module: str) -> dict[bool, Any]:
    """``in_space_and_plane``, and all of a plastic law but its stress, from bulk, shear, density and lateral.

    ``lateral`` is the wave stiffness of the analysis over that of uniaxial strain.
    """
    found = in_space_and_plane(name, fields, module)
    for made in found.values():

        @strain_energy.register(made)
        def _(m: Any, F: Any, H: Any, p: Any) -> Any:
            return hencky_energy(m, H, p)

        @dissipated_heat.register(made)
        def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
            return H[LAST, p]

        @bulk_speed_squared.register(made)
        def _(m: Any, F: Any, H: Any, p: Any) -> Any:
            return max(0.0, m.bulk * (1.0 - elastic_volume(m, H, p)) / m.density)

        @wave_speed_squared.register(made)
        def _(m: Any, F: Any, H: Any, p: Any) -> Any:
            return m.lateral * hencky_stiffness(m, H, p) / m.density

    return found
