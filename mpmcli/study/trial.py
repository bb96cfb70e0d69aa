"""One trial of a stability study: a scene run at one Courant number, its energy watched."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.core.times import is_reached
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import LoadedScene, load_scene

if TYPE_CHECKING:
    from mpmcli.run.events import Events
    from mpmcli.study.disturbance import DisturbedTwin

FINISHED, FAILED, ENERGY, CRAWLED = "finished", "failed", "energy", "crawled"
"""How a trial ended: at its end, by an error of the simulation, with too much energy, by ever shorter steps."""
WORKS_ON_BODIES = ("boundary_work", "external_work")
HOPELESS = 1.0
"""A trial is stopped when it has this share of the energy put in too much: what grows so far does not come back."""
EARLY = 100
"""Not in so many first steps: what begins at rest has been given next to no energy, and is off by much of it."""
MOST_STEPS = 30
"""A trial is stopped after this many times the steps that its first one promised."""
MANY, SELDOM = 4000, 5
"""With this many particles the energy is checked every fifth step, else every step."""


def run_trial(job: dict[str, Any]) -> dict[str, Any]:
    """Run the scene of a job at its Courant number.

    Parameters
    ----------
    job
        ``scene`` (path), ``sets``, ``defines``, ``allow_outside_files``, ``courant``, ``until`` (or None),
        ``threads``, ``bound`` (share of the energy put in that may be too much), ``is_disturbed`` (run a disturbed
        twin beside it).

    Returns
    -------
    dict
        ``ended`` in a word and ``message``; ``bounded``; ``excess``, the largest share of the energy put in that was
        too much; ``loss``, the share that was missing at the end; ``steps``, ``time`` and ``seconds``; ``growth`` of
        the disturbance, None where it went beyond all measure or there was none.
    """
    from mpmcli.solver.simulation import Simulation

    begin = time.perf_counter()
    loaded = load_job(job)
    set_courant(loaded, job["courant"])
    simulation = Simulation(loaded, threads=job.get("threads"))
    until = job.get("until")
    end = float(loaded.scene.time.end if until is None else until)
    twin = None
    if job.get("is_disturbed"):
        from mpmcli.study.disturbance import DisturbedTwin

        twin = DisturbedTwin(loaded, simulation, job.get("threads"))
    ended, message, watch = _advance(simulation, end, float(job["bound"]), twin, _events(loaded, simulation))
    excess = watch.excess
    bounded = ended == FINISHED and excess <= job["bound"]
    if ended == FINISHED and not bounded:
        ended, message = ENERGY, watch.words()
    return {
        "ended": ended,
        "message": message,
        "bounded": bounded,
        "excess": excess if math.isfinite(excess) else None,
        "loss": watch.loss if ended in (FINISHED, ENERGY) and math.isfinite(watch.loss) else None,
        "steps": simulation.state.step,
        "time": simulation.state.time,
        "growth": twin.growth if twin is not None and math.isfinite(twin.growth) else None,
        "seconds": time.perf_counter() - begin,
    }


def load_job(job: dict[str, Any]) -> LoadedScene:
    """The scene of a job."""
    return load_scene(
        Path(job["scene"]),
        sets=tuple(job.get("sets", ())),
        defines=tuple(job.get("defines", ())),
        allow_outside_files=bool(job.get("allow_outside_files", False)),
    )


def set_courant(loaded: LoadedScene, courant: float | str) -> None:
    """Put a Courant number, or ``auto``, into a scene instead of its own step."""
    scene = loaded.scene
    span = scene.time.model_copy(update={"courant": courant, "step": None})
    loaded.scene = scene.model_copy(update={"time": span})


def _events(loaded: LoadedScene, simulation: Any) -> Events | None:
    """What holds, reverses or ends the run of the scene."""
    scene = loaded.scene
    if not scene.events and scene.time.stop_when is None:
        return None
    from mpmcli.output.of_scene import context_of
    from mpmcli.run.events import Events

    return Events(scene, context_of(scene, simulation.state), simulation)


@np.errstate(all="ignore")  # the watchdogs say it better
def _advance(
    simulation: Any,
    end: float,
    bound: float,
    twin: DisturbedTwin | None = None,
    events: Events | None = None,
) -> tuple[str, str, EnergyWatch]:
    watch = EnergyWatch(simulation.state)
    every = SELDOM if simulation.particles.count > MANY else 1
    most, max_steps = math.inf, simulation.max_steps or math.inf
    state = simulation.state
    try:
        while not is_reached(state.time, end) and state.step < max_steps:
            simulation.step()
            if twin is not None:
                twin.step()
            if events is not None:
                events.look()
                if events.ended:
                    break
            if state.step == 1:
                most = MOST_STEPS * (end / state.dt + 10.0)
            if state.step % every == 0:
                watch.look(state)
                if state.step > EARLY and not watch.running_excess <= max(HOPELESS, bound):
                    return ENERGY, watch.words(), watch
            if state.step > most:
                return CRAWLED, f"{state.step} ever shorter steps to time {state.time:.6g}", watch
        watch.look(state)
        if twin is not None:
            twin.look()
    except (SimulationError, ArithmeticError) as error:
        return FAILED, str(error), watch
    return FINISHED, "", watch


class EnergyWatch:
    """Kinetic and strain energy against what was put in: the energy of the start and the work on the bodies.

    With E = K + Ψ and the work W of boundary conditions, walls, rigid bodies, loads and gravity, the excess at a time
    is E − (E₀ + W); all shares are those of the largest E₀ + W of the run.

    Attributes
    ----------
    running_excess : the last excess over the largest energy put in so far [-]
    """

    def __init__(self, state: Any):
        self.start = self.energy = _energy(state)
        self.put_in = self.largest_put_in = self.start
        self.largest_excess = 0.0
        self.running_excess = 0.0

    def look(self, state: Any) -> None:
        """Take the energies of this state into account."""
        ring = state.full_ring
        work = sum(state.work.get(name, 0.0) for name in WORKS_ON_BODIES) * ring
        self.energy, self.put_in = _energy(state), self.start + work
        self.largest_put_in = max(self.largest_put_in, self.put_in)
        excess = self.energy - self.put_in
        if math.isnan(excess):
            excess = math.inf
        self.largest_excess = max(self.largest_excess, excess)
        self.running_excess = _share(excess, self.largest_put_in)

    @property
    def excess(self) -> float:
        """Largest share that was too much."""
        return _share(self.largest_excess, self.largest_put_in)

    @property
    def loss(self) -> float:
        """Share that was missing at the last check."""
        return _share(self.put_in - self.energy, self.largest_put_in)

    def words(self) -> str:
        """The excess in words."""
        return f"kinetic and strain energy reached {1.0 + self.excess:.4g} of what was put in"


def _energy(state: Any) -> float:
    snapshot = Snapshot(state)
    strain = float((snapshot.particles.vol0 * state.strain_energy_density()).sum()) * state.full_ring
    return snapshot.total_kinetic_energy + strain


def _share(energy: float, scale: float) -> float:
    if scale > 0.0:
        return energy / scale
    return 0.0 if energy == 0.0 else math.copysign(math.inf, energy)
