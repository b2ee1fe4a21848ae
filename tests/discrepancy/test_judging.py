"""How models are compared by the errors on left-out tests, by evidence and by prior odds."""

from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.fitting import search
from reliab.discrepancy.fitting.error_search import ErrorSearch
from reliab.discrepancy.fitting.left_out import LeftOut
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.naming.naming import calibrate_plainly
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.general.general_terms import general_terms
from reliab.effects.registry import find_effect

CUBIC, VISCOUS = find_effect("cubic_stiffness"), find_effect("viscous_damping")
TERM, OTHER_TERM = general_terms(Block.SPECIMEN)[:2]
HYSTERESIS = find_effect("hysteresis")


def errors(energies, *, foretold=None, units=None):
    single = np.ones(len(energies))
    return LeftOut(
        energies=np.array(energies, dtype=float),
        signals=4.0 * single,
        units=single if units is None else np.array(units),
        foretold=single > 0.0 if foretold is None else np.array(foretold),
    )


def test_an_error_is_at_most_itself_and_its_multiple():
    error = errors([1.0, 3.0])
    assert error.is_at_most(1.0, error)
    assert not error.is_at_most(1.0 - 1e-12, error)
    assert errors([2.0, 6.0]).is_at_most(2.0, error)
    assert not errors([2.0, 6.1]).is_at_most(2.0, error)


def test_only_foretold_tests_are_compared():
    assert errors([1.0, 99.0], foretold=[True, False]).is_at_most(1.0, errors([1.0, 1.0]))
    assert not errors([99.0, 1.0], foretold=[True, False]).is_at_most(1.0, errors([1.0, 99.0]))


def test_tests_count_alike_whatever_their_amplitude():
    assert errors([8.0, 0.1], units=[100.0, 1.0]).energy == pytest.approx(0.18)
    assert errors([3.0, 1.0]).nrmse == pytest.approx(np.sqrt(4.0 / 8.0))


class SearchOfScores(Search):
    """Models with given energies in training and on a left-out test; noise judges."""

    def __init__(self, energies, left_out):
        self.rejected, self.fitted, self.left = {}, {}, left_out
        for effects, energy in energies.items():
            names = [str(effect.name) for effect in effects]
            space = SimpleNamespace(
                effects=effects, names=names, key=frozenset(names), block=None, energy=energy
            )
            self.fitted[frozenset(names)] = SimpleNamespace(
                space=space,
                residual=np.array([np.sqrt(energy)]),
                noise=None,
                coordinates=None,
                log_evidence=-0.5 * energy,
            )
        self.null = self.fitted[frozenset()]
        self.problem = SimpleNamespace(
            whiten=lambda space, *_: np.array([np.sqrt(space.energy)]),
            block=SimpleNamespace(twins={}),
        )

    @staticmethod
    def _acts(_candidate, _kind):
        return True

    def error(self, candidate):
        return errors([self.left[candidate.space.effects]])

    def fit_of(self, *effects):
        return self.fitted[frozenset(str(effect.name) for effect in effects)]

    def supports(self, *effects):
        return self.is_supported(self.fit_of(*effects))

    def matters(self, larger, smaller):
        return self._matters(self.fit_of(*larger), self.fit_of(*smaller))


@pytest.mark.parametrize(("growth", "matters"), [(1.015, True), (1.025, False)])
def test_further_effect_may_predict_worse_by_the_noise(growth, matters):
    """It closes two hundredths of the gap, and the error on left-out tests grows."""
    training = {(): 1000.0, (CUBIC,): 120.0, (VISCOUS,): 900.0, (CUBIC, VISCOUS): 102.0}
    left_out = {(CUBIC,): 1.0, (VISCOUS,): 9.0, (CUBIC, VISCOUS): growth}
    assert SearchOfScores(training, left_out).matters((CUBIC, VISCOUS), (CUBIC,)) is matters


@pytest.mark.parametrize(("share_left", "is_supported"), [(0.997, True), (0.9995, False)])
def test_dispensable_effect_is_not_named(share_left, is_supported):
    """Evidence praises it; the error on left-out tests is the same to a thousandth of its RMS."""
    training = {(): 1000.0, (CUBIC,): 120.0, (VISCOUS,): 900.0, (CUBIC, VISCOUS): 60.0}
    left_out = {(): 1.0, (CUBIC,): share_left, (VISCOUS,): 9.0, (CUBIC, VISCOUS): share_left * share_left}
    assert SearchOfScores(training, left_out).supports(CUBIC) is is_supported
    assert SearchOfScores(training, left_out).supports(CUBIC, VISCOUS) is is_supported


def test_effect_within_its_uncertainty_of_zero_is_not_named():
    models = SearchOfScores({(): 1000.0, (CUBIC,): 120.0}, {(): 1.0, (CUBIC,): 0.1})
    assert models.supports(CUBIC)
    models._acts = lambda _candidate, _kind: False  # noqa: SLF001 - what is replaced
    assert not models.supports(CUBIC)


@pytest.mark.parametrize(("prediction", "is_supported"), [(0.80, True), (0.82, False)])
def test_a_trifle_beside_others_predicts_a_tenth_better(prediction, is_supported):
    """It closes less than a hundredth of the gap, but a tenth of the RMS of what is left."""
    training = {(): 10_000.0, (CUBIC,): 50.0, (VISCOUS,): 9000.0, (CUBIC, VISCOUS): 30.0}
    left_out = {(CUBIC,): 1.0, (VISCOUS,): 9.0, (CUBIC, VISCOUS): prediction}
    assert SearchOfScores(training, left_out).supports(CUBIC, VISCOUS) is is_supported


def test_every_effect_costs_prior_odds_and_one_outside_the_library_more():
    models = SearchOfScores({(): 100.0, (CUBIC,): 60.0, (TERM,): 60.0, (CUBIC, VISCOUS): 60.0}, {})
    null, single, general, two = (models.score(fit) for fit in models.fitted.values())
    assert null == pytest.approx(-50.0)
    assert single == pytest.approx(-30.0 - 4.0)
    assert general == pytest.approx(-30.0 - 7.0)
    assert two == pytest.approx(-30.0 - 8.0)
    assert models.best.space.effects == (CUBIC,)


@pytest.mark.parametrize(("remaining", "is_supported"), [(0.75e-4, True), (0.85e-4, False)])
def test_audible_effect_is_named_beside_a_much_larger_one(remaining, is_supported):
    energies = {(): 1.0, (CUBIC,): 1e-4, (VISCOUS,): 0.9, (CUBIC, VISCOUS): remaining}
    assert SearchOfScores(energies, energies).supports(CUBIC, VISCOUS) is is_supported


@pytest.mark.parametrize(("share_left", "matters"), [(98.1, False), (97.95, True)])
def test_term_outside_the_library_takes_a_fiftieth_off_the_remainder(share_left, matters):
    models = SearchOfScores({(): 100.0, (TERM,): share_left}, {(): 1.0, (TERM,): 0.5})
    assert models.matters((TERM,), ()) is matters


class SearchOfGains(SearchOfScores, Search):
    """A search among models that are all fitted; what is promising is given."""

    promising = ()

    def screen(self, *_):
        return list(self.promising)

    def reaches(self, candidate, first):
        return self._is_near(candidate, first)

    def refined_count(self, *rough):
        return self._worth_refining(rough, self.null)


class ExtendedSearch(SearchOfGains):
    """A search in which what takes ten off the energy matters, and every fit is kept."""

    def _matters(self, larger, smaller):
        return larger.space.energy < smaller.space.energy - 10.0

    def keep(self, candidate):
        return candidate


def test_only_models_within_seven_nats_of_the_best_are_settled():
    """The evidence is minus half the energy; every effect costs four."""
    training = {(): 100.0, (CUBIC,): 60.0, (VISCOUS,): 73.0, (CUBIC, VISCOUS): 80.0}
    models = SearchOfGains(training, {})
    calls = []
    models.is_supported = lambda candidate: calls.append(candidate.space.effects) or True
    models.settle()
    assert sorted(map(str, calls)) == sorted(map(str, [(CUBIC,), (VISCOUS,)]))


def test_unsupported_model_makes_room_for_the_next():
    training = {(): 100.0, (CUBIC,): 20.0, (VISCOUS,): 60.0}
    models = SearchOfGains(training, {})
    models.is_supported = lambda candidate: candidate.space.effects != (CUBIC,)
    models.settle()
    assert models.best.space.effects == (VISCOUS,)


def test_rough_fits_are_refined_from_half_the_gain_and_within_a_hundred_nats():
    models = SearchOfGains({(): 3000.0, (CUBIC,): 1000.0}, {})
    assert models.refined_count(models.fit_of(CUBIC)) == pytest.approx(-1000.0)
    models = SearchOfGains({(): 300.0, (CUBIC,): 260.0}, {})
    assert models.refined_count(models.fit_of(CUBIC)) == pytest.approx(-230.0)
    assert models.refined_count() == -np.inf


@pytest.mark.parametrize(
    ("gains", "tried_effects"), [([1000, 21, 19], [1000, 21]), ([50, 4.1, 3.9], [50, 4.1])]
)
def test_only_promising_effects_are_fitted(gains, tried_effects):
    models, calls = SearchOfGains({(): 100.0}, {}), []
    models.promising = [SimpleNamespace(gain=float(gain)) for gain in gains]
    models.extend = lambda _parent, promising: calls.extend(item.gain for item in promising) or []
    assert models.forward(models.null, ()) is models.null
    assert calls == tried_effects


@pytest.mark.parametrize(("twins", "tried_effects"), [({}, [10.0]), ({VISCOUS: (CUBIC,)}, [10.0, 0.1])])
def test_effect_hidden_by_calibration_is_always_fitted(twins, tried_effects):
    models, calls = SearchOfGains({(): 100.0}, {}), []
    models.promising = [SimpleNamespace(gain=10.0, kind=CUBIC), SimpleNamespace(gain=0.1, kind=VISCOUS)]
    models.problem.block = SimpleNamespace(twins=twins)
    models.extend = lambda _parent, promising: calls.extend(effect.gain for effect in promising) or []
    models.forward(models.null, ())
    assert calls == tried_effects


@pytest.mark.parametrize(
    ("kind", "name", "starts"),
    [
        (ErrorSearch, "hysteresis", 3),
        (ErrorSearch, "second_order_dynamics", 1),
        (Search, "hysteresis", 1),
    ],
)
def test_effects_of_several_parameters_are_fitted_from_all_starts_where_parts_judge(kind, name, starts):
    first, *remaining = (np.array([place]) for place in (1.0, 2.0, 3.0))
    promise = SimpleNamespace(kind=find_effect(name), start=first, others=(first, *remaining))
    assert len(kind._starts(None, promise)) == starts  # noqa: SLF001 - what is tested


@pytest.mark.parametrize(("second", "share_left"), [(99.0, (CUBIC,)), (20.0, (CUBIC, VISCOUS))])
def test_needless_effect_is_removed_but_never_the_last(second, share_left):
    """The second effect brings the energy from 100 to 99 or to 20; the first one matters to no one."""
    models = ExtendedSearch({(): 100.0, (CUBIC,): 100.0, (VISCOUS,): 100.0, (CUBIC, VISCOUS): second}, {})
    models.remove_effect = lambda best, kind: models.fit_of(
        *(rival for rival in best.space.effects if rival is not kind)
    )
    models.fit_of(CUBIC).log_evidence += 0.1
    assert models.backward(models.fit_of(CUBIC, VISCOUS)).space.effects == share_left


@pytest.mark.parametrize(("energy", "reaches"), [(55.0, True), (57.0, False)])
def test_model_with_half_of_the_best_gain_is_extended(energy, reaches):
    """Scores are minus half the energy and four for each effect: −50, −14 and about the mean, −32."""
    models = SearchOfGains({(): 100.0, (CUBIC,): 20.0, (VISCOUS,): energy}, {})
    assert models.reaches(models.fit_of(VISCOUS), models.fit_of(CUBIC)) is reaches


def test_remainder_matters_from_three_thousandths_of_the_explained():
    """Likelihoods are minus half the energy; a term outside the library costs seven, its first gain four."""
    models = SearchOfGains({(): 20_000.0, (CUBIC,): 0.0}, {})
    for candidate in models.fitted.values():
        candidate.log_likelihood = candidate.log_evidence
    assert models.noticeable(models.null) == pytest.approx(11.0)
    assert models.noticeable(models.fit_of(CUBIC)) == pytest.approx(11.0 + 30.0)


@pytest.mark.parametrize(
    ("energy", "converts", "anew"), [(20.0, True, True), (20.0, False, False), (99.0, True, False)]
)
def test_a_search_begins_anew_where_a_model_expects_an_error_of_the_converter(energy, converts, anew):
    """At an energy of 99 instead of 100 the effect does not pay for itself: the best model is without it."""
    models = SearchOfGains({(): 100.0, (CUBIC,): energy}, {})
    second = object()
    models.problem.correct_conversion = lambda _space, _coordinates: second if converts else models.problem
    models.move_to = lambda problem: ("on", problem)
    assert models.rerun_converted() == (("on", second) if anew else models)


def test_a_plain_calibration_weighs_every_frequency_alike():
    """Noise that grows with frequency: the mean of its density from zero to half the rate."""
    models = SearchOfGains({(): 100.0}, {})
    models.null.noise = SimpleNamespace(density=lambda frequency: 3.0 + frequency, rate=100.0)
    models.problem.block = SimpleNamespace(rate=100.0)
    with patch("reliab.discrepancy.naming.naming.fit", lambda *arguments: arguments):
        _problem, space, starts, noise = calibrate_plainly(models, models.null)
    assert (space, starts) == (models.null.space, [models.null.coordinates])
    assert noise.rate == 100.0
    assert noise.density(np.array([1.0, 49.0])) == pytest.approx(3.0 + 25.0)


class SearchByParts(SearchOfScores, ErrorSearch):
    """The same where no noise is known and left-out parts judge."""


def test_where_errors_judge_a_score_is_the_likelihood_of_left_out_tests_less_prior_odds():
    """Nine observations of an energy of 1/2 over signals of four: −(9/2) ln(1/8), and one for an effect."""
    models = SearchByParts({(): 100.0, (CUBIC,): 50.0}, {(): 2.0, (CUBIC,): 0.5})
    models.problem.tempering, models.problem.segments = (1.0,), (SimpleNamespace(bins=5),)
    energy = models.error(models.fit_of(CUBIC)).energy
    assert models.score(models.fit_of(CUBIC)) == pytest.approx(-4.5 * np.log(energy) - 1.0)


def test_observations_are_the_tempered_rows_of_all_segments():
    """A real part at zero frequency and two parts at each further one."""
    models = SearchByParts({(): 100.0}, {})
    models.problem.tempering = (0.5, 0.25)
    models.problem.segments = (SimpleNamespace(bins=10), SimpleNamespace(bins=4))
    assert models.observations == pytest.approx(0.5 * 19.0 + 0.25 * 7.0)


@pytest.mark.parametrize("spread", [True, False])
def test_an_offset_of_the_clocks_beside_effects_needs_little_only_where_noise_is_left(spread):
    def model(kinds):
        return SimpleNamespace(space=SimpleNamespace(effects=tuple(kinds)))

    search = SimpleNamespace(
        problem=SimpleNamespace(block=SimpleNamespace(twins={ClockOffset: (VISCOUS,)})), fitted={}
    )
    late = model((CUBIC, ClockOffset))
    with patch("reliab.discrepancy.fitting.search.is_spread", return_value=spread) as spread_test:
        assert Search._is_shift(search, late, {ClockOffset}) is spread  # noqa: SLF001 - what is tested
    spread_test.assert_called_once_with(search.problem, late)


@pytest.mark.parametrize(
    ("share_left", "reaches"),
    [
        ([0.01], True),
        ([0.5, 0.01], True),  # a rough fit leaves noise: no other is tried
        ([0.5, 0.4, 0.01], True),  # the refined one does
        ([0.5, 0.4, 0.3, 0.3, 0.2, 0.2, 0.1], False),
    ],
)
def test_noise_judges_only_where_a_few_effects_can_leave_it(monkeypatch, share_left, reaches):
    shares = iter(share_left)
    monkeypatch.setattr(search, "is_model_error", lambda *_: next(shares) > 0.05)
    monkeypatch.setattr(search, "refine_fit", lambda _, model: model)
    begun = SimpleNamespace(
        problem=SimpleNamespace(block=SimpleNamespace(outside=())),
        null=None,
        candidates=(),
        screen=lambda *_: [SimpleNamespace(start=np.zeros(1))],
        _rough=lambda *_: [SimpleNamespace(log_likelihood=0.0)],
    )
    assert search.Search.reaches_noise(begun) is reaches
    assert next(shares, None) is None


@pytest.mark.parametrize(
    ("best", "tried"),
    [
        ((CUBIC, TERM), {(TERM,): {HYSTERESIS}, (CUBIC,): {HYSTERESIS, OTHER_TERM}}),
        ((CUBIC,), {}),
        ((CUBIC, VISCOUS), {}),
    ],
)
def test_others_are_tried_in_the_place_of_each_effect_beside_another(best, tried):
    """Of the library in that of its main one; in that of a single one they were tried before."""
    left_out = {(): 1.0, (CUBIC,): 0.6, (TERM,): 0.5, (VISCOUS,): 0.9} | {best: 0.2}
    models = SearchByParts({effects: 100.0 * error for effects, error in left_out.items()}, left_out)
    models.problem.block = SimpleNamespace(
        linear=(VISCOUS,), candidates=(CUBIC, HYSTERESIS), outside=(TERM, OTHER_TERM)
    )
    calls = {}
    models._children = lambda parents, kinds, _: calls.update({parents[0].space.effects: set(kinds)})  # noqa: SLF001
    models._try_rivals()  # noqa: SLF001 - what is tested
    assert calls == tried
