"""What a verdict shows: the interval against the threshold, and what knowing a quantity would change."""

import re

import numpy as np
import pytest

import reliab
from reliab.core.shipped import shipped
from reliab.core.significant_digits import percent, percent_with_interval
from reliab.desk.verdict_view import interval_html, knowing_html, verdict_html
from reliab.desk.work import judgement_of, thin_histories

SAMPLE = shipped("datasets", "sample_test/test.csv")


@pytest.fixture(scope="module")
def content():
    return reliab.assess(SAMPLE, f="1±0.01", xi="0.02±0.002").to_dict()


@pytest.mark.slow
def test_the_bar_has_interval_and_threshold_in_proportion(content):
    html = interval_html(content)
    left, width = map(float, re.search(r'<rect x="([\d.]+)" y="29" width="([\d.]+)"', html).groups())
    threshold = float(re.search(r'<line x1="([\d.]+)" x2="[\d.]+" y1="20"', html)[1])
    size = content["error"]["rms"]
    scale = (threshold - 20.0) / content["threshold"]
    assert left - 20.0 == pytest.approx(scale * size["low"], abs=0.2)
    assert width == pytest.approx(scale * (size["high"] - size["low"]), abs=0.2)
    assert f'aria-label="RMS error {percent_with_interval(**size)}; the threshold is 5 %"' in html


def test_the_verdict_has_the_reasons_of_the_answer(content):
    html = verdict_html(content)
    assert "Reliable" in html
    assert content["reasons"][0] in html


def test_knowing_a_quantity_states_the_interval_and_an_action(content):
    item = content["budget"][0]
    entry = next(entry for entry in content["error"]["widest"] if entry["name"] == item["name"])
    html = knowing_html(item, content)
    width_without, width = (percent(entry[key], 2) for key in ("width_without", "width"))
    assert f"{width_without} wide instead of {width}" in html
    assert item["remedy"] in html


@pytest.mark.slow
def test_a_spike_is_marked_where_it_is(tmp_path):
    lines = SAMPLE.read_text(encoding="utf-8").splitlines()
    place = next(k for k, line in enumerate(lines) if line.startswith("20.0"))
    time, command, _ = lines[place].split(",")
    lines[place] = f"{time},{command},0.5"
    path = tmp_path / "spiked.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    judgement = judgement_of(reliab.assess(path, f=1, xi=0.02))
    assert [(mark.begin, mark.end) for mark in judgement.marks] == [
        (pytest.approx(float(time), abs=0.05), pytest.approx(float(time), abs=0.05))
    ]
    assert judgement.bound > 0.0


def test_no_peak_of_a_long_history_is_lost():
    rng = np.random.default_rng(1)
    time, values = np.arange(100_000.0), rng.normal(size=100_000)
    values[77_777] = 50.0
    points, peaks = thin_histories(time, values)
    assert points.size < 5000
    assert peaks.max() == 50.0
    assert np.all(np.diff(points) > 0)
    assert peaks.min() == values.min()
