"""Scale, offset and marks of missing samples that a file states are applied or refused, and listed."""

from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from scipy.io import netcdf_file, savemat

from reliab.core.errors import InputError
from reliab.recordings.readers.columns import series_of
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.reading import read_recording
from reliab.recordings.record import check_record, record_test, write_record

TIME = np.arange(2000) / 200.0
COMMAND = 0.02 * np.sin(6.0 * TIME)
MEASURED = 0.9 * COMMAND
COUNTS = {
    "command": np.round(COMMAND / 1e-6).astype("i4"),
    "measured": np.round(MEASURED / 2e-6).astype("i4"),
}
SCALES = {"command": {"scale_factor": 1e-6, "units": "m"}, "measured": {"scale_factor": 2e-6, "units": "m"}}


def hdf5(folder, **measured_part):
    with h5py.File(folder / "t.h5", "w") as file:
        file["time"] = TIME
        file["time"].attrs["units"] = "s"
        for name, counts in COUNTS.items():
            values = measured_part.pop("values", counts) if name == "measured" else counts
            file[name] = values
            file[name].attrs.update({**SCALES[name], **(measured_part if name == "measured" else {})})
    return folder / "t.h5"


def write_with_xarray(folder):
    variables = {
        name: ("time", v, {"units": "m"}) for name, v in (("command", COMMAND), ("measured", MEASURED))
    }
    archive = {"dtype": "int32", "scale_factor": 1e-7, "add_offset": 0.003, "_FillValue": -(2**31)}
    data = xr.Dataset(variables, coords={"time": ("time", TIME, {"units": "s"})})
    data.to_netcdf(folder / "t.nc", engine="h5netcdf", encoding=dict.fromkeys(COUNTS, archive))
    return folder / "t.nc"


def classic(folder):
    with netcdf_file(folder / "t.nc", "w") as file:
        file.createDimension("time", TIME.size)
        histories: list[tuple[str, str, Any, dict[str, Any]]] = [("time", "d", TIME, {"units": "s"})]
        histories += [(name, "i", COUNTS[name], SCALES[name]) for name in COUNTS]
        for name, kind, values, attributes in histories:
            variable = file.createVariable(name, kind, ("time",))
            variable[:] = values
            for attribute, value in attributes.items():
                setattr(variable, attribute, value)
    return folder / "t.nc"


def tdms(folder):
    from nptdms import ChannelObject, TdmsWriter

    clock = {"wf_increment": 1.0 / 200.0, "unit_string": "m"}
    with TdmsWriter(str(folder / "t.tdms")) as writer:
        scales = {name: {"scale_factor": SCALES[name]["scale_factor"]} for name in COUNTS}
        content = [ChannelObject("a", n, v, properties={**clock, **scales[n]}) for n, v in COUNTS.items()]
        writer.write_segment(content)
    return folder / "t.tdms"


def tdms_of_daqmx(folder, kind="Linear"):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(str(folder / "t.tdms")) as writer:
        for name, values in COUNTS.items():
            scale = {
                "NI_Number_Of_Scales": 1,
                "NI_Scaling_Status": "unscaled",
                "NI_Scale[0]_Scale_Type": kind,
            }
            scale |= {"NI_Scale[0]_Linear_Slope": SCALES[name]["scale_factor"], "unit_string": "m"}
            scale |= {"NI_Scale[0]_Linear_Y_Intercept": 0.0, "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF}
            writer.write_segment(
                [ChannelObject("a", name, values, properties={**scale, "wf_increment": 0.005})]
            )
    return folder / "t.tdms"


def matlab(folder):
    content = {name: {"data": COUNTS[name].astype(float), **SCALES[name]} for name in COUNTS}
    savemat(folder / "t.mat", {"t": TIME, **content})
    return folder / "t.mat"


@pytest.mark.parametrize("write", [hdf5, write_with_xarray, classic, tdms, tdms_of_daqmx, matlab])
def test_packed_numbers_are_unpacked_and_the_scale_is_listed(tmp_path, write):
    test = read_recording(write(tmp_path))
    np.testing.assert_allclose(test.measured, MEASURED, atol=3e-6)
    np.testing.assert_allclose(test.command, COMMAND, atol=3e-6)
    reading = next(channel for channel in test.channels if channel.part == "measured")
    assert "scale" in reading.corrections[0]
    assert any("scale" in note for note in test.notes)


def mark_samples(value):
    counts = COUNTS["measured"].copy()
    counts[700:703] = value
    return counts


@pytest.mark.parametrize(
    "attributes",
    [
        {"values": mark_samples(-9999), "_FillValue": np.int32(-9999)},
        {"values": mark_samples(-9999), "missing_value": [-8888, -9999]},
        {"values": mark_samples(99999), "valid_max": np.int32(90000)},
        {"values": mark_samples(-99999), "valid_range": np.array([-90000, 90000], dtype="i4")},
        {"values": mark_samples(99999), "valid_range": [-0.15, 0.15]},
    ],
    ids=["fill value", "missing values", "largest", "range of counts", "range in metres"],
)
def test_marked_sample_is_a_gap(tmp_path, attributes):
    with pytest.raises(
        InputError, match=r"t\.h5, sample 701, column measured: .*marked as missing, 3 in all"
    ):
        read_recording(hdf5(tmp_path, **attributes))


def test_unwritten_chunk_is_a_gap(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["time"] = TIME
        for name, values in (("command", COMMAND), ("measured", MEASURED)):
            data = file.create_dataset(name, shape=values.shape, chunks=(100,), dtype="f8")
            data[:700] = values[:700]
            data[800 if name == "measured" else 700 :] = values[800 if name == "measured" else 700 :]
    with pytest.raises(InputError, match=r"sample 701, column measured: .*100 in all"):
        read_recording(tmp_path / "t.h5")


def test_a_fill_value_of_the_file_itself_is_a_gap(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["time"], file["command"] = TIME, COMMAND
        data = file.create_dataset("measured", shape=MEASURED.shape, dtype="f8", fillvalue=-999.0)
        data[10:] = MEASURED[10:]
    with pytest.raises(InputError, match=r"sample 1, column measured: .*10 in all"):
        read_recording(tmp_path / "t.h5")


@pytest.mark.parametrize(
    ("archive", "attributes", "values"),
    [
        ([250], {"_Unsigned": "true", "_FillValue": np.int8(-1)}, [250.0]),
        ([255, 3], {"_Unsigned": "true", "_FillValue": np.int8(-1)}, [np.nan, 3.0]),
        ([1, 2], {"scale_factor": "0.5", "add_offset": np.array([1.0])}, [1.5, 2.0]),
    ],
)
def test_numbers_without_a_sign_and_attributes_as_text(archive, attributes, values):
    counts = np.array(archive, dtype="u1").view("i1")
    np.testing.assert_array_equal(series_of(counts, attributes).values, values)


@pytest.mark.parametrize("value", ["half", [1.0, 2.0], np.nan])
def test_non_numeric_scale_is_refused(tmp_path, value):
    with pytest.raises(
        InputError, match=r"t\.h5, measured: The attribute scale_factor of this channel is no number"
    ):
        read_recording(hdf5(tmp_path, scale_factor=value))


CHANNELS = "[channels.measured]\nscale = {}\n"


@pytest.mark.parametrize("attributes", [{"gain": 2.0}, {"offset": 0.1}, {"Calibration_Factor": 0.5}])
def test_possible_scale_is_questioned_until_stated(tmp_path, attributes):
    path = hdf5(tmp_path, **attributes)
    with pytest.raises(InputError, match=r"beside 'measured', but not whether its numbers contain it"):
        read_recording(path)
    (tmp_path / "channels.toml").write_text(CHANNELS.format(1.0), encoding="utf-8")
    np.testing.assert_allclose(
        read_recording(path, channels=tmp_path / "channels.toml").measured, MEASURED, atol=3e-6
    )


def test_unknown_kind_of_scale_is_questioned(tmp_path):
    with pytest.raises(InputError, match="a scale of the type 'Reciprocal' beside 'command'"):
        read_recording(tdms_of_daqmx(tmp_path, kind="Reciprocal"))


def test_a_scale_beside_one_history_of_a_structure_is_none_of_the_sensor(tmp_path):
    content = {"command": {"data": COMMAND}, "measured": {"data": MEASURED, "scale": 0.5}}
    savemat(tmp_path / "t.mat", {"t": TIME, **content})
    with pytest.raises(InputError, match=r"scale = 0\.5 beside 'measured.data'"):
        read_recording(tmp_path / "t.mat")


def test_a_matrix_and_its_labels_are_scaled_as_a_whole(tmp_path):
    with h5py.File(tmp_path / "t.h5", "w") as file:
        data = file.create_dataset("daq", data=np.column_stack([1e6 * COMMAND, 1e6 * MEASURED]).round())
        data.attrs.update({"scale_factor": 1e-6, "columns": ["command", "measured"], "units": ["m", "m"]})
        file["rate"] = 200.0
    np.testing.assert_allclose(read_recording(tmp_path / "t.h5").measured, MEASURED, atol=1e-6)


def test_record_packed_by_another_program_is_unpacked(tmp_path):
    dataset, _ = record_test(hdf5(tmp_path))
    write_record(dataset, tmp_path / "t.nc")
    with xr.open_dataset(tmp_path / "t.nc") as content:
        archive = {"dtype": "int32", "scale_factor": 1e-7, "_FillValue": -1}
        content.load().to_netcdf(tmp_path / "p.nc", engine="h5netcdf", encoding={"measured": archive})
    np.testing.assert_allclose(read_recording(tmp_path / "p.nc").measured, MEASURED, atol=3e-6)
    assert any("`measured` are stored with a scale" in fault for fault in check_record(tmp_path / "p.nc"))


def test_record_lists_corrections(tmp_path):
    dataset, _ = record_test(hdf5(tmp_path))
    assert (
        dataset["measured"].attrs["transformation"].startswith("scale_factor 2e-06 and add_offset 0, reading")
    )


def test_attributes_without_effect_are_not_questioned(tmp_path):
    (test,) = read_tests(hdf5(tmp_path, gain=1.0, offset=0.0, sensitivity=1.0))
    assert test.series["measured"].unclear == ""
