"""Criteria of growth against closed forms."""

import math

import pytest
from pydantic import ValidationError

from mpmcli.core.errors import SimulationError
from mpmcli.cracks.criteria import CRITERIA
from mpmcli.cracks.criteria.strain_energy_density import density, least_angle
from mpmcli.cracks.integrals.elastic import PlaneElasticity
from mpmcli.cracks.tip_state import TipState


def make(kind, **keys):
    return CRITERIA[kind].model_validate({"kind": kind, **keys})


def tip(**values):
    return TipState(**({"time": 0.0, "length": 1.0, "elasticity": PlaneElasticity(1.0, 1.8)} | values))


def test_energy_release_rate():
    assert make("energy_release_rate", J_c=0.2).demand(tip(J=0.1)) == pytest.approx(0.5)
    resistance = make("energy_release_rate", J_c="0.2 + 0.1*length + 0.5*speed + t")
    assert resistance.demand(tip(J=2.3, time=1.0, length=1.0, speed=2.0)) == pytest.approx(1.0)
    assert make("energy_release_rate", J_c=0).demand(tip(J=1e-9)) == math.inf
    assert make("energy_release_rate", J_c=0).demand(tip(J=0.0)) == 0.0


@pytest.mark.parametrize(
    ("K_I", "K_II", "intensity"),
    [
        (3.0, 0.0, 3.0),  # pure mode I: K_I
        (0.0, 2.0, 2.0 * 2.0 / math.sqrt(3.0)),  # pure mode II at −70.53°: 1.1547 K_II
        (0.0, -2.0, 2.0 * 2.0 / math.sqrt(3.0)),
        (-5.0, 2.0, 2.0 * 2.0 / math.sqrt(3.0)),  # closed faces have no mode I
        (1.0, 1.0, 0.8 * math.sqrt(0.8) + 1.5 * math.sqrt(0.8) * 0.8),  # −53.13°
    ],
)
def test_maximum_hoop_stress(K_I, K_II, intensity):
    assert make("maximum_hoop_stress", K_Ic=2).demand(tip(K_I=K_I, K_II=K_II)) == pytest.approx(intensity / 2)


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.3, 0.45])
def test_strain_energy_density(nu):
    kappa = 3.0 - 4.0 * nu
    state = tip(K_I=3.0, K_II=0.0, elasticity=PlaneElasticity(1.0, kappa))
    assert make("strain_energy_density", K_Ic=2).demand(state) == pytest.approx(1.5)
    # pure mode II (Sih 1974): cos θ = (1 − 2ν)/3
    angle = math.acos((1.0 - 2.0 * nu) / 3.0)
    assert least_angle(0.0, 1.0, kappa) == pytest.approx(-angle, abs=1e-9)
    assert least_angle(0.0, -1.0, kappa) == pytest.approx(angle, abs=1e-9)
    assert density(angle, 0.0, 1.0, kappa) == pytest.approx(4.0 * (2.0 - 2.0 * nu - nu**2) / 3.0)
    for K_I in (0.2, 1.0, 5.0):
        at = least_angle(K_I, 0.7, kappa)
        assert -math.pi / 2 <= at < 0.0
        around = [density(at + d, K_I, 0.7, kappa) for d in (-1e-3, 0.0, 1e-3)]
        assert around[1] < min(around[0], around[2])


def test_empirical():
    law = make("empirical", K_Ic=2, K_IIc=1, p=2, q=1)
    assert law.demand(tip(K_I=1.0, K_II=-0.75)) == pytest.approx(1.0)
    assert law.demand(tip(K_I=-9.0, K_II=0.5)) == pytest.approx(0.5)


def test_opening():
    law = make("opening", normal=0.2, tangential=0.5)
    assert law.demand(tip(opening=0.1, slip=-0.4)) == pytest.approx(0.8)
    assert make("opening", normal=0.2).demand(tip(opening=-0.4, slip=9.0)) < 0.0
    with pytest.raises(ValidationError, match="give normal, tangential"):
        make("opening")


def test_steady_speed_has_no_delay():
    law = make("steady_speed", speed=2.0, **{"from": 1.0}, J_c=0.3)
    assert not law.sets_in(tip(time=0.9, J=1.0))
    assert not law.sets_in(tip(time=1.0, J=0.2))
    assert law.sets_in(tip(time=1.2, J=0.4))
    assert law.demand(tip(time=9.0)) == 0.0
    state = tip(time=1.2, started=1.2, increment=0.5)
    length, time = 0.0, 1.2
    for step in range(1000):
        time = 1.2 + 0.07 * step
        while law.demand(state._replace(time=time)) >= 1.0:
            state, length = state._replace(last=law.moment(state._replace(time=time))), length + 0.5
        assert length <= 2.0 * (time - 1.2) + 1e-9 < length + 0.5 + 1e-9
    assert length > 100.0


def test_never():
    assert make("never").demand(tip(J=1e9, K_I=1e9, K_II=1e9)) == 0.0


def test_values_that_are_not_defined_end_the_run():
    state = TipState(
        time=0.5, length=2.0, J=1.0, K_I=1.0, K_II=0.1, opening=0.1, started=0.1, name="main:end"
    )
    for law in (
        make("energy_release_rate", J_c="log(1 - length)"),
        make("maximum_hoop_stress", K_Ic="sqrt(-length)"),
        make("opening", normal=1.0, tangential="log(t - length)"),
        make("steady_speed", speed="sqrt(t - length)"),
    ):
        with pytest.raises(
            SimulationError, match=r"'main:end' is not defined at time 0.5, length 2 and speed 0"
        ):
            law.demand(state)
