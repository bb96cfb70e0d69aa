"""Commands called within the process of a test, and what is wrong with their words."""

import contextlib
import io
import math
import re
import time

from mpmcli.cli.main import call


def spoken(arguments: list[str]) -> tuple[int, str, float]:
    """Exit code of a command, all that it wrote, and the seconds that it computed."""
    written = io.StringIO()
    begin = time.process_time()
    with contextlib.redirect_stdout(written), contextlib.redirect_stderr(written):
        code = call(arguments)
    return code, written.getvalue(), time.process_time() - begin


def unfit(code: int, written: str) -> str:
    """What is wrong with the words of an answer."""
    if code and not written.strip():
        return "no words"
    found = re.search(r"Traceback|Input should|validation error|Warning:", written)
    return f"says '{found[0]}'" if found else ""


def answered(arguments: list[str], allowed: set[int], most: float = math.inf) -> tuple[int, str]:
    """Exit code of a command, and what is wrong with its answer, or that it computed for too many seconds."""
    code, written, seconds = spoken(arguments)
    wrong = unfit(code, written)
    if code not in allowed or seconds > most:
        wrong = f"exit code {code} after {seconds:.3g} s {wrong}"
    return code, f"{wrong}\n{written[-1500:]}" if wrong else ""
