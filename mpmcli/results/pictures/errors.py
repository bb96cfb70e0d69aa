"""What a picture cannot be made of, and what is missing to make it."""

from __future__ import annotations

from typing import Any

from mpmcli.core.errors import RequestError


class PictureError(RequestError):
    """A picture that was asked for cannot be made: wrong words, or a library that is not installed."""


def matplotlib() -> Any:
    """The package matplotlib; PictureError with the command that installs it, if it is missing."""
    try:
        import matplotlib
    except ImportError:
        raise PictureError("pictures need matplotlib; install it with pip install 'mpmcli[plot]'") from None
    return matplotlib
