"""Nothing of a stored dataset depends on the order in which a disk lists its folders."""

import json
import shutil

import reliab
from reliab.motions.loading import load_motions
from reliab.sweep.results import open_results


def test_variables_stand_in_the_same_order_however_the_store_lists_them(tmp_path):
    reliab.simulate(load_motions("synthetic")[:2], out=tmp_path / "one.zarr")
    described = json.loads((tmp_path / "one.zarr/zarr.json").read_text(encoding="utf-8"))
    assert described["node_type"] == "group"
    (tmp_path / "two.zarr").mkdir()
    for place in sorted((tmp_path / "one.zarr").iterdir(), reverse=True):
        copied = tmp_path / "two.zarr" / place.name
        shutil.copytree(place, copied) if place.is_dir() else shutil.copy(place, copied)
    one, two = (open_results(tmp_path / f"{name}.zarr") for name in ("one", "two"))
    assert list(one.variables) == list(two.variables) == sorted(one.variables)
    assert one.load().identical(two.load())
