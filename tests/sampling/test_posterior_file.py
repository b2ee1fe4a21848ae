"""Draws as a file that ArviZ reads."""

from unittest.mock import patch

import arviz
import h5py
import numpy as np

from reliab.sampling.posterior_sample import PosteriorSample

DRAWS = np.random.default_rng(5).standard_normal((2, 7, 3, 2))  # ensembles, draws, walkers, parameters
SAMPLE = PosteriorSample(names=("a", "b"), draws=DRAWS, thin=1, accepted=0.3)


def test_arviz_reads_the_draws_one_chain_for_each_ensemble(tmp_path):
    SAMPLE.write_netcdf(tmp_path / "draws.nc")
    posterior = arviz.from_netcdf(tmp_path / "draws.nc").posterior
    assert dict(posterior.sizes) == {"chain": 2, "draw": 21}
    for k, name in enumerate(SAMPLE.names):
        assert np.sort(posterior[name].values, axis=1).tolist() == (
            np.sort(DRAWS[..., k].reshape(2, -1), axis=1).tolist()
        )


def test_hdf5_writes_no_file_itself(tmp_path):
    """It would lose the error of a full disk when it closes the file."""
    opened = []
    opening = h5py.File.__init__

    def watched(self, name, mode="r", *rest, **more):
        opened.append((name, mode))
        opening(self, name, mode, *rest, **more)

    with patch.object(h5py.File, "__init__", watched):
        SAMPLE.write_netcdf(tmp_path / "draws.nc")
    assert opened
    assert not any(isinstance(name, str) and mode != "r" for name, mode in opened)
