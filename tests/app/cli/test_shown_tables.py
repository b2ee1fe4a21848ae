"""Tables on the terminal show the numbers that the JSON holds."""

import numpy as np
import pytest
from rich.console import Console

from reliab.app.api.followed_test import Message
from reliab.app.cli import validate
from reliab.app.cli.monitor import _table
from reliab.assessment.monitor import Monitor
from reliab.core.significant_digits import percent_with_interval
from reliab.core.vocabulary import Metric
from reliab.structures.structure import Structure


def words_of(text):
    return " ".join(text.split())


@pytest.mark.parametrize(("truth", "noted"), [("ellipse", True), ("simulation", False)])
def test_probabilities_are_shown_beside_the_share_of_good_tests(truth, noted, capsys):
    row = {"stated": 0.9, "observed": 0.85, "low": 0.7, "high": 0.95, "tests": 43}
    validate.show_probabilities({"scheme": "leave_one_event_out", "truth": truth, "bins": [row]})
    output = words_of(capsys.readouterr().out)
    for part in ("leave one event out", "90.0 %", "85", "43"):
        assert part in output
    assert ("llipse" in output) is noted


def test_the_table_of_a_running_test_grows_with_knowledge():
    time = np.arange(3000) / 256.0
    command = np.minimum(time, 1.0) * 0.01 * np.sin(6.0 * time)
    monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), 1.0 / 256.0)
    message = Message(kind="update", content={}, monitor=monitor, alarms={})

    def shown():
        screen = Console(width=100)
        with screen.capture() as caught:
            screen.print(_table(message, Metric.RMS, 0.05))
        return words_of(caught.get())

    monitor.feed(command[:100], 0.99 * command[:100])
    assert "not settled" in shown()
    assert "90 % interval" not in shown()
    monitor.feed(command[100:], 0.99 * command[100:])
    result = monitor.ask(draws=8)
    message.alarms["energy"] = "the loop has gained energy"  # type: ignore[index]
    text = shown()
    assert percent_with_interval(result.rms.value, result.rms.low, result.rms.high) in text
    assert f"{result.probability(0.05):.3f}" in text
    assert f"{100 * monitor.now.damping.ratio:.2f} ± {100 * monitor.now.damping.deviation:.2f} %" in text
    assert "the loop has gained energy" in text
