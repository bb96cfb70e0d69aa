"""Jobs of a study on the machines of a Dask cluster, each still in a process of its own."""

import threading
from typing import Any

from mpmcli.core.errors import ArchiveError
from mpmcli.study.processes import CRASHED, Stopped, run_job


class Cluster:
    """Runs jobs on a Dask cluster; its machines need mpmcli and the scene at the same path.

    Raises ArchiveError if the scheduler does not answer.

    Parameters
    ----------
    address : of the scheduler, such as ``tcp://host:8786``
    timeout : seconds by the clock after which a run is killed; none if None
    """

    def __init__(self, address: str, timeout: float | None = None):
        from distributed import Client  # type: ignore[import-not-found,unused-ignore]

        self.timeout = timeout
        self._address = address
        try:
            self._client = Client(address)
        except (OSError, ValueError) as error:
            raise ArchiveError(f"the scheduler {address} does not answer: {error}") from error
        self._running: set[Any] = set()
        self._lock = threading.Lock()
        self.is_stopped = False

    def run(self, job: dict[str, Any]) -> dict[str, Any]:
        """Run one job and wait for it; where a machine of the cluster is lost, it is a result that says so.

        Raises Stopped if ``stop`` was called before it ended, and ArchiveError if the scheduler is gone.
        """
        with self._lock:
            if self.is_stopped:
                raise Stopped
            future = self._client.submit(run_job, job, self.timeout, pure=False)
            self._running.add(future)
        try:
            result: dict[str, Any] = future.result()
        except Exception as error:
            if self.is_stopped:
                raise Stopped from None
            if self._client.status != "running":
                raise ArchiveError(
                    f"the connection to the scheduler {self._address} is lost: {error}"
                ) from error
            result = {
                "ended": CRASHED,
                "message": f"the cluster lost the run: {type(error).__name__}: {error}",
            }
        finally:
            with self._lock:
                self._running.discard(future)
        return result

    def stop(self) -> None:
        """Give up what runs and start nothing more."""
        with self._lock:
            self.is_stopped = True
            for future in self._running:
                future.cancel()

    def close(self) -> None:
        """Leave the cluster."""
        self._client.close()
