"""How probable each of all fitted models is."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.fitting.left_out import LeftOut
from reliab.discrepancy.fitting.prior import cost
from reliab.discrepancy.fitting.space import MODEL_ERROR
from reliab.discrepancy.naming.choice import Ranking, _clock_models, _shares_of_parts, _shares_of_scores
from reliab.discrepancy.result.block_diagnosis import RankedModel
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.registry import find_effect

NOTHING_LINEAR = SimpleNamespace(block=SimpleNamespace(linear=()))
STROKE, COMMAND = find_effect("stroke_saturation"), find_effect("command_saturation")
BACKLASH = find_effect("backlash")


def model(effect, evidence):
    return SimpleNamespace(space=SimpleNamespace(effects=(effect,)), log_evidence=evidence)


def errors(energies):
    item = np.ones(4)
    return LeftOut(energies=np.array(energies), signals=item, units=item, foretold=item > 0.0)


def test_winning_by_one_test_is_less_probable_than_by_all():
    """Their summed errors are the same; a flat Dirichlet distribution weighs the tests anew."""

    def sure_of(energies):
        rival, first = model(BACKLASH, 0.0), model(STROKE, 0.0)
        errors_by_model = {id(rival): errors(np.ones(4)), id(first): errors(energies)}
        search = SimpleNamespace(
            observations=72.0, error=lambda fit: errors_by_model[id(fit)], problem=NOTHING_LINEAR
        )
        no_test = LeftOut(
            energies=np.zeros(0), signals=np.zeros(0), units=np.zeros(0), foretold=np.zeros(0, dtype=bool)
        )
        return _shares_of_parts(search, [rival, first], [no_test, no_test], 0.0)[1]

    probability_by_all, probability_by_one = sure_of([0.9, 0.9, 0.9, 0.9]), sure_of([0.3, 1.1, 1.1, 1.1])
    assert probability_by_all == pytest.approx(
        1.0 / (1.0 + 0.9**36), rel=1e-6
    )  # of (energy)^(-observations / 2)
    assert probability_by_one < 0.8


def test_held_out_tests_count_as_left_out_ones_do():
    """One model is better in training by as much as the other one is on held-out tests."""
    rival, first = model(BACKLASH, 0.0), model(STROKE, 0.0)
    good, bad = errors([0.5, 0.5, 0.5, 0.5]), errors([2.0, 2.0, 2.0, 2.0])
    errors_by_model = {id(rival): good, id(first): bad}
    search = SimpleNamespace(
        observations=10.0, error=lambda fit: errors_by_model[id(fit)], problem=NOTHING_LINEAR
    )
    shares = _shares_of_parts(search, [rival, first], [bad, good], 10.0)
    assert shares[1] == pytest.approx(0.5, abs=0.1)


def test_effect_is_no_more_probable_for_being_tried_with_linear_ones_too():
    """Of four models that are equally good three hold softening, and differ in linear effects only."""
    damper, mass = find_effect("viscous_damping"), find_effect("added_mass")
    softening, cubic = find_effect("softening"), find_effect("cubic_stiffness")
    kinds = [(softening,), (softening, damper), (softening, mass), (cubic, damper)]
    models = [SimpleNamespace(space=SimpleNamespace(effects=effects)) for effects in kinds]
    search = SimpleNamespace(
        observations=10.0,
        error=lambda _fit: errors(np.ones(4)),
        problem=SimpleNamespace(block=SimpleNamespace(linear=(damper, mass))),
    )
    shares = _shares_of_parts(search, models, [errors(np.ones(4))] * 4, 10.0)
    assert shares[1] == pytest.approx(shares[2])
    assert shares[1] == pytest.approx(shares[3] / 3.0)  # each effect costs as much
    assert shares[0] == pytest.approx(np.e * shares[1])


@pytest.mark.parametrize(
    ("twins", "loss", "reference"),
    [
        ({STROKE: (COMMAND,)}, 0.0, 0.5),  # the data do not tell
        ({STROKE: (COMMAND,)}, 3.0, 1.0 / (1.0 + np.exp(-2.5))),  # half a nat is the simulations' own
        ({}, 0.0, 1.0 / (1.0 + np.exp(-9.0))),  # evidence and prior odds decide
    ],
)
def test_between_twins_the_data_alone_decide(twins, loss, reference):
    def fitted(effect, score, likelihood):
        space = SimpleNamespace(effects=(effect,))
        return SimpleNamespace(space=space, score=score, log_likelihood=likelihood, noise=None)

    first, twin = fitted(STROKE, 50.0, 90.0), fitted(COMMAND, 41.0, 90.0 - loss)
    block = SimpleNamespace(twins=twins)
    problem = SimpleNamespace(block=block, loudness=lambda _noise: 1.0 / MODEL_ERROR**2)
    search = SimpleNamespace(
        fitted={"first": first, "twin": twin},
        with_clocks={},
        problem=problem,
        score=lambda fit: fit.score,
    )
    shares = _shares_of_scores(search, [first, twin])
    assert shares[0] == pytest.approx(reference)
    assert np.argmax(shares) == 0


@pytest.mark.parametrize(("second_effect", "reference"), [(58.0, 0.5), (49.0, 1.0 / (1.0 + np.exp(-1.0)))])
def test_unnamed_clock_offset_keeps_the_credibility_of_a_model(second_effect, reference):
    def fitted(score, *effects):
        space = SimpleNamespace(effects=effects, names=tuple(sorted(str(effect.name) for effect in effects)))
        return SimpleNamespace(space=space, score=score, log_likelihood=0.0, noise=None)

    single, second = fitted(50.0, STROKE), fitted(30.0, BACKLASH)
    late = fitted(second_effect, STROKE, ClockOffset)
    search = SimpleNamespace(
        fitted={frozenset(fit.space.names): fit for fit in (single, second)},
        with_clocks={frozenset(late.space.names): late},
        problem=SimpleNamespace(block=SimpleNamespace(twins={})),
        score=lambda fit: fit.score,
    )
    shares = _shares_of_scores(search, [single, second, *_clock_models(search)])
    assert shares[0] == pytest.approx(reference, abs=1e-6)
    assert shares[0] + shares[2] == pytest.approx(1.0, abs=1e-6)


def test_an_offset_of_the_clocks_beside_rejected_effects_takes_no_part():
    def fitted(score, *effects):
        space = SimpleNamespace(effects=effects, names=tuple(sorted(str(effect.name) for effect in effects)))
        return SimpleNamespace(space=space, score=score, log_likelihood=0.0, noise=None)

    single, late = fitted(50.0, STROKE), fitted(60.0, COMMAND, ClockOffset)
    search = SimpleNamespace(
        fitted={frozenset(single.space.names): single},
        with_clocks={frozenset(late.space.names): late},
        problem=SimpleNamespace(block=SimpleNamespace(twins={})),
        score=lambda fit: fit.score,
    )
    assert _clock_models(search) == []


def test_an_offset_of_the_clocks_costs_nothing_beside_an_effect():
    assert cost([STROKE, ClockOffset]) == cost([STROKE]) == cost([ClockOffset]) > 0.0


def row_of(probability, *effects):
    fit = SimpleNamespace(space=SimpleNamespace(effects=effects))
    return RankedModel(fit=fit, probability=probability, left_out=0.1, held_out=0.1)


@pytest.mark.parametrize(("single", "is_doubted"), [(0.6, False), (0.4, True)])
def test_an_offset_of_the_clocks_is_doubtful_where_it_is_more_probable_than_none(single, is_doubted):
    rows = row_of(1.0 - single, STROKE, ClockOffset), row_of(single, STROKE), row_of(0.0)
    best, sure, doubtful = Ranking(search=None, rows=rows, proof=None).split_by_certainty(rows[0])
    assert sure == {STROKE}
    assert doubtful == ({ClockOffset} if is_doubted else set())
    assert set(best.fit.space.effects) == sure | doubtful


@pytest.mark.parametrize(
    ("energies", "likelihood", "place"),
    [
        ([3.3, 0.65, 0.8, 0.5], 78.0, COMMAND),  # a limit that shows in one test only, which is left out once
        ([3.3, 3.0, 3.5, 3.1], 78.0, STROKE),  # left-out tests tell
        ([3.3, 0.65, 0.8, 0.5], 58.0, STROKE),  # all tests together say the same
    ],
)
def test_all_tests_tell_where_a_limit_acts_if_left_out_ones_do_not(monkeypatch, energies, likelihood, place):
    def fitted(effect, log_likelihood):
        return SimpleNamespace(space=SimpleNamespace(effects=(effect,)), log_likelihood=log_likelihood)

    stroke_fit, command_fit = fitted(STROKE, 68.0), fitted(COMMAND, likelihood)
    errors_by_model = {id(stroke_fit): errors([1.0, 1.1, 0.9, 1.0]), id(command_fit): errors(energies)}
    search = SimpleNamespace(
        candidates=(STROKE, COMMAND, BACKLASH),
        error=lambda fit: errors_by_model[id(fit)],
        exchange=lambda _fit, _kind, _rival: command_fit,
    )
    monkeypatch.setattr(
        "reliab.discrepancy.naming.choice.errors_of_parts", lambda _proof, fit: errors_by_model[id(fit)]
    )
    monkeypatch.setattr("reliab.discrepancy.naming.choice.compute_nrmse", lambda _proof, _fit: 0.0)
    proof = SimpleNamespace(residuals=lambda fit: fit)
    best = RankedModel(fit=stroke_fit, probability=0.5, left_out=0.1, held_out=0.1)
    ranking = Ranking(search=search, rows=(), proof=proof)
    assert ranking.place_effects(best).effects == (place,)
