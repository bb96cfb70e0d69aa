"""Laws that have shorter code for the plane: the same stress and history as by the code for space; in plain Python."""

import numpy as np
import pytest
from scipy.linalg import expm

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import (
    bulk_speed_squared,
    history_at_start,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.planar import is_planar

E = {"E": 100.0, "nu": 0.3}
TERMS = [{"time": 0.1, "G": 10.0, "K": 2.0}, {"time": 0.4, "G": 5.0}]
CLAY = {"M": 1.0, "lambda": 0.1, "kappa": 0.02, "nu": 0.3, "e0": 1.0, "p0": 1.0}
LAWS = {
    "j2_plastic": E | {"hardening": {"kind": "voce", "yield_stress": 0.1, "saturation": 1.0, "eps0": 0.1}},
    "mohr_coulomb": E | {"cohesion": 0.01, "friction": 30, "dilation": 5},
    "drucker_prager": E | {"cohesion": 0.01, "friction": 30, "dilation": 5, "match": "plane_strain"},
    "granular": E | {"mu_s": 0.4, "mu_2": 0.6, "grain_diameter": 0.1, "grain_density": 2.0},
    "modified_cam_clay": CLAY,
    "bingham": {"K": 100.0, "viscosity": 0.01, "yield_stress": 0.01},
    "clamped_neo_hookean": E | {"compression": 1e-3, "extension": 1e-3, "hardening": 1},
    "viscoelastic": {"G": 10.0, "K": 80.0, "terms": TERMS},
}
RATES = {
    "any": np.array([[-0.3, 0.2, 0], [-0.1, 0.1, 0], [0, 0, -0.1]]),
    "equal in the plane": np.diag([-0.1, -0.1, 0.15]),
    "z first": np.diag([-0.3, 0.1, 0.3]),
    "equal": np.diag([0.1, 0.1, 0.1]),
}


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("kind", LAWS)
def test_plane_and_space_agree(kind, rate):
    """Through ten steps, which flow."""
    model = MATERIALS[kind].model_validate({"kind": kind, "density": 2.0} | LAWS[kind])
    dt, F = 0.01, np.eye(3)
    dF = expm(RATES[rate] * dt)
    laws = [model.parameters(analysis, False) for analysis in ("3d", "plane_strain")]
    assert [is_planar(m) for m in laws] == [False, True]
    histories = [history_at_start(model, 1) for _ in laws]
    for _ in range(10):
        F = dF @ F
        found = []
        for m, H in zip(laws, histories, strict=True):
            f = tuple(F.ravel())
            tau = kirchhoff_stress(m, f, tuple(dF.ravel()), H, 0, dt, True)
            others = [each(m, f, H, 0) for each in (strain_energy, wave_speed_squared, bulk_speed_squared)]
            found.append(np.array([*tau, *others]))
        assert found[1] == pytest.approx(found[0], rel=1e-10, abs=1e-12)
        assert histories[1] == pytest.approx(histories[0], rel=1e-10, abs=1e-13)
    assert np.any(found[0][:6]) or "cohesionless" in model.properties
