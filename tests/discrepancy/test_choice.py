"""The held-out tests have the last word: which model is believed, and which of its effects have a name."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.fitting.error_search import ErrorSearch
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.naming import choice
from reliab.discrepancy.naming.choice import best_rival, choose, find_sustained, probability, remarks_on
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


NONE = row(share=0.0, left_out=1.0, held_out=1.0)


class Known(ErrorSearch):
    """A search among models of given errors, each of which shows in held-out tests as in the others."""

    def __init__(self, rows):
        self.rows = {frozenset(one.fit.space.effects): one for one in rows}
        self.problem = SimpleNamespace(block=SimpleNamespace(linear=(), candidates=()))

    def remove_effect(self, fitted, kind):
        return self.rows[frozenset(fitted.space.effects) - {kind}].fit

    def energy(self, fitted, _noise):
        return self.rows[frozenset(fitted.space.effects)].left_out ** 2


@pytest.fixture
def chosen(monkeypatch):
    """Function that chooses among rows."""
    monkeypatch.setattr(choice, "_is_silent", lambda *_: False)
    return lambda *rows: choose(Known(rows), rows, None)


def test_probable_model_that_held_out_tests_contradict_gives_way_to_its_rival(chosen):
    """Hysteresis with a power law explains the fitted tests best: 0.50 with it, 0.40 without it."""
    both = row(HYSTERESIS, POWER, share=0.9, left_out=0.10, held_out=0.50)
    alone = row(HYSTERESIS, share=0.1, left_out=0.12, held_out=0.40)
    law = row(POWER, share=0.0, left_out=0.5, held_out=0.7)
    found = chosen(both, alone, law, NONE)
    assert found.best is alone
    assert found.contradicted is both
    assert "contradict hysteresis + power law damping" in next(iter(remarks_on(found)))


@pytest.mark.parametrize(("left_out", "believed"), [(0.5, 1), (0.8, 0)])
def test_rival_takes_the_place_only_if_it_explains_half_of_the_fitted_tests(left_out, believed):
    """Half of what the best model explains of the energy: 1 to 0.1² is left from 0.71 on."""
    rows = (
        row(HYSTERESIS, share=0.9, left_out=0.1, held_out=0.3),
        row(POWER, share=0.1, left_out=left_out, held_out=0.2),
        NONE,
    )
    assert find_sustained(rows) is rows[believed]


@pytest.mark.parametrize(("without", "named"), [(0.2002, set()), (0.30, {HYSTERESIS})])
def test_effect_that_changes_nothing_on_held_out_tests_has_no_name(chosen, without, named):
    found = chosen(
        row(HYSTERESIS, share=0.99, left_out=0.1, held_out=0.2), row(left_out=0.3, held_out=without)
    )
    assert found.sure == named
    assert [kind for kind, *_ in found.unchanging] == ([] if named else [HYSTERESIS])


def test_effect_that_explains_less_than_is_left_refines_the_model_without_a_name(chosen):
    both = row(HYSTERESIS, CUBIC, share=0.99, left_out=0.1, held_out=0.20)
    found = chosen(
        both, row(HYSTERESIS, left_out=0.2, held_out=0.27), row(CUBIC, left_out=0.6, held_out=0.7), NONE
    )
    assert found.best is both
    assert found.sure == {HYSTERESIS}
    assert found.refining == {CUBIC: 0.27}


@pytest.mark.parametrize(
    ("share", "rival", "refining"), [(0.9, 0.4, {}), (0.3, 0.4, {CUBIC: 0.5}), (0.9, 0.25, {CUBIC: 0.5})]
)
def test_effect_in_whose_place_another_explains_as_much_has_no_name(chosen, share, rival, refining):
    """By the probability of models without it, or by their error on held-out tests: 0.25² < 2 · 0.20²."""
    both = row(HYSTERESIS, CUBIC, share=share, left_out=0.1, held_out=0.20)
    found = chosen(
        both,
        row(HYSTERESIS, POWER, share=1.0 - share, left_out=0.1, held_out=rival),
        row(HYSTERESIS, left_out=0.5, held_out=0.5),
        row(CUBIC, left_out=0.6, held_out=0.7),
        NONE,
    )
    assert found.best is both
    assert found.refining == refining
    assert all("other effects explain nearly as much" in text for text in remarks_on(found))


@pytest.mark.parametrize(("without_term", "refining"), [(0.211, {}), (0.28, {POWER: 0.30})])
def test_effect_is_measured_beside_what_is_left_without_refinements(chosen, without_term, refining):
    """A square spring takes little off 0.20 and has no name; 0.30² is 2.02 times 0.211², 1.15 times 0.28²."""
    every = row(HYSTERESIS, POWER, CUBIC, share=0.9, left_out=0.1, held_out=0.20)
    found = chosen(
        every,
        row(HYSTERESIS, POWER, share=0.1, left_out=0.11, held_out=without_term),
        row(HYSTERESIS, CUBIC, left_out=0.2, held_out=0.30),
        row(POWER, CUBIC, left_out=0.6, held_out=0.7),
        row(HYSTERESIS, left_out=0.3, held_out=0.32),
        row(POWER, left_out=0.6, held_out=0.7),
        NONE,
    )
    assert found.best is every
    assert {kind for kind in found.refining if kind is not CUBIC} == set(refining)
    assert found.refining[CUBIC] == without_term


@pytest.mark.parametrize(("without", "is_named"), [(0.30, True), (0.27, False)])
def test_main_effect_that_explains_less_than_is_left_is_in_doubt(chosen, without, is_named):
    """0.30² is 2.25 times 0.20², and 0.27² is 1.8 times."""
    found = chosen(
        row(HYSTERESIS, share=0.95, held_out=0.20), row(share=0.05, left_out=0.3, held_out=without)
    )
    assert (found.sure, found.doubtful) == (({HYSTERESIS}, set()) if is_named else (set(), {HYSTERESIS}))
    assert not found.refining


class Noisy(Search):
    """The same where noise judges."""

    __init__, energy = Known.__init__, Known.energy


@pytest.mark.parametrize(
    ("search", "change", "rows", "silent"),
    [
        (Known, 0.19, 100, True),  # 4 % of the energy is 2 % of the error
        (Known, 0.21, 100, False),
        (Noisy, 0.21, 100, True),  # two standard errors are 4/10
        (Noisy, 0.41, 100, False),
        (Noisy, 0.21, 10_000, False),
    ],
)
def test_fitted_tests_decide_where_held_out_ones_could_not_show_an_effect(
    monkeypatch, search, change, rows, silent
):
    with_it, without = row(CUBIC, left_out=0.1, held_out=1.0), row(left_out=0.2, held_out=1.0)
    monkeypatch.setattr(choice, "compute_nrmse", lambda _, values: values[0])
    proof = SimpleNamespace(rows=rows, residuals=lambda fit: {0: change * (fit is without.fit)})
    judged = search((with_it, without))
    assert choice._is_silent(judged, with_it, without, proof) is silent  # noqa: SLF001
    assert not choice._is_silent(judged, with_it, with_it, proof)  # noqa: SLF001 - nor do the fitted ones


def test_terms_of_a_general_kind_must_be_a_fifth_better_than_effects_with_a_name(chosen):
    inside = row(HYSTERESIS, share=0.1, left_out=0.12, held_out=0.20)
    little = row(TERM, share=0.9, left_out=0.1, held_out=0.17)
    much = row(TERM, share=0.9, left_out=0.1, held_out=0.15)
    assert chosen(little, inside, NONE).best is inside
    assert chosen(much, inside, NONE).best is much


def test_special_forms_of_an_effect_share_its_probability():
    rows = (row(DEGRADING, share=0.5), row(HYSTERESIS, share=0.4), row(POWER, share=0.1))
    assert probability(rows, DEGRADING) == pytest.approx(0.9)
    assert probability(rows, POWER) == pytest.approx(0.1)


def test_best_rival_lacks_one_of_the_effects():
    both, alone = row(HYSTERESIS, CUBIC, held_out=0.1), row(HYSTERESIS, held_out=0.3)
    more = row(HYSTERESIS, CUBIC, POWER, held_out=0.05)
    assert best_rival((more, both, alone, NONE), both) is alone
