"""R-hat and effective sizes are the ones that other programs give."""

import numpy as np
import pytest

from reliab.sampling.posterior_sample import diagnose


def test_r_hat_and_effective_sizes_are_those_of_arviz():
    """Of `arviz.rhat` and `arviz.ess` of ArviZ 0.23.4 for chains that drift and mix slowly."""
    steps = np.random.default_rng(7).normal(size=(4, 60, 12, 2)).cumsum(axis=1)
    draws = 0.2 * steps + np.random.default_rng(8).normal(size=steps.shape)
    found = diagnose(draws, ("first", "second"), 1)
    assert found.r_hat == pytest.approx([1.0494420699778853, 1.074017193162151], rel=1e-9)
    assert found.bulk_size == pytest.approx([127.68912472561152, 111.69269751338625], rel=1e-9)
    assert found.tail_size == pytest.approx([312.4976634048946, 175.2148084866827], rel=1e-9)
