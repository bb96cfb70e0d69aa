"""``mpmcli stability`` on the vibrating bar: Fig. 12A of Nairn (2026)."""

from pathlib import Path

import pytest

from mpmcli.study.journal import Journal
from mpmcli.study.processes import Processes
from mpmcli.study.stability import Settings, Source, find_limits, make_cases

pytestmark = [pytest.mark.long, pytest.mark.timeout(1800)]

BAR = Path(__file__).parents[2] / "inputs" / "vibrating_bar.yaml"
LIMITS = {"flip": (0.85, 0.02), "fmpm:2": (0.685, 0.015), "fmpm:4": (0.541, 0.015), "fmpm:8": (0.41, 0.015)}


def test_limits_of_the_vibrating_bar(tmp_path):
    cases = make_cases(Source(str(BAR)), list(LIMITS), [])
    find_limits(cases, Settings(), Processes(), Journal(tmp_path / "trials.jsonl"))
    for case in cases:
        limit, tolerance = LIMITS[case.transfer]
        assert case.limit == pytest.approx(limit, abs=tolerance), case.name
        assert case.predicted == pytest.approx(case.limit, rel=0.08), case.name
        assert case.loss < 0.005, case.name
