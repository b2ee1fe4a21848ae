"""The same test comes back from every layout, and what was recognised is stated."""

import numpy as np
import pytest
from layouts import COMMAND, FORCE, LAYOUTS, MEASURED, RATE, dspace

from reliab.recordings import read_recording

PRECISION = {dspace: 1e-9}
"""Files of single precision."""


@pytest.mark.parametrize("write", LAYOUTS)
def test_a_test_in_any_layout_is_read_without_an_option(tmp_path, write):
    test = read_recording(write(tmp_path))
    assert test.time_step == pytest.approx(1.0 / RATE, rel=1e-9)
    precision = PRECISION.get(write, 1e-12)
    np.testing.assert_allclose(test.command, COMMAND, atol=precision)
    np.testing.assert_allclose(test.measured, MEASURED, atol=precision)
    if test.force is not None:
        np.testing.assert_allclose(test.force, FORCE, atol=1e-4)
    parts = [str(channel.part) for channel in test.channels]
    assert parts[:2] == ["command", "measured"]
    assert all(channel.reason for channel in test.channels)
