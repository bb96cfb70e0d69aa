"""``mpmcli tradeoff --scheduler`` on a Dask cluster of this machine."""

import csv
import os
import sys
from pathlib import Path

import pytest

from mpmcli.cli.main import call
from mpmcli.core.errors import ArchiveError
from mpmcli.study import cluster
from mpmcli.study.processes import CRASHED

distributed = pytest.importorskip("distributed", reason="needs Dask: pip install distributed")

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]

BAR = Path(__file__).parents[3] / "inputs" / "vibrating_bar.yaml"


@pytest.fixture
def local():
    import dask

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, silence_logs=50
        ) as found,
    ):
        yield found


def test_a_study_on_a_cluster(local, tmp_path, capsys):
    vary = [
        "--vary",
        "time.courant=0.2,0.5",
        "--vary",
        "method.transfer=flip,fmpm:4",
        "--until",
        "20",
        "--repeats",
        "1",
    ]
    arguments = [
        "tradeoff",
        str(BAR),
        *vary,
        "--scheduler",
        local.scheduler_address,
        "-o",
        str(tmp_path / "s"),
        "-q",
    ]
    assert call(arguments) == 0
    assert "The cheapest case within" in capsys.readouterr().out
    with (tmp_path / "s" / "tradeoff.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["finished"] * 4
    assert len(list((tmp_path / "s" / "tables").glob("*.csv"))) == 4


def _die(job, timeout):
    os._exit(3)


def test_a_machine_that_is_lost_is_a_row(local, tmp_path, monkeypatch):
    import cloudpickle

    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    try:
        monkeypatch.setattr(cluster, "run_job", _die)
        vary = ["--vary", "time.courant=0.2,0.5", "--repeats", "1"]
        arguments = [
            "tradeoff",
            str(BAR),
            *vary,
            "--scheduler",
            local.scheduler_address,
            "-o",
            str(tmp_path / "s"),
            "-q",
        ]
        assert call(arguments) == 4
    finally:
        cloudpickle.unregister_pickle_by_value(sys.modules[__name__])
    with (tmp_path / "s" / "tradeoff.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == [CRASHED] * 2
    assert "the cluster lost the run: KilledWorker" in rows[0]["remark"]


def test_nobody_at_the_address():
    import dask

    with (
        dask.config.set({"distributed.comm.timeouts.connect": "1s"}),
        pytest.raises(ArchiveError, match="does not answer"),
    ):
        cluster.Cluster("tcp://127.0.0.1:9")
