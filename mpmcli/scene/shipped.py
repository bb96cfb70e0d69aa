"""Scenes that come with mpmcli: commented templates, and the scenes of the documentation and the verification.

A scene is a file ``NAME.yaml``. The files that it reads (pictures, meshes) are beside it, with the same stem.
"""

import re
from functools import cache
from importlib.resources import files
from pathlib import Path

TEMPLATES = Path(str(files("mpmcli.scene"))) / "templates"
"""Commented scenes to start from: each file in this folder is one."""
STARTS = ("block_impact", "dam_break", "granular_column", "taylor_bar", "vibrating_bar")
"""Scenes of ``inputs/`` that are listed with the templates."""
SCHEMA = "scene.schema.json"
"""JSON Schema that the first line of a new scene names, in the folder of the scene."""

_SCHEMA_LINE = re.compile(r"\A# yaml-language-server: \$schema=.*$", re.MULTILINE)
_TITLE = re.compile(r"^title: (.*)$", re.MULTILINE)


def inputs() -> Path:
    """Return the folder ``inputs``: beside this module where mpmcli is installed, else that of the source tree."""
    installed = TEMPLATES.parent / "inputs"
    return installed if installed.is_dir() else TEMPLATES.parents[2] / "inputs"


@cache
def shipped() -> dict[str, Path]:
    """Return the file of each scene by its name: what to start from first, then the others, each in order of names."""
    templates = {path.stem: path for path in TEMPLATES.glob("*.yaml")}
    others = {path.stem: path for path in inputs().glob("*.yaml")}
    starts = templates | {name: others[name] for name in STARTS}
    return dict(sorted(starts.items())) | dict(sorted(others.items()))


def is_start(name: str) -> bool:
    """Whether a scene is one to start from."""
    return name in STARTS or shipped()[name].parent == TEMPLATES


def title(name: str) -> str:
    """Return the title of a scene."""
    found = _TITLE.search(shipped()[name].read_text(encoding="utf-8"))
    return found.group(1) if found else ""


def scene_text(name: str) -> str:
    """Return the text of a scene, its first line naming the schema in the scene's folder."""
    text = shipped()[name].read_text(encoding="utf-8")
    return _SCHEMA_LINE.sub(f"# yaml-language-server: $schema={SCHEMA}", text)


def companions(name: str) -> list[Path]:
    """Return the files that a scene reads."""
    path = shipped()[name]
    return sorted(other for other in path.parent.glob(f"{name}.*") if other != path)
