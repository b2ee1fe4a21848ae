"""The rig that ships: what happened to it is noticed, and its next test is predicted."""

import json
import shutil

import numpy as np
import pytest

from reliab.app.cli import run
from reliab.core.shipped import shipped
from reliab.rig.rig_folder import RigFolder
from reliab.rig.watching import drift_chart

CHANGE_PLACE = 63  # the first test after the valve was exchanged, counted from 0


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rig") / "sample_rig"
    shutil.copytree(shipped("datasets", "sample_rig"), folder)  # where its table may be written
    return RigFolder(folder).table()


def test_sample_rig_matches_its_page(table):
    assert len(table) == 126
    assert len(set(table.texts("event"))) == 42
    assert all(event.startswith("simulated") for event in table.texts("event"))
    assert not table.faults


def test_its_change_is_noticed_and_the_delay_named(table):
    interval = drift_chart(table.rows).changes
    changes = [change for change in interval if change.cause == "delay" and change.confirmed]
    assert changes[0].noticed - CHANGE_PLACE in range(6)
    assert changes[0].began == pytest.approx(CHANGE_PLACE, abs=3)
    assert changes[0].size == pytest.approx(1.0, abs=0.4)  # ms


def test_delays_differ_by_the_simulated_change(table):
    delays = table.numbers("d_ms")
    assert np.median(delays[CHANGE_PLACE:]) - np.median(delays[:CHANGE_PLACE]) == pytest.approx(1.0, abs=0.15)


@pytest.mark.slow
def test_it_is_copied_and_its_next_test_predicted(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["samples"]) == 0
    capsys.readouterr()
    options = ["rig", "predict", "datasets/sample_rig", "--f", "1", "--xi", "0.03", "--json", "-"]
    assert run(options) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["tests"] == 126
    assert result["d_ms"]["low"] < 2.1 < result["d_ms"]["high"]  # after the change
    assert result["d_ms"]["low"] > 1.0
