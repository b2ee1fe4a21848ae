"""The error of a frame's test whose specimen is known by its recorded force only."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from reliab.assessment.assess import assess
from reliab.assessment.budget.sizes import ordinary_equipment
from reliab.assessment.verdict import Word
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric

nonlinear_frames = pytest.importorskip("nonlinear_frames")

_TIMES = np.arange(0.0, 12.0, nonlinear_frames.STEP)


def _ground() -> np.ndarray:
    """Ground acceleration of some strong seconds with a broad spectrum [m/s²]."""
    noise = np.random.default_rng(4).standard_normal(_TIMES.size)
    smooth = np.convolve(noise, np.hanning(100), mode="same")
    return 0.3 * smooth * (_TIMES / 4.0) * np.exp(1.0 - _TIMES / 4.0)


def _simulate_family(family: str, seed: int) -> Any:
    draw = np.random.default_rng(seed)
    while not 0.01 < (test := nonlinear_frames.simulate_frame_test(family, _ground(), draw)).error < 0.1:
        pass
    return test


@pytest.mark.slow
@pytest.mark.parametrize("family", ["bilinear", "Bouc-Wen", "cubic"])
def test_error_is_against_a_perfect_actuator(family: str) -> None:
    test = _simulate_family(family, 1)
    assessment = assess(test.recording, test.frame, measured_specimen=True)
    size = assessment.error.estimate(Metric.RMS)
    assert size.value == pytest.approx(test.error, rel=0.1)
    assert 0.9 * size.low < test.error < 1.1 * size.high
    remainder = np.sqrt(np.mean((assessment.error.reference - test.exact) ** 2))
    assert remainder < 0.25 * np.sqrt(np.mean((test.moved - test.exact) ** 2))
    stated_values = assess(test.recording, test.frame, linear_specimen=True).error.estimate(Metric.RMS)
    assert abs(size.value - test.error) < 0.5 * abs(stated_values.value - test.error)
    summary = assessment.to_dict()
    assert summary["specimen"]["known"] == "measured"
    assert "specimen" in {item["name"] for item in summary["budget"]}
    assert sum(part["share"] for part in summary["error"]["parts"].values()) == pytest.approx(1.0)


@pytest.mark.slow
def test_a_linear_specimen_of_a_frame_loses_nothing() -> None:
    test = _simulate_family("linear", 2)
    measured_displacement, stated_values = (
        assess(test.recording, test.frame, **{reference: True}).error.estimate(Metric.RMS)
        for reference in ("measured_specimen", "linear_specimen")
    )
    assert measured_displacement.value == pytest.approx(stated_values.value, rel=0.01)
    assert measured_displacement.high - measured_displacement.low < 1.3 * (
        stated_values.high - stated_values.low
    )


@pytest.mark.slow
def test_a_measured_specimen_of_a_frame_needs_its_force_and_no_mass() -> None:
    test = _simulate_family("bilinear", 1)
    with pytest.raises(InputError, match="needs its force"):
        assess(replace(test.recording, force=None), test.frame, measured_specimen=True)
    partition = test.frame.partition
    heavy = replace(partition, specimen_mass=np.array([[10.0]]))
    with pytest.raises(InputError, match=r"no mass of its own; found mass_kg = 10"):
        assess(test.recording, replace(test.frame, partition=heavy), measured_specimen=True)


@pytest.mark.slow
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_ground_acceleration_is_compared_beside_any_specimen(sign: float) -> None:
    test = _simulate_family("bilinear", 1)
    ground = np.interp(test.recording.time_step * np.arange(test.recording.command.size), _TIMES, _ground())
    shown = assess(
        replace(test.recording, ground=sign * ground), test.frame, measured_specimen=True
    ).error.ground
    assert shown.fits
    assert ("The ground acceleration has the opposite sign." in shown.notes) is (sign < 0.0)
    assert shown.sign == sign
    with pytest.raises(InputError, match="does not fit its unit"):
        assess(replace(test.recording, ground=ground / 9.80665), test.frame, measured_specimen=True)


@pytest.mark.parametrize(("family", "known"), [("bilinear", "measured"), ("linear", "stated")])
def test_a_recorded_force_shows_by_itself_whether_the_specimen_is_linear(family: str, known: str) -> None:
    test = _simulate_family(family, 1)
    found = assess(test.recording, test.frame, equipment=ordinary_equipment())
    size = found.error.estimate(Metric.RMS)
    assert found.error.specimen_known == known
    assert size.low < test.error < size.high
    if known == "stated":
        without = assess(replace(test.recording, force=None), test.frame, equipment=ordinary_equipment())
        other = without.error.estimate(Metric.RMS)
        assert size.high - size.low < 0.9 * (other.high - other.low)
        assert not found.turning.sentences or "No force was recorded" not in found.turning.sentences[0]


def test_a_nonlinear_specimen_with_a_mass_is_said_and_not_learned() -> None:
    test = _simulate_family("bilinear", 1)
    partition = test.frame.partition
    heavy = replace(test.frame, partition=replace(partition, specimen_mass=np.array([[1.0]])))
    found = assess(test.recording, heavy, equipment=ordinary_equipment())
    assert found.error.specimen_known == "stated"
    assert found.verdict is not Word.RELIABLE
    assert any("looks nonlinear" in reason for reason in found.reasons)
