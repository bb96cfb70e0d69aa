"""Growth of tips in made-up states: where points go, joints, ends of bodies, waiting, memory."""

from types import SimpleNamespace

import numpy as np
import pytest
from particles_at import particles_at
from pydantic import ValidationError

from mpmcli.core.analysis import PlaneStrain
from mpmcli.core.errors import SimulationError
from mpmcli.core.state import CracksView, State, TipValues
from mpmcli.cracks.chain import END, START, Chain, divide
from mpmcli.cracks.fracture import Fracture
from mpmcli.cracks.growth import CrackGrowth
from mpmcli.cracks.meeting import first_meeting
from mpmcli.cracks.model import Crack
from mpmcli.cracks.points import AllPoints
from mpmcli.cracks.tips import Tips, opening_behind
from mpmcli.materials.linear_elastic import LinearElastic

pytestmark = pytest.mark.usefixtures("python_and_compiled")
CELL, DT = 0.1, 0.01
MODES = ("normal", "tangential")
GRIFFITH = {"kind": "energy_release_rate", "J_c": 1.0}


def block(size=(4.0, 2.0)):
    """Particles, four per cell, in [0, 4] × [0, 2]."""
    axes = [np.arange(0.25 * CELL, length, 0.5 * CELL) for length in size]
    X = np.stack([a.ravel() for a in np.meshgrid(*axes)])
    return particles_at(PlaneStrain(), X, 0.25 * CELL, 0.25 * CELL**2, 0.25 * CELL**2)


class World:
    """Cracks in a block whose tips have the J, K_I and K_II that a test gives them."""

    def __init__(self, *cracks, thickness=2.0, tractions=None, **fracture):
        self.values = TipValues(1.0, 1.0, 0.0)
        models = [Crack.model_validate(c) for c in cracks]
        chains = [
            Chain(m.name, i, m.path.corners().T, (m.ends.start == "tip", m.ends.end == "tip"))
            for i, m in enumerate(models)
        ]
        p = block()
        state = State(PlaneStrain(), p, ["block"], ["m"], [SimpleNamespace(properties=frozenset())], dt=DT)
        self.view = CracksView(
            chains=chains,
            force=np.zeros((len(chains), 2)),
            released=np.zeros(len(chains)),
            interface_energy=np.zeros(len(chains)),
        )
        self.state, self.particles, self.wave_speed = state, p, 61.0
        self.order = SimpleNamespace(drift=0.0)
        grid = SimpleNamespace(cell=np.array([CELL, CELL]), lower=np.zeros(2))
        tips = Tips(Fracture(**fracture), chains, models, state, grid, thickness)
        tips._find = lambda chain, end: self.values
        self.growth = CrackGrowth(
            models, tips, np.ones((len(chains), 1), dtype=bool), state, self.order, False,
            lambda: self.wave_speed, self.view, tractions,
        )  # fmt: skip

    def step(self, count=1):
        for _ in range(count):
            self.state.step += 1
            self.state.time += DT
            self.growth.grow(None)

    @property
    def events(self):
        return [event[3] for event in self.view.events]


def crack(points=((0.5, 1.0), (2.0, 1.0)), name="main", **keys):
    return {"name": name, "path": {"kind": "points", "points": points}} | keys


def grows(end="end", criterion=GRIFFITH, **keys):
    return {"growth": {end: {"criterion": criterion} | keys}}


@pytest.mark.parametrize("end", ["start", "end"])
def test_points_are_added_ahead(end):
    world = World(crack(**grows(end)))
    chain = world.view.chains[0]
    chain.velocity[:, 0], chain.velocity[1, 1] = 3.0, 4.0
    world.step()
    at, x = (START, 0.45) if end == "start" else (END, 2.05)
    assert chain.X[:, at] == pytest.approx([x, 1.0])
    assert chain.count == chain.faces.shape[2] == chain.velocity.shape[2] == len(chain.length0) + 1 == 3
    assert chain.faces[:, :, at] == pytest.approx(np.array([[x, 1.0]] * 2))
    assert np.array_equal(chain.velocity[:, :, at], chain.velocity[:, :, 1])
    assert sorted(chain.length0) == pytest.approx([0.05, 1.5])
    assert chain.length == pytest.approx(1.55)
    assert world.order.drift == np.inf
    assert world.view.released == pytest.approx([0.05 * 2.0])
    time, *rest = world.view.events[0]
    assert time == pytest.approx(DT)
    assert rest == ["main", end, "growth", pytest.approx(x), 1.0, 1.0, 1.0, 0.0, pytest.approx(1.55)]


def test_long_increments_are_divided():
    world = World(crack(**grows(increment=2.0)))
    world.step()
    assert world.view.chains[0].X[0] == pytest.approx([0.5, 2.0, 2.0 + 0.2 / 3, 2.0 + 0.4 / 3, 2.2])


def test_a_tip_below_its_criterion_stays():
    world = World(crack(**grows()))
    world.values = TipValues(0.99, 1.0, 0.0)
    world.step(5)
    assert world.view.chains[0].count == 2
    assert not world.view.events
    assert world.order.drift == 0.0


def test_static_integrals_wait_until_waves_have_crossed_the_ring():
    waiting, running = World(crack(**grows()), outer=12.0), World(crack(**grows()), terms=2)
    waiting.step(5)  # ring of 1.2 at a speed of 61: two steps
    running.step(5)
    assert waiting.view.chains[0].count == 2 + 3
    assert running.view.chains[0].count == 2 + 5


def test_tips_grow_no_faster_than_surface_waves():
    """With inertia, whose integrals hold between increments."""
    steel = LinearElastic.model_validate({"kind": "linear_elastic", "density": 2.0, "E": 1.0, "nu": 0.25})
    rayleigh = 0.9194 * np.sqrt(0.4 / 2.0)  # of the speed of shear waves for ν = 1/4 (Rayleigh 1885)
    for keys, speed in (({}, rayleigh), ({"speed": {"max": 0.7}}, 0.7)):
        world = World(crack(((0.5, 1.0), (1.0, 1.0)), **grows(**keys)), terms=2)
        world.state.material_models[0] = steel
        world.step(300)
        chain = world.view.chains[0]
        assert (chain.length - 0.5) / world.state.time == pytest.approx(speed, rel=0.05)
        assert world.growth.fastest(world.growth.growing[0])[0] == pytest.approx(speed, rel=1e-4)


def test_the_speed_that_static_integrals_allow():
    world = World(crack(((0.5, 1.0), (1.0, 1.0)), **grows()), outer=40.0, inner=2.0)
    world.step(300)
    speed, words = world.growth.fastest(world.growth.growing[0])
    assert speed == pytest.approx(0.05 * 61.0 / 4.0)
    assert "ring" in words
    assert (world.view.chains[0].length - 0.5) / world.state.time == pytest.approx(speed, rel=0.1)
    given = World(crack(**grows(criterion={"kind": "steady_speed", "speed": 1e3})), terms=2)
    assert given.growth.fastest(given.growth.growing[0])[0] == np.inf


def test_hoop_direction():
    law = {"kind": "maximum_hoop_stress", "K_Ic": 0.5}
    for end, x in (("end", [2.0, 1.0]), ("start", [0.5, 1.0])):
        world = World(crack(**grows(end, law)))
        world.values = TipValues(1.0, 1.0, 1.0)
        world.step()
        chain = world.view.chains[0]
        angle = np.radians(-53.130102 + (180.0 if end == "start" else 0.0))
        tip = chain.X[:, START if end == "start" else END]
        assert tip == pytest.approx(x + 0.05 * np.array([np.cos(angle), np.sin(angle)]))


def test_longest_crack_and_speed():
    world = World(crack(**grows(max_length=1.6)))
    world.step(40)
    assert world.view.chains[0].length == pytest.approx(1.6)
    slow = World(crack(**grows(speed={"max": 0.02 / DT})), terms=2)
    slow.step(101)  # 0.02 per step: an increment of 0.05 in 2.5 steps
    assert slow.view.chains[0].length == pytest.approx(1.5 + 0.05 * 41)


def test_steady_speed_needs_no_integral():
    law = {"kind": "steady_speed", "speed": 0.02 / DT, "from": 10.5 * DT}
    world = World(crack(**grows(criterion=law)))
    found = []
    world.growth._tips._find = lambda chain, end: found.append(world.state.step) or world.values
    world.step(61)
    assert world.view.chains[0].length == pytest.approx(1.5 + 0.05 * 20)
    assert found[0] == 14  # what the first increment releases


def test_checks_at_intervals():
    world = World(crack(**grows()), terms=2, every=4.0 * DT)
    world.step(12)
    assert [round(event[0] / DT) for event in world.view.events] == [1, 4, 8, 12]


def test_a_tip_becomes_the_mouth_of_a_crack_at_the_end_of_the_body():
    world = World(crack(((0.5, 1.0), (3.93, 1.0)), **grows()), terms=2)
    world.step(9)
    assert world.events == ["growth", "mouth"]
    chain = world.view.chains[0]
    assert chain.tips == (True, False)
    assert chain.joined == (False, False)
    assert chain.X[0, END] > 4.0
    assert AllPoints(world.view.chains, 1.0).get().mouths.tolist() == [[False, True]]


def test_a_tip_joins_another_crack():
    across = crack(((2.2, 0.4), (2.2, 1.6)), "other")
    world = World(crack(**grows()), across, terms=2)
    world.step(9)
    assert world.events == ["growth"] * 3 + ["joined"]
    chain = world.view.chains[0]
    assert (chain.tips, chain.joined) == ((True, False), (False, True))
    assert 2.2 < chain.X[0, END] < 2.2 + 2e-3 * CELL
    points = AllPoints(world.view.chains, 1.0).get()
    assert not points.mouths.any()  # the other crack ends it, so that it is not continued beyond
    memory = {name: np.copy(value) for name, value in chain.memory().items()}
    again = Chain("main", 0, np.array([[0.5, 2.0], [1.0, 1.0]]), (True, True))
    again.recall(memory)
    assert (again.tips, again.joined) == (chain.tips, chain.joined)


def test_arrays_of_points_keep_their_layout():
    """Compiled code is found once for types of arrays, of which the layout is a part."""
    chain = Chain("main", 0, divide(np.array([[0.0, 0.0], [1.0, 0.0]]), 0.3), (True, True))
    points = AllPoints([chain], 1.0)
    kept = {name: value.copy() for name, value in chain.memory().items()}
    beyond = np.array([[1.1], [0.1]])
    changes = (
        lambda: chain.extend(START, beyond),
        lambda: chain.extend(END, beyond),
        lambda: chain.put_points(np.array([0.0, 1.0, 1.5, 2.0])),
        lambda: chain.close_tip(END, joined=True),
        lambda: chain.recall(kept),
    )
    for change in (lambda: None, *changes):
        change()
        assert all(array.flags.c_contiguous for array in points.get())


@pytest.mark.parametrize("end", ["start", "end"])
def test_a_tip_joins_its_own_crack(end):
    hook = [(1.5, 1.0), (2.5, 1.0), (2.5, 1.3), (2.0, 1.3)]
    down = grows(end, direction={"kind": "given", "along": [0, -1]})
    world = World(crack(hook if end == "end" else hook[::-1], **down), terms=2)
    world.step(9)
    assert world.events == ["growth"] * 5 + ["joined"]
    chain = world.view.chains[0]
    at = START if end == "start" else END
    assert chain.X[:, at] == pytest.approx([2.0, 1.0], abs=1e-12)
    assert chain.joined[at]
    assert not chain.tips[at]


def test_a_tip_that_turns_straight_back_has_joined_its_own_crack():
    world = World(crack(**grows(direction={"kind": "given", "along": [-1, 0]})), terms=2)
    world.step(3)
    assert world.events == ["joined"]
    assert world.view.chains[0].length == 1.5
    assert world.view.released == [0.0]


def test_a_tip_that_winds_away_from_its_own_crack_meets_nothing():
    world = World(crack(**grows(direction={"kind": "hoop"}, increment=0.2)), terms=2)
    world.values = TipValues(1.0, 0.0, -1.0)  # 70.5 degrees in every step
    world.step(3)
    assert world.events == ["growth"] * 3
    world.step(4)
    assert world.events[3:] == ["joined"]  # once round


def test_a_tip_that_no_longer_grows_is_arrested():
    world = World(crack(**grows()), outer=6.0)
    world.step()
    world.values = TipValues(0.2, 0.5, 0.0)
    world.step(60)
    assert world.events == ["growth", "arrest"]
    assert world.view.events[1][6] == 0.2


def test_a_tip_that_runs_slowly_is_not_arrested_before_its_end():
    law = {"kind": "steady_speed", "speed": 0.01 / DT}
    world = World(crack(**grows(criterion=law, increment=4.0, max_length=3.1)))
    world.wave_speed = 1e3  # a wave crosses the ring within a tenth of a step
    world.step(150)
    assert world.events == ["growth"] * 3
    world.step(100)
    assert world.events == ["growth"] * 4 + ["arrest"]


def test_nothing_is_found_for_tips_that_wait_or_are_at_their_end():
    world = World(crack(**grows(max_length=1.6)), outer=4.0)
    found = []
    world.growth._tips._find = lambda chain, end: found.append(world.state.step) or world.values
    world.wave_speed = 4.0 * CELL / (10.5 * DT)
    world.step(400)
    assert found[:2] == [1, 12]
    last = 12 + round(20 * 10.5)
    assert world.events == ["growth", "growth", "arrest"]
    assert found[-1] == pytest.approx(last, abs=1)


def test_no_number_ends_the_run():
    world = World(crack(**grows()))
    world.values = TipValues(np.nan, np.nan, np.nan)
    with pytest.raises(SimulationError, match=r"tip 'main:end' at \(2, 1\) is nan at time 0.01"):
        world.step()


def test_memory():
    world, other = World(crack(**grows()), every=2 * DT), World(crack(**grows()), every=2 * DT)
    world.step(3)
    other.growth.recall(world.growth.memory())
    assert other.growth.memory()["growth"] == pytest.approx(world.growth.memory()["growth"], nan_ok=True)
    assert other.growth._next == world.growth._next > 0.0


def test_growth_at_a_mouth_is_refused():
    with pytest.raises(
        ValidationError, match=r"growth.end needs a tip, but the end of crack 'main' is a mouth"
    ):
        Crack.model_validate(crack(ends={"end": "mouth"}, **grows()))
    with pytest.raises(ValidationError, match="give start, end, or both"):
        Crack.model_validate(crack(growth={}))


def test_opening_behind_a_tip():
    X = np.array([[0.0, 1.0, 2.0, 3.0, 4.0], [0.0] * 5])
    chain = Chain("main", 0, X, (True, True))
    chain.faces[0, 1] += np.array([0.0, 0.1, 0.4, 0.3, 0.0])
    chain.faces[0, 0] += np.array([0.0, 0.01, 0.0, 0.02, 0.0])
    assert opening_behind(chain, START) == pytest.approx(((0.4 + 0.4) / 6, 0.04 / 6))
    assert opening_behind(chain, END) == pytest.approx(((1.2 + 0.4) / 6, 0.08 / 6))


@pytest.mark.parametrize(
    ("goal", "point"),
    [
        ([1.0, 0.0], [0.5, 0.0]),  # crosses
        ([0.45, 0.0], [0.5, 0.0]),  # ends beside it
        ([0.3, 0.0], None),  # too far
        ([-0.3, 0.0], None),  # moves away
        ([0.5, 1.5], None),  # past its end
        ([0.45, 1.02], [0.5, 1.0]),  # beside its end
    ],
)
def test_meetings(goal, point):
    other = np.array([[0.5, 0.5, 0.5], [-1.0, 0.2, 1.0]])
    meeting = first_meeting(np.zeros(2), np.array(goal), [other], 0.1)
    assert (meeting is None) == (point is None)
    if meeting is not None:
        assert meeting.point == pytest.approx(point)


def test_the_first_of_several_cracks_is_met():
    planes = [np.array([[x, x], [-1.0, 1.0]]) for x in (0.8, 0.4, 0.6)]
    meeting = first_meeting(np.zeros(2), np.array([1.0, 0.0]), planes, 0.1)
    assert meeting is not None
    assert meeting.point == pytest.approx([0.4, 0.0])


@pytest.mark.parametrize("end", ["start", "end"])
def test_gradual_release_holds_new_points_and_the_one_that_was_the_tip(end):
    world = World(crack(**grows(end, release="gradual", increment=2.0)), terms=2)
    world.particles.tau[:] = np.array([[1.0], [3.0], [0.0], [4.0]])  # J = 1, |T| = 5
    held = []
    world.growth._tractions = SimpleNamespace(hold=lambda *given: held.append(given))
    world.step()
    (chain, at, count, pull, opening), *more = held
    assert not more
    assert (chain.count, at, count) == (5, START if end == "start" else END, 4)
    assert pull == pytest.approx([-4.0, -3.0])  # on the matter above
    assert opening == pytest.approx(2.0 / 5.0)


def test_growth_leaves_tractions_behind():
    law = {"kind": "cohesive"} | {
        mode: {"shape": "triangular", "strength": 1, "toughness": 1} for mode in MODES
    }
    model = Crack.model_validate(crack(**grows(traction=law)))
    assert model.carries_tractions
    assert [key for key, _ in model.laws_of_points()] == ["growth.end.traction"]
    with pytest.raises(ValidationError, match="release 'gradual' has tractions of its own"):
        Crack.model_validate(crack(**grows(traction=law, release="gradual")))
    with pytest.raises(
        ValidationError, match="points of a crack take a law of kind 'cohesive', not 'coulomb'"
    ):
        Crack.model_validate(crack(**grows(traction={"kind": "coulomb", "friction": 0.1})))
    bound = []
    tractions = SimpleNamespace(add_law=lambda model: 3, bind=lambda *given: bound.append(given))
    world = World(crack(**grows(traction=law, increment=2.0)), tractions=tractions, terms=2)
    world.step()
    assert bound == [(world.view.chains[0], END, 3, 3)]


def test_matter_that_presses_is_not_held_across():
    world = World(crack(**grows(release="gradual")))
    world.particles.tau[:] = np.array([[1.0], [-2.0], [0.0], [0.5]])
    assert world.growth._tips.pull_ahead(world.view.chains[0], END) == pytest.approx([-0.5, 0.0])
