"""Records for the tests of the loop."""

import numpy as np
import pytest
from scipy.signal import lfilter

from reliab.simulation.excitation import Excitation


@pytest.fixture(scope="session")
def random_excitation():
    """Make an excitation from a seed: modulated, coloured noise with a step that records have."""

    def make(seed, window=(0.0, -1.0)):
        rng = np.random.default_rng(seed)
        time_step = float(rng.choice([0.0025, 0.005, 0.01, 0.02]))
        t = np.arange(0.0, rng.uniform(15.0, 40.0), time_step)
        envelope = (t / 6.0) ** 2 * np.exp(-t / rng.uniform(2.0, 5.0))
        noise = lfilter(
            [1.0], [1.0, -np.exp(-time_step * rng.uniform(5.0, 40.0))], rng.standard_normal(t.size)
        )
        acceleration = 3.0 * envelope * noise / np.std(noise)
        return Excitation(acceleration=acceleration, time_step=time_step, window=window)

    return make


@pytest.fixture(scope="session")
def benchmark_partition():
    """Make the partition of a case of the benchmark, of which facts are published; a study holds it."""
    return pytest.importorskip("reliab_studies.rths_benchmark.benchmark").benchmark_partition
