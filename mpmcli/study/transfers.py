"""Short forms of transfers, ``flip``, ``fmpm:4``, ``xpic:5``, and lists of them."""

import re
from collections.abc import Iterable
from typing import Any

import yaml

from mpmcli.core.suggest import did_you_mean
from mpmcli.core.variants import TRANSFER_METHODS

SHORT = re.compile(r"\s*([A-Za-z]\w*)\s*(?::\s*(\S+))?\s*")
OPENING, CLOSING = "[{(", "]})"


def split_list(text: str) -> list[str]:
    """Parts between the commas of ``text``; commas within brackets, braces or quotes do not part."""
    parts, depth, quote, start = [], 0, "", 0
    for place, mark in enumerate(text):
        if quote:
            quote = "" if mark == quote else quote
        elif mark in "\"'":
            quote = mark
        elif mark in OPENING:
            depth += 1
        elif mark in CLOSING:
            depth -= 1
        elif mark == "," and depth == 0:
            parts.append(text[start:place])
            start = place + 1
    parts.append(text[start:])
    return [part.strip() for part in parts if part.strip()]


def transfer_value(text: str) -> str:
    """The YAML value that a short form stands for; a mapping ``{kind: …}`` is handed through.

    Raises ValueError if there is no such transfer, or it takes no such order.
    """
    if text.lstrip().startswith("{"):
        return text.strip()
    match = SHORT.fullmatch(text)
    kinds = ", ".join("flip" if kind == "flip" else f"{kind}:ORDER" for kind in TRANSFER_METHODS)
    if match is None:
        raise ValueError(f"'{text}' is not a transfer; write one of {kinds}, or {{kind: fmpm, order: 4}}")
    kind, order = match.groups()
    if kind not in TRANSFER_METHODS:
        raise ValueError(
            f"'{kind}' is not a transfer{did_you_mean(kind, TRANSFER_METHODS)} (allowed: {kinds})"
        )
    if order is None:
        return f"{{kind: {kind}}}"
    if kind == "flip":
        raise ValueError(f"'{text}' is not a transfer, because flip has no order")
    if not order.isdecimal() or int(order) < 1:
        raise ValueError(f"'{text}' is not a transfer; the order must be a whole number of at least 1")
    return f"{{kind: {kind}, order: {int(order)}}}"


def label_of(transfer: Any) -> str:
    """The short form of a transfer as the scene's model has it, with what it says beyond kind and order."""
    changed = transfer.model_dump(exclude_defaults=True, exclude_none=True)
    contents = {key: value for key, value in transfer.model_dump().items() if key in changed}
    kind, order = contents.pop("kind", transfer.kind), getattr(transfer, "order", None)
    contents.pop("order", None)
    label = kind if order is None or kind == "flip" else f"{kind}:{order}"
    if not contents:
        return label
    extra = yaml.safe_dump(contents, default_flow_style=True, width=10_000, sort_keys=True).strip()
    return f"{label} {extra}"


def split_lists(texts: Iterable[str]) -> list[str]:
    """All parts of several lists, each once."""
    return list(dict.fromkeys(part for text in texts for part in split_list(text)))


def check_names(names: list[str], known: Iterable[str], what: str) -> list[str]:
    """The names, if all are known; ValueError for the first that is not."""
    known = list(known)
    for name in names:
        if name not in known:
            raise ValueError(
                f"'{name}' is not a {what}{did_you_mean(name, known)} (allowed: {', '.join(sorted(known))})"
            )
    return names
