"""The process in which one run of a study happens: ``python -m mpmcli.study.worker``.

Reads the job as one line of JSON from stdin and prints the result as one marked line. It ends at once when its stdin is
closed: then whoever asked is gone.
"""

import json
import os
import sys
import threading
from collections.abc import Callable
from typing import Any

from mpmcli.core.errors import ArchiveError, SceneError
from mpmcli.study.processes import MARK


def _end_when_alone() -> None:
    sys.stdin.read()
    os._exit(1)


def work(job: dict[str, Any]) -> dict[str, Any]:
    """Do a job, by its ``task``; errors of the scene and of files are results too."""
    try:
        return _task(job["task"])(job)
    except SceneError as error:
        return {"ended": "invalid scene", "message": str(error)}
    except ArchiveError as error:
        return {"ended": "files", "message": str(error)}


def _task(name: str) -> Callable[[dict[str, Any]], dict[str, Any]]:
    if name == "trial":
        from mpmcli.study.trial import run_trial

        return run_trial
    from mpmcli.study.measure import measure_case

    return measure_case


def main() -> None:
    """Read the job, do it, print the result."""
    job = json.loads(sys.stdin.readline())
    threading.Thread(target=_end_when_alone, daemon=True).start()
    # what a library prints must not end up in the middle of the result
    result, sys.stdout = sys.stdout, sys.stderr
    text = json.dumps(work(job), ensure_ascii=False)
    result.write(f"\n{MARK}{text}\n")
    result.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
