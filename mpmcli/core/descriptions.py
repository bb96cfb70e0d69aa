"""What the docstrings below the fields of a model say: read from its source only when asked for."""

import ast
import inspect
import textwrap
from functools import cache
from itertools import pairwise


@cache
def field_descriptions(model: type) -> dict[str, str]:
    """Words about the fields of a class by name, those of its bases included.

    Parameters
    ----------
    model
        A class with annotated fields, each followed by a docstring.
    """
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        if base.__module__.startswith(("pydantic", "builtins", "typing", "abc")):
            continue
        for statement, following in _pairs(base):
            words = _text(following)
            if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name) and words:
                found[statement.target.id] = words
    return found


def _pairs(cls: type) -> list[tuple[ast.stmt, ast.stmt]]:
    """Each statement in the body of a class with the one after it."""
    try:
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
    except (OSError, TypeError, SyntaxError):
        return []
    body = tree.body if isinstance(tree, ast.ClassDef) else []
    return list(pairwise(body))


def _text(statement: ast.stmt) -> str | None:
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
        value = statement.value.value
        return inspect.cleandoc(value) if isinstance(value, str) else None
    return None
