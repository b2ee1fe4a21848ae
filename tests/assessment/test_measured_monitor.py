"""A test that is followed while its specimen is learned from its force."""

import json
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from reliab import assess, follow_test
from reliab.app.cli import run
from reliab.assessment import monitor as following
from reliab.assessment.monitor import MeasuredMonitor
from reliab.assessment.rebuilt_error.running_test import TIME_WITHOUT_DOUBLING
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

simulated_tests = pytest.importorskip("reliab_studies.measured_specimen.simulated_tests")

_STEP = 1.0 / 256.0
_TIMES = np.arange(0.0, 16.0, _STEP)
_STRUCTURE = Partition.from_structure(Structure(frequency=1.0, damping_ratio=0.03))


@pytest.fixture
def learner(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """What would be learned: a specimen with a share of the force that is missed, and an error of 20 %."""
    size = SimpleNamespace(value=0.2, low=0.15, high=0.25)
    peak = np.where(_TIMES > 1.0, 1.0, 0.1)
    rebuilt = SimpleNamespace(
        rms=size,
        mte=size,
        displacements=[SimpleNamespace(error=0.2 * peak, reference=peak)],
        estimate=lambda _metric: size,
    )
    specimen = SimpleNamespace(held_out=0.2, learned=True)
    rebuilt.specimen = specimen

    def learn(command: np.ndarray, *_: Any, **__: Any) -> SimpleNamespace:
        if command.size < 300:
            raise InputError("Too short")
        rebuilt.displacements[0].reference = peak[: command.size]
        return rebuilt

    monkeypatch.setattr(following, "rebuild", learn)
    return rebuilt


def _monitor(seconds: float) -> MeasuredMonitor:
    monitor = MeasuredMonitor(_STRUCTURE, _STEP)
    path = np.sin(6.0 * _TIMES[: round(seconds / _STEP)])
    monitor.feed(path, path, path)
    return monitor


def test_no_error_is_stated_before_the_force_is_predicted_to_a_tenth(learner: SimpleNamespace) -> None:
    monitor = _monitor(8.0)
    assert monitor.ask() is None
    assert (monitor.now.rms, monitor.now.error, monitor.specimen.held_out) == (None, None, 0.2)
    assert monitor.ask(at_end=True) is learner  # as `assess` takes it
    learner.specimen.held_out = 0.09
    assert monitor.ask() is learner
    assert monitor.now.rms == 0.2
    learner.specimen.held_out, learner.specimen.learned = 0.4, False
    assert monitor.ask(at_end=True) is None


@pytest.mark.usefixtures("learner")
def test_too_short_a_test_is_still_learned() -> None:
    monitor = _monitor(1.0)
    assert monitor.ask() is None
    assert monitor.specimen is None
    with pytest.raises(InputError, match="Too short"):
        monitor.ask(at_end=True)


def test_a_measured_specimen_is_learned_at_each_fourth(learner: SimpleNamespace) -> None:
    learner.specimen.held_out = 0.01
    monitor, options = _monitor(4.0), []
    for _ in range(1, round(12.0 / 0.25)):
        if monitor.due:
            options.append(monitor.samples)
            monitor.ask()
        path = 0.1 * np.ones(round(0.25 / _STEP))
        monitor.feed(path, path, path)
    assert len(options) > 2
    assert all(later >= 1.25 * first for first, later in pairwise(options))


def test_the_alarm_waits_until_the_peak_is_calm(learner: SimpleNamespace) -> None:
    """The peak last doubled at one second, and half of the low end of 15 % is above 5 % but not 8 %."""
    learner.specimen.held_out = 0.01
    for seconds, calm in (
        (1.0 + TIME_WITHOUT_DOUBLING - 0.1, False),
        (1.0 + TIME_WITHOUT_DOUBLING + 0.1, True),
    ):
        monitor = _monitor(seconds)
        monitor.ask()
        assert [monitor.exceeds(limit, Metric.RMS) for limit in (0.05, 0.08)] == [calm, False]


def test_no_reading_is_too_large() -> None:
    with pytest.raises(InputError, match="finite number below"):
        MeasuredMonitor(_STRUCTURE, _STEP).feed(np.array([1e30]), np.zeros(1), np.zeros(1))


_STATED = {"f": 1, "xi": 0.02}


@pytest.mark.parametrize(
    ("stated_values", "says"),
    [
        ({"specimen": "measured"}, "needs the `mass`"),
        ({"specimen": "elastic"}, "Unknown kind of specimen"),
        ({"mass": 1.0}, "unless the `specimen` is measured"),
        ({"force_channel": ["lag_ms=2"]}, "unless the `specimen` is measured"),
        ({"specimen": "measured", "mass": 1.0}, "No column for the force"),
        ({"specimen": "measured", "mass": -1.0}, "`mass` must be between"),
    ],
)
def test_untrackable_test_is_refused(stated_values: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        list(follow_test("sample_test", **_STATED, **stated_values, wait=0.05))


def _write_recording(path: Path, family: str, seconds: float) -> tuple[Any, dict[str, Any]]:
    """Write a simulated test of a structure of 1000 kg; return it with what is stated of it."""
    times = np.arange(0.0, seconds, _STEP)
    noise = np.random.default_rng(4).standard_normal(times.size)
    load = np.convolve(noise, np.hanning(25), mode="same") * np.minimum(times, 1.0)
    draw = np.random.default_rng(8)
    while not 0.01 < (test := simulated_tests.simulate(family, load, _STEP, draw)).error < 0.1:
        pass
    columns = {"time_s": times, "command_m": test.command, "measured_m": test.measured}
    pd.DataFrame({**columns, "force_kn": test.force}).to_csv(path, index=False)
    loop = test.loop
    return test, {"f": loop.frequency, "xi": loop.damping_ratio, "alpha": loop.share, "mass": 1000.0}


@pytest.mark.slow
def test_end_equals_assess_and_errors_so_far_are_true(tmp_path: Path) -> None:
    test, stated_values = _write_recording(tmp_path / "test.csv", "bilinear", 20.0)
    messages = {**stated_values, "specimen": "measured"}
    *running, end = (
        message.to_dict() for message in follow_test(tmp_path / "test.csv", **messages, wait=0.05)
    )
    result = assess(tmp_path / "test.csv", **messages).error.rebuilt.rms
    assert [end["error"]["rms"][name] for name in ("value", "low", "high")] == [
        result.value,
        result.low,
        result.high,
    ]
    assert running[0]["specimen"] == {"learning": True, "held_out": None, "until_s": None}
    assert running[0]["rms"] is None
    assert running[0]["false_alarm_rates"]["error"] is None
    reference = [message for message in running if "error" in message]
    assert len(reference) > 3
    for message in reference:
        displacement, exact = (history[: message["samples"]] for history in (test.moved, test.exact))
        true = np.sqrt(np.mean((displacement - exact) ** 2)) / np.abs(exact).max()
        stated_error = message["error"]["rms"]
        assert stated_error["low"] < true < stated_error["high"]
        assert stated_error["value"] == pytest.approx(true, rel=0.2)


@pytest.mark.slow
def test_command_reports_learning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A force that is noise is never learned: the exit code is 0, and the answer undecided."""
    _, stated_values = _write_recording(tmp_path / "test.csv", "linear", 12.0)
    table = pd.read_csv(tmp_path / "test.csv")
    table["force_kn"] = np.random.default_rng(0).standard_normal(len(table))
    table.to_csv(tmp_path / "test.csv", index=False)
    options = [part for name, value in stated_values.items() for part in (f"--{name}", f"{value}")]
    command = ["monitor", str(tmp_path / "test.csv"), *options, "--specimen", "measured", "--wait", "0.05"]
    assert run(command) == 0
    output = " ".join(capsys.readouterr().out.split())
    assert "still learning the specimen" in output
    assert "UNDECIDED" in output
    assert run([*command, "--json", "-"]) == 0
    end = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert (end["above_threshold"], end["specimen"]["learning"]) == (None, True)
