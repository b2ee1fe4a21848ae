"""The held-out tests have the last word: which model is believed, and which of its effects have a name."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.fitting.error_search import ErrorSearch
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.naming import choice
from reliab.discrepancy.naming.choice import Ranking, choose, find_sustained, remarks_on
from reliab.discrepancy.result.block_diagnosis import RankedModel
from reliab.effects.general.general_terms import general_terms
from reliab.effects.registry import find_effect

HYSTERESIS, POWER = find_effect("hysteresis"), find_effect("power_law_damping")
CUBIC, DEGRADING = find_effect("cubic_stiffness"), find_effect("degrading_hysteresis")
TERM = general_terms(Block.SPECIMEN)[0]


def row(*effects, share=0.0, left_out=0.2, held_out=0.2):
    space = SimpleNamespace(effects=effects, names=tuple(sorted(str(effect.name) for effect in effects)))
    fit = SimpleNamespace(space=space, coordinates=np.zeros(1), noise=None)
    return RankedModel(fit=fit, probability=share, left_out=left_out, held_out=held_out)


CALIBRATION = row(share=0.0, left_out=1.0, held_out=1.0)


class KnownFits(Search):
    """A search among models of given errors, each of which shows in held-out tests as in the others."""

    def __init__(self, rows):
        self.rows = {frozenset(item.fit.space.effects): item for item in rows}
        self.problem = SimpleNamespace(block=SimpleNamespace(linear=(), candidates=()))

    def remove_effect(self, model_fit, kind):
        return self.rows[frozenset(model_fit.space.effects) - {kind}].fit

    def energy(self, model_fit, _noise):
        return self.rows[frozenset(model_fit.space.effects)].left_out ** 2


class KnownErrors(KnownFits, ErrorSearch):
    """The same, judged by left-out parts."""


@pytest.fixture
def selection(monkeypatch):
    """Function that chooses among rows."""
    monkeypatch.setattr(Ranking, "is_silent", lambda *_: False)
    return lambda *rows: choose(Ranking(search=KnownErrors(rows), rows=rows, proof=None))


def test_contradicted_model_gives_way_to_its_rival(selection):
    """Hysteresis with a power law explains the fitted tests best: 0.50 with it, 0.40 without it."""
    both = row(HYSTERESIS, POWER, share=0.9, left_out=0.10, held_out=0.50)
    single = row(HYSTERESIS, share=0.1, left_out=0.12, held_out=0.40)
    law = row(POWER, share=0.0, left_out=0.5, held_out=0.7)
    choice = selection(both, single, law, CALIBRATION)
    assert choice.best is single
    assert choice.contradicted is both
    assert "contradict hysteresis + power law damping" in next(iter(remarks_on(choice)))


@pytest.mark.parametrize(("left_out", "is_believed"), [(0.5, 1), (0.8, 0)])
def test_rival_takes_the_place_only_if_it_explains_half_of_the_fitted_tests(left_out, is_believed):
    """Half of what the best model explains of the energy: 1 to 0.1² is left from 0.71 on."""
    rows = (
        row(HYSTERESIS, share=0.9, left_out=0.1, held_out=0.3),
        row(POWER, share=0.1, left_out=left_out, held_out=0.2),
        CALIBRATION,
    )
    assert find_sustained(rows) is rows[is_believed]


@pytest.mark.parametrize(("error_without", "names"), [(0.2002, set()), (0.30, {HYSTERESIS})])
def test_effect_without_gain_on_held_out_tests_has_no_name(selection, error_without, names):
    choice = selection(
        row(HYSTERESIS, share=0.99, left_out=0.1, held_out=0.2), row(left_out=0.3, held_out=error_without)
    )
    assert choice.sure == names
    assert [kind for kind, *_ in choice.unchanging] == ([] if names else [HYSTERESIS])


@pytest.mark.parametrize(("error_without", "is_kept"), [(0.203, False), (0.205, True)])
def test_effect_that_takes_two_per_cent_off_the_error_refines_the_model(selection, error_without, is_kept):
    both = row(HYSTERESIS, CUBIC, share=0.9, left_out=0.1, held_out=0.2)
    single = row(HYSTERESIS, share=0.1, left_out=0.12, held_out=error_without)
    choice = selection(both, single, row(CUBIC, left_out=0.6, held_out=0.7), CALIBRATION)
    assert choice.best is (both if is_kept else single)
    assert choice.sure == {HYSTERESIS}
    assert choice.refining == ({CUBIC: error_without} if is_kept else {})


def test_minor_effect_refines_the_model_without_a_name(selection):
    both = row(HYSTERESIS, CUBIC, share=0.99, left_out=0.1, held_out=0.20)
    choice = selection(
        both,
        row(HYSTERESIS, left_out=0.13, held_out=0.27),
        row(CUBIC, left_out=0.6, held_out=0.7),
        CALIBRATION,
    )
    assert choice.best is both
    assert choice.sure == {HYSTERESIS}
    assert choice.refining == {CUBIC: 0.27}


@pytest.mark.parametrize(
    ("share", "left_out", "rival", "held_out", "is_named", "is_in_doubt"),
    [
        (0.9, 0.2, 0.4, 0.5, True, False),
        (0.3, 0.2, 0.4, 0.5, False, False),
        (0.9, 0.2, 0.25, 0.5, False, True),
        (0.9, 0.1, 0.4, 0.5, False, True),
        (0.9, 0.2, 0.25, 0.27, False, False),
    ],
)
def test_replaceable_effect_has_no_name(selection, share, left_out, rival, held_out, is_named, is_in_doubt):
    """By the probability of models without it, or by either of their errors: 0.25² < 2 · 0.20².

    It is in doubt if the model without it, with nothing in its place, leaves twice as much (0.27² is less).
    """
    both = row(HYSTERESIS, CUBIC, share=share, left_out=0.1, held_out=0.20)
    choice = selection(
        both,
        row(HYSTERESIS, POWER, share=1.0 - share, left_out=left_out, held_out=rival),
        row(HYSTERESIS, left_out=0.5, held_out=held_out),
        row(CUBIC, left_out=0.6, held_out=0.7),
        CALIBRATION,
    )
    assert choice.best is both
    assert (CUBIC in choice.sure, CUBIC in choice.doubtful) == (is_named, is_in_doubt)
    assert choice.refining == ({} if is_named or is_in_doubt else {CUBIC: held_out})
    reason = "other effects explain nearly as much" if held_out == 0.5 else "it explains too little"
    assert all(reason in text for text in remarks_on(choice))


@pytest.mark.parametrize(("plain_term", "is_named"), [(0.211, True), (0.28, False)])
def test_effect_is_measured_without_refinements(selection, plain_term, is_named):
    """A square spring takes little off 0.20 and has no name; 0.30² is 2.02 times 0.211², 1.15 times 0.28²."""
    thinning = row(HYSTERESIS, POWER, CUBIC, share=0.9, left_out=0.1, held_out=0.20)
    choice = selection(
        thinning,
        row(HYSTERESIS, POWER, share=0.1, left_out=0.11, held_out=plain_term),
        row(HYSTERESIS, CUBIC, left_out=0.2, held_out=0.30),
        row(POWER, CUBIC, left_out=0.6, held_out=0.7),
        row(HYSTERESIS, left_out=0.3, held_out=0.32),
        row(POWER, left_out=0.6, held_out=0.7),
        CALIBRATION,
    )
    assert choice.best is thinning
    assert (POWER in choice.sure, POWER in choice.doubtful) == (is_named, not is_named)
    assert choice.refining == {CUBIC: plain_term}


@pytest.mark.parametrize(
    ("left_out", "held_out", "is_named"), [(0.27, 0.30, True), (0.30, 0.27, True), (0.27, 0.27, False)]
)
def test_minor_main_effect_is_in_doubt(selection, left_out, held_out, is_named):
    """0.30² is 2.25 times 0.20², and 0.27² is 1.8 times; left-out parts or held-out tests may show it."""
    choice = selection(
        row(HYSTERESIS, share=0.95, held_out=0.20), row(share=0.05, left_out=left_out, held_out=held_out)
    )
    assert (choice.sure, choice.doubtful) == (({HYSTERESIS}, set()) if is_named else (set(), {HYSTERESIS}))
    assert not choice.refining


@pytest.mark.parametrize(("with_term", "left_out", "is_unknown"), [(0.15, 0.1, False), (0.13, 0.1, True)])
def test_term_beside_an_effect_is_unknown_if_it_explains_more_than_is_left(
    selection, with_term, left_out, is_unknown
):
    """0.20² is 1.8 times 0.15² and 2.4 times 0.13²."""
    both = row(HYSTERESIS, TERM, share=0.9, left_out=left_out, held_out=with_term)
    single = row(HYSTERESIS, share=0.1, left_out=0.2, held_out=0.20)
    choice = selection(both, single, row(TERM, left_out=0.6, held_out=0.7), CALIBRATION)
    assert (choice.best, choice.plain) == (both, single)
    assert choice.sure == {HYSTERESIS}
    assert choice.refining == ({} if is_unknown else {TERM: 0.20})


@pytest.mark.parametrize(("held_out", "left_out"), [(0.197, 0.1), (0.15, 0.21)])
def test_term_without_gain_on_held_out_tests_or_on_left_out_parts_is_in_no_model(
    selection, held_out, left_out
):
    single = row(HYSTERESIS, share=0.1, left_out=0.2, held_out=0.20)
    both = row(HYSTERESIS, TERM, share=0.9, left_out=left_out, held_out=held_out)
    choice = selection(both, single, row(TERM, left_out=0.6, held_out=0.7), CALIBRATION)
    assert choice.best is single


@pytest.mark.parametrize("leaves_noise", [True, False])
def test_minor_effect_has_no_name_where_noise_judges_and_is_not_left(monkeypatch, leaves_noise):
    monkeypatch.setattr(choice, "is_noise", lambda *_: leaves_noise)
    monkeypatch.setattr(Ranking, "is_silent", lambda *_: False)
    rows = (
        row(HYSTERESIS, CUBIC, share=0.99, held_out=0.20),
        row(HYSTERESIS, left_out=0.25, held_out=0.25),
        row(CUBIC, left_out=0.8, held_out=0.8),
        CALIBRATION,
    )
    ranking = Ranking(search=KnownFits(rows), rows=rows, proof=None)
    assert choose(ranking).sure == ({HYSTERESIS, CUBIC} if leaves_noise else {HYSTERESIS})


@pytest.mark.parametrize(("with_cubic", "is_named"), [(0.298, False), (0.290, True)])
def test_effect_needed_by_an_unknown_term_alone_refines_it(selection, with_cubic, is_named):
    """Without the term a cubic spring must take 2 % off the error of the hysteresis alone, 0.30."""
    choice = selection(
        row(HYSTERESIS, CUBIC, TERM, share=0.95, left_out=0.10, held_out=0.05),
        row(HYSTERESIS, TERM, share=0.0, left_out=0.2, held_out=0.20),
        row(CUBIC, TERM, left_out=0.5, held_out=0.60),
        row(HYSTERESIS, CUBIC, share=0.05, left_out=0.3, held_out=with_cubic),
        row(HYSTERESIS, left_out=0.3, held_out=0.30),
        row(CUBIC, left_out=0.9, held_out=0.90),
        row(TERM, left_out=0.6, held_out=0.70),
        CALIBRATION,
    )
    assert choice.best.fit.space.effects == (HYSTERESIS, CUBIC, TERM)
    assert (CUBIC in choice.sure, CUBIC in choice.refining) == (is_named, not is_named)
    assert HYSTERESIS in choice.sure
    assert TERM not in choice.refining


class Noisy(Search):
    """The same where noise judges."""

    __init__, energy = KnownErrors.__init__, KnownErrors.energy


@pytest.mark.parametrize(
    ("search", "change", "rows", "silent"),
    [
        (KnownErrors, 0.19, 100, True),  # 4 % of the energy is 2 % of the error
        (KnownErrors, 0.21, 100, False),
        (Noisy, 0.21, 100, True),  # two standard errors are 4/10
        (Noisy, 0.41, 100, False),
        (Noisy, 0.21, 10_000, False),
    ],
)
def test_fitted_tests_decide_where_held_out_ones_could_not_show_an_effect(
    monkeypatch, search, change, rows, silent
):
    larger, smaller = row(CUBIC, left_out=0.1, held_out=1.0), row(left_out=0.2, held_out=1.0)
    monkeypatch.setattr(choice, "compute_nrmse", lambda _, values: values[0])
    proof = SimpleNamespace(rows=rows, residuals=lambda fit: {0: change * (fit is smaller.fit)})
    ranking = Ranking(search=search((larger, smaller)), rows=(larger, smaller), proof=proof)
    assert ranking.is_silent(larger, smaller) is silent
    assert not ranking.is_silent(larger, larger)  # nor do the fitted ones


@pytest.mark.parametrize(("held_out", "left_out"), [(0.15, 0.08), (0.13, 0.09), (0.13, 0.08)])
def test_term_takes_the_place_of_an_effect_if_it_explains_more_than_it_leaves(selection, held_out, left_out):
    library_model = row(HYSTERESIS, share=0.1, left_out=0.12, held_out=0.20)
    term = row(TERM, share=0.9, left_out=left_out, held_out=held_out)
    choice = selection(term, library_model, CALIBRATION)
    is_replaced = (held_out, left_out) == (0.13, 0.08)
    assert choice.best is (term if is_replaced else library_model)
    assert choice.doubtful == (set() if is_replaced else {HYSTERESIS})


def test_special_forms_of_an_effect_share_its_probability():
    rows = (row(DEGRADING, share=0.5), row(HYSTERESIS, share=0.4), row(POWER, share=0.1))
    ranking = Ranking(search=None, rows=rows, proof=None)
    assert ranking.probability(DEGRADING) == pytest.approx(0.9)
    assert ranking.probability(POWER) == pytest.approx(0.1)


def test_best_rival_lacks_one_of_the_effects():
    both, single = row(HYSTERESIS, CUBIC, held_out=0.1), row(HYSTERESIS, held_out=0.3)
    larger = row(HYSTERESIS, CUBIC, POWER, held_out=0.05)
    ranking = Ranking(search=None, rows=(larger, both, single, CALIBRATION), proof=None)
    assert ranking.find_rival((HYSTERESIS, CUBIC)) is single


def test_best_rival_holds_no_other_form_of_the_effect():
    degrading, power = row(DEGRADING, held_out=0.1), row(POWER, held_out=0.3)
    ranking = Ranking(search=None, rows=(degrading, power), proof=None)
    assert ranking.find_rival((HYSTERESIS,)) is power


def test_refinement_holds_a_named_effect_at_one_place(selection):
    """Limits before and after the dynamics share the level that each would have alone."""
    stroke, command = find_effect("stroke_saturation"), find_effect("command_saturation")
    assert stroke.label() == command.label()
    plain = row(command, share=0.5, left_out=0.13, held_out=0.20)
    refined = row(command, TERM, share=0.1, left_out=0.12, held_out=0.18)
    twice = row(command, stroke, TERM, share=0.4, left_out=0.1, held_out=0.16)
    other_rows = row(TERM, left_out=0.6, held_out=0.7), row(stroke, left_out=0.4, held_out=0.5), CALIBRATION
    assert selection(plain, refined, twice, *other_rows).best is refined
    assert selection(plain, twice, *other_rows).best is plain
