"""How many members the parts of a scene may have, so that every scene is checked within a second."""

from __future__ import annotations

from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.tree import Node

LARGEST: dict[tuple[str, ...], int] = {
    ("constants",): 1000,
    ("materials",): 1000,
    ("bodies",): 1000,
    ("contact", "pairs"): 1000,
    ("boundary",): 1000,
    ("loads",): 1000,
    ("probes",): 1000,
    ("archive", "particles", "fields"): 1000,
    ("archive", "globals", "columns"): 1000,
    ("archive", "grid", "fields"): 1000,
}
"""Most members of each list or mapping of the scene."""


def refuse_large_parts(root: Node) -> None:
    """Raise SceneError if a list or mapping of the scene has too many members; nothing else is checked then."""
    problems: list[Problem] = []
    for keys, most in LARGEST.items():
        node: Node | None = root
        for key in keys:
            node = node.value.get(key) if node is not None and node.is_mapping else None
        if node is not None and (node.is_mapping or node.is_sequence) and len(node.value) > most:
            words = f"{len(node.value):,} members: at most {most:,} are possible"
            problems.append(node.mark.problem(".".join(keys), words, "too_many"))
    if problems:
        raise SceneError(problems)
