"""Problems of a scene in plain words, with the line and column of each: pydantic's errors translated."""

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

from mpmcli.core.errors import Problem
from mpmcli.core.model import Refused
from mpmcli.core.registry import OneOf
from mpmcli.core.suggest import MAX_WORD, did_you_mean, listing, meanings, searches_are_left, synonym
from mpmcli.scene.tree import Mark, Node, member_label

MAX_SHOWN = 100
"""Problems that are shown; further ones are counted."""
MAX_MESSAGE = 2000
MAX_PATH = 200
MAX_OWNERS = 4
"""Kinds that a message names because they have a key that another kind lacks."""

_NOUNS = {
    "materials": "material",
    "bodies": "region",
    "boundary": "boundary condition",
    "loads": "load",
    "path": "path",
    "criterion": "growth criterion",
    "direction": "growth direction",
    "probes": "probe",
    "analysis": "analysis",
    "transfer": "transfer",
    "normal": "normal method",
    "separation": "separation",
    "law": "contact law",
    "closed": "contact law",
    "mixing": "mixing rule",
}
_LIMITS = {
    "greater_than": ("gt", "above"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "below"),
    "less_than_equal": ("le", "at most"),
}
_NEEDED = {
    **dict.fromkeys(("float_type", "float_parsing"), "a number"),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), "a whole number"),
    "string_type": "text",
    "bool_type": "true or false",
    **dict.fromkeys(("tuple_type", "list_type"), "a list"),
    "dict_type": "a mapping of names to values",
    **dict.fromkeys(("model_type", "model_attributes_type"), "a mapping of keys to values"),
}


@dataclass(frozen=True)
class Place:
    """Where an error of pydantic stands: path, the nearest node that exists, and the place of its key."""

    path: tuple[str, ...]
    node: Node
    key: Mark


def follow(root: Node, loc: Sequence[str | int]) -> Place:
    """Follow a location of pydantic, passing over what is no key (tags of unions, names of functions)."""
    node, key, path = root, root.mark, []
    tag_passed = False
    for part in loc:
        member, mark = None, None
        if node.is_mapping and isinstance(part, str):
            kind = node.value.get("kind")
            if kind is not None and kind.value == part and not tag_passed:
                tag_passed = True
                continue
            member, mark = node.value.get(part), node.keys.get(part)
        elif node.is_sequence and isinstance(part, int) and part < len(node.value):
            member = node.value[part]
            part, mark = member_label(member, part), member.mark
        if member is not None and mark is not None:
            node, key, tag_passed = member, mark, False
            path.append(str(part))
    return Place(tuple(path), node, key)


def locate(root: Node, path: str, message: str, code: str = "invalid", severity: str = "error") -> Problem:
    """A problem at a dotted path (list members by name or index), placed at the part of it that exists."""
    node, keys = root, path.split(".") if path else []
    for index, key in enumerate(keys):
        member = node.member(key)
        if member is None and node.is_sequence:
            member = node.member(".".join(keys[index:]))
        if member is None:
            break
        node = member
    return node.mark.problem(path, message, code, severity)


def translate(error: ValidationError, root: Node, model: type[BaseModel]) -> list[Problem]:
    """Every error of pydantic as a problem with words and place."""
    found: dict[tuple[str, str], tuple[Problem, str]] = {}
    errors = error.errors(include_url=False)
    for index, details in enumerate(errors):
        for problem in _problems(dict(details), root, model):
            found.setdefault((problem.path, problem.message), (problem, str(details["type"])))
        if len(found) >= MAX_SHOWN:
            kept = _without_echoes(list(found.values()))
            left = len(errors) - index - 1
            return [*kept, *[root.mark.problem("", f"… and {left} more", MORE)] * (left > 0)]
    return _without_echoes(list(found.values()))


def _without_echoes(found: list[tuple[Problem, str]]) -> list[Problem]:
    """Of several errors at one path (the members of a union) leave out those that only say "wrong type"."""
    by_path: dict[str, list[tuple[Problem, str]]] = {}
    for problem, kind in found:
        by_path.setdefault(problem.path, []).append((problem, kind))
    kept = []
    for path, group in by_path.items():
        if any(inner.startswith(f"{path}.") for inner in by_path):
            # a mapping is one of several alternatives, and the others are words
            group = [(problem, kind) for problem, kind in group if kind != "literal_error"]
            if not group:
                continue
        telling = [problem for problem, kind in group if kind not in _NEEDED]
        kept += telling if telling else [group[0][0]]
    return kept


def _problems(details: dict[str, Any], root: Node, model: type[BaseModel]) -> list[Problem]:
    kind, loc, context = details["type"], tuple(details["loc"]), details.get("ctx", {})
    place = follow(root, loc)
    inner = context.get("error")
    if isinstance(inner, ValidationError):
        inside = [dict(each) | {"loc": (*loc, *each["loc"])} for each in inner.errors(include_url=False)]
        return [problem for each in inside for problem in _problems(each, root, model)]
    path, mark = ".".join(place.path), place.node.mark
    if kind == "too_short" and place.node.is_sequence and len(place.node.value) >= context["min_length"]:
        return []  # pydantic counts valid members only; the others are reported by themselves
    if kind == "missing":
        return [mark.problem(_join(path, str(loc[-1])), "is missing", "missing")]
    if kind == "extra_forbidden":
        keys = _keys_of(model, loc[:-1])
        word = str(loc[-1])
        choice = f" (allowed: {listing(keys, 40)})" if keys else ""
        hint = _owners_of_key(word, keys, model, loc[:-1]) or _hint_of_key(word, keys, model, path)
        if word.isdecimal():
            hint = "; decimals have a point, not a comma"
        message = f"unknown key '{word}'{hint or choice}"
        return [place.key.problem(path, message, "unknown_key")]
    if kind in {"union_tag_invalid", "union_tag_not_found"}:
        return [_tag_problem(kind, place, context)]
    return [mark.problem(path, words_of(kind, context, details), kind if kind in _CODES else "invalid")]


_CODES = {*_LIMITS, "finite_number", "literal_error"}
MORE = "more"
"""The code of the problem that counts those that are left out."""


def _tag_problem(kind: str, place: Place, context: dict[str, Any]) -> Problem:
    path = ".".join(place.path)
    key = str(context.get("discriminator", "kind")).strip("'")
    noun = (
        "region"
        if "region" in place.path
        else next((_NOUNS[part] for part in reversed(place.path) if part in _NOUNS), "kind")
        if key == "kind"
        else key
    )
    if kind == "union_tag_not_found":
        if not place.node.is_mapping:
            message = f"a mapping with '{key}' is needed, not {describe(place.node.plain())}"
            return place.node.mark.problem(path, message, "type")
        message = f"is missing; give the {f'kind of {noun}' if key == 'kind' else key}"
        return place.node.mark.problem(_join(path, key), message, "missing")
    names = re.findall(r"'([^']*)'", str(context.get("expected_tags", "")))
    node = place.node.value.get(key, place.node) if place.node.is_mapping else place.node
    word = describe(node.value)
    message = (
        f"{word} is not a known {noun}{did_you_mean(str(node.value), names)} (allowed: {listing(names, 40)})"
    )
    return node.mark.problem(_join(path, key), message, "unknown_kind")


def words_of(kind: str, context: dict[str, Any], details: dict[str, Any]) -> str:
    """An error of pydantic, of this kind, in words."""
    value = details.get("input")
    if kind in {"value_error", "assertion_error"}:
        return re.sub(r"^Input should be ", "must be ", str(context.get("error", details["msg"])))
    if kind in _LIMITS:
        name, words = _LIMITS[kind]
        hint = "; temperatures are absolute" if details["loc"][-1] in ("T0", "temperature", "around") else ""
        return f"{describe(value)} is out of range: must be {words} {context[name]:g}{hint}"
    if kind == "int_parsing_size":
        return f"{describe(value)} is too large"
    if kind == "finite_number":
        return "must be finite"
    if kind == "literal_error":
        found = re.findall(r"'([^']*)'|(\d+)", str(context.get("expected", "")))
        choice = [text or number for text, number in found]
        hint = did_you_mean(value, choice) if isinstance(value, str) else ""
        return f"{describe(value)} is not allowed{hint} (allowed: {listing(choice, 40)})"
    if kind in _NEEDED:
        hint = "; put it in quotes" if kind == "string_type" and isinstance(value, int | float) else ""
        if kind == "model_attributes_type" and isinstance(value, str) and details["loc"][-1] in _NOUNS:
            hint = f"; write {{kind: {value}}}" if value.isidentifier() else ""
        if details["loc"][-1:] == ("face",):
            hint = "; write {axis: x, side: lower}, with the axis and side of the face"
        return f"{_NEEDED[kind]} is needed, not {describe(value)}{hint}"
    if kind in {"too_short", "too_long"}:
        limit = context.get("min_length", context.get("max_length"))
        bound = "at least" if kind == "too_short" else "at most"
        return f"{bound} {limit} values are allowed, not {context['actual_length']}"
    if kind == "string_too_short":
        return "must not be empty"
    if kind == "string_too_long":
        return f"is too long: at most {context['max_length']} characters"
    message = re.sub(r"^Input should be ", "must be ", str(details["msg"]))
    return message[:1].lower() + message[1:]


def describe(value: Any) -> str:
    """A value as a message shows it."""
    if value is None:
        return "nothing"
    if isinstance(value, Refused):
        return describe(value.value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return f"{value:.15g}" if isinstance(value, float) else str(value)[:40]
    if isinstance(value, str):
        return f"'{value if len(value) <= 60 else value[:57] + '…'}'"
    if isinstance(value, dict):
        return "a mapping"
    return "a list" if isinstance(value, list | tuple) else "this"


def _join(path: str, key: str) -> str:
    return f"{path}.{key}" if path else key


def _hint_of_key(word: str, keys: list[str], model: type[BaseModel], path: str) -> str:
    """The key that a word means here, or stands for elsewhere in the scene, or is most like here.

    Members of lists and mappings of names ask for keys of their own section only.
    """
    if len(word) <= MAX_WORD and searches_are_left() and synonym(word, keys) is None:
        paths, section = _paths_of_sections(model), path.split(".")[0]
        field = model.model_fields.get(section)
        is_member = field is not None and _has_members(field.annotation)
        if field is not None and not is_member:  # what the section has itself comes first
            paths = paths | _paths_of_sections(model, only=section)
        for name in meanings(word):
            found = paths.get(name, path)
            if found != path and (not is_member or found.startswith(f"{section}.")):
                return f"; did you mean '{found}'?"
    return did_you_mean(word, keys)


def _owners_of_key(word: str, keys: list[str], model: type[BaseModel], loc: Sequence[Any]) -> str:
    """Which alternatives of the kind at a place have a key, where few of them do: "flip has no order; …"."""
    if len(word) > MAX_WORD or synonym(word, keys) is not None or not searches_are_left():
        return ""
    *before, kind = loc or ("",)
    for own in _candidates(model, before):
        if kind in _kinds(own) and word in _paths_of_sections(own):
            return f"; did you mean '{_paths_of_sections(own)[word]}'?"
    owners = [c for c in _candidates(model, before) if word in c.model_fields]
    kinds = [str(name) for owner in owners for name in _kinds(owner)[:1]]
    if not 1 <= len(kinds) <= MAX_OWNERS or not any(kind in _kinds(c) for c in _candidates(model, before)):
        return ""
    have = "has" if len(kinds) == 1 else "have"
    return f"; {kind} has no {word}, {' and '.join([', '.join(kinds[:-1]), kinds[-1]][len(kinds) == 1 :])} {have}"


def _has_members(annotation: Any) -> bool:
    """Whether an annotation is of a list or a mapping of names."""
    return any(get_origin(part) in (tuple, list, dict) for part in (annotation, *get_args(annotation)))


@cache
def _paths_of_sections(model: type[BaseModel], depth: int = 2, only: str | None = None) -> dict[str, str]:
    """Dotted paths of the keys of a model's sections (mappings that are no lists and no names of the user), by key.

    Of several the shortest. With ``only`` those of one section.
    """
    found: dict[str, str] = {}
    inner_models = [
        (section, inner)
        for section, field in model.model_fields.items()
        if get_origin(field.annotation) not in (tuple, list, dict) and only in (None, section)
        for inner in (*_models(field.annotation), *_models(field.metadata))
    ]
    for section, inner in inner_models:
        for key in inner.model_fields:
            found.setdefault(key, f"{section}.{key}")
    for section, inner in inner_models:
        for key, path in (_paths_of_sections(inner, depth - 1) if depth > 1 else {}).items():
            found.setdefault(key, f"{section}.{path}")
    return {key: path for key, path in found.items() if key not in {"kind", "name"}}


def _keys_of(model: type[BaseModel], loc: Sequence[Any]) -> list[str]:
    """The keys that a mapping of the scene may have, found by the types of the models on the way to it."""
    fields = [item for c in _candidates(model, loc) for item in c.model_fields.items()]
    return list(dict.fromkeys(field.alias or name for name, field in fields))


def _candidates(model: type[BaseModel], loc: Sequence[Any]) -> list[type[BaseModel]]:
    """Models that a mapping of the scene may be of."""
    candidates = [model]
    for part in loc:
        tagged = [c for c in candidates if part in _kinds(c)]
        if len(candidates) > 1 and tagged:
            candidates = tagged
        elif any(part in c.model_fields for c in candidates):
            fields = [c.model_fields[part] for c in candidates if part in c.model_fields]
            candidates = [
                m for field in fields for m in (*_models(field.annotation), *_models(field.metadata))
            ]
    return candidates


def _kinds(model: type[BaseModel]) -> tuple[Any, ...]:
    """By what a model is told apart from its alternatives."""
    field = model.model_fields.get("kind", model.model_fields.get("shape"))
    return get_args(field.annotation) if field is not None else ()


def _models(annotation: Any) -> list[type[BaseModel]]:
    """The models that occur in an annotation."""
    if isinstance(annotation, OneOf):
        return annotation.models()
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    parts = annotation if isinstance(annotation, list) else get_args(annotation)
    return [model for part in parts for model in _models(part)]


def ordered(problems: Iterable[Problem]) -> list[Problem]:
    """Problems by file and line, each once; those without a line first; errors before warnings where many."""
    unique = list(dict.fromkeys(problems))
    rest = sum(int(p.message.split()[2]) for p in unique if p.code == MORE)
    unique = [p for p in unique if p.code != MORE]
    place = {id(p): (p.file or "", p.line is not None, p.line or 0, p.column or 0) for p in unique}
    unique.sort(key=lambda p: place[id(p)])
    if len(unique) > MAX_SHOWN:
        unique.sort(key=lambda p: p.severity != "error")
        rest += len(unique) - MAX_SHOWN
        unique = sorted(unique[:MAX_SHOWN], key=lambda p: place[id(p)])
    shown = [_cut_short(problem) for problem in unique]
    if rest:
        severity = "error" if any(p.severity == "error" for p in shown) else "warning"
        last = Mark(shown[-1].file or "scene").problem("", f"… and {rest} more", MORE, severity)
        shown.append(last)
    return shown


def _cut_short(problem: Problem) -> Problem:
    """The same problem, shorter where it repeats very long text of the scene."""
    path, message = problem.path, problem.message
    if len(path) <= MAX_PATH and len(message) <= MAX_MESSAGE:
        return problem
    path = path if len(path) <= MAX_PATH else path[: MAX_PATH - 1] + "…"
    message = message if len(message) <= MAX_MESSAGE else message[: MAX_MESSAGE - 1] + "…"
    return replace(problem, path=path, message=message)


def as_text(problems: Sequence[Problem]) -> str:
    """One line per problem, the paths aligned; what counts those left out has no place."""
    return "\n".join(problem.message if problem.code == MORE else str(problem) for problem in problems)


def as_json(problems: Sequence[Problem]) -> str:
    """A JSON list of {file, line, column, path, code, severity, message}."""
    keys = ("file", "line", "column", "path", "code", "severity", "message")
    return json.dumps(
        [{key: asdict(problem)[key] for key in keys} for problem in problems], indent=1, ensure_ascii=False
    )
