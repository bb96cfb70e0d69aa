"""Particle vectors extrapolated to a node, side by side: what grid methods see of the separation."""

from typing import Any

from mpmcli.core.compiled.kernel import inline


@inline
def extrapolate_along(axes: Any, neighbours: Any, vectors: Any, count: Any, n: Any) -> Any:
    """Component along ``n`` of S⁺ ``vectors`` (d, N) for α and β, weighted by S and mass, and whether both exist.

    S⁺ = m⁻¹ Sᵀ M, taken over the particles of each side alone (Nairn et al. 2020, Eqs. 6 and 11).
    """
    mass_alpha, sum_alpha, mass_beta, sum_beta = 0.0, 0.0, 0.0, 0.0
    for p in range(count):
        along = 0.0
        for a in range(len(axes)):
            along += vectors[a, p] * n[a]
        weight = neighbours.S[p] * neighbours.mass[p]
        alpha = weight if neighbours.side[p] < 0.0 else 0.0
        beta = weight - alpha
        mass_alpha += alpha
        sum_alpha += alpha * along
        mass_beta += beta
        sum_beta += beta * along
    if mass_alpha > 0.0 and mass_beta > 0.0:
        return sum_alpha / mass_alpha, sum_beta / mass_beta, True
    return 0.0, 0.0, False
