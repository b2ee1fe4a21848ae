"""Sampling by ensembles, and its kept chains."""

import errno
import os
from types import SimpleNamespace
from unittest.mock import patch

import h5py
import numpy as np
import pytest
import xarray as xr
from emcee.backends import HDFBackend
from normal_values import NormalValues

from reliab.core.errors import IncompleteError, InputError
from reliab.sampling import ensembles
from reliab.sampling.ensembles import Ensembles, sample, width_of
from reliab.sampling.posterior_sample import ConvergenceWarning, PosteriorSample, diagnose

MODEL = NormalValues(values=np.random.default_rng(1).normal(size=30))
QUICK = Ensembles(steps=40, thin=2, walkers=8)
SHORT = pytest.mark.filterwarnings("ignore::reliab.sampling.posterior_sample.ConvergenceWarning")


@SHORT
def test_a_resumed_run_ends_as_if_it_had_never_stopped(tmp_path):
    complete = sample(MODEL, QUICK)
    sample(MODEL, Ensembles(steps=24, thin=2, walkers=8), file=tmp_path / "run.h5")
    second_run = sample(MODEL, QUICK, file=tmp_path / "run.h5")
    np.testing.assert_array_equal(second_run.draws, complete.draws)


@SHORT
def test_a_finished_run_is_read_and_not_run_again(tmp_path):
    first = sample(MODEL, QUICK, file=tmp_path / "run.h5")
    steps = []
    second = sample(MODEL, QUICK, file=tmp_path / "run.h5", progress=lambda step, _: steps.append(step))
    np.testing.assert_array_equal(second.draws, first.draws)
    assert not steps


@pytest.mark.slow
def test_a_run_goes_on_until_it_has_converged_and_no_further():
    start = Ensembles(steps=40, walkers=16, longest=4000)
    result = sample(MODEL, start)
    assert result.has_converged
    assert 40 < 2 * result.draws.shape[1] <= 4000
    with pytest.warns(ConvergenceWarning):  # half as long was not enough
        sample(MODEL, Ensembles(steps=result.draws.shape[1], walkers=16))


class Ridge(NormalValues):
    """A density that is ten thousand million times as thin across its ridge as along it."""

    def log_likelihood(self, theta):
        return -0.5 * (1e10 * theta.sum(axis=1)) ** 2


@SHORT
def test_walkers_start_on_a_thin_ridge():
    samples = sample(Ridge(values=MODEL.values), QUICK).flat
    assert np.abs(samples.sum(axis=1)).max() < 1e-8
    assert np.ptp(samples[:, 0]) > 0.1


class StopError(Exception):
    pass


def stop_after(blocks):
    calls = []

    def stop(*_):
        calls.append(None)
        if len(calls) == blocks:
            raise StopError

    return stop


@SHORT
def test_an_interrupted_run_keeps_its_draws_and_ends_with_the_same_bytes(tmp_path):
    sample(MODEL, QUICK, file=tmp_path / "whole.h5", group="a")
    with pytest.raises(StopError):
        sample(MODEL, QUICK, file=tmp_path / "run.h5", group="a", progress=stop_after(30))
    steps = []
    sample(MODEL, QUICK, file=tmp_path / "run.h5", group="a", progress=lambda step, _: steps.append(step))
    assert steps[0] == 2 * 31
    assert (tmp_path / "run.h5").read_bytes() == (tmp_path / "whole.h5").read_bytes()


@SHORT
def test_a_file_of_chains_keeps_those_of_other_runs(tmp_path):
    first = sample(MODEL, QUICK, file=tmp_path / "run.h5", group="a/b")
    sample(NormalValues(values=MODEL.values + 1.0), QUICK, file=tmp_path / "run.h5", group="c")
    steps = []
    second = sample(
        MODEL, QUICK, file=tmp_path / "run.h5", group="a/b", progress=lambda step, _: steps.append(step)
    )
    np.testing.assert_array_equal(second.draws, first.draws)
    assert not steps


@SHORT
def test_emcee_reads_the_file_of_chains(tmp_path):
    samples = sample(MODEL, QUICK, file=tmp_path / "run.h5", group="a")
    backend = HDFBackend(str(tmp_path / "run.h5"), name="a/ensemble_0", read_only=True)
    np.testing.assert_array_equal(backend.get_chain(discard=10), samples.draws[0])


@pytest.mark.slow
@SHORT
def test_full_disk_message_says_draws_are_safe(tmp_path, monkeypatch):
    monkeypatch.setattr(ensembles, "_SAVING_INTERVAL", 0.0)
    monkeypatch.setattr(ensembles, "_SHARE_OF_TIME", 1e9)
    archive = []

    def full(group, chain, signature):
        archive.append(chain.iteration)
        if len(archive) == 20:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        store_chain(group, chain, signature)

    store_chain = vars(ensembles)["_store"]
    monkeypatch.setattr(ensembles, "_store", full)
    with pytest.raises(IncompleteError, match=r"run\.h5 failed.*Earlier draws are safe"):
        sample(MODEL, QUICK, file=tmp_path / "run.h5")
    monkeypatch.setattr(ensembles, "_store", store_chain)
    second_run = sample(MODEL, QUICK, file=tmp_path / "run.h5")
    np.testing.assert_array_equal(second_run.draws, sample(MODEL, QUICK).draws)


@SHORT
def test_writing_long_chains_takes_a_tenth_of_the_time(tmp_path, monkeypatch):
    """By a clock on which a step takes a second and a file a second for each ensemble."""
    now, start = [0.0], []
    store_chain = vars(ensembles)["_store"]

    def store_slowly(group, chain, signature):
        start.append(now[0])
        now[0] += 1.0
        store_chain(group, chain, signature)

    def step(*_):
        now[0] += 1.0

    monkeypatch.setattr(ensembles, "time", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(ensembles, "_store", store_slowly)
    sample(MODEL, Ensembles(steps=200, count=1, walkers=8), file=tmp_path / "run.h5", progress=step)
    event_variance = np.diff(start)[1:-1]  # the first and the last writing are owed in any case
    assert (event_variance >= 1.0 / 0.1).all()
    assert event_variance.max() < 20.0


def test_an_ensemble_has_more_than_twice_as_many_walkers_as_parameters():
    """With fewer an ensemble stays in a part of the space; emcee wants an even number of at least twice."""
    widths = [width_of(SimpleNamespace(parameters=[None] * count)) for count in range(1, 60)]
    assert widths[0] == 32
    assert all(width % 2 == 0 and width > 2 * count for count, width in enumerate(widths, start=1))


@SHORT
def test_a_file_of_other_data_is_refused(tmp_path):
    sample(MODEL, QUICK, file=tmp_path / "run.h5")
    with pytest.raises(InputError, match="belong to another model"):
        sample(NormalValues(values=MODEL.values + 1.0), QUICK, file=tmp_path / "run.h5")


@SHORT
def test_ensembles_are_independent_and_reproducible():
    single, two = sample(MODEL, QUICK), sample(MODEL, QUICK)
    np.testing.assert_array_equal(single.draws, two.draws)
    assert not np.array_equal(single.draws[0], single.draws[1])


def test_short_run_warns_with_the_reason():
    with pytest.warns(ConvergenceWarning, match=r"NOT CONVERGED.*R-hat.*effective draws"):
        result = sample(MODEL, Ensembles(steps=40, walkers=12))
    assert not result.has_converged
    assert any("R-hat" in sentence for sentence in result.diagnostics.complaints)


@pytest.mark.slow
def test_too_few_ensembles_are_complained_about():
    with pytest.warns(ConvergenceWarning, match="Only 2 independent ensembles"):
        sample(MODEL, Ensembles(steps=1600, count=2, walkers=16))


@pytest.mark.slow
def test_a_long_run_converges_and_reports_its_figures():
    values = np.random.default_rng(2).normal(-1.0, 0.6, 60)
    result = sample(NormalValues(values=values), Ensembles(steps=1600, thin=2, walkers=14))
    table = result.table()
    assert result.has_converged
    assert (table["r_hat"] < 1.01).all()
    assert (table[["bulk_size", "tail_size"]] > 1000.0).all().all()
    assert table["autocorrelation_time"].between(1.0, 100.0).all()
    assert table["mean"].iloc[0] == pytest.approx(values.mean(), abs=0.05)


@pytest.mark.parametrize(("steps", "thin"), [(0, 1), (101, 1), (30, 4)])
def test_steps_must_fit_the_thinning(steps, thin):
    with pytest.raises(InputError, match="multiple of twice the thinning"):
        Ensembles(steps=steps, thin=thin)


DRAWS = np.random.default_rng(5).standard_normal((2, 7, 3, 2))  # ensembles, draws, walkers, parameters
SAMPLE = PosteriorSample(names=("a", "b"), draws=DRAWS, thin=1, accepted=0.3)


def test_the_group_of_draws_has_one_chain_for_each_ensemble(tmp_path):
    SAMPLE.write_netcdf(tmp_path / "draws.nc")
    with xr.open_dataset(tmp_path / "draws.nc", group="posterior", engine="h5netcdf") as posterior:
        assert posterior.sizes == {"chain": 2, "draw": 21}
        for name in ("chain", "draw"):
            assert posterior[name].values.tolist() == list(range(posterior.sizes[name]))
        for k, name in enumerate(SAMPLE.names):
            assert posterior[name].dims == ("chain", "draw")
            assert posterior[name].values.tolist() == DRAWS[..., k].transpose(0, 2, 1).reshape(2, -1).tolist()


def test_tree_equals_file_content(tmp_path):
    SAMPLE.write_netcdf(tmp_path / "draws.nc")
    with xr.open_dataset(tmp_path / "draws.nc", group="posterior", engine="h5netcdf") as posterior:
        assert posterior.load().equals(SAMPLE.to_datatree()["posterior"].to_dataset())


def test_the_same_draws_make_the_same_file(tmp_path):
    for name in ("one.nc", "two.nc"):
        SAMPLE.write_netcdf(tmp_path / name)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()


def test_hdf5_writes_no_file_itself(tmp_path):
    """It would lose the error of a full disk when it closes the file."""
    dataset = []
    opening = h5py.File.__init__

    def watched(self, name, mode="r", *remainder, **larger):
        dataset.append((name, mode))
        opening(self, name, mode, *remainder, **larger)

    with patch.object(h5py.File, "__init__", watched):
        SAMPLE.write_netcdf(tmp_path / "draws.nc")
    assert dataset
    assert not any(isinstance(name, str) and mode != "r" for name, mode in dataset)


def test_r_hat_and_effective_sizes_are_those_of_arviz():
    """Of `arviz.rhat` and `arviz.ess` of ArviZ 0.23.4 for chains that drift and mix slowly."""
    steps = np.random.default_rng(7).normal(size=(4, 60, 12, 2)).cumsum(axis=1)
    draws = 0.2 * steps + np.random.default_rng(8).normal(size=steps.shape)
    result = diagnose(draws, ("first", "second"), 1)
    assert result.r_hat == pytest.approx([1.0494420699778853, 1.074017193162151], rel=1e-9)
    assert result.bulk_size == pytest.approx([127.68912472561152, 111.69269751338625], rel=1e-9)
    assert result.tail_size == pytest.approx([312.4976634048946, 175.2148084866827], rel=1e-9)
