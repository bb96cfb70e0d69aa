"""Cohesive laws: how modes mix, what closed faces do, and what scenes may say about them."""

import math

import numpy as np
import pytest
import yaml
from pydantic import ValidationError

from mpmcli.contact.laws import LAWS
from mpmcli.interfaces.base import BREAKS, HISTORY, damage, jump_impulse, remember
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

NORMAL = {"shape": "triangular", "strength": 5, "toughness": 0.5}
SHEAR = {"shape": "triangular", "strength": 8, "toughness": 1.0}
N_HAT, AXES = np.array([0.0, 1.0]), (0.0, 0.0)


@pytest.fixture(autouse=True)
def in_python(plain_python):
    with plain_python():
        yield


def law_of(**keys):
    return LAWS["cohesive"].model_validate({"kind": "cohesive", "normal": NORMAL, "tangential": SHEAR} | keys)


def spent_at_failure(law, angle, steps=4000):
    """Energy per area that a straight path of jumps spends until it breaks, and the jump there."""
    history, total = np.zeros(HISTORY), 0.0
    for size in np.linspace(0, 0.4, steps)[1:]:
        jump = size * np.array([math.sin(angle), math.cos(angle)])
        total += remember(law, AXES, N_HAT, jump, history)
        if history[BREAKS] > 0.5:
            return total, jump, history
    raise AssertionError("it does not break")


@pytest.mark.parametrize("angle", [0.0, 0.4, 0.8, 1.2, math.pi / 2])
def test_coupled_modes_fail_on_the_ellipse_of_openings(angle):
    """Along straight paths G_I/G_Ic + G_II/G_IIc = 1, with the shares of the relative openings."""
    total, jump, history = spent_at_failure(law_of(mixing={"kind": "coupled"}).parameters(), angle)
    x = np.array([jump[1] / 0.2, abs(jump[0]) / 0.25])
    assert math.hypot(*x) == pytest.approx(1, rel=1e-3)
    share = x**2 / (x @ x)
    assert total == pytest.approx(share[0] * 0.5 + share[1] * 1.0, rel=1e-9)
    assert damage(law_of(mixing={"kind": "coupled"}).parameters(), history) == 1


@pytest.mark.parametrize("angle", [0.4, 0.8, 1.2])
@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_power_mixing_fails_on_its_curve(angle, exponent):
    law = law_of(mixing={"kind": "power", "exponent": exponent}).parameters()
    jump, history = spent_at_failure(law, angle)[1:]
    ends = (0.2, 0.25)
    shares = [
        (max(x, 0.2259 * end) - 0.2259 * end) / (end - 0.2259 * end)
        for x, end in zip((jump[1], abs(jump[0])), ends, strict=True)
    ]
    assert sum(share**exponent for share in shares) == pytest.approx(1, abs=5e-3)
    assert history[0] < 0.2
    assert history[1] < 0.25


@pytest.mark.parametrize("angle", [0.0, 0.8, math.pi / 2])
def test_without_mixing_the_first_mode_breaks_it(angle):
    total, jump, _ = spent_at_failure(law_of().parameters(), angle)
    assert max(jump[1] / 0.2, abs(jump[0]) / 0.25) == pytest.approx(1, rel=2e-3)
    if angle in (0.0, math.pi / 2):
        assert total == pytest.approx(0.5 if angle == 0.0 else 1.0, rel=1e-9)


@pytest.mark.parametrize("mixing", [{"kind": "none"}, {"kind": "coupled"}])
def test_closed_faces_press_and_do_not_rub(mixing):
    """Pressed, the normal momentum is that of contact and the shear traction still that of the joint."""
    law = law_of(mixing=mixing, closed={"kind": "coulomb", "friction": 0.5}).parameters()
    dp, jump, out = np.array([1e-4, -2e-3]), np.array([0.001, -1e-5]), np.zeros(2)
    jump_impulse(law, AXES, dp, N_HAT, jump, np.zeros(2), 1.0, 1e-3, 1e-4, np.zeros(HISTORY), False, out)
    assert out[1] == pytest.approx(-2e-3, rel=1e-14)
    slope = 8 / (0.2259 * 0.25)
    stiff = 1.0 * 1e-4**2 / 1e-3 * slope
    assert out[0] == pytest.approx(1e-4 * slope * (0.001 + 1e-4 * 1e-4 / 1e-3) / (1 + stiff), rel=1e-12)
    soft = law_of(mixing=mixing, closed={"kind": "frictionless", "stiffness": 100}).parameters()
    jump_impulse(soft, AXES, dp, N_HAT, jump, np.zeros(2), 1.0, 1e-3, 1e-4, np.zeros(HISTORY), False, out)
    assert -2e-3 < out[1] < 0


def test_openings_of_the_past_soften():
    """Unloaded to a quarter of its largest opening it pulls on the line through the origin, whatever the step does."""
    law, out = law_of().parameters(), np.zeros(2)
    most = np.array([0.1, 0.0, 0.0])
    jump_impulse(law, AXES, np.zeros(2), N_HAT, 0.025 * N_HAT, np.zeros(2), 1.0, 1e9, 1e-6, most, False, out)
    top = 5 * (0.2 - 0.1) / (0.2 - 0.2259 * 0.2)
    assert out[1] / 1e-6 == pytest.approx(0.25 * top, rel=1e-9)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"closed": {"kind": "perfect"}}, "sides that press"),
        ({"closed": {"kind": "none"}}, "sides that press"),
        ({"closed": {"kind": "linear_interface", "normal": 1, "tangential": 1}}, "sides that press"),
        (
            {
                "closed": {
                    "kind": "adhesion_friction",
                    "normal_strength": 1,
                    "shear_strength": 1,
                    "friction": 0,
                }
            },
            "sides that press",
        ),
        (
            {"mixing": {"kind": "coupled"}, "normal": NORMAL | {"peak": 0.1}},
            r"different: peak \(0.1, 0.2259\)",
        ),
        (
            {"mixing": {"kind": "coupled"}, "normal": {"shape": "cubic", "strength": 1, "opening": 1}},
            r"different: shape \(cubic, triangular\)",
        ),
        ({"mixing": {"kind": "coupled"}, "normal": {"shape": "linear", "stiffness": 1}}, "modes that fail"),
        ({"mixing": {"kind": "power", "exponent": 0}}, "greater than 0"),
        ({"normal": NORMAL | {"opening": 1}}, "not all three"),
    ],
)
def test_refused(keys, words):
    with pytest.raises(ValidationError, match=words):
        law_of(**keys)


def test_words_about_it():
    law = law_of(closed={"kind": "frictionless", "stiffness": 1e4})
    assert law.slopes == pytest.approx((1e4, 8 / (0.2259 * 0.25)))
    assert law.last_opening == 0.25
    assert law.closed_law.kind == "frictionless"
    assert law.normal.resistance == pytest.approx((5, 0.5, 0.2))
    assert law_of(tangential={"shape": "linear", "stiffness": 3}).last_opening == math.inf


@pytest.mark.parametrize("update", ["usl", "usavg+"])
@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 3}])
def test_broken_faces_are_in_contact_by_the_closed_law(update, transfer):
    """Of a contact with a stiffness, too: sides that were never bonded press on each other as the same contact does."""
    spring = {"kind": "frictionless", "stiffness": 20}
    joint = {"kind": "cohesive", "normal": NORMAL, "tangential": SHEAR, "closed": spring, "bonded": "x - 6"}
    places = {"a": [0, 2], "b": [2, 4], "c": [7, 9], "d": [9, 11]}
    motions = []
    for pairs in ([], [{"between": ["a", "b"], "law": spring}]):
        scene = {
            "version": 1,
            "analysis": {"kind": "uniaxial_strain"},
            "grid": {"lower": [-2], "upper": [13], "cell": 1},
            "method": {"shape": "linear", "update": update, "transfer": transfer},
            "materials": {"soft": {"kind": "linear_elastic", "E": 100, "nu": 0, "density": 1}},
            "bodies": [
                {
                    "name": name,
                    "material": "soft",
                    "region": {"kind": "box", "lower": ends[:1], "upper": ends[1:]},
                    "velocity": [-float(name in "bd")],
                }
                for name, ends in places.items()
            ],
            "contact": {"law": joint, "pairs": pairs, "interface": {"area": "volumes"}},
            "time": {"end": 1, "courant": 0.2},
        }
        simulation = Simulation(load_scene(yaml.safe_dump(scene)))
        for _ in range(10):
            simulation.step()
        p = simulation.particles
        motions.append(p.V[0, p.body < 2])
    assert np.abs(motions[0][:4]).max() > 0.01
    assert (motions[0] == motions[1]).all()
