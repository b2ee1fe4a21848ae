"""Value objects of the loop refuse what makes no sense."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.model import Actuator
from reliab.simulation.linear_loop.cells import Cells
from reliab.structures.structure import Structure


@pytest.mark.parametrize(
    "wrong",
    [
        {"frequency": 0.0},
        {"frequency": np.nan},
        {"damping_ratio": 2.0},
        {"damping_ratio": 0.0},
        {"experimental_fraction": 0.0},
        {"experimental_fraction": 1.1},
    ],
)
def test_structure(wrong):
    with pytest.raises(InputError, match="must"):
        Structure(**{"frequency": 1.0, "damping_ratio": 0.02, **wrong})


@pytest.mark.parametrize("wrong", [{"gain": 0.0}, {"gain": np.inf}, {"delay": -1e-3}, {"delay": np.nan}])
def test_actuator(wrong):
    with pytest.raises(InputError, match="must"):
        Actuator(**wrong)


@pytest.mark.parametrize(("gain", "delay"), [(np.nan, 0.0), (-1.0, 0.0), (1.0, -1.0)])
def test_cells(gain, delay):
    with pytest.raises(InputError, match="must"):
        Cells(
            structure=Structure(frequency=1.0, damping_ratio=0.02),
            gain=np.array([gain]),
            delay=np.array([delay]),
        )


@pytest.mark.parametrize("window", [(0.0, 11.0), (5.0, 5.0), (-1.0, 3.0)])
def test_window(window):
    with pytest.raises(InputError, match="window"):
        Excitation(acceleration=np.ones(101), time_step=0.1, window=window)


def test_the_record_since_a_time_has_the_same_samples_in_its_window():
    record = np.arange(1001.0)
    complete = Excitation(acceleration=record, time_step=0.01, window=(6.003, 8.5))
    later = complete.since(4.0)
    left_out = record.size - later.acceleration.size
    assert left_out == 399
    assert later.acceleration[0] == record[left_out]
    assert later.window == pytest.approx((6.003 - 3.99, 8.5 - 3.99))
    assert complete.since(-1.0).acceleration.size == record.size
