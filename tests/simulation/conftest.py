"""Records for the tests of the loop."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

RecordOf = Callable[[np.random.Generator], tuple[NDArray[np.float64], float]]


@pytest.fixture(scope="session")
def random_record() -> RecordOf:
    """Make an accelerogram: modulated, coloured noise with a step that records have."""

    def make(rng: np.random.Generator) -> tuple[NDArray[np.float64], float]:
        time_step = float(rng.choice([0.0025, 0.005, 0.01, 0.02]))
        t = np.arange(0.0, rng.uniform(15.0, 40.0), time_step)
        envelope = (t / 6.0) ** 2 * np.exp(-t / rng.uniform(2.0, 5.0))
        noise = lfilter(
            [1.0], [1.0, -np.exp(-time_step * rng.uniform(5.0, 40.0))], rng.standard_normal(t.size)
        )
        return 3.0 * envelope * noise / np.std(noise), time_step

    return make


@pytest.fixture(scope="session")
def benchmark_partition():
    """Make the partition of a case of the benchmark, of which facts are published; a study holds it."""
    return pytest.importorskip("reliab_studies.rths_benchmark.benchmark").benchmark_partition
