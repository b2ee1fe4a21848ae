"""Models of the same names: left-out tests tell them apart where these decide, else all tests together."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.fitting.left_out import LeftOut
from reliab.discrepancy.fitting.prior import cost
from reliab.discrepancy.fitting.space import MODEL_ERROR
from reliab.discrepancy.naming.naming import believed, ranking
from reliab.discrepancy.terms.clock_offset import ClockOffset
from reliab.effects.registry import find_effect

AFTER, BEFORE = find_effect("stroke_saturation"), find_effect("command_saturation")
BACKLASH = find_effect("backlash")
STEADY = [1.0, 1.1, 0.9, 1.0]
ONE_WORSE = [3.3, 0.65, 0.8, 0.5]  # of what a limit shows in one test only, which is left out once
ALL_WORSE = [3.3, 3.0, 3.5, 3.1]


def model(effect, evidence):
    return SimpleNamespace(space=SimpleNamespace(effects=(effect,)), log_evidence=evidence)


def errors(energies):
    one = np.ones(4)
    return LeftOut(energies=np.array(energies), signals=one, units=one, foretold=one > 0.0)


def first_of(*models, flat=True):
    """Effect of the most probable of models with their left-out errors."""
    fits = {str(k): fit for k, (fit, _) in enumerate(models)}
    left = {id(fit): errors(energies) for fit, energies in models}
    search = SimpleNamespace(
        fitted=fits,
        with_clocks={},
        problem=SimpleNamespace(flat=flat, block=SimpleNamespace(twins={})),
        observations=20.0,
        error=lambda fit: left[id(fit)],
        score=lambda fit: -10.0 * np.log(left[id(fit)].energy),
    )
    return ranking(search)[0].fit.space.effects[0]


def test_all_tests_tell_the_place_where_left_out_ones_do_not():
    after, before = (model(AFTER, 68.0), STEADY), (model(BEFORE, 78.0), ONE_WORSE)
    assert first_of(after, before) is BEFORE


@pytest.mark.parametrize(
    ("other", "energies", "evidence", "flat"),
    [
        (BEFORE, ALL_WORSE, 78.0, True),  # left-out tests decide
        (BEFORE, ONE_WORSE, 58.0, True),  # the likelihood says the same
        (BACKLASH, ONE_WORSE, 78.0, True),  # another effect
        (BEFORE, ONE_WORSE, 78.0, False),  # noise judges by the evidence itself
    ],
)
def test_the_first_model_stays_first_otherwise(other, energies, evidence, flat):
    assert first_of((model(AFTER, 68.0), STEADY), (model(other, evidence), energies), flat=flat) is AFTER


def test_a_model_that_wins_by_a_single_test_is_less_probable_than_one_that_wins_by_all():
    """Their summed errors are the same; a flat Dirichlet distribution weighs the tests anew."""

    def sure_of(energies):
        fits = {"rival": model(BACKLASH, 0.0), "first": model(AFTER, 0.0)}
        left = {id(fits["rival"]): errors(np.ones(4)), id(fits["first"]): errors(energies)}
        search = SimpleNamespace(
            fitted=fits,
            with_clocks={},
            problem=SimpleNamespace(flat=True),
            observations=72.0,
            error=lambda fit: left[id(fit)],
        )
        return next(r.probability for r in ranking(search) if r.fit is fits["first"])

    by_all, by_one = sure_of([0.9, 0.9, 0.9, 0.9]), sure_of([0.3, 1.1, 1.1, 1.1])
    assert by_all == pytest.approx(1.0 / (1.0 + 0.9**36), rel=1e-6)  # of (energy)^(-observations / 2)
    assert by_one < 0.8


@pytest.mark.parametrize(
    ("twins", "lost", "expected"),
    [
        ({AFTER: (BEFORE,)}, 0.0, 0.5),  # the data do not tell
        ({AFTER: (BEFORE,)}, 3.0, 1.0 / (1.0 + np.exp(-2.5))),  # half a nat is the simulations' own
        ({}, 0.0, 1.0 / (1.0 + np.exp(-9.0))),  # evidence and prior odds decide
    ],
)
def test_between_twins_the_data_alone_decide(twins, lost, expected):
    def fitted(effect, score, likelihood):
        space = SimpleNamespace(effects=(effect,))
        return SimpleNamespace(space=space, score=score, log_likelihood=likelihood, noise=None)

    first, twin = fitted(AFTER, 50.0, 90.0), fitted(BEFORE, 41.0, 90.0 - lost)
    block = SimpleNamespace(twins=twins)
    problem = SimpleNamespace(flat=False, block=block, loudness=lambda _noise: 1.0 / MODEL_ERROR**2)
    search = SimpleNamespace(
        fitted={"first": first, "twin": twin},
        with_clocks={},
        problem=problem,
        score=lambda fit: fit.score,
    )
    ranked = ranking(search)
    assert ranked[0].fit is first
    assert ranked[0].probability == pytest.approx(expected)


@pytest.mark.parametrize(("beside", "expected"), [(58.0, 0.5), (49.0, 1.0 / (1.0 + np.exp(-1.0)))])
def test_a_model_is_as_credible_as_with_an_offset_of_the_clocks_that_is_not_named(beside, expected):
    def fitted(score, *effects):
        space = SimpleNamespace(effects=effects, names=tuple(sorted(str(one.name) for one in effects)))
        return SimpleNamespace(space=space, score=score, log_likelihood=0.0, noise=None)

    alone, other = fitted(50.0, AFTER), fitted(30.0, BACKLASH)
    late = fitted(beside, AFTER, ClockOffset)
    search = SimpleNamespace(
        fitted={frozenset(fit.space.names): fit for fit in (alone, other)},
        with_clocks={frozenset(late.space.names): late},
        problem=SimpleNamespace(flat=False, block=SimpleNamespace(twins={})),
        score=lambda fit: fit.score,
    )
    shares = {id(ranked.fit): ranked.probability for ranked in ranking(search)}
    assert shares[id(alone)] == pytest.approx(expected, abs=1e-6)
    assert shares[id(alone)] + shares[id(late)] == pytest.approx(1.0, abs=1e-6)


def test_an_offset_of_the_clocks_beside_rejected_effects_takes_no_part():
    def fitted(score, *effects):
        space = SimpleNamespace(effects=effects, names=tuple(sorted(str(one.name) for one in effects)))
        return SimpleNamespace(space=space, score=score, log_likelihood=0.0, noise=None)

    alone, late = fitted(50.0, AFTER), fitted(60.0, BEFORE, ClockOffset)
    search = SimpleNamespace(
        fitted={frozenset(alone.space.names): alone},
        with_clocks={frozenset(late.space.names): late},
        problem=SimpleNamespace(flat=False, block=SimpleNamespace(twins={})),
        score=lambda fit: fit.score,
    )
    assert [ranked.fit for ranked in ranking(search)] == [alone]


def test_an_offset_of_the_clocks_costs_nothing_beside_an_effect():
    assert cost([AFTER, ClockOffset]) == cost([AFTER]) == cost([ClockOffset]) > 0.0


def ranked_as(probability, *effects):
    return SimpleNamespace(
        fit=SimpleNamespace(space=SimpleNamespace(effects=effects)), probability=probability
    )


@pytest.mark.parametrize(("alone", "doubted"), [(0.6, False), (0.4, True)])
def test_an_offset_of_the_clocks_is_doubtful_where_it_is_more_probable_than_none(alone, doubted):
    ranked = [ranked_as(1.0 - alone, AFTER, ClockOffset), ranked_as(alone, AFTER)]
    best, sure, doubtful = believed(ranked, None)
    assert sure == {AFTER}
    assert doubtful == ({ClockOffset} if doubted else set())
    assert set(best.space.effects) == sure | doubtful
