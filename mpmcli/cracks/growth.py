"""Growth of cracks: tips that meet their criterion get new points (Nairn 2003, 6)."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.core.order import CellOrder
from mpmcli.core.state import CracksView, State, TipValues
from mpmcli.core.step import Step
from mpmcli.cracks.chain import END, START, Chain
from mpmcli.cracks.meeting import Meeting, first_meeting, self_meeting
from mpmcli.cracks.tip_state import TipState
from mpmcli.cracks.tips import Tips, opening_behind

Array = np.ndarray

LONGEST = 0.7
"""Cells: longer increments are divided."""
JOINS = 0.25
"""Cells from another crack at which a tip joins it."""
ROUNDS = 10.0
"""A tip that has not grown for as long as a wave takes to cross its ring so many times is arrested."""


class GrowingTip:
    """A tip that may grow.

    Attributes
    ----------
    chain, end, model : crack, ``START`` or ``END``, and what the scene says
    cuts : (bodies,) whether the crack cuts a body
    angle0 : direction at the start of the run [rad]
    last, started, speed : when it grew last, when it began to run at a given speed, its speed; nan before
    runs : whether it grew and is not arrested
    law : number of the law of tractions on new points, 0 without
    """

    def __init__(self, chain: Chain, end: int, model: Any, cuts: Array):
        self.chain, self.end, self.model, self.cuts = chain, end, model, cuts
        self.direction = model.way
        self.angle0 = angle_of(chain.direction(end))
        self.last = self.started = self.speed = math.nan
        self.runs = False
        self.law = 0

    @property
    def name(self) -> str:
        """``main:end``."""
        return f"{self.chain.name}:{self.word}"

    @property
    def word(self) -> str:
        """Which end it is."""
        return "start" if self.end == START else "end"


class CrackGrowth:
    """Lets the tips of all cracks grow.

    Parameters
    ----------
    models : of all cracks
    tips : their fracture quantities
    cuts : (cracks, bodies) whether a crack cuts a body
    state : time, time step and particles
    order : of the particles, which is found anew after growth
    is_ring : whether the analysis is axisymmetric
    wave_speed : returns the largest wave speed now
    view : what output sees
    tractions : on the points of cracks, which hold what is released gradually; None without
    """

    def __init__(
        self,
        models: Any,
        tips: Tips,
        cuts: Array,
        state: State,
        order: CellOrder,
        is_ring: bool,
        wave_speed: Callable[[], float],
        view: CracksView,
        tractions: Any = None,
    ):
        self._state, self._order, self._is_ring, self._wave_speed = state, order, is_ring, wave_speed
        self._tips, self._view, self._tractions = tips, view, tractions
        self._cell = tips.cell
        self._every, self._next = tips.model.every, 0.0
        chains = view.chains
        self.growing = [
            GrowingTip(chain, end, model, cuts[chain.index])
            for chain, crack in zip(chains, models, strict=True)
            if crack.growth is not None
            for end, model in ((START, crack.growth.start), (END, crack.growth.end))
            if model is not None
        ]

        for tip in self.growing:
            if tip.model.traction is not None and tractions is not None:
                tip.law = tractions.add_law(tip.model.traction)

    def speed(self, crack: int, end: int) -> float:
        """Return the speed of a tip; 0 before it has grown twice, and where it rests [velocity]."""
        for tip in self.growing:
            if (tip.chain.index, tip.end) == (crack, end) and tip.runs:
                return 0.0 if math.isnan(tip.speed) else tip.speed
        return 0.0

    def grow(self, step: Step) -> None:
        """Check the tips at the end of a step, and let those grow that meet their criterion."""
        time = self._state.time
        if time < self._next - 1e-6 * self._state.dt:
            return
        if self._every > 0.0:
            self._next = self._every * (math.floor(time / self._every * (1.0 + 1e-9)) + 1.0)
        for tip in self.growing:
            if tip.chain.tips[tip.end]:
                self._check(tip, time)

    def _check(self, tip: GrowingTip, time: float) -> None:
        criterion, longest = tip.model.criterion, tip.model.max_length
        at_end = longest is not None and tip.chain.length >= longest * (1.0 - 1e-9)
        if (at_end and not tip.runs) or (criterion.needs and time - tip.last < self.response()):
            return
        values = self._values(tip) if self._asks(tip) else TipValues(math.nan, math.nan, math.nan)
        state = self._tip_state(tip, time, values)
        if math.isnan(tip.started) and hasattr(criterion, "sets_in") and criterion.sets_in(state):
            tip.started = time
            state = state._replace(started=time)
        if at_end or not criterion.demand(state) >= 1.0:
            if at_end or not criterion.goes_on(state):
                self._rest(tip, time, values)
            return
        moment = criterion.moment(state)
        fastest = math.inf if math.isnan(tip.last) else self.speed_limit(tip)
        if fastest < math.inf:
            earliest, round_off = tip.last + state.increment / fastest, 1e-6 * self._state.dt
            if time < earliest - round_off:
                return
            if time - earliest <= self._state.dt + round_off:  # it waited: no delay adds up
                moment = earliest
        if math.isnan(values.J):
            values = self._values(tip)
            state = self._tip_state(tip, time, values)
        self._extend(tip, state, values, moment)

    def speed_limit(self, tip: GrowingTip) -> float:
        """Return the largest speed that the scene gives a tip, or what holds without one [velocity].

        Integrals with inertia hold at every speed: without a limit the tip would grow in every step in which they
        exceed the critical value. The Rayleigh speed is the limit of cracks that open (Freund 1990).
        """
        if tip.model.speed is not None:
            return float(tip.model.speed.max)
        if self._tips.model.terms == 1 or not tip.model.criterion.needs:
            return math.inf
        rayleigh = self._tips.rayleigh_speed(tip.chain.index, tip.end)
        return float(self._wave_speed()) if rayleigh is None else rayleigh

    def fastest(self, tip: GrowingTip) -> tuple[float, str]:
        """Return the largest speed that a tip can have by the limits of a run, and in words what sets it [velocity]."""
        increment = tip.model.increment * self._cell
        limits = [
            (self.speed_limit(tip), "speed.max" if tip.model.speed is not None else "waves along a surface")
        ]
        if tip.model.criterion.needs and self.response() > 0.0:
            limits.append((increment / self.response(), "one increment while waves cross the ring"))
        if self._every > 0.0:
            limits.append((increment / self._every, "one increment per fracture.every"))
        return min(limits)

    def response(self) -> float:
        """Time that a tip waits after an increment, before it is checked again.

        Static integrals know of an increment when waves have crossed the ring; until then they would let the tip run
        on. Those with inertia hold in between, too.
        """
        static = self._tips.model.terms == 1 and self._wave_speed() > 0.0
        return self._tips.outer / self._wave_speed() if static else 0.0

    def _asks(self, tip: GrowingTip) -> bool:
        """Whether numbers must be found to know if the tip grows."""
        criterion = tip.model.criterion
        waits = math.isnan(tip.started) and getattr(criterion, "J_c", None) is not None
        return bool(criterion.needs or tip.direction.needs or waits)

    def _values(self, tip: GrowingTip) -> TipValues:
        values = self._tips.values(tip.chain.index, tip.end)
        if not math.isfinite(values.J):
            x, y = tip.chain.X[:, tip.end]
            raise SimulationError(
                f"the energy release rate of tip '{tip.name}' at ({x:.6g}, {y:.6g}) is {values.J} at time "
                f"{self._state.time:.6g}. Its ring may have left the matter; use a smaller fracture.outer"
            )
        return values

    def _tip_state(self, tip: GrowingTip, time: float, values: TipValues) -> TipState:
        chain, increment = tip.chain, tip.model.increment * self._cell
        opening, slip = opening_behind(chain, tip.end)
        since = math.inf if math.isnan(tip.last) else max(time - tip.last, self._state.dt)
        return TipState(
            time=time, length=chain.length, speed=increment / since, J=values.J, K_I=values.K_I, K_II=values.K_II,
            elasticity=self._tips.elasticity(chain.index, tip.end), opening=opening, slip=slip,
            angle=angle_of(chain.direction(tip.end)), angle0=tip.angle0, last=tip.last, started=tip.started,
            increment=increment, name=tip.name,
        )  # fmt: skip

    def _rest(self, tip: GrowingTip, time: float, values: TipValues) -> None:
        """Note that a tip does not grow."""
        crossing = 2.0 * self._tips.outer / self._wave_speed()
        if tip.runs and time - tip.last > ROUNDS * crossing:
            tip.runs, tip.speed = False, 0.0
            self._log(tip, "arrest", values)

    def _extend(self, tip: GrowingTip, state: TipState, values: TipValues, moment: float) -> None:
        """Add points to the chain of a tip."""
        chain, end = tip.chain, tip.end
        angle = state.angle + tip.direction.angle(state)
        place = chain.X[:, end].copy()
        goal = place + state.increment * np.array([math.cos(angle), math.sin(angle)])
        others = [c.X for c in self._view.chains if c is not chain]
        reach = JOINS * self._cell
        meeting, own = first_meeting(place, goal, others, reach), self_meeting(chain, end, goal, reach)
        event = "growth"
        if own is not None and (meeting is None or own.way < meeting.way):
            goal, event = own.point, "joined"
        elif meeting is not None:
            goal, event = beyond(place, meeting, self._cell), "joined"
        elif not self._is_in_matter(tip, goal):
            event = "mouth"
        length = float(np.hypot(*(goal - place)))
        pull = self._tips.pull_ahead(chain, end) if tip.model.release == "gradual" else None
        if length > 0.0:
            parts = math.ceil(length / (LONGEST * self._cell) * (1.0 - 1e-12))
            chain.extend(end, place[:, None] + (goal - place)[:, None] * np.arange(1, parts + 1) / parts)
            self._order.drift = np.inf
            if tip.law and self._tractions is not None:
                self._tractions.bind(chain, end, parts, tip.law)
            if pull is not None and self._tractions is not None:
                size = float(np.hypot(*pull))
                if size > 0.0 and values.J > 0.0:  # with the point that was the tip, which opens from now on
                    self._tractions.hold(chain, end, parts + 1, pull, 2.0 * values.J / size)
        if event != "growth":
            chain.close_tip(end, joined=event == "joined")
        self._view.released[chain.index] += values.J * length * self._breadth(place, goal)
        tip.speed = 0.0 if math.isnan(tip.last) else length / max(moment - tip.last, 1e-300)
        tip.last, tip.runs = moment, event == "growth"
        self._log(tip, event, values)

    def _breadth(self, place: Array, goal: Array) -> float:
        """Area of new crack over its length: the thickness, or the mean radius."""
        if self._is_ring:
            return float(0.5 * (place[0] + goal[0]))
        return self._tips.thickness

    def _is_in_matter(self, tip: GrowingTip, x: Array) -> bool:
        """Whether a particle of the bodies that the crack cuts covers a place, with half as much again."""
        p = self._state.particles
        dx, dy = np.abs(p.X[0] - x[0]), np.abs(p.X[1] - x[1])
        near = np.flatnonzero((dx < 2.0 * self._cell) & (dy < 2.0 * self._cell))
        near = near[tip.cuts[p.body[near]]]
        F, size = p.F[:, near], 1.5 * p.size[:, near]
        wide = np.abs(F[0]) * size[0] + np.abs(F[1]) * size[1]
        high = np.abs(F[2]) * size[0] + np.abs(F[3]) * size[1]
        return bool(np.any((dx[near] <= wide) & (dy[near] <= high)))

    def _log(self, tip: GrowingTip, event: str, values: TipValues) -> None:
        x, y = tip.chain.X[:, tip.end]
        self._view.events.append(
            (self._state.time, tip.chain.name, tip.word, event, float(x), float(y), *values, tip.chain.length)
        )

    # ------------------------------------------------------------------ from one step to the next

    def memory(self) -> dict[str, Any]:
        """What it remembers from step to step."""
        rows = [[tip.last, tip.started, tip.speed, float(tip.runs)] for tip in self.growing]
        return {"growth": np.array(rows), "next_check": self._next}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._next = float(memory["next_check"])
        for tip, (last, started, speed, runs) in zip(self.growing, memory["growth"].tolist(), strict=True):
            tip.last, tip.started, tip.speed, tip.runs = last, started, speed, bool(runs)


def angle_of(way: Array) -> float:
    """Angle of a vector (2,) from the x axis [rad]."""
    return math.atan2(way[1], way[0])


def beyond(place: Array, meeting: Meeting, cell: float) -> Array:
    """Return the end of a crack that joins another one: a thousandth of a cell past it, so that no sight slips by."""
    way = meeting.point - place
    length = float(np.hypot(*way))
    return place if length == 0.0 else meeting.point + way * (1e-3 * cell / length)
