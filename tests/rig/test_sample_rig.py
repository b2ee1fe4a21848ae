"""The rig that ships: what happened to it is noticed, and its next test is predicted."""

import json
import shutil

import numpy as np
import pytest

from reliab.app.cli import run
from reliab.core.shipped import shipped
from reliab.rig.rig_folder import RigFolder
from reliab.rig.watching import drift_chart

CHANGED = 63  # the first test after the valve was exchanged, counted from 0


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rig") / "sample_rig"
    shutil.copytree(shipped("datasets", "sample_rig"), folder)  # where its table may be written
    return RigFolder(folder).table()


def test_it_holds_what_its_page_says(table):
    assert len(table) == 126
    assert len(set(table.texts("event"))) == 42
    assert all(event.startswith("simulated") for event in table.texts("event"))
    assert not table.faults


def test_its_change_is_noticed_and_the_delay_named(table):
    every = drift_chart(table.rows).changes
    changes = [change for change in every if change.cause == "delay" and change.confirmed]
    assert changes[0].noticed - CHANGED in range(6)
    assert changes[0].began == pytest.approx(CHANGED, abs=3)
    assert changes[0].size == pytest.approx(1.0, abs=0.4)  # ms


def test_delays_before_and_after_differ_by_what_was_simulated(table):
    delays = table.numbers("d_ms")
    assert np.median(delays[CHANGED:]) - np.median(delays[:CHANGED]) == pytest.approx(1.0, abs=0.15)


@pytest.mark.slow
def test_it_is_copied_and_its_next_test_predicted(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["samples"]) == 0
    capsys.readouterr()
    asked = ["rig", "predict", "datasets/sample_rig", "--f", "1", "--xi", "0.03", "--json", "-"]
    assert run(asked) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["tests"] == 126
    assert found["d_ms"]["low"] < 2.1 < found["d_ms"]["high"]  # after the change
    assert found["d_ms"]["low"] > 1.0
