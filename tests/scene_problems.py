"""Scenes that are changed piece by piece, and what is wrong with them."""

from collections.abc import Iterable
from copy import deepcopy
from typing import Any

from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.loader import load_scene


def changed(text: str, *changes: tuple[str, str]) -> str:
    """A text in which each piece, which is there once, is replaced."""
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def with_keys(scene: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """A copy of a scene; keys with two underscores lead into it (``method__update="usf"``)."""
    scene = deepcopy(scene)
    for path, value in changes.items():
        *parents, last = path.split("__")
        at: Any = scene
        for key in parents:
            at = at[int(key)] if isinstance(at, list) else at.setdefault(key, {})
        at[int(last) if isinstance(at, list) else last] = value
    return scene


def problems_of(text: str, sets: Iterable[str] = ()) -> list[Problem]:
    """Errors of a scene, or warnings of one that is valid."""
    try:
        return load_scene(text, sets=tuple(sets)).warnings
    except SceneError as error:
        return error.problems
