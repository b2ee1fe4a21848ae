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
from reliab.discrepancy.terms import ClockOffset
from reliab.effects.general.general_terms import general_terms
from reliab.effects.registry import find_effect

CUBIC, VISCOUS = find_effect("cubic_stiffness"), find_effect("viscous_damping")
TERM = general_terms(Block.SPECIMEN)[0]


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
    assert error.is_at_most(1.0, error)
    assert not error.is_at_most(1.0 - 1e-12, error)
    assert errors([2.0, 6.0]).is_at_most(2.0, error)
    assert not errors([2.0, 6.1]).is_at_most(2.0, error)


def test_only_tests_that_the_others_foretell_are_compared():
    assert errors([1.0, 99.0], foretold=[True, False]).is_at_most(1.0, errors([1.0, 1.0]))
    assert not errors([99.0, 1.0], foretold=[True, False]).is_at_most(1.0, errors([1.0, 99.0]))


def test_tests_count_alike_whatever_their_amplitude():
    assert errors([8.0, 0.1], units=[100.0, 1.0]).energy == pytest.approx(0.18)
    assert errors([3.0, 1.0]).nrmse == pytest.approx(np.sqrt(4.0 / 8.0))


class Judged(Search):
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

    def with_effects(self, *effects):
        return self.fitted[frozenset(str(effect.name) for effect in effects)]

    def supports(self, *effects):
        return self.is_supported(self.with_effects(*effects))

    def matters(self, larger, smaller):
        return self._matters(self.with_effects(*larger), self.with_effects(*smaller))


@pytest.mark.parametrize(("growth", "matters"), [(1.015, True), (1.025, False)])
def test_an_effect_beside_others_is_tried_though_it_predicts_worse_by_what_noise_brings_about(
    growth, matters
):
    """It closes two hundredths of the gap, and the error on left-out tests grows."""
    training = {(): 1000.0, (CUBIC,): 120.0, (VISCOUS,): 900.0, (CUBIC, VISCOUS): 102.0}
    left_out = {(CUBIC,): 1.0, (VISCOUS,): 9.0, (CUBIC, VISCOUS): growth}
    assert Judged(training, left_out).matters((CUBIC, VISCOUS), (CUBIC,)) is matters


@pytest.mark.parametrize(("left", "supported"), [(0.997, True), (0.9995, False)])
def test_no_effect_is_named_without_which_tests_are_predicted_as_well(left, supported):
    """Evidence praises it; the error on left-out tests is the same to a thousandth of its RMS."""
    training = {(): 1000.0, (CUBIC,): 120.0, (VISCOUS,): 900.0, (CUBIC, VISCOUS): 60.0}
    left_out = {(): 1.0, (CUBIC,): left, (VISCOUS,): 9.0, (CUBIC, VISCOUS): left * left}
    assert Judged(training, left_out).supports(CUBIC) is supported
    assert Judged(training, left_out).supports(CUBIC, VISCOUS) is supported


def test_no_effect_is_named_whose_parameters_are_within_their_uncertainty_of_none():
    models = Judged({(): 1000.0, (CUBIC,): 120.0}, {(): 1.0, (CUBIC,): 0.1})
    assert models.supports(CUBIC)
    models._acts = lambda _candidate, _kind: False  # noqa: SLF001 - what is replaced
    assert not models.supports(CUBIC)


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


@pytest.mark.parametrize(("remaining", "supported"), [(0.75e-4, True), (0.85e-4, False)])
def test_beside_a_much_larger_effect_one_is_named_that_takes_a_tenth_off_the_noise(remaining, supported):
    energies = {(): 1.0, (CUBIC,): 1e-4, (VISCOUS,): 0.9, (CUBIC, VISCOUS): remaining}
    assert Judged(energies, energies).supports(CUBIC, VISCOUS) is supported


@pytest.mark.parametrize(("left", "matters"), [(98.1, False), (97.95, True)])
def test_a_term_outside_the_library_takes_a_fiftieth_off_what_is_left(left, matters):
    models = Judged({(): 100.0, (TERM,): left}, {(): 1.0, (TERM,): 0.5})
    assert models.matters((TERM,), ()) is matters


class Searched(Judged, Search):
    """A search among models that are all fitted; what is promising is given."""

    promising = ()

    def screen(self, *_):
        return list(self.promising)

    def reaches(self, candidate, first):
        return self._is_near(candidate, first)

    def refined_from(self, *rough):
        return self._worth_refining(rough, self.null)


class Extended(Searched):
    """A search in which what takes ten off the energy matters, and every fit is kept."""

    def _matters(self, larger, smaller):
        return larger.space.energy < smaller.space.energy - 10.0

    def keep(self, candidate):
        return candidate


def test_only_models_within_seven_nats_of_the_best_are_settled():
    """The evidence is minus half the energy; every effect costs four."""
    training = {(): 100.0, (CUBIC,): 60.0, (VISCOUS,): 73.0, (CUBIC, VISCOUS): 80.0}
    models = Searched(training, {})
    asked = []
    models.is_supported = lambda candidate: asked.append(candidate.space.effects) or True
    models.settle()
    assert sorted(map(str, asked)) == sorted(map(str, [(CUBIC,), (VISCOUS,)]))


def test_a_model_that_is_not_supported_makes_room_for_those_behind_it():
    training = {(): 100.0, (CUBIC,): 20.0, (VISCOUS,): 60.0}
    models = Searched(training, {})
    models.is_supported = lambda candidate: candidate.space.effects != (CUBIC,)
    models.settle()
    assert models.best.space.effects == (VISCOUS,)


def test_rough_fits_are_refined_from_half_the_gain_and_within_a_hundred_nats():
    models = Searched({(): 3000.0, (CUBIC,): 1000.0}, {})
    assert models.refined_from(models.with_effects(CUBIC)) == pytest.approx(-1000.0)
    models = Searched({(): 300.0, (CUBIC,): 260.0}, {})
    assert models.refined_from(models.with_effects(CUBIC)) == pytest.approx(-230.0)
    assert models.refined_from() == -np.inf


@pytest.mark.parametrize(("gains", "fitted"), [([1000, 21, 19], [1000, 21]), ([50, 4.1, 3.9], [50, 4.1])])
def test_effects_are_fitted_that_promise_a_fiftieth_of_the_best_and_what_they_cost(gains, fitted):
    models, asked = Searched({(): 100.0}, {}), []
    models.promising = [SimpleNamespace(gain=float(gain)) for gain in gains]
    models.extend = lambda _parent, promising: asked.extend(each.gain for each in promising) or []
    assert models.forward(models.null, ()) is models.null
    assert asked == fitted


@pytest.mark.parametrize(("twins", "fitted"), [({}, [10.0]), ({VISCOUS: (CUBIC,)}, [10.0, 0.1])])
def test_an_effect_that_calibration_hides_is_fitted_whatever_it_promises(twins, fitted):
    models, asked = Searched({(): 100.0}, {}), []
    models.promising = [SimpleNamespace(gain=10.0, kind=CUBIC), SimpleNamespace(gain=0.1, kind=VISCOUS)]
    models.problem.block = SimpleNamespace(twins=twins)
    models.extend = lambda _parent, promising: asked.extend(effect.gain for effect in promising) or []
    models.forward(models.null, ())
    assert asked == fitted


@pytest.mark.parametrize(
    ("kind", "name", "starts"),
    [
        (ErrorSearch, "hysteresis", 3),
        (ErrorSearch, "second_order_dynamics", 1),
        (Search, "hysteresis", 1),
    ],
)
def test_effects_of_several_parameters_are_fitted_from_all_starts_where_parts_judge(kind, name, starts):
    first, *others = (np.array([place]) for place in (1.0, 2.0, 3.0))
    promise = SimpleNamespace(kind=find_effect(name), start=first, others=(first, *others))
    assert len(kind._starts(None, promise)) == starts  # noqa: SLF001 - what is tested


@pytest.mark.parametrize(("second", "left"), [(99.0, (CUBIC,)), (20.0, (CUBIC, VISCOUS))])
def test_an_effect_that_is_not_needed_is_removed_but_never_the_last_one(second, left):
    """The second effect brings the energy from 100 to 99 or to 20; the first one matters to no one."""
    models = Extended({(): 100.0, (CUBIC,): 100.0, (VISCOUS,): 100.0, (CUBIC, VISCOUS): second}, {})
    models.remove_effect = lambda best, kind: models.with_effects(
        *(other for other in best.space.effects if other is not kind)
    )
    models.with_effects(CUBIC).log_evidence += 0.1
    assert models.backward(models.with_effects(CUBIC, VISCOUS)).space.effects == left


@pytest.mark.parametrize(("energy", "reaches"), [(55.0, True), (57.0, False)])
def test_a_model_goes_on_that_gains_more_than_half_of_what_the_best_gains(energy, reaches):
    """Scores are minus half the energy and four for each effect: −50, −14 and about the mean, −32."""
    models = Searched({(): 100.0, (CUBIC,): 20.0, (VISCOUS,): energy}, {})
    assert models.reaches(models.with_effects(VISCOUS), models.with_effects(CUBIC)) is reaches


def test_what_is_left_matters_from_three_thousandths_of_what_is_explained():
    """Likelihoods are minus half the energy; a term outside the library costs seven, its first gain four."""
    models = Searched({(): 20_000.0, (CUBIC,): 0.0}, {})
    for candidate in models.fitted.values():
        candidate.log_likelihood = candidate.log_evidence
    assert models.noticeable(models.null) == pytest.approx(11.0)
    assert models.noticeable(models.with_effects(CUBIC)) == pytest.approx(11.0 + 30.0)


@pytest.mark.parametrize(
    ("energy", "converts", "anew"), [(20.0, True, True), (20.0, False, False), (99.0, True, False)]
)
def test_a_search_begins_anew_where_a_model_expects_an_error_of_the_converter(energy, converts, anew):
    """At an energy of 99 instead of 100 the effect does not pay for itself: the best model is without it."""
    models = Searched({(): 100.0, (CUBIC,): energy}, {})
    other = object()
    models.problem.correct_conversion = lambda _space, _coordinates: other if converts else models.problem
    models.move_to = lambda problem: ("on", problem)
    assert models.rerun_converted() == (("on", other) if anew else models)


def test_a_plain_calibration_weighs_every_frequency_alike():
    """Noise that grows with frequency: the mean of its density from zero to half the rate."""
    models = Searched({(): 100.0}, {})
    models.null.noise = SimpleNamespace(density=lambda frequency: 3.0 + frequency, rate=100.0)
    models.problem.block = SimpleNamespace(rate=100.0)
    with patch("reliab.discrepancy.fitting.search.fit", lambda *given: given):
        _problem, space, starts, noise = models.plain(models.null)
    assert (space, starts) == (models.null.space, [models.null.coordinates])
    assert noise.rate == 100.0
    assert noise.density(np.array([1.0, 49.0])) == pytest.approx(3.0 + 25.0)


class JudgedByParts(Judged, ErrorSearch):
    """The same where no noise is known and left-out parts judge."""


def test_where_errors_judge_a_score_is_the_likelihood_of_left_out_tests_less_prior_odds():
    """Nine observations of an energy of 1/2 over signals of four: −(9/2) ln(1/8), and one for an effect."""
    models = JudgedByParts({(): 100.0, (CUBIC,): 50.0}, {(): 2.0, (CUBIC,): 0.5})
    models.problem.tempering, models.problem.segments = (1.0,), (SimpleNamespace(bins=5),)
    energy = models.error(models.with_effects(CUBIC)).energy
    assert models.score(models.with_effects(CUBIC)) == pytest.approx(-4.5 * np.log(energy) - 1.0)


def test_observations_are_the_tempered_rows_of_all_segments():
    """A real part at zero frequency and two parts at each further one."""
    models = JudgedByParts({(): 100.0}, {})
    models.problem.tempering = (0.5, 0.25)
    models.problem.segments = (SimpleNamespace(bins=10), SimpleNamespace(bins=4))
    assert models.observations == pytest.approx(0.5 * 19.0 + 0.25 * 7.0)


@pytest.mark.parametrize(
    ("effects", "pair_matters", "stands"),
    [
        ((ClockOffset, VISCOUS), False, False),
        ((ClockOffset, VISCOUS), True, True),
        ((ClockOffset,), False, True),
        ((VISCOUS,), False, True),
    ],
)
def test_a_damper_and_an_offset_of_the_clocks_that_cancel_each_other_must_matter_together(
    effects, pair_matters, stands
):
    def model(kinds):
        return SimpleNamespace(space=SimpleNamespace(effects=tuple(kinds)))

    compared = []

    def matters(candidate, smaller):
        compared.append((candidate.space.effects, smaller.space.effects))
        return pair_matters

    search = SimpleNamespace(
        problem=SimpleNamespace(block=SimpleNamespace(twins={ClockOffset: (VISCOUS,)})),
        remove_effect=lambda larger, kind: model(k for k in larger.space.effects if k is not kind),
        _matters=matters,
    )
    candidate = model((CUBIC, *effects))
    assert Search._clocks_matter(search, candidate) is stands  # noqa: SLF001 - what is tested
    assert all(smaller == (CUBIC,) for _, smaller in compared)
    assert len(compared) == (len(effects) == 2)


@pytest.mark.parametrize("spread", [True, False])
def test_an_offset_of_the_clocks_beside_effects_needs_little_only_where_noise_is_left(spread):
    def model(kinds):
        return SimpleNamespace(space=SimpleNamespace(effects=tuple(kinds)))

    search = SimpleNamespace(
        problem=SimpleNamespace(block=SimpleNamespace(twins={ClockOffset: (VISCOUS,)})), fitted={}
    )
    late = model((CUBIC, ClockOffset))
    with patch("reliab.discrepancy.fitting.search.is_spread", return_value=spread) as judged:
        assert Search._is_shift(search, late, {ClockOffset}) is spread  # noqa: SLF001 - what is tested
    judged.assert_called_once_with(search.problem, late)


@pytest.mark.parametrize(
    ("left", "reaches"), [([0.01], True), ([0.5, 0.4, 0.01], True), ([0.5, 0.4, 0.3, 0.2], False)]
)
def test_noise_judges_only_where_a_few_effects_can_leave_it(monkeypatch, left, reaches):
    shares = iter(left)
    monkeypatch.setattr(search, "is_model_error", lambda *_: next(shares) > 0.05)
    begun = SimpleNamespace(
        problem=SimpleNamespace(block=SimpleNamespace(outside=())),
        null=None,
        candidates=(),
        screen=lambda *_: [SimpleNamespace(start=np.zeros(1))],
        _rough=lambda *_: [SimpleNamespace(log_likelihood=0.0)],
    )
    assert search.Search.reaches_noise(begun) is reaches
    assert next(shares, None) is None


@pytest.mark.parametrize(("second", "tried"), [(VISCOUS, [(CUBIC,)]), (TERM, [(CUBIC,)])])
def test_others_are_tried_in_the_place_of_effects_but_for_the_main_one_of_the_library(second, tried):
    """Without the spring more is missed than without the damper, and less than without the term."""
    training = {(): 100.0, (CUBIC,): 60.0, (second,): 50.0, (CUBIC, second): 20.0}
    left_out = {(): 1.0, (CUBIC,): 0.6, (second,): 0.7 if second is VISCOUS else 0.5, (CUBIC, second): 0.2}
    models = JudgedByParts(training, left_out)
    models.problem.block = SimpleNamespace(linear=(), candidates=(CUBIC, VISCOUS, TERM), outside=())
    asked = []
    models._children = lambda parents, *_: asked.append(parents[0].space.effects)  # noqa: SLF001
    models._try_rivals()  # noqa: SLF001 - what is tested
    assert asked == tried
