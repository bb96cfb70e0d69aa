"""One element of every law under uniaxial, shear and cyclic paths: computed and exact values, in plain Python."""

import math
from collections.abc import Callable, Collection, Iterator
from typing import Any, NamedTuple

import numpy as np
import soil_elements as soil
from material_point import MaterialPoint
from scipy.optimize import brentq

from mpmcli.materials import MATERIALS

PATHS = ("uniaxial", "shear", "cyclic")


class Answer(NamedTuple):
    """One figure of one path; a law's sub-model follows its name after a comma."""

    law: str
    path: str
    quantity: str
    computed: float
    exact: float

    @property
    def error(self) -> float:
        """Error, relative to the exact value if that is not 0 [-]."""
        return abs(self.computed - self.exact) / (abs(self.exact) or 1.0)


def answers(kinds: Collection[str] = tuple(sorted(set(MATERIALS) - {"rigid"}))) -> Iterator[Answer]:
    """Laws by name, each with all paths."""
    for kind in kinds:
        for name, make in LAWS[kind].items():
            for path, (quantity, computed, exact) in zip(PATHS, make(), strict=True):
                yield Answer(kind + name, path, quantity, float(computed), float(exact))


Figure = tuple[str, float, float]
STRETCH = "$\\lambda$ = "


def stretched(point: MaterialPoint, *stretches: float, count: int = 40) -> float:
    """Stress along x after stretches one after the other."""
    now = math.log(point.F[0])
    for stretch in stretches:
        point.steps(count, 1.0 / count, math.log(stretch) - now)
        now = math.log(stretch)
    return float(point.tau[0])


def sheared(point: MaterialPoint, *angles: float, count: int = 40, time: float = 1.0) -> float:
    """Shear stress after simple shears one after the other."""
    now = 0.0
    for angle in angles:
        point.steps(count, time / count, 0.0, (angle - now) / time, 0.0, 0.0)
        now = angle
    return float(point.tau[3])


def elastic(words: dict[str, Any], analysis: str, along: Callable[[float], float], shear: Callable[[float], float],
            largest: float = 1.5, angle: float = 1.0) -> Iterator[Figure]:  # fmt: skip
    """Paths of a law whose stress depends on the strain only; the cycle ends at a third strain."""
    least, last = 1 - 0.4 * (largest - 1), 1 + 0.4 * (largest - 1)
    point = MaterialPoint(analysis, words)
    yield f"{STRETCH}{largest:g}", stretched(point, largest), along(largest)
    yield f"$\\gamma$ = {angle:g}", sheared(MaterialPoint("plane_strain", words), angle), shear(angle)
    words_of_cycle = f"{STRETCH}{largest:g}, {least:g}, {last:g}"
    yield words_of_cycle, stretched(point, least, last), along(last)


def linear_elastic() -> Iterator[Figure]:
    def shear(angle: float) -> float:
        return 4 * 100.0 * math.asinh(angle / 2) / math.sqrt(4 + angle**2)

    words = {"kind": "linear_elastic", "E": 250.0, "nu": 0.25}
    return elastic(words, "uniaxial_stress", lambda s: 250 * math.log(s), shear)


def neo_hookean() -> Iterator[Figure]:
    words = {"kind": "neo_hookean", "E": 250.0, "nu": 0.25}  # Lamé's first modulus and G are both 100
    return elastic(words, "uniaxial_strain", lambda s: 150 * (s * s - 1), lambda g: 100 * g)


def mooney_rivlin() -> Iterator[Figure]:
    words = {"kind": "mooney_rivlin", "G1": 0.7, "G2": 0.3, "K": 1e5}
    return elastic(words, "uniaxial_stress", lambda s: (0.7 + 0.3 / s) * (s * s - 1 / s), lambda g: g)


FIBRES = {"E_axial": 100.0, "E_transverse": 10.0, "G_axial": 5.0, "nu_axial": 0.3, "nu_transverse": 0.4}
WOOD = {"E1": 100.0, "E2": 10.0, "E3": 5.0, "G12": 5.0, "G13": 4.0, "G23": 1.0}
WOOD |= {"nu12": 0.3, "nu13": 0.25, "nu23": 0.4}


def along_an_axis(words: dict[str, Any]) -> Iterator[Figure]:
    """A sheet pulled along its first axis at free width; its thickness is free in plane stress."""

    def pulled(*stretches: float) -> float:
        point, now = MaterialPoint("plane_stress", words), 0.0
        for stretch in stretches:
            for _ in range(10):
                held(point, (math.log(stretch) - now) / 10)
            now = math.log(stretch)
        return float(point.tau[0])

    def exact(stretch: float) -> float:
        return 100 / 8 * (stretch**4 - stretch**-4)

    yield STRETCH + "1.1", pulled(1.1), exact(1.1)
    yield "$\\gamma$ = 0.001", sheared(MaterialPoint("plane_strain", words), 1e-3), 5e-3
    yield STRETCH + "1.1, 0.95, 1.05", pulled(1.1, 0.95, 1.05), exact(1.05)


def held(point: MaterialPoint, strain: float) -> None:
    """A step along x with a rate along y such that the stress across vanishes."""
    p = point.particles
    kept = [array.copy() for array in (p.F, p.tau, p.H, p.stress_work)]

    def miss(lateral: float) -> float:
        for array, before in zip((p.F, p.tau, p.H, p.stress_work), kept, strict=True):
            array[:] = before
        return float(point.step(1.0, strain, 0.0, 0.0, lateral)[1])

    size = 2 * abs(strain)
    miss(float(brentq(miss, -size, size, xtol=1e-15, rtol=1e-13)))


def viscoelastic() -> Iterator[Figure]:
    K, G, more, time = 300.0, 40.0, 60.0, 2.0
    words = {"kind": "viscoelastic", "G": G, "K": K, "terms": [{"time": time, "G": more}]}

    def modulus(t: float) -> float:
        return G + more * math.exp(-t / time)

    point = MaterialPoint("uniaxial_strain", words)
    point.step(1e-9, 1e5)
    yield (
        "stress at t = 3 of $\\varepsilon$ = 1e-4",
        point.steps(3, 1.0, 0.0)[0],
        1e-4 * (K + 4 / 3 * modulus(3)),
    )
    point = MaterialPoint("plane_strain", words)
    point.step(1e-9, 0.0, 1e9, 0.0, 0.0)
    yield "stress at t = 3 of $\\gamma$ = 1", point.steps(3, 1.0, 0.0, 0.0, 0.0, 0.0)[3], modulus(3)
    point, n, lost, amplitude = MaterialPoint("plane_strain", words), 80, 0.0, 1e-3
    for i in range(4 * n):
        if i == 3 * n:
            lost = point.history("heat_energy")
        rate = math.sin(2 * math.pi * (i + 1) / n) - math.sin(2 * math.pi * i / n)
        dt = 2 * math.pi * time / n  # one radian per relaxation time: half of the modulus is lost
        point.step(dt, 0.0, amplitude * rate / dt, 0.0, 0.0)
    lost = (point.history("heat_energy") - lost) / (math.pi * amplitude**2)
    yield "loss modulus at $\\omega t_1$ = 1", lost, more / 2


def ideal_gas() -> Iterator[Figure]:
    words = {"kind": "ideal_gas", "pressure": 100.0, "gamma": 1.4}
    point = MaterialPoint("uniaxial_strain", words, adiabatic=True)
    yield STRETCH + "0.5, adiabatic", stretched(point, 0.5, count=400), -100 * 0.5**-0.4
    yield "$\\gamma$ = 1", sheared(MaterialPoint("plane_strain", words), 1.0), 0.0
    yield STRETCH + "0.5, 2, 0.8", stretched(point, 2.0, 0.8, count=400), -100 * 0.8**-0.4


def fluid(kind: str, n: float, rest: float) -> Iterator[Figure]:
    """Pressures of Tait's equation, and shear stress at a rate and the opposite one."""
    words = {"kind": kind, "K": 1000.0, "viscosity": 0.02} | ({"yield_stress": rest} if rest else {})

    def pressure(J: float) -> float:
        return -J * 1000 / n * (J**-n - 1)

    def pressed(*volumes: float) -> float:
        point, now = MaterialPoint("3d", words), 0.0
        for J in volumes:
            rate = (math.log(J) - now) / 3
            point.steps(10, 0.1, *(rate if i % 4 == 0 else 0.0 for i in range(9)))
            now = math.log(J)
        point.step(0.1, *(9 * [0.0]))
        return float(point.tau[0])

    yield "J = 0.9", pressed(0.9), pressure(0.9)
    point = MaterialPoint("plane_strain", words)
    yield "rate 5", point.steps(60, 0.01, 0, 5.0, 0, 0)[3], rest + 0.1
    yield "rate −5 after it", point.steps(60, 0.01, 0, -5.0, 0, 0)[3], -rest - 0.1


def mie_gruneisen() -> Iterator[Figure]:
    words = {"kind": "mie_gruneisen", "K": 1000.0, "G": 100.0, "S1": 1.5, "gamma0": 0.0, "heat_capacity": 1.0}

    def along(J: float) -> float:
        eta = 1 - J
        pressure = 1000 * eta / (1 - 1.5 * eta) ** 2 if eta > 0 else 1000 * eta
        return -J * pressure + 200 / 3 * (J ** (4 / 3) - J ** (-2 / 3))

    point = MaterialPoint("uniaxial_strain", words)
    yield STRETCH + "0.8, $\\gamma_0$ = 0", stretched(point, 0.8), along(0.8)
    yield "$\\gamma$ = 0.5", sheared(MaterialPoint("plane_strain", words), 0.5), 50.0
    yield STRETCH + "0.8, 1.1, 0.9", stretched(point, 1.1, 0.9), along(0.9)


HARDENING: dict[str, tuple[dict[str, Any], Callable[[float], float]]] = {
    "linear": ({"modulus": 2.0}, lambda a: 0.4 + 2 * a),
    "swift": ({"eps0": 0.01, "n": 0.2}, lambda a: 0.4 * (1 + a / 0.01) ** 0.2),
    "voce": ({"saturation": 0.9, "eps0": 0.05}, lambda a: 0.9 - 0.5 * math.exp(-a / 0.05)),
    "power_law": ({"B": 0.8, "n": 0.3}, lambda a: 0.4 + 0.8 * a**0.3),
    "johnson_cook": ({"A": 0.4, "B": 0.8, "n": 0.3}, lambda a: 0.4 + 0.8 * a**0.3),
    "steinberg_cochran_guinan": (
        {"Y_max": 0.9, "beta": 36.0, "n": 0.45},
        lambda a: min(0.9, 0.4 * (1 + 36 * a) ** 0.45),
    ),
}
"""Hardening laws of the initial yield stress 0.4, and their flow stresses."""


def flow_after(Y: Callable[[float], float], slope: float, factor: float, *strains: float) -> float:
    """Stress after a path of strains, with slope·(strain − factor·α) = stress where it flows at Y/factor."""
    stress, strain, alpha = 0.0, 0.0, 0.0
    for end in strains:
        sign = math.copysign(1.0, end - strain)
        trial = stress + slope * (end - strain)
        if abs(trial) * factor <= Y(alpha):
            stress, strain = trial, end
            continue

        def miss(a: float, trial: float = trial, sign: float = sign, alpha: float = alpha) -> float:
            return sign * trial - slope * factor * (a - alpha) - Y(a) / factor

        alpha = float(brentq(miss, alpha, alpha + abs(end - strain) / factor, xtol=1e-15))
        stress, strain = sign * Y(alpha) / factor, end
    return stress


def j2_plastic(kind: str) -> Callable[[], Iterator[Figure]]:
    keys, Y = HARDENING[kind]
    law = {"kind": kind, **({} if kind == "johnson_cook" else {"yield_stress": 0.4}), **keys}
    words = {"kind": "j2_plastic", "E": 200.0, "nu": 0.25, "hardening": law}

    def make() -> Iterator[Figure]:
        point = MaterialPoint("uniaxial_stress", words)
        yield "$\\varepsilon$ = 0.1", stretched(point, math.exp(0.1)), flow_after(Y, 200.0, 1.0, 0.1)
        point = MaterialPoint("plane_strain", words)
        found = []
        for sign in (1, -1, 1):
            found.append(point.steps(40, 1e-3, 0.0, sign, sign, 0.0)[3])
        root = math.sqrt(3.0)
        yield "$\\gamma$ = 0.08", found[0], flow_after(Y, 80.0, root, 0.08)
        yield "$\\gamma$ = 0.08, 0, 0.08", found[2], flow_after(Y, 80.0, root, 0.08, 0.0, 0.08)

    return make


def hill_plastic() -> Iterator[Figure]:
    ratios = {"kind": "ratios", "R11": 1.2, "R22": 1.0, "R33": 0.9, "R12": 0.8}
    numbers = {"E1": 200.0, "E2": 200.0, "E3": 200.0, "nu12": 0.25, "nu13": 0.25, "nu23": 0.25}
    numbers |= {"G12": 80.0, "G13": 80.0, "G23": 80.0}
    hardening = {"kind": "linear", "yield_stress": 0.4, "modulus": 2.0}
    words = {"kind": "hill_plastic", **numbers, "anisotropy": ratios, "hardening": hardening}
    Y = HARDENING["linear"][1]
    point = MaterialPoint("plane_stress", words)
    for _ in range(20):
        held(point, 0.002)
    yield "$\\varepsilon$ = 0.04", point.tau[0], flow_after(Y, 200.0, 1 / 1.2, 0.04)
    point = MaterialPoint("plane_strain", words)
    found = [point.steps(40, 1e-3, 0.0, sign, sign, 0.0)[3] for sign in (1, -1, 1)]
    factor = math.sqrt(3.0) / 0.8
    yield "$\\gamma$ = 0.08", found[0], flow_after(Y, 80.0, factor, 0.08)
    yield "$\\gamma$ = 0.08, 0, 0.08", found[2], flow_after(Y, 80.0, factor, 0.08, 0.0, 0.08)


def clamped_neo_hookean() -> Iterator[Figure]:
    words = {"kind": "clamped_neo_hookean", "E": 250.0, "nu": 0.25, "compression": 0.02, "extension": 0.005}

    def along(stretch: float, J: float) -> float:
        return 150 * (stretch**2 - 1) * math.exp(10 * (1 - J))

    point = MaterialPoint("uniaxial_strain", words)
    yield STRETCH + "0.8", stretched(point, 0.8), along(0.98, 0.8 / 0.98)
    shear = MaterialPoint("plane_strain", words).steps(60, 0.001, 0.0, 1.0, 1.0, 0.0)[3]
    factor = math.exp(10 * (1 - 1 / (1.005 * 0.98)))
    yield "$\\gamma$ = 0.12", shear, 50 * (1.005**2 - 0.98**2) * factor
    yield STRETCH + "0.8, 0.81", stretched(point, 0.81), along(0.98 * 0.81 / 0.8, 0.8 / 0.98)


def isotropic_softening() -> Iterator[Figure]:
    words = {"kind": "isotropic_softening", "E": 1000.0, "nu": 0.25, "strength": 1.0, "toughness": 0.01}
    point = MaterialPoint("uniaxial_stress", words, bands=(0.5, 9, 9))
    opened = (0.02 - 0.001) / (1 / 0.5 - 0.001 / 0.02)  # the strain is stress/E + opening/band
    stress = stretched(point, math.exp(0.02), count=80)
    yield "$\\varepsilon$ = 0.02, band 0.5", stress, 1 - opened / 0.02
    sheared_point = MaterialPoint("plane_strain", words, bands=(0.5, 0.5, 1))
    sheared_point.steps(2, 0.00052, 1.0, 0.0, 0.0, 0.0)
    sheared_point.steps(200, 0.001, 0.0, 1.0, 1.0, 0.0)
    yield "energy of a sheared crack", 0.5 * sheared_point.history("dissipated_energy"), 0.01
    stretched(point, math.exp(-0.01), count=80)
    yield (
        "$\\varepsilon$ = −0.01, 0.02 after it",
        stretched(point, math.exp(0.02), count=80),
        1 - opened / 0.02,
    )


MATCH = {"drucker_prager": {"match": "outer"}, "mohr_coulomb": {}}


def cohesive_shear(kind: str) -> tuple[float, float]:
    """Shear stresses without friction, and after a reversal."""
    e = soil.frictional(kind, **MATCH[kind], friction=0.0, dilation=0.0)
    e.confine(soil.CONFINING)
    found = []
    for sign in (1, -1):
        for _ in range(50):
            e.step(np.array([sign * 1e-3, 0.0, -sign * 1e-3]))
        found.append((e.tau[0] - e.tau[2]) / 2)
    return found[0], found[1]


def frictional(kind: str, strength: float) -> Iterator[Figure]:
    e = soil.frictional(kind, **MATCH[kind])
    e.confine(soil.CONFINING)
    e.load(-0.05, 50, -soil.CONFINING)
    yield "axial stress, triaxial", -e.tau[2], soil.passive(soil.CONFINING)
    first, second = cohesive_shear(kind)
    yield "$\\varphi$ = 0", first, strength
    yield "$\\varphi$ = 0, reversed", second, -strength


def granular() -> Iterator[Figure]:
    words = {"mu_s": 0.38, "mu_2": 0.64, "I0": 0.28, "grain_diameter": 1e-3, "grain_density": 2500.0}
    e = soil.Element("granular", E=soil.E, nu=0.1, **words | {"mu_2": 0.38})
    for _ in range(50):
        e.step(np.array([0.0, 0.0, -2e-4]), 1e-3)
    root = 0.38 / math.sqrt(3)
    yield "lateral over axial stress, oedometer", e.tau[0] / e.tau[2], (1 - root) / (1 + 2 * root)
    e, rate, exact = soil.Element("granular", E=soil.E, nu=soil.NU, **words), 10.0, 0.0
    e.confine(1e3)
    for sign, text in ((1, "stress over pressure, rate 10/s"), (-1, "the same, reversed")):
        for _ in range(600):
            e.step(np.array([[0, sign * rate * 2e-6, 0], [0, 0, 0], [0, 0, 0]]), 2e-6)
        p = -e.tau[:3].mean()
        exact = 0.38 + 0.26 / (1 + 0.28 / (rate * 1e-3 * math.sqrt(2500.0 / p)))
        yield text, e.tau[3] / p, sign * exact


def modified_cam_clay() -> Iterator[Figure]:
    M, slope, kappa, e0, p0 = 1.2, 0.2, 0.04, 1.0, 1e5
    words = {"M": M, "lambda": slope, "kappa": kappa, "nu": soil.NU, "e0": e0, "p0": p0}
    e = soil.Element("modified_cam_clay", **words)
    critical = p0 * 0.5 ** (1 - kappa / slope)
    for _ in range(300):
        e.step(np.array([1e-3, 1e-3, -2e-3]))
    yield "q, undrained triaxial", e.tau[0] - e.tau[2], M * critical
    e = soil.Element("modified_cam_clay", **words)
    for _ in range(300):
        e.step(np.array([2e-3, 0.0, -2e-3]))
    yield "$\\sqrt{J_2}$, undrained", (e.tau[0] - e.tau[2]) / 2, M * critical / math.sqrt(3)
    e = soil.Element("modified_cam_clay", **words)
    for strain in 20 * [-0.01] + 5 * [0.01]:
        e.step(np.full(3, strain / 3))
    yield "p, $\\ln J$ = −0.2, −0.15", -e.tau[0], p0 * math.exp(0.4 / slope - 0.1 / kappa)


LAWS: dict[str, dict[str, Callable[[], Iterator[Figure]]]] = {
    "bingham": {"": lambda: fluid("bingham", 7.0, 0.3)},
    "clamped_neo_hookean": {"": clamped_neo_hookean},
    "drucker_prager": {"": lambda: frictional("drucker_prager", soil.COHESION * 2 / math.sqrt(3))},
    "granular": {"": granular},
    "hill_plastic": {"": hill_plastic},
    "ideal_gas": {"": ideal_gas},
    "isotropic_softening": {"": isotropic_softening},
    "j2_plastic": {f", {kind}": j2_plastic(kind) for kind in HARDENING},
    "linear_elastic": {"": linear_elastic},
    "mie_gruneisen": {"": mie_gruneisen},
    "modified_cam_clay": {"": modified_cam_clay},
    "mohr_coulomb": {"": lambda: frictional("mohr_coulomb", soil.COHESION)},
    "mooney_rivlin": {"": mooney_rivlin},
    "neo_hookean": {"": neo_hookean},
    "orthotropic": {"": lambda: along_an_axis({"kind": "orthotropic", **WOOD})},
    "tait_fluid": {"": lambda: fluid("tait_fluid", 7.0, 0.0)},
    "transversely_isotropic": {
        "": lambda: along_an_axis({"kind": "transversely_isotropic", "axis": "x", **FIBRES})
    },
    "viscoelastic": {"": viscoelastic},
}
"""Paths of each kind, and of each sub-model that has its own."""
