"""Where errors judge, an effect is named if it explains more of what others leave than remains."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.fitting.left_out import LeftOut
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.terms.outside_terms import outside_terms
from reliab.effects.registry import find_effect

CUBIC, VISCOUS = find_effect("cubic_stiffness"), find_effect("viscous_damping")
LAG, SECOND_ORDER = find_effect("first_order_lag"), find_effect("second_order_dynamics")
TERM = outside_terms(Block.SPECIMEN)[0]
WHOLE = 1.0  # energy that the calibrated model leaves


class Known(Search):
    """Models that leave given energies, in training as on left-out tests."""

    def __init__(self, energies, *, flat=True):
        self.rejected = {}
        self.fitted = {}
        for effects, energy in {(): WHOLE, **energies}.items():
            names = [str(effect.name) for effect in effects]
            space = SimpleNamespace(effects=effects, names=names, block=None, energy=energy)
            residual = np.array([np.sqrt(energy)])
            self.fitted[frozenset(names)] = SimpleNamespace(
                space=space, residual=residual, noise=None, coordinates=None
            )
        self.null = self.fitted[frozenset()]
        self.problem = SimpleNamespace(
            flat=flat,
            tempering=(1.0,),
            segments=(SimpleNamespace(bins=30),),
            whitened=lambda space, *_: np.array([np.sqrt(space.energy)]),
            block=SimpleNamespace(twins={}),
        )

    @staticmethod
    def _acts(_candidate, _kind):
        return True

    def error(self, candidate):
        one = np.ones(1)
        return LeftOut(energies=candidate.space.energy * one, signals=one, units=one, foretold=one > 0.0)

    def supports(self, *effects):
        return self.supported(self.fitted[frozenset(str(effect.name) for effect in effects)])


@pytest.mark.parametrize(("remaining", "supported"), [(0.04, True), (0.055, False)])
def test_a_second_effect_explains_more_of_the_first_one_s_error_than_it_leaves(remaining, supported):
    models = Known({(CUBIC,): 0.1, (VISCOUS,): 0.9, (CUBIC, VISCOUS): remaining})
    assert models.supports(CUBIC, VISCOUS) is supported
    assert models.supports(CUBIC)


@pytest.mark.parametrize(("remaining", "supported"), [(0.008, True), (0.012, False)])
def test_beside_a_far_larger_effect_one_is_named_that_takes_more_than_half_of_what_that_leaves(
    remaining, supported
):
    """The first effect leaves a fiftieth of the whole gap, so that the second can take no thirtieth of it."""
    models = Known({(CUBIC,): 0.02, (VISCOUS,): 0.9, (CUBIC, VISCOUS): remaining})
    assert models.supports(CUBIC, VISCOUS) is supported


def test_an_effect_of_many_parameters_may_be_no_more_than_what_a_far_larger_one_leaves():
    hysteresis = find_effect("hysteresis")
    models = Known({(CUBIC,): 0.02, (hysteresis,): 0.9, (CUBIC, hysteresis): 0.002})
    assert not models.supports(CUBIC, hysteresis)


@pytest.mark.parametrize(("remaining", "supported"), [(0.75e-4, True), (0.85e-4, False)])
def test_beside_a_much_larger_effect_one_is_named_that_takes_a_tenth_off_the_noise(remaining, supported):
    models = Known({(CUBIC,): 1e-4, (VISCOUS,): 0.9, (CUBIC, VISCOUS): remaining}, flat=False)
    assert models.supports(CUBIC, VISCOUS) is supported


@pytest.mark.parametrize(("remaining", "supported"), [(0.04, True), (0.055, False)])
def test_a_term_outside_the_library_explains_more_of_what_the_library_leaves_than_remains(
    remaining, supported
):
    assert Known({(CUBIC,): 0.1, (TERM,): remaining}).supports(TERM) is supported


def test_a_term_outside_the_library_stands_where_no_member_explains_anything():
    assert Known({(TERM,): 0.6}).supports(TERM)


@pytest.mark.parametrize(("remaining", "supported"), [(0.07, True), (0.095, False)])
def test_an_effect_predicts_better_than_its_limiting_case(remaining, supported):
    models = Known({(LAG,): 0.1, (SECOND_ORDER,): remaining})
    assert models.supports(SECOND_ORDER) is supported
    assert models.supports(LAG)


def test_a_limiting_case_counts_although_it_was_rejected_itself():
    """Friction beside a spring explains too little to be named; hysteresis that is friction says no more."""
    hysteresis, friction = find_effect("hysteresis"), find_effect("coulomb_friction")
    energies = {(CUBIC,): 0.9, (friction,): 0.1, (hysteresis,): 0.11, (CUBIC, friction): 0.055}
    models = Known({**energies, (CUBIC, hysteresis): 0.05})
    assert not models.supports(CUBIC, friction)
    models._reject(models.fitted[frozenset({"cubic_stiffness", "coulomb_friction"})])  # noqa: SLF001 - as the search does
    assert not models.supports(CUBIC, hysteresis)
