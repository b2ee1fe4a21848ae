"""A chunk is written byte by byte as Zarr writes it, and read back by Zarr."""

from pathlib import Path

import numpy as np
import pytest
import zarr

from reliab.sweep.store_layout import ChunkNames, codecs, encoded, write_chunk


@pytest.mark.parametrize("dtype", ["float32", "bool"])
@pytest.mark.parametrize("separator", ["/", "."])  # stores of older versions have folders
def test_bytes_are_those_of_zarr(tmp_path, dtype, separator):
    shape = 2, 1, 41, 21
    drawn = np.random.default_rng(1).normal(size=shape)
    drawn.flat[0] = np.inf
    values = drawn > 0.0 if dtype == "bool" else drawn.astype(dtype)
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
    assert first.read_bytes() == encoded(values)
    within = ChunkNames.of_array(Path("values"), array).of_motion(1)
    write_chunk(tmp_path / "store", within, encoded(values))
    np.testing.assert_array_equal(array[1], values)
