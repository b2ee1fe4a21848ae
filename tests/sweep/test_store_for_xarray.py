"""The store as xarray opens it, chunk by chunk."""

import json
import os
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import zarr

from reliab.core.errors import IncompleteError, InputError
from reliab.sweep import run as stores
from reliab.sweep.request import ExplicitGrid
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.sweep.store_layout import chunk_path, codecs, encode, write_chunk


@pytest.fixture
def dataset(store):
    """The store as xarray opens it by itself; a warning would fail the test."""
    return xr.open_zarr(store)


@pytest.fixture
def old_store(own_store):
    """A store as version 0.3.0 wrote it before: journal among the arrays, nothing gathered or stated."""
    shutil.move(own_store / "journal/entries", own_store / "entries")
    shutil.rmtree(own_store / "journal")
    (own_store / "entries").rename(own_store / "journal")
    for description in own_store.rglob("zarr.json"):
        content = json.loads(description.read_text())
        content.pop("consolidated_metadata", None)
        attributes = content["attributes"]
        for name in ("status", "coordinates", "comment"):
            attributes.pop(name, None)
        if "schema_version" in attributes:
            attributes["schema_version"] = 1
        description.write_text(json.dumps(content))
    return own_store


def test_plain_open_zarr_needs_no_option(store, dataset):
    assert dataset.attrs["window"] == "record"
    assert xr.open_zarr(store, group="window_arias").attrs["window"] == "arias"
    assert xr.open_zarr(store, consolidated=True).identical(dataset)


def test_descriptions_of_motions_are_coordinates(dataset, suite):
    assert set(dataset.coords) == {
        *("motion", "f", "xi", "kp", "tau"),
        *("event", "duration", "dt", "pga", "checksum"),
    }
    assert dataset["rms"].mean("motion").sizes == {"f": 2, "xi": 2, "kp": 29, "tau": 47}
    assert dataset["event"].values.tolist() == list(suite.events)
    groups = dataset["rms"].isel(f=0, xi=0, kp=0, tau=0).load().groupby("event").mean()
    assert groups.sizes == {"event": 3}


def test_every_variable_is_a_number(dataset):
    for variable in dataset.data_vars.values():
        assert variable.dtype.kind in "fb"
    stable = dataset.where(dataset["stable"])
    assert float(stable["rms"].max()) < np.inf
    assert dataset.to_array().sizes["variable"] == len(dataset.data_vars)


def test_xarray_and_open_results_agree(store, dataset):
    ours = open_results(store)
    for name in (*dataset.data_vars, *dataset.coords):
        np.testing.assert_array_equal(np.asarray(dataset[name]).astype(ours[name].dtype), ours[name])


def test_scaled_gains_and_delays_say_so(dataset, tmp_path, suite, request_):
    assert "each xi" in dataset["kp"].attrs["comment"]
    assert "each f and xi" in dataset["tau"].attrs["comment"]
    other_request = replace(request_, grid=ExplicitGrid(), windows=request_.windows[:1])
    explicit = xr.open_zarr(run_sweep(suite[:1], other_request, tmp_path / "explicit.zarr"))
    assert not {"comment"} & (set(explicit["kp"].attrs) | set(explicit["tau"].attrs))
    assert explicit.sel(kp=1.0, tau=0.0)["rms"].max() < 1e-6


def test_unfinished_store_says_so_until_it_is_finished(tmp_path, suite, request_, monkeypatch):
    path, write_chunk = tmp_path / "results.zarr", stores.write_chunk  # type: ignore[attr-defined]

    def full(place, motion_variance, chunk):
        if motion_variance.name.startswith("c.2."):
            raise OSError(28, "No space left on device")
        write_chunk(place, motion_variance, chunk)

    monkeypatch.setattr(stores, "write_chunk", full)
    with pytest.raises(IncompleteError):
        run_sweep(suite, request_, path, workers=1)
    monkeypatch.setattr(stores, "write_chunk", write_chunk)
    for group in ("", "window_arias"):
        partial_file = xr.open_zarr(path, group=group)
        assert partial_file.attrs["status"].startswith("unfinished")
        assert bool(partial_file["rms"].isel(motion=-1).isnull().all())
    run_sweep(suite, request_, path, resume=True)
    for group in ("", "window_arias"):
        assert xr.open_zarr(path, group=group).attrs["status"] == "complete"


def test_attributes_can_be_written_as_netcdf(dataset, tmp_path):
    dataset.isel(motion=0, f=0, xi=0)[["rms", "mte"]].to_netcdf(tmp_path / "some.nc", engine="h5netcdf")
    assert xr.load_dataset(tmp_path / "some.nc").attrs["status"] == "complete"


def test_store_of_the_version_before_is_read_and_not_resumed(store, old_store, suite, request_):
    new, old = open_results(store), open_results(old_store)
    for dataset in (new, old):
        for attributes in (dataset.attrs, *(variable.attrs for variable in dataset.variables.values())):
            for name in ("status", "schema_version", "comment"):
                attributes.pop(name, None)
    assert new.identical(old)
    with pytest.raises(InputError, match=r"schema version 2 can be resumed.*Simulate again to another store"):
        run_sweep(suite, request_, old_store, resume=True)


def test_gathered_descriptions_are_not_trusted(own_store):
    """They are a second copy, which may say anything of arrays that stand beside it."""
    content = json.loads((own_store / "zarr.json").read_text())
    content["consolidated_metadata"]["metadata"]["rms"]["attributes"]["units"] = "m"
    (own_store / "zarr.json").write_text(json.dumps(content))
    assert open_results(own_store)["rms"].attrs["units"] == "1"


@pytest.mark.parametrize(
    "name", ["rms_at_rest/c.1.0.0", "window_arias/rms_at_rest/c.5.0.0", "journal/entries"]
)
def test_lost_chunk_of_any_array_of_the_window_is_named(own_store, name):
    place = own_store / name
    shutil.rmtree(place) if place.is_dir() else place.unlink()
    if "journal" in name:
        assert open_results(own_store).sizes["motion"] == 6  # of use to resume alone
        return
    window = "arias" if "arias" in name else "record"
    with pytest.raises(InputError, match=r"1 of 6 chunks of rms_at_rest missing.*--resume"):
        open_results(own_store, window=window)


def test_a_chunk_of_another_name_replaces_none(own_store):
    (own_store / "rms_at_rest/c.1.0.0").rename(own_store / "rms_at_rest/c.7.0.0")
    with pytest.raises(InputError, match=r"1 of 6 chunks of rms_at_rest missing"):
        open_results(own_store)


def annex(store, repository):
    """Put every chunk where git-annex does, with a link in its place."""
    objects = repository / ".git/annex/objects"
    for number, chunk in enumerate(sorted(path for path in store.rglob("*") if path.is_file())):
        key = objects / f"k{number}" / f"SHA256-{number}"
        key.parent.mkdir(parents=True)
        shutil.move(chunk, key)
        chunk.symlink_to(os.path.relpath(key, chunk.parent))
    return objects


def test_store_under_git_annex_is_read(own_store, store):
    annex(own_store, own_store.parent)
    assert open_results(own_store).identical(open_results(store))


def test_unfetched_content_is_named(own_store):
    objects = annex(own_store, own_store.parent)
    (own_store / "rms/c.3.0.0.0.0").resolve().unlink()
    with pytest.raises(InputError, match=r"c\.3\.0\.0\.0\.0.*git annex get"):
        open_results(own_store)
    assert objects.is_dir()


@pytest.mark.parametrize("is_linked", [False, True])
def test_annex_of_another_repository_is_no_way_out(own_store, tmp_path, is_linked):
    """Neither where the objects are elsewhere, nor where the annex is itself a link to anywhere."""
    elsewhere = tmp_path / "elsewhere"
    annex(own_store, elsewhere)
    if is_linked:
        (own_store.parent / ".git/annex").mkdir(parents=True)
        (own_store.parent / ".git/annex/objects").symlink_to("/")
    with pytest.raises(InputError, match="must not contain links"):
        open_results(own_store)


def test_store_under_git_annex_is_not_written_to(own_store, suite, request_):
    annex(own_store, own_store.parent)
    with pytest.raises(InputError, match="must not contain links"):
        run_sweep(suite, request_, own_store, resume=True)


def test_description_of_endless_chunks_is_refused_at_once(own_store):
    description = own_store / "rms_at_rest/zarr.json"
    content = json.loads(description.read_text())
    content["shape"][0] = 10**12
    description.write_text(json.dumps(content))
    with pytest.raises(InputError):
        open_results(own_store)


@pytest.mark.parametrize("dtype", ["float32", "bool"])
@pytest.mark.parametrize("separator", ["/", "."])  # stores of older versions have folders
def test_bytes_are_those_of_zarr(tmp_path, dtype, separator):
    shape = 2, 1, 41, 21
    samples = np.random.default_rng(1).normal(size=shape)
    samples.flat[0] = np.inf
    values = samples > 0.0 if dtype == "bool" else samples.astype(dtype)
    group = zarr.create_group(tmp_path / "store", zarr_format=3)
    array = group.create_array(
        "values",
        shape=(2, *shape),
        chunks=(1, *shape),
        dtype=dtype,
        compressors=codecs(),
        chunk_key_encoding={"name": "default", "separator": separator},
    )
    array[0] = values
    (first,) = (file for file in (tmp_path / "store" / "values").rglob("*0") if file.is_file())
    assert first.read_bytes() == encode(values)
    motion_variance = chunk_path(Path("values"), array, 1)
    write_chunk(tmp_path / "store", motion_variance, encode(values))
    np.testing.assert_array_equal(array[1], values)
