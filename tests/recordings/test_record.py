"""The open record keeps a test whole, is read without us, and says when it is spoilt."""

import hashlib

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from layouts import COMMAND, MEASURED, RATE, csv_with_units_in_brackets, tdms

import reliab
from reliab.core.errors import InputError
from reliab.core.shipped import shipped as shipped_path
from reliab.recordings.reading import read_recording
from reliab.recordings.record import check_record

CHANNELS = """
[channels.command]
column = ["Setpoint B", "Setpoint A"]
unit = "mm"
sign = -1
zero = 2.0
[channels.measured]
column = "S7"
unit = "in"
scale = 2.0
[sampling]
rate_hz = 256
"""


@pytest.fixture
def record(tmp_path):
    reliab.record(
        csv_with_units_in_brackets(tmp_path),
        tmp_path / "t.nc",
        f="1±0.01",
        rig="rig 3",
        operator="N. N.",
        attributes={"grade": "S355"},
    )
    return tmp_path / "t.nc"


def test_xarray_opens_a_record_by_itself(record):
    with xr.open_dataset(record) as dataset:
        assert dict(dataset.sizes) == {"actuator": 1, "time": COMMAND.size}
        np.testing.assert_allclose(dataset["command"].values[0], COMMAND, atol=1e-12)
        assert dataset["measured"].attrs["units"] == "m"
        assert dataset["command"].attrs["source_column"] == "Dis command (mm)"
        assert "from mm to m" in dataset["command"].attrs["transformation"]
        assert dataset["Voltage_command"].attrs["long_name"] == "Voltage command"
        source = record.with_name(dataset.attrs["source_file"])
        assert dataset.attrs["source_sha256"] == hashlib.sha256(source.read_bytes()).hexdigest()
        assert (dataset.attrs["rig"], dataset.attrs["grade"]) == ("rig 3", "S355")


def test_undecodable_command_line_text_stays_text(tmp_path):
    declared_values = "1±0.01".encode().decode("ascii", "surrogateescape")
    reliab.record(
        csv_with_units_in_brackets(tmp_path), tmp_path / "t.nc", f=declared_values, rig="Gr\udcc3\udcb6sse"
    )
    assert str(read_recording(tmp_path / "t.nc").stated["f"]) == "1 ± 0.01"
    with h5py.File(tmp_path / "t.nc") as file:
        assert file.attrs["rig"] == "Grösse"


def test_stated_values_survive_a_round_trip(record):
    test = read_recording(record)
    assert str(test.stated["f"]) == "1 ± 0.01"
    assert [channel.reason for channel in test.channels][:2] == ["the record says so"] * 2


def test_a_sound_record_has_no_fault_and_a_spoilt_one_names_it(record):
    assert check_record(record) == []
    with h5py.File(record, "r+") as file:
        file["command"].attrs["units"] = "mm"
        file["measured"][0, 5] = np.nan
        del file["force"].attrs["transformation"]
        file.attrs["time_step_s"] = 0.01
    faults = " ".join(check_record(record))
    for words in (
        "unit of `command`",
        "`measured` has values",
        "`transformation`",
        "increase by `time_step_s`",
    ):
        assert words in faults


def test_invalid_record_is_reported(tmp_path):
    (tmp_path / "a.nc").write_bytes(b"no")
    with pytest.raises(InputError, match="This is no record"):
        check_record(tmp_path / "a.nc")


def test_csv_of_a_record_is_the_same_test(tmp_path):
    reliab.record(tdms(tmp_path), csv=tmp_path / "t.csv", alpha=0.9)
    test = read_recording(tmp_path / "t.csv")
    np.testing.assert_allclose(test.measured, MEASURED, atol=1e-15)
    assert test.stated["alpha"].value == 0.9


def test_several_actuators_are_kept_with_a_dimension(tmp_path):
    table = {"t": np.arange(COMMAND.size) / RATE}
    for number in (1, 2):
        table |= {f"cmd_{number} (mm)": number * COMMAND, f"meas_{number} (mm)": number * MEASURED}
    pd.DataFrame(table).to_csv(tmp_path / "t.csv", index=False)
    reliab.record(tmp_path / "t.csv", tmp_path / "t.nc")
    with xr.open_dataset(tmp_path / "t.nc") as dataset:
        assert dataset["actuator"].values.tolist() == ["1", "2"]
        np.testing.assert_allclose(dataset["measured"].values[1], 2e-3 * MEASURED, rtol=1e-12)
    assert check_record(tmp_path / "t.nc") == []
    with pytest.raises(InputError, match="holds channels of actuators"):
        read_recording(tmp_path / "t.nc")


def test_a_laboratory_states_its_channels_once(tmp_path):
    (tmp_path / "channels.toml").write_text(CHANNELS, encoding="utf-8")
    table = {"Setpoint A": 2.0 - 1e3 * COMMAND, "S7": MEASURED / 0.0508, "Setpoint C": COMMAND}
    pd.DataFrame(table).to_csv(tmp_path / "t.csv", index=False)
    test = read_recording(tmp_path / "t.csv", channels=tmp_path / "channels.toml")
    np.testing.assert_allclose(test.command, COMMAND, atol=1e-12)
    np.testing.assert_allclose(test.measured, MEASURED, atol=1e-12)
    assert test.time_step == 1.0 / RATE


@pytest.mark.parametrize(
    ("variant", "message"),
    [
        (("sign = -1", "sign = 3"), "sign"),
        (("[channels.command]", "[channels.comand]"), "comand is not a known"),
        (('unit = "mm"', 'unit = "kN"'), "Unknown unit of length"),
        (("rate_hz = 256", "rate_hz = -1"), "rate_hz"),
    ],
)
def test_spoilt_descriptions_of_channels_are_explained(tmp_path, variant, message):
    (tmp_path / "channels.toml").write_text(CHANNELS.replace(*variant), encoding="utf-8")
    pd.DataFrame({"Setpoint A": COMMAND, "S7": MEASURED}).to_csv(tmp_path / "t.csv", index=False)
    with pytest.raises(InputError, match=message):
        read_recording(tmp_path / "t.csv", channels=tmp_path / "channels.toml")


def test_record_and_csv_keep_the_stated_skew(tmp_path):
    shipped = read_recording(shipped_path("datasets", "sample_test/test.csv"))
    reliab.record("sample_test", tmp_path / "t.nc", csv=tmp_path / "t.csv")
    for file in ("t.nc", "t.csv"):
        assert read_recording(tmp_path / file).stated["skew"] == shipped.stated["skew"]
