"""What somebody sent names files within itself only: no place of it leads to another file of this machine."""

import ast
import json
import os
import pickle
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import pytest
from fuzz import corpus
from fuzz.damage import write
from parsed import nodes

import reliab
from reliab.core import untrusted_files as received
from reliab.core.errors import InputError
from reliab.core.untrusted_files import objects_of, open_hdf5, resolve_within
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions
from reliab.recordings.readers.registry import read_tests
from reliab.report.content import read_content
from reliab.sampling.ensembles import draw
from reliab.simulation.frames.frame_file import read_frame
from reliab.study.stages import RunFolder
from reliab.study.steps import read_run_dataset
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep

PACKAGE = Path(reliab.__file__).parent
FRAME = next(case["frame.toml"] for case in corpus.frames() if b"[transfer_system]" not in case["frame.toml"])
A_CHUNK = "results.zarr/rms/c.0.0.0.0.0"
RIG = b'\n[transfer_system]\nfile = "plant.mat"\n'


class Place(NamedTuple):
    """A place of a folder in which a file is named: `old` in the file `listed`, or only the file itself."""

    make: Callable[[], dict[str, bytes]]
    read: Callable[[Path], object]
    file: str
    listed: str = ""


def first_motion(folder):
    return load_motions(folder)[0].acceleration


def checked(folder):
    faults = inspect(folder).faults
    if faults:
        raise faults[0].error()


def record():
    return {"a.AT2": corpus.catalogue()[0]["a.AT2"]}


def run_of_a_study():
    figure = b'<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>'
    parts = {"blocks": [{"kind": "figure", "file": "figure-1.svg"}]}
    return {"report/document.json": json.dumps(parts).encode(), "report/figure-1.svg": figure}


def finish_run():
    return {"manifest.json": b'{"stages": {}}', **run_of_a_study()}


def open_run(folder):
    with RunFolder.open(folder, study={}):
        pass


def frame():
    return {"frame.toml": FRAME + RIG, **corpus.plants()[0]}


def results(folder):
    return open_results(folder / "results.zarr")["rms"].values


def resumed(folder):
    run_sweep(corpus.suite(), corpus.REQUEST, folder / "results.zarr", resume=True)


PLACES = {
    "catalogue's file": Place(lambda: corpus.catalogue()[0], first_motion, "a.AT2", "catalog.csv"),
    "catalogue's file, checked": Place(lambda: corpus.catalogue()[0], checked, "a.AT2", "catalog.csv"),
    "catalogue": Place(lambda: corpus.catalogue()[0], first_motion, "catalog.csv"),
    "record": Place(record, first_motion, "a.AT2"),
    "record, checked": Place(record, checked, "a.AT2"),
    "campaign's test": Place(lambda: corpus.campaign()[0], read_campaign, "a.csv", "campaign.toml"),
    "campaign": Place(lambda: corpus.campaign()[0], read_campaign, "campaign.toml"),
    "frame's rig": Place(frame, lambda folder: read_frame(folder / "frame.toml"), "plant.mat", "frame.toml"),
    "report's figure": Place(
        run_of_a_study,
        lambda folder: read_content(folder / "report"),
        "figure-1.svg",
        "report/document.json",
    ),
    "report's content": Place(
        run_of_a_study, lambda folder: read_content(folder / "report"), "document.json"
    ),
    "run's manifest": Place(finish_run, open_run, "manifest.json"),
    "store's chunk": Place(lambda: corpus.stores()[0], results, A_CHUNK),
    "store's description": Place(lambda: corpus.stores()[0], results, "results.zarr/zarr.json"),
    "resumed store's chunk": Place(lambda: corpus.stores()[0], resumed, A_CHUNK),
}


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "sent"
    path.mkdir()
    return path


def stands_at(folder, place):
    return folder / Path(place.listed).parent / place.file


@pytest.mark.parametrize("name", PLACES)
def test_a_sound_folder_is_read(name, folder):
    place = PLACES[name]
    write(place.make(), folder)
    place.read(folder)


@pytest.mark.parametrize("kind", ["absolute", "relative"])
@pytest.mark.parametrize("name", PLACES)
def test_a_link_leading_out_of_the_folder_is_refused(name, kind, folder, tmp_path):
    """What the link leads to is sound, so that nothing but the link is wrong."""
    place = PLACES[name]
    write(place.make(), folder)
    member = next(
        path for path in folder.rglob(Path(place.file).name) if path.as_posix().endswith(place.file)
    )
    elsewhere = Path(shutil.move(member, tmp_path / "elsewhere"))
    member.symlink_to(os.path.relpath(elsewhere, member.parent) if kind == "relative" else elsewhere)
    with pytest.raises(InputError, match=r"lies outside the folder|must not contain links"):
        place.read(folder)


@pytest.mark.parametrize("written", ["../NAME", "FOLDER/NAME", "b/../../NAME", "b/../NAME", "link/NAME"])
@pytest.mark.parametrize("name", [name for name, place in PLACES.items() if place.listed])
def test_a_name_leading_out_of_the_folder_is_refused(name, written, folder):
    place = PLACES[name]
    write(place.make(), folder)
    member = stands_at(folder, place)
    (member.parent / "b").mkdir()
    (member.parent / "link").symlink_to(member.parent.parent)
    shutil.copy(member, member.parent.parent / member.name)
    hostile = written.replace("NAME", member.name).replace("FOLDER", str(member.parent.parent))
    member = folder / place.listed
    member.write_text(member.read_text().replace(place.file, hostile, 1))
    with pytest.raises(InputError, match=r"lies outside the folder|a figure of the name"):
        place.read(folder)


def test_one_file_under_two_names_is_one_file(folder):
    write(corpus.campaign()[0], folder)
    (folder / "b.csv").unlink()
    (folder / "b.csv").symlink_to("a.csv")
    with pytest.raises(InputError, match="must be listed for one test only"):
        read_campaign(folder)


def test_a_linked_folder_is_read(folder, tmp_path):
    write(corpus.campaign()[0], folder)
    (tmp_path / "link").symlink_to(folder)
    assert len(read_campaign(tmp_path / "link").tests) == 2


@pytest.mark.parametrize("name", ["a\0b", "../a", "/a", ".."])
def test_invalid_names_are_refused(name, folder):
    with pytest.raises(InputError, match=r"catalog\.csv, line 2: (The|A) file"):
        resolve_within(folder, name, where="catalog.csv, line 2")


def resume_chains(path):
    draw(corpus.CHAIN_MODEL, corpus.CHAIN_SETTINGS, file=path, group="run")


HDF5 = {
    "a test": (corpus.tests, read_tests),
    "ellipses": (corpus.ellipse_files, open_ellipses),
    "results": (corpus.ellipse_files, open_results),
    "a run": (corpus.ellipse_files, read_run_dataset),
    "chains": (corpus.chains, resume_chains),
}
"""Seeds of everything that is read from HDF5, and its reader."""


def hdf5_of(seeds, folder):
    for case in seeds:
        for name, content in case.items():
            if content.startswith(b"\x89HDF"):
                (folder / name).write_bytes(content)
                return folder / name
    raise LookupError


def replace_group(path, kind):
    """Put the data of the largest dataset into another file, and name that."""
    with h5py.File(path, "r+") as file:
        parts = [(name, item) for name, item in objects_of(file) if isinstance(item, h5py.Dataset)]
        name, item = max(parts, key=lambda part: part[1].size * (part[1].dtype.kind == "f"))
        values = item[...]
        with h5py.File(path.with_name("other.h5"), "w") as second:
            second["x"] = values
        values.tofile(path.with_name("raw.bin"))
        del file[name]
        if kind == "external link":
            file[name] = h5py.ExternalLink("other.h5", "/x")
        elif kind == "raw storage":
            raw = [(str(path.with_name("raw.bin")), 0, values.nbytes)]
            file.create_dataset(name, values.shape, values.dtype, external=raw)
        elif kind == "virtual":
            layout = h5py.VirtualLayout(values.shape, values.dtype)
            layout[...] = h5py.VirtualSource(path.with_name("other.h5"), "x", shape=values.shape)
            file.create_virtual_dataset(name, layout)
        elif kind == "soft link through an external one":
            file["aside"] = h5py.ExternalLink("other.h5", "/")
            file[name] = h5py.SoftLink("/aside/x")


@pytest.mark.parametrize(
    "kind", ["external link", "raw storage", "virtual", "soft link through an external one"]
)
@pytest.mark.parametrize("what", HDF5)
def test_data_of_another_hdf5_file_are_refused(what, kind, tmp_path):
    seeds, read = HDF5[what]
    path = hdf5_of(seeds(), tmp_path)
    replace_group(path, kind)
    with pytest.raises(InputError, match="are in another file"):
        read(path)


def test_groups_in_a_circle_and_soft_links_are_walked_once(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a/b"] = np.arange(3)
        file["a/again"] = file["a"]
        file["a/soft"] = h5py.SoftLink("/a/b")
        file["c"] = file["a/b"]
    with open_hdf5(tmp_path / "a.h5") as file:
        assert [name for name, _ in objects_of(file)] == ["a", "a/b"]


def test_many_groups_in_each_other_are_refused_without_going_through_them(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        group = file
        for _ in range(1000):
            group = group.create_group("g")
    refusal = pytest.raises(InputError, match="are nested more than 32 deep")
    with refusal, open_hdf5(tmp_path / "a.h5"):
        pass


class OpenFile:
    """Leaves a file behind when it is unpickled."""

    def __init__(self, path):
        self.path = str(path)

    def __reduce__(self):
        return open, (self.path, "w")


def test_a_store_format_with_code_is_refused(folder, tmp_path):
    """Version 2 of Zarr has a filter that unpickles; version 3 has none."""
    write(corpus.stores()[0], folder)
    store = folder / "results.zarr"
    content = json.loads((store / "zarr.json").read_text())
    (store / "zarr.json").unlink()
    (store / ".zgroup").write_text('{"zarr_format": 2}')
    (store / ".zattrs").write_text(json.dumps(content["attributes"]))
    for path in store.rglob("zarr.json"):
        array = json.loads(path.read_text())
        if array["node_type"] != "array":
            continue
        names = {"_ARRAY_DIMENSIONS": array["dimension_names"]}
        filters = [{"id": "vlen-utf8"}, {"id": "pickle", "protocol": 5}]
        plain = {"zarr_format": 2, "dtype": "|O", "order": "C", "compressor": None, "fill_value": None}
        shape = {"shape": array["shape"], "chunks": array["shape"], "filters": filters}
        (path.parent / ".zattrs").write_text(json.dumps(names))
        (path.parent / ".zarray").write_text(json.dumps(plain | shape))
        chunk = ".".join("0" for _ in array["shape"])
        (path.parent / chunk).write_bytes(pickle.dumps(OpenFile(tmp_path / "executed")))
    numcodecs = pytest.importorskip("numcodecs.pickles")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numcodecs, "ALLOW_UNSAFE_PICKLE_DECODE", True, raising=False)  # as older ones are
        for read in (results, resumed):
            with pytest.raises(InputError):
                read(folder)
    assert not (tmp_path / "executed").exists()


DOORS = {
    "File": {"core/untrusted_files.py", "core/hdf5_probe.py"},  # and one that writes, in memory
    "open_group": {"sweep/store_layout.py"},
    "open_dataset": {"sweep/netcdf.py"},
    "open_zarr": {"sweep/results.py"},
    "load": set(),
    "loads": set(),
    "read_pickle": set(),
    "compile": {"report/pdf.py"},
}
LIBRARIES = {"h5py", "zarr", "xr", "np", "numpy", "pickle", "marshal", "joblib", "pd", "pandas", "typst"}


def test_unsafe_libraries_are_called_at_one_place():
    stray = {
        f"{path.relative_to(PACKAGE)}: {ast.unparse(node.func)}"
        for path in PACKAGE.rglob("*.py")
        for node in nodes(path)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
        if isinstance(node.func.value, ast.Name) and node.func.value.id in LIBRARIES
        if str(path.relative_to(PACKAGE)) not in DOORS.get(node.func.attr, {str(path.relative_to(PACKAGE))})
    }
    assert stray == {"sampling/ensembles.py: h5py.File"}  # which writes


def test_a_file_crashing_its_reader_is_refused(tmp_path, monkeypatch):
    """A library that fails on a file takes another process with it, not this one."""
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["a"] = np.arange(9.0)
    probe = tmp_path / "hdf5_probe.py"
    monkeypatch.setattr(received, "_PROBE", received._Probe(probe))  # noqa: SLF001 - in place of the shared one
    for answer in ("os.abort()", "print('failed', flush=True)"):
        probe.write_text(f"import os, sys\nprint('ready', flush=True)\nsys.stdin.readline()\n{answer}\n")
        with pytest.raises(InputError, match=r"a\.h5: The HDF5 library fails"), open_hdf5(path):
            pass
        received._PROBE.end()  # noqa: SLF001
    probe.write_text(
        "import sys\nprint('ready', flush=True)\nsys.stdin.readline()\nprint('read', flush=True)\n"
    )
    for _ in range(2):  # also after the other process has ended
        with open_hdf5(path) as file:
            assert file["a"][8] == 8.0
        os.utime(path, ns=(1, 1))
        received._PROBE._process.wait()  # noqa: SLF001
    received._PROBE.end()  # noqa: SLF001
    probe.write_text("raise SystemExit")
    with open_hdf5(path) as file:  # where no other process can be had
        assert file["a"][8] == 8.0


@pytest.mark.parametrize("value", [3.0, "scale", np.arange(3)])
def test_an_unexpected_attribute_of_scales_is_refused(tmp_path, value):
    """The library reads beyond its memory there, which ended `reliab record` with a segmentation fault."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a"] = np.zeros((300, 3))
        file["a"].attrs["DIMENSION_LIST"] = value
    for read in (read_tests, open_ellipses):
        with pytest.raises(InputError, match=r"DIMENSION_LIST|The HDF5 library fails"):
            read(tmp_path / "a.h5")
