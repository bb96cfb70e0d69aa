"""From a request to files: which pictures, of what, where."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.core.suggest import did_you_mean
from mpmcli.output.files import GLOBALS, PLOTS
from mpmcli.results.crack_results import growth_of_tips
from mpmcli.results.pictures.animation import KINDS, MOST_FRAMES, check_writer, write_animation
from mpmcli.results.pictures.cracks import draw_growth, draw_opening, is_profile
from mpmcli.results.pictures.curves import (
    ENERGIES,
    SUBJECTS,
    Panel,
    abscissa,
    column_panels,
    draw_panels,
    probe_panels,
    subject_panels,
)
from mpmcli.results.pictures.drawing import (
    FORMATS,
    PictureError,
    drawing,
    matplotlib,
    pixels,
    save,
    write_bytes,
)
from mpmcli.results.pictures.extent import Extent
from mpmcli.results.pictures.paraview import default_path, paraview_script
from mpmcli.results.pictures.particles import LinePicture, Palette, ParticlePicture, PlanePicture
from mpmcli.results.pictures.quantities import DEFAULTS, DEFAULTS_ON_A_LINE, Coloring, find_coloring
from mpmcli.results.pictures.space import VIEWS, SectionPicture, SpacePicture, place_of_section
from mpmcli.results.reading import Frame, Results

GROWTH, PARTICLES, PROBES, ALL = "growth", "particles", "probes", "all"
WHAT = (*SUBJECTS, GROWTH, PROBES, PARTICLES, ALL)
"""What pictures can be of."""
FILES = (*FORMATS, *(f".{kind}" for kind in KINDS), ".py")
"""Endings by which the name of a file is told from that of a folder."""


@dataclass(frozen=True)
class Request:
    """What to draw.

    Attributes
    ----------
    what : words of ``WHAT``; without any the energies and the particles at the last time, as far as there are such
    columns : columns of tables, ``*`` for any text
    over : column that those of tables are drawn over instead of time
    color : quantity that particles are coloured by
    limits : its numbers at both ends of the colours
    time, frame : which archive of particles; the last without either
    animate : ``gif`` or ``mp4`` instead of a single time
    rate : pictures per second
    view : direction from which particles in space are seen
    section : axis (0, 1, 2) of the normal of a plane that cuts particles in space, and where it cuts it [length]; the
        particle nearest to the middle where that is None
    paraview : write a script for ParaView, and no pictures
    output : file or folder
    progress : called with words while an animation is drawn
    """

    what: tuple[str, ...] = ()
    columns: tuple[str, ...] = ()
    over: str | None = None
    color: str | None = None
    limits: tuple[float, float] | None = None
    time: float | None = None
    frame: str | int | None = None
    animate: str | None = None
    rate: float = 10.0
    view: str = "iso"
    section: tuple[int, float | None] | None = None
    paraview: bool = False
    output: Path | None = None
    progress: Callable[[str], None] = field(default=lambda words: None)

    @property
    def is_about_particles(self) -> bool:
        """Whether something is asked that only pictures of particles have."""
        chosen = (self.color, self.limits, self.time, self.frame, self.animate, self.section)
        return any(value is not None for value in chosen)


def plot(directory: Path | str, request: Request | None = None) -> tuple[list[Path], list[str]]:
    """Draw the pictures of a results folder.

    Raises PictureError if what is asked for is not there, or a library is missing, and ArchiveError if files cannot be
    read or written.

    Returns
    -------
    paths : the files written
    notes : what the person should know about them
    """
    request = request or Request()
    _check(request)
    results = Results(directory)
    if request.paraview:
        return [_write_script(results, request)], []
    matplotlib()
    if request.animate:
        check_writer(request.animate)
    jobs = list(_jobs(results, request))
    if not jobs:
        raise ArchiveError(f"{directory} has neither {GLOBALS} nor archives of particles")
    paths = _paths(results, request, [(name, ending) for name, ending, _ in jobs])
    notes: list[str] = []
    with drawing():
        for (_, _, draw), path in zip(jobs, paths, strict=True):
            notes += [words for words in draw(path) if words not in notes]
    return paths, notes


def _check(request: Request) -> None:
    for word in request.what:
        if word not in WHAT:
            raise PictureError(f"there is no picture '{word}'{did_you_mean(word, WHAT)} ({', '.join(WHAT)})")
    if request.animate not in (None, *KINDS):
        raise PictureError(f"'{request.animate}' is not a kind of animation (allowed: {', '.join(KINDS)})")
    if request.view not in VIEWS:
        raise PictureError(
            f"there is no view '{request.view}'{did_you_mean(request.view, VIEWS)} ({', '.join(VIEWS)})"
        )
    if request.time is not None and request.frame is not None:
        raise PictureError("give either a time or the number of an archive")
    if request.animate and (request.time is not None or request.frame is not None):
        raise PictureError("an animation shows all times; remove the time or archive")
    if request.section is not None and request.view != "iso":
        raise PictureError("a section is seen along its normal; remove the view")
    about_tables = (request.what, request.columns, request.over, request.animate, request.section)
    if request.paraview and any(about_tables):
        raise PictureError(
            "a ParaView script takes only a quantity, a colour range, a view, and the time or archive to begin with"
        )
    if request.limits is not None and not request.limits[0] < request.limits[1]:
        raise PictureError("the first number of a range must be below the second")


Draw = Callable[[Path], Sequence[str]]


def _jobs(results: Results, request: Request) -> Iterator[tuple[str, str, Draw]]:
    """Name, ending and maker of each picture."""
    what = _what(results, request)
    over = None if request.over is None else abscissa(results, request.over)

    def curves(panels: list[Panel]) -> Draw:
        return _saved(lambda: draw_panels(panels, results, over))

    for subject in SUBJECTS:
        if subject in what:
            yield subject, ".png", curves(subject_panels(results, subject))
    if GROWTH in what:
        yield GROWTH, ".png", _saved(lambda: draw_growth(results))
    if PROBES in what:
        for name in results.table_names():
            if name != GLOBALS:
                probe = Path(name).stem
                yield f"probe_{probe}", ".png", _probe(results, name, curves)
    if request.columns:
        yield "columns", ".png", curves(column_panels(results, request.columns))
    if PARTICLES in what:
        yield PARTICLES, f".{request.animate or 'png'}", _particles(results, request)


def _saved(make: Callable[[], Any]) -> Draw:
    def draw(path: Path) -> list[str]:
        save(make(), path)
        return []

    return draw


def _probe(results: Results, name: str, curves: Callable[[list[Panel]], Draw]) -> Draw:
    table = results.table(name)
    if is_profile(table):
        return _saved(lambda: draw_opening(table, results))
    return curves(probe_panels(results, name))


def _what(results: Results, request: Request) -> list[str]:
    """The subjects asked for; PictureError if one is not there."""
    what = [word for word in request.what if word != ALL]
    if ALL in request.what:
        what += _existing(results)
    if request.is_about_particles and PARTICLES not in what:
        what.append(PARTICLES)
    if not what and not request.columns and request.over is None:
        what = [word for word in (ENERGIES, PARTICLES) if word in _existing(results)]
    if request.over is not None and not request.columns and what in ([], [PARTICLES]):
        raise PictureError("--x needs columns; give --column")
    if PROBES in what and results.table_names() in ([], [GLOBALS]):
        raise PictureError(f"{results.directory} has no tables of probes; add probes to the scene")
    return what


def _existing(results: Results) -> list[str]:
    found = []
    for subject in SUBJECTS:
        try:
            subject_panels(results, subject)
        except PictureError:
            continue
        found.append(subject)
    found += [GROWTH] * bool(growth_of_tips(results.directory))
    found += [PROBES] * any(name != GLOBALS for name in results.table_names())
    return found + [PARTICLES] * results.has_particles


def _paths(results: Results, request: Request, pictures: list[tuple[str, str]]) -> list[Path]:
    output = request.output
    if output is None or output.suffix.lower() not in FILES or output.is_dir():
        folder = results.directory / PLOTS if output is None else output
        return [folder / f"{name}{ending}" for name, ending in pictures]
    if len(pictures) > 1:
        names = ", ".join(name for name, _ in pictures)
        raise PictureError(
            f"{output} is one file, but {len(pictures)} pictures are requested ({names}); give a folder"
        )
    is_animation = f".{request.animate}" == pictures[0][1]
    allowed = (pictures[0][1],) if is_animation else FORMATS
    if output.suffix.lower() not in allowed:
        raise PictureError(f"'{output.name}' must end with {' or '.join(allowed)}")
    return [output]


def _particles(results: Results, request: Request) -> Draw:
    files = [path for _, path in results.series] if request.animate else [_file(results, request)]
    files = _thinned(files)
    last = results.frame(files[-1])
    coloring = find_coloring(request.color, last, _usual(results, last))

    def draw(path: Path) -> list[str]:
        frames = (last if file == files[-1] else results.frame(file) for file in files)
        extent = Extent.of(frames, coloring, results)
        picture = _picture(results, last, coloring, extent, request)
        picture.lay_out(last)
        if request.animate:
            write_animation(path, _each(picture, results, files, request.progress), request.rate)
        else:
            picture.update(last)
            save(picture.figure, path)
        notes = picture.notes
        if request.animate and len(files) < len(results.series):
            notes.append(f"the animation shows {len(files)} of {len(results.series)} archives")
        return notes

    return draw


def _file(results: Results, request: Request) -> Path:
    """The archive asked for, or the last."""
    if request.time is not None:
        return results.path_at(request.time)
    return results.path_of(-1 if request.frame is None else request.frame)


def _usual(results: Results, frame: Frame) -> tuple[str, ...]:
    return DEFAULTS_ON_A_LINE if results.dimensions(frame) == 1 else DEFAULTS


def _thinned(files: list[Path]) -> list[Path]:
    if len(files) <= MOST_FRAMES:
        return files
    return [files[i] for i in np.linspace(0, len(files) - 1, MOST_FRAMES).round().astype(int)]


def _picture(
    results: Results, frame: Frame, coloring: Coloring, extent: Extent, request: Request
) -> ParticlePicture:
    palette = Palette(results, coloring, extent, request.limits)
    d = results.dimensions(frame)
    if d < 3 and request.section is not None:
        raise PictureError(f"a section needs a 3D analysis, and this one is {d}D")
    if d == 1:
        return LinePicture(results, palette, extent)
    if d == 2:
        return PlanePicture(results, palette, extent)
    if request.section is None:
        return SpacePicture(results, palette, extent, request.view)
    axis, asked = request.section
    position = place_of_section(frame, extent, axis, asked)
    return SectionPicture(results, palette, extent, axis, position)


def _each(
    picture: ParticlePicture, results: Results, files: list[Path], progress: Callable[[str], None]
) -> Iterator[Any]:
    """The pictures of an animation."""
    for number, file in enumerate(files, start=1):
        progress(f"archive {number} of {len(files)}")
        picture.update(results.frame(file))
        yield pixels(picture.figure)


def _write_script(results: Results, request: Request) -> Path:
    path = request.output or default_path(results)
    if path.is_dir() or path.suffix.lower() != ".py":
        path = path / default_path(results).name
    frame = results.frame(_file(results, request))
    coloring = find_coloring(request.color, frame, _usual(results, frame))
    write_bytes(path, paraview_script(results, frame, coloring, request.limits, request.view).encode())
    return path
