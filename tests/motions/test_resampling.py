import numpy as np
import pytest
from hypothesis import given, strategies as st

from reliab.core.errors import InputError
from reliab.motions.motion import Motion, resample

SAMPLES = st.lists(st.floats(-40.0, 40.0), min_size=2, max_size=50)


def motion(samples: list[float], time_step: float) -> Motion:
    return Motion(name="a", acceleration=np.array(samples), time_step=time_step, event="e", set_name="s")


@given(samples=SAMPLES, time_step=st.floats(0.001, 0.05), rate=st.floats(200.0, 3000.0))
def test_resampling_stays_on_the_line_between_samples(
    samples: list[float], time_step: float, rate: float
) -> None:
    record = motion([*samples, *samples, *samples], time_step)
    if record.duration * rate < 1:
        return
    second = resample(record, rate)
    position = second.times / time_step
    left_index = np.minimum(position.astype(int), record.acceleration.size - 2)
    share = position - left_index
    start, end = record.acceleration[left_index], record.acceleration[left_index + 1]
    np.testing.assert_allclose(second.acceleration, start + share * (end - start), atol=1e-6)
    assert -1e-9 < record.duration - second.duration < 1.0 / rate + 1e-9


def test_an_integer_multiple_of_the_rate_keeps_every_sample() -> None:
    record = motion(np.sin(np.arange(4096)).tolist(), 1.0 / 256.0)
    assert np.array_equal(resample(record).acceleration[::4], record.acceleration)


def test_resampling_a_record_of_one_hundred_hertz_reaches_its_last_sample() -> None:
    record = motion([0.0] * 2999 + [1.0], 0.01)
    second = resample(record)
    assert second.time_step == 1.0 / 1024.0
    assert second.acceleration.size == int(29.99 * 1024) + 1


def test_name_event_and_set_are_kept() -> None:
    second = resample(motion([0.0, 1.0, 2.0], 0.1))
    assert (second.name, second.event, second.set_name) == ("a", "e", "s")


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, np.inf, 1.0])
def test_an_impossible_rate_is_refused(rate: float) -> None:
    with pytest.raises(InputError, match="sampling rate"):
        resample(motion([0.0, 1.0], 0.1), rate)
