"""What all figures share: the runs they need, their numbers, panels to draw in, and the text of their page."""

from __future__ import annotations

import csv
import io
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from make_gallery import shrink
from make_studies import STUDIES, run_study

from mpmcli import Results, load, run
from mpmcli.cli.main import call
from mpmcli.core.errors import ArchiveError
from mpmcli.results.pictures.drawing import new_figure
from mpmcli.run.resume import differences
from mpmcli.scene.loader import LoadedScene
from mpmcli.study.report import save_picture, tidy

DOCS = Path(__file__).parents[1]
INPUTS = DOCS.parent / "inputs"
PAGES = DOCS / "gallery"
IMAGES = DOCS / "images"
PAPERS = {
    "nairn2020": ("Nairn et al. 2020", "Contact by logistic regression"),
    "nairn2023notes": ("Nairn 2023", "Notes on normals"),
    "nairn2026": ("Nairn 2026", "FMPM with boundary conditions and contact"),
}
"""Short names of the papers, and what they are about, by their citation keys."""

SHOWN = 12
"""Most commands on a page; the driver lists the others."""

Table = list[list[Any]]


@dataclass(frozen=True)
class Case:
    """One run: a scene of ``inputs/`` and what ``mpmcli run`` is told about it."""

    scene: str
    sets: tuple[str, ...] = ()

    def load(self) -> LoadedScene:
        """The scene, checked."""
        return load(INPUTS / f"{self.scene}.yaml", sets=self.sets)

    def command(self) -> str:
        """What makes this run on the command line."""
        words = ["mpmcli", "run", f"inputs/{self.scene}.yaml"]
        for change in self.sets:
            constant = change.removeprefix("constants.")
            words += ["--set", change] if constant == change else ["-D", constant]
        return shlex.join(words)


@dataclass(frozen=True)
class Limits:
    """A study of the largest stable Courant numbers: ``mpmcli stability`` of a scene of ``inputs/``."""

    scene: str
    options: tuple[str, ...]

    def command(self) -> str:
        """What makes this study on the command line."""
        return shlex.join(["mpmcli", "stability", f"inputs/{self.scene}.yaml", *self.options])


class Runs:
    """Results of cases and studies, each run where it is not done already."""

    def __init__(self, folder: Path):
        self.folder = folder
        self._known: dict[Case, Results] = {}

    def __getitem__(self, case: Case) -> Results:
        """The results of a run, which may have failed: that is a result too."""
        if case not in self._known:
            self._known[case] = self._run(case)
        return self._known[case]

    def _run(self, case: Case) -> Results:
        loaded = case.load()
        directory = self.folder / f"{case.scene}_{loaded.hash[:16]}"
        if not directory.exists():
            older = sorted(self.folder.glob(f"{case.scene}_*"))
            directory = next((each for each in older if _is_of(each, loaded)), directory)
        if (ended := _ended(directory)) not in ("finished", "failed"):
            print(case.command(), flush=True)
            outcome = run(loaded, directory, threads=1, overwrite=True, progress=False, verbosity=-1)
            ended = outcome.ended.partition(":")[0]
            if ended not in ("finished", "failed"):
                raise SystemExit(f"{ended}: {case.command()}")
        return Results(directory)

    def has_finished(self, case: Case) -> bool:
        """Whether the run came to its end."""
        return _ended(self[case].directory) == "finished"

    def limits(self, study: Limits, label: str) -> dict[str, dict[str, str]]:
        """Rows of the table of limits by transfer; a study that was stopped goes on."""
        directory = self.folder / label
        scene = str(INPUTS / f"{study.scene}.yaml")
        if call(["stability", scene, *study.options, "--jobs", "1", "--no-plot", "-q", "-o", str(directory)]):
            raise SystemExit(f"failed: {study.command()}")
        with (directory / "limits.csv").open(encoding="utf-8", newline="") as file:
            return {row["transfer"]: row for row in csv.DictReader(file)}

    def trade(self, name: str) -> Path:
        """The folder of a study of ``docs/make_studies.py``; one that was stopped goes on."""
        directory = self.folder / name
        run_study(name, directory, STUDIES[name].repeats)
        return directory


def _ended(directory: Path) -> str:
    try:
        return str(Results(directory).manifest.get("run", {}).get("ended", "")).partition(":")[0]
    except ArchiveError:
        return ""


def _is_of(directory: Path, loaded: LoadedScene) -> bool:
    """Whether a kept run is of this scene before mpmcli had some of its keys, which are at their defaults now."""
    try:
        before = Results(directory).manifest.get("scene", {})
    except ArchiveError:
        return False
    now = loaded.resolved()
    said = loaded.resolved(with_defaults=False)
    defaults = [path for path, value, _ in differences(said, now) if value is None]
    return not loaded.file_digests and all(
        old is None and any(f"{path}.".startswith(f"{default}.") for default in defaults)
        for path, old, _ in differences(before, now)
    )


@dataclass(frozen=True)
class Figure:
    """A figure of a paper, made again.

    Attributes
    ----------
    paper, number, title : its citation key, its number there, and what it is about
    verdict : one sentence for the index
    words : Markdown below the numbers: what is shown, what differs and why
    cases, limits : what is run, by name
    studies : names of studies of ``docs/make_studies.py`` whose results and pictures it uses
    measure : from the results, the rows of the table, the first one with the names of the columns
    draw : draws the picture into the file it is given
    alt : what is to be seen, in one sentence
    drawn : pictures that are there already, by their files below ``docs/images``, with what is to be seen
    """

    paper: str
    number: str
    title: str
    verdict: str
    words: str
    cases: Mapping[str, Case] = field(default_factory=dict)
    limits: Mapping[str, Limits] = field(default_factory=dict)
    studies: tuple[str, ...] = ()
    measure: Callable[[Runs], Table] | None = None
    draw: Callable[[Runs, Path], None] | None = None
    alt: str = ""
    drawn: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of its module, page, table and picture."""
        whole, _, part = self.number.partition(".")
        return f"{self.paper}_fig{int(whole):02d}" + (f"_{part}" if part else "")

    @property
    def pictures(self) -> dict[str, str]:
        """Files of the pictures below ``docs/images``, with what is to be seen."""
        own = {} if self.draw is None else {f"papers/{self.name}.png": self.alt}
        return own | dict(self.drawn)

    @property
    def table(self) -> Path:
        """File of the numbers."""
        return PAGES / f"{self.name}.csv"

    def commands(self) -> list[str]:
        """What the figure runs, as commands."""
        mine = [case.command() for case in self.cases.values()]
        mine += [limits.command() for limits in self.limits.values()]
        return mine + [f"python docs/make_studies.py {name}" for name in self.studies]

    def page(self) -> str:
        """The text of its page."""
        lines = [
            f"# {PAPERS[self.paper][0]}, Fig. {self.number}: {self.title}",
            "",
            f"{{cite:t}}`{self.paper}`, Fig. {self.number}.",
            "",
        ]
        for file, seen in self.pictures.items():
            lines += [f"```{{image}} ../images/{file}", f":alt: {seen}", "```", ""]
        if self.measure is not None:
            lines += ["```{csv-table}", f":file: {self.name}.csv", ":header-rows: 1", "```", ""]
        lines += [self.words.strip(), ""]
        commands = self.commands()
        if commands:
            lines += [
                "## Commands",
                "",
                "```bash",
                f"python docs/make_paper_figures.py {self.name}",
                "```",
                "",
            ]
            is_all = len(commands) <= SHOWN
            which = (
                "these commands" if is_all else f"{len(commands)} commands like these (`--list` shows all)"
            )
            lines += [f"The script makes picture and table from the results of {which}:", ""]
            shown = commands if is_all else commands[:2]
            lines += ["```bash", *shown, "```", ""]
        return "\n".join(lines).rstrip() + "\n"


def write_table(path: Path, rows: Table) -> None:
    """Write numbers as CSV; floats with four digits."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([_cell(value) for value in row] for row in rows)
    path.write_text(text.getvalue(), encoding="utf-8")


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def panels(
    count: int = 1, width: float = 8.0, height: float = 3.6, ratios: Sequence[float] | None = None
) -> tuple[Any, list[Any]]:
    """A figure with panels side by side, marked A, B and so on if there are several."""
    figure = new_figure(width, height)
    first = figure.add_subplot()
    if count == 1:
        return figure, [first]
    first.remove()
    axes = list(figure.subplots(1, count, width_ratios=ratios))
    for letter, panel in zip("ABCDEF", axes, strict=False):
        panel.set_title(letter, loc="left", fontweight="bold")
    return figure, axes


def save(figure: Any, axes: Sequence[Any], path: Path) -> None:
    """Draw grids and legends, and write the picture, small."""
    for panel in axes[:-1]:
        tidy(panel)
    path.parent.mkdir(parents=True, exist_ok=True)
    save_picture(figure, axes[-1], path)
    shrink(path)


def transfer(kind: str, order: int = 0) -> str:
    """The setting of FLIP, or of FMPM or XPIC of some order."""
    return (
        f"method.transfer={{kind: {kind}}}"
        if not order
        else f"method.transfer={{kind: {kind}, order: {order}}}"
    )
