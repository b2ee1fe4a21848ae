"""How models are compared by the errors on left-out tests, by evidence and by prior odds."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.fitting.fitted_models import FittedModels
from reliab.discrepancy.fitting.left_out import LeftOut
from reliab.discrepancy.terms import outside_terms
from reliab.loop.effects import find_effect
from reliab.vocabulary import Block

CUBIC, VISCOUS = find_effect("cubic_stiffness"), find_effect("viscous_damping")
TERM = outside_terms(Block.SPECIMEN)[0]


def errors(energies, *, foretold=None, units=None):
    one = np.ones(len(energies))
    return LeftOut(
        energies=np.array(energies, dtype=float),
        signals=4.0 * one,
        units=one if units is None else np.array(units),
        foretold=one > 0.0 if foretold is None else np.array(foretold),
    )


def test_an_error_is_at_most_itself_and_its_multiple():
    error = errors([1.0, 3.0])
    assert error.at_most(1.0, error)
    assert not error.at_most(1.0 - 1e-12, error)
    assert errors([2.0, 6.0]).at_most(2.0, error)
    assert not errors([2.0, 6.1]).at_most(2.0, error)


def test_only_tests_that_the_others_foretell_are_compared():
    assert errors([1.0, 99.0], foretold=[True, False]).at_most(1.0, errors([1.0, 1.0]))
    assert not errors([99.0, 1.0], foretold=[True, False]).at_most(1.0, errors([1.0, 99.0]))


def test_tests_count_alike_whatever_their_amplitude():
    assert errors([8.0, 0.1], units=[100.0, 1.0]).energy == pytest.approx(0.18)
    assert errors([3.0, 1.0]).nrmse == pytest.approx(np.sqrt(4.0 / 8.0))


@pytest.mark.parametrize(("ratios", "undecided"), [([2.0, 0.6], True), ([2.0, 2.2], False), ([2.0], True)])
def test_a_difference_within_its_standard_error_is_undecided(ratios, undecided):
    """Of two logarithms x and y, the mean is (x + y)/2 and its standard error |x − y|/2."""
    rival = errors(np.ones(len(ratios)))
    assert errors(ratios).undecided(rival) is undecided
    if len(ratios) > 1:
        x, y = np.log(ratios)
        assert bool(abs(x + y) < abs(x - y)) is undecided


class Judged(FittedModels):
    """Models with given energies in training and on a left-out test; noise judges."""

    def __init__(self, energies, left_out):
        self.rejected, self.fitted, self.left = set(), {}, left_out
        for effects, energy in energies.items():
            names = [str(effect.name) for effect in effects]
            space = SimpleNamespace(effects=effects, names=names, block=None, energy=energy)
            self.fitted[frozenset(names)] = SimpleNamespace(
                space=space,
                residual=np.array([np.sqrt(energy)]),
                noise=None,
                coordinates=None,
                log_evidence=-0.5 * energy,
            )
        self.null = self.fitted[frozenset()]
        self.problem = SimpleNamespace(
            flat=False, whitened=lambda space, *_: np.array([np.sqrt(space.energy)])
        )

    def error(self, candidate):
        return errors([self.left[candidate.space.effects]])

    def supports(self, *effects):
        return self.supported(self.fitted[frozenset(str(effect.name) for effect in effects)])


@pytest.mark.parametrize(("growth", "supported"), [(1.015, True), (1.025, False)])
def test_an_effect_beside_others_may_predict_worse_by_what_noise_brings_about(growth, supported):
    """It closes two hundredths of the gap, and the error on left-out tests grows."""
    training = {(): 1000.0, (CUBIC,): 120.0, (VISCOUS,): 900.0, (CUBIC, VISCOUS): 102.0}
    left_out = {(CUBIC,): 1.0, (VISCOUS,): 9.0, (CUBIC, VISCOUS): growth}
    assert Judged(training, left_out).supports(CUBIC, VISCOUS) is supported


@pytest.mark.parametrize(("predicted", "supported"), [(0.80, True), (0.82, False)])
def test_a_trifle_beside_others_predicts_a_tenth_better(predicted, supported):
    """It closes less than a hundredth of the gap, but a tenth of the RMS of what is left."""
    training = {(): 10_000.0, (CUBIC,): 50.0, (VISCOUS,): 9000.0, (CUBIC, VISCOUS): 30.0}
    left_out = {(CUBIC,): 1.0, (VISCOUS,): 9.0, (CUBIC, VISCOUS): predicted}
    assert Judged(training, left_out).supports(CUBIC, VISCOUS) is supported


def test_every_effect_costs_prior_odds_and_one_outside_the_library_more():
    models = Judged({(): 100.0, (CUBIC,): 60.0, (TERM,): 60.0, (CUBIC, VISCOUS): 60.0}, {})
    null, one, outside, two = (models.score(fit) for fit in models.fitted.values())
    assert null == pytest.approx(-50.0)
    assert one == pytest.approx(-30.0 - 4.0)
    assert outside == pytest.approx(-30.0 - 7.0)
    assert two == pytest.approx(-30.0 - 8.0)
    assert models.best.space.effects == (CUBIC,)
