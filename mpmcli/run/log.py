"""Messages of a run: to the user as they come, and all of them to ``run.log``."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mpmcli.output.files import LOG, writing
from mpmcli.run.progress import MessageHandler, Progress

LOGGER = logging.getLogger("mpmcli")


@contextmanager
def messages(progress: Progress, verbosity: int) -> Iterator[None]:
    """Show messages: −1 errors only, 0 normal, 1 all."""
    level = {-1: logging.ERROR, 0: logging.INFO}.get(verbosity, logging.DEBUG)
    with _handler(MessageHandler(progress, level)):
        yield


class _LogFile(logging.FileHandler):
    def handleError(self, record: logging.LogRecord) -> None:
        """A log that cannot be written (a full disk) must not hide the error that is being logged."""


@contextmanager
def log_file(directory: Path, mode: str) -> Iterator[None]:
    """Write all messages to a folder's log; ArchiveError if it cannot be opened."""
    with writing(directory / LOG):
        handler = _LogFile(directory / LOG, mode=mode, encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    with _handler(handler):
        yield


@contextmanager
def _handler(handler: logging.Handler) -> Iterator[None]:
    level = LOGGER.level
    LOGGER.setLevel(logging.DEBUG)
    LOGGER.addHandler(handler)
    try:
        yield
    finally:
        LOGGER.removeHandler(handler)
        LOGGER.setLevel(level)
        with suppress(OSError):
            handler.close()
