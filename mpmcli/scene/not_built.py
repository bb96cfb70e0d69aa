"""Values that a scene may be thought to take, and that are left out: taken out, and said why in words."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from mpmcli.core.errors import Problem
from mpmcli.scene.tree import Node

# where ("*" stands for any member), which value (None: any), why not
ENTRIES: tuple[tuple[tuple[str, ...], Any, str], ...] = (
    (
        ("method", "precision"),
        "single",
        "single precision is left out: it would save less than a tenth of a step",
    ),
)


def take_out(root: Node) -> tuple[Node, list[Problem]]:
    """The scene without what is left out, and a problem for each of them."""
    problems: list[Problem] = []
    for pattern, value, words in ENTRIES:
        root = _take(root, pattern, value, words, (), problems)
    return root, problems


def _take(
    node: Node,
    pattern: tuple[str, ...],
    value: Any,
    words: str,
    path: tuple[str, ...],
    problems: list[Problem],
) -> Node:
    key, rest = pattern[0], pattern[1:]
    if key == "*":
        if node.is_mapping:
            members = {k: _take(m, rest, value, words, (*path, k), problems) for k, m in node.value.items()}
            return replace(node, value=members)
        if node.is_sequence:
            labels = [member_label(m, i) for i, m in enumerate(node.value)]
            pairs = zip(labels, node.value, strict=True)
            return replace(node, value=[_take(m, rest, value, words, (*path, k), problems) for k, m in pairs])
        return node
    member = node.value.get(key) if node.is_mapping else None
    if member is None:
        return node
    if rest:
        return replace(
            node, value=node.value | {key: _take(member, rest, value, words, (*path, key), problems)}
        )
    if value is not None and member.value != value:
        return node
    problems.append(node.keys[key].problem(".".join((*path, key)), words, "not_built"))
    return _without(node, key)


def _without(node: Node, key: str) -> Node:
    return replace(
        node,
        value={k: m for k, m in node.value.items() if k != key},
        keys={k: m for k, m in node.keys.items() if k != key},
    )


def member_label(node: Node, index: int) -> str:
    """How a member of a list is called in a path: by its name, or by its index."""
    if node.is_mapping and "name" in node.value and isinstance(node.value["name"].value, str):
        return node.value["name"].value
    return str(index)
