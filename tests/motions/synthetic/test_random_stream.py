"""Random numbers: uniform, normal, independent, and the same for ever."""

import numpy as np
from scipy import stats

from reliab.motions.synthetic.random_stream import RandomStream


def test_numbers_are_uniform_and_normal() -> None:
    assert stats.kstest(RandomStream(1, 2).uniforms(20_000), "uniform").pvalue > 0.01
    assert stats.kstest(RandomStream(1, 3).normals(20_000), "norm").pvalue > 0.01


def test_streams_of_different_keys_are_independent() -> None:
    first, second, third = (RandomStream(1, *key).normals(20_000) for key in [(1,), (2,), (1, 0)])
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.03
    assert abs(np.corrcoef(first, third)[0, 1]) < 0.03


def test_stream_does_not_depend_on_how_it_is_read() -> None:
    piecewise = RandomStream(5)
    parts = [piecewise.uniforms(3), piecewise.uniforms(1), [piecewise.uniform()]]
    assert np.array_equal(np.concatenate(parts), RandomStream(5).uniforms(5))


def test_bits_are_those_of_the_algorithm() -> None:
    """NumPy makes a uniform number of the same 53 bits, without the half step that keeps ours off zero."""
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(2017, spawn_key=(1,))))
    assert np.array_equal(RandomStream(2017, 1).uniforms(9), generator.random(9) + 2.0**-54)
