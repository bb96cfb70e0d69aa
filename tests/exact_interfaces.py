"""Closed forms of bodies that an interface joins, which the tests compare with."""

import numpy as np

Array = np.ndarray


def impact_speed(t: Array, D: float, passage: float, Z: float = 1.0, v: float = 1.0) -> Array:
    """Mean speed of the bar that was at rest; a wave takes ``passage`` along it and back. D may be infinite."""
    if np.isinf(D):
        return v * t / passage
    tau = Z / (2.0 * D)
    return v * (t - tau * (1.0 - np.exp(-t / tau))) / passage


def unlike_impact(
    t: Array, D: float, mass: float, Z: float, other: float, v: float = 1.0
) -> tuple[Array, Array]:
    """Mean speed of the bar that was at rest, of impedance ``other`` and ``mass`` per area, after an impact at ``v`` of
    one of impedance ``Z``, until a wave returns; and the energy per area of the interface.
    """
    both = Z * other / (Z + other)
    tau = both / D
    rise = 1.0 - np.exp(-t / tau)
    return both * v * (t - tau * rise) / mass, 0.5 * (both * v * rise) ** 2 / D


def impact_energy(D: float, Z: float = 1.0, v: float = 1.0) -> float:
    """Energy per area that the interface stores once the force is constant."""
    return 0.5 * (0.5 * Z * v) ** 2 / D


def transmitted(omega: Array, D: float, Z: float = 1.0) -> Array:
    """Transmitted over incident velocity of a harmonic wave between equal bars."""
    return 1.0 / (1.0 + 0.5j * omega * Z / D)


def filtered(t: Array, incident: Array, D: float, Z: float = 1.0) -> Array:
    """The transmitted pulse of any ``incident`` pulse: τ v′ + v = v_in, τ = Z/2D, at equal intervals; both start at 0.

    Exact for a pulse that is linear between the times.
    """
    if np.isinf(D) or D == 0.0:
        return incident if D else np.zeros_like(incident)
    h = (t[1] - t[0]) * 2.0 * D / Z
    decay = np.exp(-h)
    late = 1.0 - (1.0 - decay) / h
    early = (1.0 - decay) / h - decay
    out = np.zeros_like(incident)
    for i in range(1, len(t)):
        out[i] = decay * out[i - 1] + early * incident[i - 1] + late * incident[i]
    return out


def series_stress(u: float, length: float, D: float, E: float) -> float:
    """Stress of a bar of ``length`` with an interface across it, whose held ends are ``u`` further apart."""
    return u / (length / E + 1.0 / D)


def series_stress_of_extrapolated_jump(u: float, length: float, D: float, E: float, cell: float) -> float:
    """The same as the jump of extrapolated displacements finds it: it holds 0.75 cells of strain of the bar."""
    return u / ((length - 0.75 * cell) / E + 1.0 / D)


def ring_pressure(a: float, b: float, p: float, D: float, E: float, nu: float) -> float:
    """Pressure between a disk r < a and a ring a < r < b of the same material in plane strain under ``p`` on r = b."""
    c = E * (b * b - a * a)
    given = 2.0 * (1.0 - nu**2) * a * b * b * p / c
    ring = (1.0 + nu) * a * ((1.0 - 2.0 * nu) * a * a + b * b) / c
    disk = (1.0 + nu) * (1.0 - 2.0 * nu) * a / E
    return given / (ring + disk + 1.0 / D)


def centrifugal_stress(x: Array, radius: float, density: float, omega: float, nu: float) -> Array:
    """Stress across a diameter of a disk in plane strain that turns, at distances ``x`` from its centre.

    Its mean, ρ ω² R²/3, is what half of the disk pulls at the other half, whatever joins them.
    """
    nu = nu / (1.0 - nu)
    return density * omega**2 / 8.0 * ((3.0 + nu) * radius**2 - (1.0 + 3.0 * nu) * x**2)


def centrifugal_energy(D: float, radius: float, density: float, omega: float, nu: float) -> float:
    """What springs across that diameter store over the kinetic energy of the disk, with the stress of a whole disk."""
    x = np.linspace(-radius, radius, 2001)
    stored = np.trapezoid(centrifugal_stress(x, radius, density, omega, nu) ** 2, x) / (2.0 * D)
    return float(stored / (0.25 * np.pi * density * radius**4 * omega**2))


def least_centrifugal_energy(D: float, radius: float, density: float, omega: float) -> float:
    """The least that springs can store over the kinetic energy: that of the uniform stress ρ ω² R²/3."""
    return 4.0 * density * omega**2 * radius / (9.0 * np.pi * D)
