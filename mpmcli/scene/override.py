"""Changes to a scene from the command line: ``--set key=value`` and ``-D name=value``."""

import re
from dataclasses import replace

from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.scene.tree import Mark, Node, compose_value


def apply_sets(root: Node, sets: tuple[str, ...]) -> Node:
    """The scene with each ``a.b.c=value`` in place; list members are named by their name or index."""
    for text in sets:
        key, _, value = text.partition("=")
        option = f"--set {key.strip()}"
        root = _put(root, key.strip().split("."), (), compose_value(value, option), option)
    return root


def apply_defines(root: Node, defines: tuple[str, ...]) -> Node:
    """The scene with each constant ``name=value`` in place."""
    for text in defines:
        name, _, value = text.partition("=")
        option = f"-D {name.strip()}"
        _check_use(root, name.strip(), option)
        root = _put(root, ["constants", name.strip()], (), compose_value(value, option), option)
    return root


def _put(node: Node, keys: list[str], before: tuple[str, ...], value: Node, option: str) -> Node:
    """A copy of ``node`` in which the value stands at ``keys``; nodes beside it are shared."""
    if not keys:
        return value
    key, rest = keys[0], keys[1:]
    mark = Mark(option)
    path = ".".join([*before, key])
    if not key:
        raise mark.error(path, "a dotted key is needed, as in method.transfer.order=4", "option")
    if node.is_sequence:
        member = node.member(key)
        if member is None:
            names = [n.value["name"].value for n in node.value if n.is_mapping and "name" in n.value]
            choice = f" ({listing(names)})" if names else f" (it has {len(node.value)} entries)"
            message = f"'{key}' is not a member of the list{did_you_mean(key, map(str, names))}{choice}"
            raise mark.error(path, message, "option")
        new = _put(member, rest, (*before, key), value, option)
        return replace(node, value=[new if other is member else other for other in node.value])
    if node.value is not None and not node.is_mapping:
        raise mark.error(path, f"'{'.'.join(before)}' is a single value and has no keys", "option")
    members = node.value or {}
    member = members.get(key) or Node(None, mark)
    new = _put(member, rest, (*before, key), value, option)
    return replace(node, value=members | {key: new}, keys={key: mark} | node.keys)


def _check_use(root: Node, name: str, option: str) -> None:
    """A constant that the scene neither declares nor uses is a slip of the pen."""
    constants = root.member("constants") if root.is_mapping else None
    declared = constants.value if constants is not None and constants.is_mapping else {}
    word = re.compile(rf"\b{re.escape(name)}\b")
    if name in declared or any(word.search(text) for text in root.texts()):
        return
    message = f"the scene has no constant '{name}'{did_you_mean(name, declared)}"
    raise Mark(option).error(f"constants.{name}", message, "option")
