"""What fuzzing found, in small."""

import gc
import json
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
import zarr
from scipy.io import savemat

from fuzz import corpus
from fuzz.damage import Instead, write
from fuzz.targets import TARGETS, examine
from fuzz.test_described_files import replace_value
from reliab.core.errors import InputError
from reliab.core.untrusted_files import open_hdf5
from reliab.criterion.criterion import Criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.recording import Recording
from reliab.simulation.frames.transfer_table import read_matlab
from reliab.simulation.hybrid_test.model_file import read_model
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep


@pytest.mark.parametrize("name", TARGETS)
@pytest.mark.parametrize("kind", ["pipe", "zero"])
def test_special_files_are_refused_at_once(name, kind):
    first = max(TARGETS[name].seeds()[0])
    examine(TARGETS[name], {**TARGETS[name].seeds()[0], first: Instead(kind)})


def spoil_file(tmp_path, case, name, change):
    write({**case, name: change(case[name])}, tmp_path)
    return tmp_path / name


def flip_bit(folder, array):
    """Write a store with one bit of the first chunk of an array flipped."""
    case = corpus.stores()[0]
    name = next(name for name in sorted(case) if name.startswith(f"results.zarr/{array}/c."))
    spoil_file(folder, case, name, lambda content: content[:20] + bytes([content[20] ^ 1]) + content[21:])
    return folder / "results.zarr"


def test_a_matlab_file_of_an_unknown_kind_is_explained(tmp_path):
    path = spoil_file(
        tmp_path, corpus.plants()[0], "plant.mat", lambda content: content[:132] + content[100:]
    )
    with pytest.raises(InputError, match="A MATLAB file must be readable"):
        read_matlab(path)


def test_damage_in_a_compressed_matlab_file_is_explained(tmp_path):
    savemat(tmp_path / "test.mat", {"command": np.arange(99.0)}, do_compression=True)
    content = bytearray((tmp_path / "test.mat").read_bytes())
    content[-6] ^= 255
    (tmp_path / "test.mat").write_bytes(content)
    with pytest.raises(InputError, match="Cannot read the file"):
        read_tests(tmp_path / "test.mat")


def test_an_hdf5_file_with_a_damaged_tree_is_explained(tmp_path):
    content = corpus.tests()[4]["test.csv"].replace(b"SNOD", b"SNAD")
    (tmp_path / "test.h5").write_bytes(content)
    with pytest.raises(InputError, match="Cannot read the file"):
        read_tests(tmp_path / "test.h5")


def test_endless_texts_of_hdf5_are_refused(tmp_path):
    path = tmp_path / "record.h5"
    with h5py.File(path, "w") as file:
        file.attrs.create("names", ["command", "measured"], dtype=h5py.string_dtype())
    content = bytearray(path.read_bytes())
    heap = content.index(b"GCOL")
    with open_hdf5(path) as file:
        assert list(file.attrs["names"]) == ["command", "measured"]
    content[heap + 16 : heap + 32] = bytes(16)
    path.write_bytes(content)
    with pytest.raises(InputError, match="must follow each other"), open_hdf5(path):
        pass


@pytest.mark.parametrize(
    ("table", "rule"), [("a,b\n1e-4,20,30\n", "must be a readable CSV file"), ("a,b\n\n", "has no rows")]
)
def test_a_table_of_ellipses_without_whole_rows_is_refused(tmp_path, table, rule):
    (tmp_path / "ellipses.csv").write_text(table)
    with pytest.raises(InputError, match=rule):
        read_ellipses(tmp_path / "ellipses.csv")


def test_a_file_of_ellipses_cut_short_is_explained_without_a_traceback(tmp_path, capfd):
    path = spoil_file(tmp_path, corpus.ellipse_files()[0], "ellipses.nc", lambda content: content[:900])
    with pytest.raises(InputError, match="Ellipses in NetCDF are a and b"):
        open_ellipses(path)
    assert capfd.readouterr().err == ""


def test_a_store_with_a_damaged_chunk_is_refused(tmp_path):
    results = open_results(flip_bit(tmp_path, "rms"))
    with pytest.raises(InputError, match="with every checksum right"):
        results.reliab.ellipses()


@pytest.mark.parametrize(
    "name", ["rms/c.1", "A/c.", "stable/c.", "rms_at_rest/c.", "kp/c.", "f/c.", "event/c.", "motion/c."]
)
def test_a_store_without_a_chunk_is_refused(tmp_path, name):
    """Zarr would put NaN, False or empty names in its place."""
    case = corpus.stores()[0]
    chunk = next(file for file in sorted(case) if file.startswith(f"results.zarr/{name}"))
    write({file: content for file, content in case.items() if file != chunk}, tmp_path)
    with pytest.raises(InputError, match=f"1 of . chunks of {name.partition('/')[0]} missing"):
        open_results(tmp_path / "results.zarr")


@pytest.mark.parametrize("name", ["rms", "kp", "event"])
def test_a_store_without_an_array_is_refused_without_a_warning(tmp_path, name, capfd):
    case = corpus.stores()[0]
    write({f: c for f, c in case.items() if f != f"results.zarr/{name}/zarr.json"}, tmp_path)
    with pytest.raises(InputError, match=f"no array {name}"):
        open_results(tmp_path / "results.zarr")
    assert capfd.readouterr().err == ""


@pytest.mark.slow
def test_a_store_with_several_damaged_arrays_is_one_error_and_no_traceback(tmp_path, caplog):
    case = corpus.stores()[0]
    names = [f"results.zarr/{name}/zarr.json" for name in ("A", "kp", "mte", "rms_at_rest", "motion")]
    write({**case, **{name: case[name][:90] for name in names}}, tmp_path)
    with pytest.raises(InputError, match="must be as `reliab simulate` wrote them"):
        open_results(tmp_path / "results.zarr")
    gc.collect()  # what event loops tell, they tell of tasks that are forgotten
    assert caplog.records == []


@pytest.mark.parametrize("key", ["study_hash", "windows", "experimental_fraction"])
def test_a_store_without_an_attribute_is_refused(tmp_path, key):
    write(corpus.stores()[0], tmp_path)
    group = zarr.open_group(tmp_path / "results.zarr", mode="r+")
    attributes = dict(group.attrs)
    del attributes[key]
    group.attrs.clear()
    group.attrs.update(attributes)
    with pytest.raises(InputError):
        open_results(tmp_path / "results.zarr").reliab.ellipses()


def change_metadata(folder, name, change):
    """Write a store whose description of a group or array is changed."""
    case = corpus.stores()[0]
    file = f"results.zarr/{name}zarr.json"
    description = json.loads(case[file])
    change(description)
    write({**case, file: json.dumps(description).encode()}, folder)
    return folder / "results.zarr"


@pytest.mark.parametrize("windows", [[], "", None, ["arias"]])
def test_a_store_without_its_first_window_is_refused(tmp_path, windows):
    store = change_metadata(
        tmp_path, "", lambda description: description["attributes"].update(windows=windows)
    )
    with pytest.raises(InputError):
        open_results(store)


@pytest.mark.parametrize(
    ("name", "dimensions"),
    [
        ("rms", ["mo[[tests]]tion", "f", "xi", "kp", "tau"]),
        ("mte", ["motion", "xi", "f", "kp", "tau"]),
        ("event", ["f"]),
        ("kp", ["xi", "tau"]),
        ("tau", ["kp", "xi", "tau"]),
        ("f", ["xi"]),
    ],
)
def test_a_store_with_an_array_over_other_dimensions_is_refused(tmp_path, name, dimensions):
    store = change_metadata(
        tmp_path, f"{name}/", lambda description: description.update(dimension_names=dimensions)
    )
    with pytest.raises(InputError, match="must be as `reliab simulate` wrote them"):
        open_results(store)


def test_nothing_is_written_where_a_link_in_a_store_leads():
    case = corpus.stores()[0]
    assert not examine(TARGETS["resume"], {**case, "results.zarr/motion/c.0": Instead("secret")})


@pytest.mark.parametrize(
    ("name", "shape", "chunks"),
    [
        ("journal/entries", [0], [2]),
        ("pga", [999999999999999999999], [2]),
        ("checksum", [2], [10**12]),
        ("mte", [2, 1, 1, 13, 10**12], [1, 1, 1, 13, 35]),
        ("rms", [2, 1, 1, 13, 35], [1, 1, 1, 13, 7]),
    ],
)
def test_a_store_with_arrays_of_other_shapes_is_not_resumed(tmp_path, name, shape, chunks):
    def reshape(description):
        description["shape"] = shape
        description["chunk_grid"]["configuration"]["chunk_shape"] = chunks

    store = change_metadata(tmp_path, f"{name}/", reshape)
    with pytest.raises(InputError, match="A store can be resumed only if"):
        run_sweep(corpus.suite(), corpus.REQUEST, store, resume=True)


def test_chains_with_a_damaged_random_state_are_not_resumed(tmp_path):
    path = spoil_file(tmp_path, corpus.chains()[0], "chains.h5", lambda content: content)
    with h5py.File(path, "r+") as file:
        file["run/ensemble_0"].attrs["random_state_0"] = "PCG64"
    with pytest.raises(InputError, match="The file of the chains"):
        TARGETS["chains"].read(tmp_path)


@pytest.mark.parametrize("spoil", [float("nan"), 0.25])
def test_chains_with_a_changed_value_are_not_resumed(tmp_path, spoil):
    path = spoil_file(tmp_path, corpus.chains()[0], "chains.h5", lambda content: content)
    with h5py.File(path, "r") as file:
        values = file["run/ensemble_0/chain"][...]
    place = path.read_bytes().index(values[3, 2, 0].tobytes())
    content = bytearray(path.read_bytes())
    content[place : place + 8] = np.float64(spoil).tobytes()
    path.write_bytes(content)
    with pytest.raises(InputError, match="The file of the chains"):
        TARGETS["chains"].read(tmp_path)


@pytest.mark.parametrize("value", [1e308, -1e160])
def test_an_impossible_displacement_is_refused(value):
    histories = corpus.test_histories()
    command, measured = (histories[name].to_numpy(copy=True) for name in ("command_m", "measured_m"))
    measured[300] = value
    with pytest.raises(InputError, match="Not a finite number below 1e"):
        Recording(command=command, measured=measured, time_step=0.01)


def campaign(folder: Path, **changes: bytes) -> Path:
    write({**corpus.campaign()[0], **{f"{name}.csv": content for name, content in changes.items()}}, folder)
    return folder


@pytest.mark.parametrize(
    ("target", "text", "replacement", "rule"),
    [
        *(
            ("campaign", rb'"a\.csv"', json.dumps(name).encode(), "lies outside the folder")
            for name in ("../a.csv", "/etc/passwd", "b/../../a.csv")
        ),
        ("campaign", rb'"b\.csv"', b'"./a.csv"', "A file must be listed for one test only"),
        ("campaign", rb'motion = "one"', b"held_out = true", "At least one test must not be held out"),
        ("campaign", rb"(?s)\A.+", b"", "sampling is missing"),
        *(
            (
                *("campaign", rb"(?<=frequency_hz = )\S+", number),
                r"line 3.*frequency_hz: the natural frequency must be between",
            )
            for number in (b"1e-320", b"1e308")
        ),
        ("frame", rb"(?<=storey_height_m = )\S+", b"1e308", "storey_height_m: the length must be between"),
        ("frame", rb"(?<=storeys = )\S+", b"1000000", "5,000 displacements and rotations at most"),
    ],
)
def test_a_described_fault_is_refused_by_its_rule(tmp_path, target, text, replacement, rule):
    file = f"{target}.toml"
    case = next(case for case in TARGETS[target].seeds() if re.search(text, case[file]))
    content, count = re.subn(text, lambda _: replacement, case[file])
    assert count == 1
    write({**case, file: content}, tmp_path)
    with pytest.raises(InputError, match=rule):
        TARGETS[target].read(tmp_path)


@pytest.mark.parametrize("column", [0, 2])
def test_an_impossible_value_of_a_campaign_is_refused(tmp_path, column):
    lines = corpus.campaign()[0]["a.csv"].split(b"\n")
    cells = lines[7].split(b",")
    cells[column] = b"-1e308"
    lines[7] = b",".join(cells)
    with pytest.raises(InputError, match=r"Not a finite number below|by equal steps"):
        read_campaign(campaign(tmp_path, a=b"\n".join(lines)))


def test_a_line_of_too_many_cells_is_refused(tmp_path):
    lines = corpus.campaign()[0]["a.csv"].split(b"\n")
    lines[7] += b",5"
    with pytest.raises(InputError, match="6 columns, but 5 in the first line"):
        read_campaign(campaign(tmp_path, a=b"\n".join(lines)))


def test_a_test_without_ends_of_lines_is_not_followed_for_ever(tmp_path):
    from reliab.recordings.following import chunks_of_text, rows_as_written

    (tmp_path / "test.csv").write_bytes(b"x" * 200_000)
    pieces = chunks_of_text(str(tmp_path / "test.csv"), wait=0.01, start_within=0.01)
    with pytest.raises(InputError, match="characters"):
        list(rows_as_written(pieces, name="test.csv", declarations={}))


@pytest.mark.parametrize("table", ["", "[actuator]\n"])
def test_a_key_without_end_gives_a_short_error(tmp_path, table):
    sound = corpus.models()[0]["model.toml"].decode()
    path = tmp_path / "model.toml"
    path.write_text(table + "x" * 10_000 + " = 1\n" if table else "x" * 10_000 + " = 1\n" + sound)
    with pytest.raises(InputError) as refusal:
        read_model(path)
    assert len(str(refusal.value)) < 2500


def test_matlab_numbers_of_no_kind_are_refused_before_scipy_reads_them(tmp_path):
    content = bytearray(corpus.plants()[0]["plant.mat"])
    place = content.index(b"num") + 4
    content[place : place + 2] = (1234).to_bytes(2, "little")
    (tmp_path / "plant.mat").write_bytes(content)
    with pytest.raises(InputError, match="A MATLAB file must be readable; found numbers of the unknown kind"):
        read_matlab(tmp_path / "plant.mat")


def test_an_ellipse_beyond_any_boundary_is_refused(tmp_path):
    text = corpus.ellipse_tables()[0]["ellipses.csv"].replace(b",0.0", b",1e30", 1)
    (tmp_path / "ellipses.csv").write_bytes(text)
    assert not examine(TARGETS["ellipse_table"], {"ellipses.csv": text})


def test_a_running_test_refuses_an_impossible_displacement():
    text = corpus.tests()[0]["test.csv"].split(b"\n")
    text[300] = text[300].rsplit(b",", 1)[0] + b",1e308"
    assert not examine(TARGETS["monitor"], {"test.csv": b"\n".join(text)})


def test_a_store_with_damaged_delays_is_refused(tmp_path):
    with pytest.raises(InputError, match="with every checksum right"):
        open_results(flip_bit(tmp_path, "tau"))


@pytest.mark.parametrize("digits", [21, 400])
def test_a_criterion_with_a_whole_number_of_very_many_digits_is_read_or_refused(digits):
    """NumPy holds whole numbers of nineteen digits, floating-point ones of 308."""
    content = json.loads(corpus.criteria()[2]["criterion.json"])
    content["law"]["a"][0][0] = int("9" * digits)
    if digits == 21:
        a, _ = Criterion.from_json(json.dumps(content)).limits(0.5, 0.02)
        assert a == pytest.approx(1e21)
    else:
        with pytest.raises(InputError, match="Not a finite number"):
            Criterion.from_json(json.dumps(content))


@pytest.mark.parametrize(
    ("place", "value", "rule"),
    [
        (("population", "log_alpha", 0, 0, 0), 1e308, "Logarithms of ellipse parameters"),
        (("law", "a", 0), [1e308], r"must be .*, at most 1e\+30"),
        (("law", "frequencies", -1), 1e308, r"must be .*, at most 1e\+30"),
    ],
)
def test_a_criterion_of_immense_numbers_is_refused(place, value, rule):
    content = json.loads(corpus.criteria()[2]["criterion.json"])
    with pytest.raises(InputError, match=rule):
        Criterion.from_json(json.dumps(replace_value(content, place, value)))


@pytest.mark.parametrize("denominator", [[5e-256, 8e-53, 1e184], [1e20, 1e200, 1e20]])
def test_plant_coefficients_of_immense_ratio_are_refused(tmp_path, denominator):
    savemat(tmp_path / "plant.mat", {"num": [1.0, 2.0], "den": denominator})
    with pytest.raises(InputError, match=r"The denominator .* at most 1e\+100 times the first"):
        read_matlab(tmp_path / "plant.mat")
