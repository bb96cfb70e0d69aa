"""Reading a scene for a run."""

from __future__ import annotations

from pathlib import Path

from mpmcli.core.suggest import few_suggestions
from mpmcli.output.of_scene import check_output
from mpmcli.scene.loader import LoadedScene, load_scene
from mpmcli.stability.heat import check_steps


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
