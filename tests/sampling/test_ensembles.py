"""Runs can be resumed, are reproducible, and say when they are not to be relied on."""

import numpy as np
import pytest

from reliab.errors import InputError
from reliab.sampling import (
    ConvergenceWarning,
    Ensembles,
    NormalValues,
    sample,
)
from reliab.sampling.diagnostics import inference_data

MODEL = NormalValues(values=np.random.default_rng(1).normal(size=30))
QUICK = Ensembles(steps=40, thin=2, walkers=8)
SHORT = pytest.mark.filterwarnings("ignore::reliab.sampling.ConvergenceWarning")


@SHORT
def test_a_resumed_run_ends_as_if_it_had_never_stopped(tmp_path):
    whole = sample(MODEL, QUICK)
    sample(MODEL, Ensembles(steps=24, thin=2, walkers=8), file=tmp_path / "run.h5")
    resumed = sample(MODEL, QUICK, file=tmp_path / "run.h5")
    np.testing.assert_array_equal(resumed.draws, whole.draws)


@SHORT
def test_a_finished_run_is_read_and_not_run_again(tmp_path):
    first = sample(MODEL, QUICK, file=tmp_path / "run.h5")
    steps = []
    again = sample(MODEL, QUICK, file=tmp_path / "run.h5", progress=lambda done, _: steps.append(done))
    np.testing.assert_array_equal(again.draws, first.draws)
    assert not steps


def test_a_run_goes_on_until_it_has_converged_and_no_further():
    begun = Ensembles(steps=40, walkers=16, longest=4000)
    found = sample(MODEL, begun)
    assert found.converged
    assert 40 < 2 * found.draws.shape[1] <= 4000
    with pytest.warns(ConvergenceWarning):  # half as long was not enough
        sample(MODEL, Ensembles(steps=found.draws.shape[1], walkers=16))


@SHORT
def test_a_file_of_other_data_is_refused(tmp_path):
    sample(MODEL, QUICK, file=tmp_path / "run.h5")
    with pytest.raises(InputError, match="began with"):
        sample(NormalValues(values=MODEL.values + 1.0), QUICK, file=tmp_path / "run.h5")


@SHORT
def test_ensembles_are_independent_and_reproducible():
    one, two = sample(MODEL, QUICK), sample(MODEL, QUICK)
    np.testing.assert_array_equal(one.draws, two.draws)
    assert not np.array_equal(one.draws[0], one.draws[1])


def test_too_short_a_run_warns_and_says_what_is_wrong():
    with pytest.warns(ConvergenceWarning, match=r"NOT CONVERGED.*R-hat.*effective draws"):
        found = sample(MODEL, Ensembles(steps=40, walkers=12))
    assert not found.converged
    assert any("R-hat" in sentence for sentence in found.diagnostics.complaints)


def test_too_few_ensembles_are_complained_about():
    with pytest.warns(ConvergenceWarning, match="Only 2 independent ensembles"):
        sample(MODEL, Ensembles(steps=1600, count=2, walkers=16))


def test_a_long_run_converges_and_reports_its_figures():
    values = np.random.default_rng(2).normal(-1.0, 0.6, 60)
    found = sample(NormalValues(values=values), Ensembles(steps=1600, thin=2, walkers=14))
    table = found.table()
    assert found.converged
    assert (table["r_hat"] < 1.01).all()
    assert (table[["bulk_size", "tail_size"]] > 1000.0).all().all()
    assert table["autocorrelation_time"].between(1.0, 100.0).all()
    assert table["mean"].iloc[0] == pytest.approx(values.mean(), abs=0.05)


@SHORT
def test_draws_go_to_arviz_with_one_chain_for_each_ensemble():
    found = sample(MODEL, QUICK)
    data = inference_data(found.draws, found.names)
    assert data.posterior["mean"].sizes == {"chain": 4, "draw": 10 * 8}


@pytest.mark.parametrize(("steps", "thin"), [(0, 1), (101, 1), (30, 4)])
def test_steps_must_fit_the_thinning(steps, thin):
    with pytest.raises(InputError, match="multiple of twice the thinning"):
        Ensembles(steps=steps, thin=thin)
