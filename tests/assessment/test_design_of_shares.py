"""Tolerable errors before a test of a structure that stands in the laboratory in part."""

import numpy as np
import pytest

from reliab.app.api.design import design_test
from reliab.core.errors import InputError
from reliab.criterion.experimental_share import growth
from reliab.structures.structure import Structure, critical_delay


def test_limits_grow_by_the_law_of_the_share_and_the_loop_is_stable_for_longer():
    full_test, part = (
        design_test(f=1, xi=0.02, alpha=alpha, confidence=0.95).tolerances[0] for alpha in (1, 0.5)
    )
    assert part.a / full_test.a == pytest.approx(growth(0.5, 0.02))
    assert part.b / full_test.b == pytest.approx(growth(0.5, 0.02))
    expected = critical_delay(Structure(frequency=1.0, damping_ratio=0.02, experimental_fraction=0.5))
    assert part.critical_delay == pytest.approx(float(expected))
    assert part.critical_delay > full_test.critical_delay
    assert (full_test.to_dict()["alpha"], part.to_dict()["alpha"]) == (1.0, 0.5)


@pytest.mark.parametrize(
    ("alpha", "words"), [(0.1, "at least 10 ξ"), (1.2, "at most 1"), ("0.5±0.1", "exact")]
)
def test_a_share_without_a_law_is_refused(alpha, words):
    with pytest.raises(InputError, match=words):
        design_test(f=1, xi=0.02, alpha=alpha)


def test_a_criterion_of_ones_own_speaks_for_its_own_share():
    from reliab.criterion.derivation import published_criterion

    criterion = published_criterion("guo_2017_18")
    with pytest.raises(InputError, match="alpha"):
        design_test(f=1, xi=0.02, alpha=0.5, criterion=criterion)
    assert np.isfinite(design_test(f=1, xi=0.02, alpha=1, criterion=criterion).tolerances[0].a)
