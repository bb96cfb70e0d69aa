"""Signals stop a study at once, whichever thread the system hands them to."""

import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from mpmcli.study.interruption import run_until_interrupted, wait_for


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="signals cannot be sent to a thread here")
def test_a_signal_that_another_thread_gets_stops_the_study():
    released, worker = threading.Event(), []

    def work() -> None:
        worker.append(threading.get_ident())
        released.wait(60)

    def study() -> None:
        with ThreadPoolExecutor(1) as pool:
            future = pool.submit(work)
            threading.Timer(0.2, lambda: signal.pthread_kill(worker[0], signal.SIGTERM)).start()
            try:
                wait_for([future])
            finally:
                released.set()

    begin = time.monotonic()
    assert run_until_interrupted(study, lambda: None) == 143
    assert time.monotonic() - begin < 30
    assert released.is_set()
