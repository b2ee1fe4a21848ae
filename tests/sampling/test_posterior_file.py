"""Draws as a file that ArviZ reads: a NetCDF file with a group `posterior` over chains and draws."""

from unittest.mock import patch

import h5py
import numpy as np
import xarray as xr

from reliab.sampling.posterior_sample import PosteriorSample

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


def test_the_tree_is_what_the_file_holds(tmp_path):
    SAMPLE.write_netcdf(tmp_path / "draws.nc")
    with xr.open_dataset(tmp_path / "draws.nc", group="posterior", engine="h5netcdf") as posterior:
        assert posterior.load().equals(SAMPLE.to_datatree()["posterior"].to_dataset())


def test_the_same_draws_make_the_same_file(tmp_path):
    for name in ("one.nc", "two.nc"):
        SAMPLE.write_netcdf(tmp_path / name)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()


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
