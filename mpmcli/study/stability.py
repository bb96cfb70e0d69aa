"""Stability limits: the largest Courant number at which a scene stays bounded, accurate or quiet, found by bisection.

Courant numbers are whole multiples of the resolution. A search begins at the predicted limit, goes away from it in
doubling strides until it has one stable and one unstable number, and halves the interval between them. There may be
isolated unstable intervals below. A few numbers among the stable ones are therefore checked, too.
"""

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, Protocol

from mpmcli.core.bisection import bisect_limit
from mpmcli.core.errors import SceneError
from mpmcli.core.version import VERSION
from mpmcli.scene.loader import LoadedScene
from mpmcli.stability.models import NoKnownLimit
from mpmcli.stability.scene_limit import limit_in_motion, stable_courant
from mpmcli.study.interruption import run_side_by_side
from mpmcli.study.journal import Journal
from mpmcli.study.processes import TIMED_OUT
from mpmcli.study.transfers import label_of, transfer_value
from mpmcli.study.trial import FINISHED, load_job

Criterion = Literal["bounded", "accurate", "quiet"]
TRIALS = "trials.jsonl"
DEFAULT_TRANSFERS = ("flip", "fmpm:1", "fmpm:2", "fmpm:4", "fmpm:8", "fmpm:16", "fmpm:40", "fmpm:80")
DEFAULT_START = 0.5


class Runner(Protocol):
    """Whatever runs a job and waits for its result."""

    def run(self, job: dict[str, Any]) -> dict[str, Any]:
        """Run a job."""


@dataclass(frozen=True)
class Settings:
    """How a limit is searched for.

    Attributes
    ----------
    criterion : ``bounded``, ``accurate`` or ``quiet``
    energy : largest spurious energy of a bounded run, as a share of the energy put in
    loss : of ``accurate``: largest additional loss of energy, compared with half the Courant number
    growth : of ``quiet``: largest growth factor of a perturbation, or this factor times that at half the Courant number
    resolution : step of the Courant numbers
    lowest, highest : Courant numbers between which limits are searched for
    until : end of the runs, or None for the scene's
    threads : of each run
    tries_auto : also run the Courant number that ``courant: auto`` selects
    checks : how many Courant numbers among those found stable are checked once a limit is found
    """

    criterion: Criterion = "bounded"
    energy: float = 0.05
    loss: float = 0.01
    growth: float = 10.0
    resolution: float = 0.005
    lowest: float = 0.02
    highest: float = 2.0
    until: float | None = None
    threads: int = 1
    tries_auto: bool = False
    checks: int = 3


@dataclass(frozen=True)
class Source:
    """Where a scene comes from, and the options that change it, as ``load_scene`` takes them."""

    scene: str
    sets: tuple[str, ...] = ()
    defines: tuple[str, ...] = ()
    allow_outside_files: bool = False

    def job(self) -> dict[str, Any]:
        """As a job names it."""
        return asdict(self) | {"scene": str(Path(self.scene).resolve())}


@dataclass
class Case:
    """One transfer with one shape function, and what is found of it.

    Attributes
    ----------
    shape, transfer : the latter in its short form
    source, scene_hash : the scene of this case
    limit : largest stable Courant number, None if there is none or it was not found
    unstable_at : smallest Courant number above it that is unstable, None if there is none
    predicted : limit of bodies in motion (``stability``)
    auto : the Courant number that ``courant: auto`` selects, None where no limit is known
    loss, excess : energy lost and largest spurious energy at the limit, as shares of the energy put in
    auto_is_stable : whether a run with this number was stable by the criterion; None if there was no such run
    trials : results of all runs, by Courant number
    remark : how the run at ``unstable_at`` ended, or why there is no limit
    is_decided : the search came to its end
    """

    shape: str
    transfer: str
    source: Source
    scene_hash: str
    end: float
    limit: float | None = None
    unstable_at: float | None = None
    predicted: float | None = None
    auto: float | None = None
    loss: float | None = None
    excess: float | None = None
    auto_is_stable: bool | None = None
    trials: dict[float, dict[str, Any]] = field(default_factory=dict)
    remark: str = ""
    is_decided: bool = False

    @property
    def name(self) -> str:
        """Shape and transfer."""
        return f"{self.shape} {self.transfer}"

    @property
    def below(self) -> float | None:
        """How far ``auto`` is below the limit, as a share of the limit; None where the limit lies above all tried."""
        if self.auto is None or not self.limit or self.unstable_at is None:
            return None
        return 1.0 - self.auto / self.limit


class Undecided(Exception):
    """A trial gave no answer; the search cannot go on."""


def make_cases(
    source: Source, transfers: Sequence[str], shapes: Sequence[str], until: float | None = None
) -> list[Case]:
    """All transfers with all shape functions; the scene's own where none are named.

    Raises ValueError if a transfer is none, and SceneError if the scene is not valid with one of them.
    """
    values = [f"method.transfer={transfer_value(text)}" for text in transfers] or [""]
    functions = [f"method.shape={name}" for name in shapes] or [""]
    cases: dict[str, Case] = {}
    for function in functions:
        for value in values:
            sets = tuple(text for text in (function, value) if text)
            changed = replace(source, sets=(*source.sets, *sets))
            loaded = load_job(changed.job())
            method = loaded.scene.method
            end = float(loaded.scene.time.end if until is None else until)
            case = Case(method.shape, label_of(method.transfer), changed, loaded.hash, end)
            cases.setdefault(case.name, case)
    return list(cases.values())


def find_limits(
    cases: Sequence[Case],
    settings: Settings,
    runner: Runner,
    journal: Journal,
    jobs: int = 1,
    tell: Callable[[str], None] = lambda words: None,
) -> None:
    """Search the limits of all cases, ``jobs`` at a time, and store them in the cases.

    Trials in the journal are not run again. An exception in one search is raised when all searches have ended, except
    those that come from the runner being stopped.
    """
    run_side_by_side([_Search(case, settings, runner, journal, tell).run for case in cases], jobs, runner)


class _Search:
    """The search of one limit."""

    _predicting = threading.Lock()

    def __init__(
        self, case: Case, settings: Settings, runner: Runner, journal: Journal, tell: Callable[[str], None]
    ):
        self.case, self.settings = case, settings
        self.runner, self.journal, self.tell = runner, journal, tell

    def run(self) -> None:
        """Find the limit."""
        case, settings = self.case, self.settings
        self._predict(load_job(case.source.job()))
        step = settings.resolution
        start = round((case.predicted or DEFAULT_START) / step)
        lowest, highest = max(1, round(settings.lowest / step)), round(settings.highest / step)
        try:
            low, high = bisect_limit(
                lambda place: self._is_stable(self._courant(place)), start, lowest, highest, settings.checks
            )
        except Undecided as reason:
            case.remark = f"not decided: {reason}"
            self.tell(f"{case.name}: {case.remark}")
            return
        case.is_decided = True
        self._conclude(low, high)
        if settings.tries_auto and case.auto is not None:
            with suppress(Undecided):
                case.auto_is_stable = self._is_stable(case.auto)

    def _predict(self, loaded: LoadedScene) -> None:
        with self._predicting:  # numpy has its own threads
            try:
                self.case.predicted = limit_in_motion(loaded.scene)
                self.case.auto = stable_courant(loaded.scene).courant
            except NoKnownLimit:
                return

    def _courant(self, place: int) -> float:
        return float(f"{place * self.settings.resolution:.9g}")

    def _is_stable(self, courant: float) -> bool:
        trial = self._trial(courant)
        if not trial["bounded"]:
            return False
        if self.settings.criterion == "bounded":
            return True
        if self.settings.criterion == "quiet":
            return self._is_quiet(courant, trial)
        half = self._trial(_half(courant))
        return bool(half["bounded"]) and trial["loss"] <= half["loss"] + self.settings.loss

    def _is_quiet(self, courant: float, trial: dict[str, Any]) -> bool:
        growth, most = trial["growth"], self.settings.growth
        if growth is None or growth <= most:
            return growth is not None
        half = self._trial(_half(courant))
        return bool(half["bounded"]) and half["growth"] is not None and growth <= most * half["growth"]

    def _trial(self, courant: float) -> dict[str, Any]:
        case, settings, name = self.case, self.settings, f"{courant:.9g}"
        is_disturbed = settings.criterion == "quiet"
        key = f"{VERSION} {case.scene_hash} {name} {case.end:.17g} {settings.energy:.9g}"
        key += " disturbed" * is_disturbed
        trial = self.journal.get(key)
        if trial is None:
            job = case.source.job() | {
                "task": "trial",
                "courant": courant,
                "until": settings.until,
                "threads": settings.threads,
                "bound": settings.energy,
                "is_disturbed": is_disturbed,
            }
            trial = self.runner.run(job)
            if trial["ended"] == TIMED_OUT:
                raise Undecided(f"at C = {name} {trial['message']}")
            if trial["ended"] in ("invalid scene", "files"):
                raise SceneError(trial["message"])
            trial = {"bounded": False, "loss": None, "excess": None, "growth": None} | trial
            about = {"shape": case.shape, "transfer": case.transfer, "courant": courant}
            self.journal.add(key, about | trial)
            self.tell(f"{case.name}: C = {name} {_words(trial)}")
        case.trials[courant] = trial
        return trial

    def _conclude(self, low: int | None, high: int | None) -> None:
        case = self.case
        if high is not None:
            case.unstable_at = self._courant(high)
            case.remark = self._why(case.unstable_at)
        if low is None:
            case.remark = f"unstable from the least Courant number on: {case.remark}"
            return
        case.limit = self._courant(low)
        case.loss, case.excess = (case.trials[case.limit][name] for name in ("loss", "excess"))
        if high is None:
            case.remark = "stable up to the largest Courant number that was tried"

    def _why(self, courant: float) -> str:
        trial = self.case.trials[courant]
        if trial["bounded"]:
            half = self.case.trials.get(_half(courant), {"bounded": True})
            if not half["bounded"]:
                return "unstable at half of it"
            if self.settings.criterion == "quiet":
                growth = trial["growth"]
                return "a perturbation grows " + (
                    "without bound" if growth is None else f"{growth:.3g} times"
                )
            return f"loses {trial['loss']:.3g}, at half of it {half['loss']:.3g}"
        return str(trial["message"])


def _half(courant: float) -> float:
    return float(f"{0.5 * courant:.9g}")


def _words(trial: dict[str, Any]) -> str:
    seconds = f", {trial['seconds']:.3g} s" if "seconds" in trial else ""
    if trial["bounded"]:
        growth = trial.get("growth")
        grown = "" if growth is None else f", perturbation times {growth:.3g}"
        return f"bounded, loss {trial['loss']:.3g}{grown}{seconds}"
    how = trial["ended"] if trial["ended"] != FINISHED else "energy"
    return f"unstable ({how}{seconds})"
