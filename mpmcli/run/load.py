"""Reading a scene for a run."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.suggest import few_suggestions
from mpmcli.output.of_scene import check_output
from mpmcli.scene.loader import LoadedScene, load_scene
from mpmcli.stability.bodies import largest_wave_speed
from mpmcli.stability.heat import diffusivities
from mpmcli.stability.scene_limit import step_of_courant

MAX_STEPS = 10_000_000_000
"""Most time steps of a run: the smallest scene takes a week for them."""


def load(
    source: str | Path,
    *,
    sets: tuple[str, ...] | list[str] = (),
    defines: tuple[str, ...] | list[str] = (),
    allow_outside_files: bool = False,
) -> LoadedScene:
    """Read and check a scene, with the names of its columns and fields, and the number of its steps.

    Parameters
    ----------
    source
        Path of a file, ``-`` for standard input, or YAML text (text with a line break).
    sets
        Changes ``key=value`` as of ``--set``: dotted keys, list members by name or index, values in YAML.
    defines
        Values of constants ``name=value``, as of ``-D``.
    allow_outside_files
        Whether the scene may name files outside its folder.

    Raises
    ------
    SceneError
        With every problem, ordered by line.
    """
    with few_suggestions():
        loaded = load_scene(source, sets=sets, defines=defines, allow_outside_files=allow_outside_files)
        with loaded.located():
            check_output(loaded.scene)
            check_steps(loaded.scene)
    return loaded


@np.errstate(all="ignore")
def check_steps(scene: Any) -> None:
    """Refuse a run of more steps than can be taken, by its fixed step or by the first one of its Courant number.

    Raises SceneError.
    """
    span, cell = scene.time, np.float64(min(scene.grid.cell))
    path, step, because = ("time.end", math.inf, "") if span.step is None else ("time.step", span.step, "")
    if span.step is None and span.courant != "auto":
        step = step_of_courant(span.courant, cell, largest_wave_speed(scene), 0.0)
    largest = np.float64(max(diffusivities(scene).values(), default=0.0) if scene.heat is not None else 0.0)
    if span.step is None and largest > 0.0:
        interval = 1 if scene.heat.interval == "auto" else scene.heat.interval
        conducting = scene.heat.fourier * cell / largest * cell / interval
        step, because = (conducting, " (by heat.fourier)") if conducting < step else (step, because)
    count = min(span.end / max(step, span.end * 1e-300), span.max_steps or math.inf)
    if count > MAX_STEPS:
        words = (
            f"the run needs {count:.2g} steps of {step:.2g}{because}, but at most {MAX_STEPS:.0e} are allowed"
        )
        raise SceneError(
            [Problem(path, f"{words}; time.max_steps can end it earlier", code="too_many_steps")]
        )
