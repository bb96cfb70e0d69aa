"""One particle of any material at temperatures of our choice, and materials for it."""

import math
from typing import Any, NamedTuple

import numpy as np
from material_point import particles_of

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.exponentials import logarithm
from mpmcli.core.tensors import determinant
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import (
    MaterialModel,
    bulk_speed_squared,
    dissipated_heat,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import dissipate_nothing, with_defaults
from mpmcli.materials.strain import (
    BLOCK,
    ArtificialViscosity,
    block_count,
    stored_energy,
    update_strain_and_stress,
)
from mpmcli.materials.thermal import thermal_of
from mpmcli.materials.warmth import ROWS

E, NU, RHO, ALPHA, T0 = 200.0, 0.3, 2.0, 1e-3, 300.0
G, K = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
HEAT = {"density": RHO, "expansion": ALPHA, "T0": T0}
HENCKY = {"kind": "linear_elastic", "E": E, "nu": NU} | HEAT
RUBBER = {"kind": "neo_hookean", "E": E, "nu": NU, "split": "isochoric"} | HEAT
METAL = {"kind": "j2_plastic", "E": E, "nu": NU, "hardening": {"kind": "linear", "yield_stress": 1e9}} | HEAT
WATER = {"kind": "tait_fluid", "K": K, "viscosity": 0.1} | HEAT | {"expansion": 1e-5}
SOLIDS = {
    "hencky": HENCKY,
    "coupled": RUBBER | {"split": "none"},
    "coupled_log": RUBBER | {"split": "none", "volumetric": "log"},
    "isochoric": RUBBER,
    "isochoric_log": RUBBER | {"volumetric": "log"},
    "metal": METAL,
}


class LogSolid(MaterialModel):
    """A plugin's material, which says nothing of heat: τ = K ln J I."""

    analyses = frozenset(ANALYSES)
    properties = frozenset({"hyperelastic", "isotropic", "stress_free_at_rest"})
    K: float

    def parameters(self, analysis, adiabatic):
        """Modulus and density."""
        return Log(self.K, self.density)


@with_defaults
class Log(NamedTuple):
    bulk: float
    density: float


@kirchhoff_stress.register(Log)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    mean = m.bulk * logarithm(determinant(F))
    return mean, mean, mean, 0.0, 0.0, 0.0


@strain_energy.register(Log)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    log = logarithm(determinant(F))
    return 0.5 * m.bulk * log * log


@wave_speed_squared.register(Log)
@bulk_speed_squared.register(Log)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.bulk * max(0.0, 1.0 - logarithm(determinant(F))) / m.density


class Run:
    """One particle of a material at a temperature of our choice."""

    def __init__(
        self, analysis, material, heating="adiabatic", conducts=False, viscosity=None, T=None, volume=0.5
    ):
        if isinstance(material, MaterialModel):
            self.model = material
        else:
            self.model = MATERIALS[material["kind"]].model_validate(material)
        model, self.analysis = self.model, ANALYSES[analysis]()
        adiabatic = heating == "adiabatic"
        self.p = p = particles_of(model, self.analysis, volume=volume, is_viscous=viscosity is not None)
        has_bath = conducts and not adiabatic
        own = "equation_of_state" in model.properties
        self.m = model.parameters(analysis, adiabatic or (has_bath and not own))
        if needs_increment(self.m) and model.expansion > 0.0:
            p.T_stress = np.full(1, model.T0)
        p.T, p.T_carried = np.full(1, model.T0), np.full(1, 7.0)
        if conducts:
            p.entropy, p.heat_inflow = np.zeros(1), np.zeros(1)
        dissipates = dissipated_heat.implementations[type(self.m)] is not dissipate_nothing
        self.numbers = thermal_of(model, adiabatic, has_bath, dissipates or viscosity is not None)
        self.bath = np.zeros(1) if has_bath else None
        self.viscous = None
        if viscosity is not None:
            self.viscous = ArtificialViscosity(*viscosity, p.viscous_pressure, p.viscous_work)
        self.speed2, self.bad = np.zeros(block_count(1)), np.zeros(block_count(1), dtype=np.int64)
        self.step(0.0)
        if T is not None:
            self.warm(T)

    @property
    def thermal(self):
        """The numbers with the arrays of the particle."""
        p, history = self.p, self.model.history
        rows = {name: p.H[i] for i, name in enumerate(history)}
        expands = self.numbers is not None and self.numbers.expansion is not None
        return self.numbers and self.numbers._replace(
            T=p.T,
            T_carried=p.T_carried,
            T_stress=p.T_stress,
            tracked=rows.get("temperature"),
            heat=rows.get("heat_energy") if self.numbers.own else None,
            plastic_work=rows.get("plastic_work") if expands else None,
            heat_energy=rows.get("heat_energy") if expands else None,
            entropy=p.entropy,
            heat_inflow=p.heat_inflow,
            bath=self.bath,
            scratch=np.full((1, ROWS, BLOCK), np.nan),
        )

    def step(self, dt, *L):
        p = self.p
        for row, value in enumerate(L):
            p.L[row] = value
        update_strain_and_stress[False](
            self.analysis, self.m, -1, p.F, p.L, p.tau, p.H, p.mass, p.vol0, p.material, p.stress_work,
            self.viscous, self.thermal, (0.0, math.inf), self.speed2, self.bad, np.zeros(2), dt,
        )  # fmt: skip
        assert self.bad[0] == -1
        return self

    def warm(self, T):
        """Heat from elsewhere, then a step at rest."""
        self.p.T[0] = T
        self.p.L[:] = 0.0
        return self.step(0.1)

    def stretch(self, J, steps, isotropic=False):
        """Uniaxial strain to J times the volume."""
        rate = math.log(J) / steps
        d = self.analysis.dimensions
        for _ in range(steps):
            self.step(
                1.0,
                *([rate / d if row % (d + 1) == 0 else 0.0 for row in range(d * d)] if isotropic else [rate]),
            )
        return self

    @property
    def T(self):
        return self.p.T[0]

    @property
    def stress(self):
        """Cauchy stress."""
        return self.p.tau[:, 0] / self.p.determinant()[0]

    def energy(self):
        out = np.zeros(1)
        stored_energy[False](self.analysis, self.m, 0, self.p.F, self.p.H, self.p.material, self.thermal, out)
        return out[0]

    def history(self, name):
        return self.p.H[self.model.history.index(name), 0]
