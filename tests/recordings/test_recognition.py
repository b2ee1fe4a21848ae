"""Channels are told from each other by name, unit and what they do; what is too close is asked about."""

import numpy as np
import pandas as pd
import pytest
from layouts import COMMAND, FORCE, MEASURED, RATE, TIME, VALVE

from reliab.core.errors import InputError
from reliab.recordings.reading import read_recording


def columns_of(table):
    return {str(channel.part): channel.column for channel in read_recording(pd.DataFrame(table)).channels}


@pytest.mark.parametrize(
    ("command", "reading"),
    [
        ("Dis command", "Dis feedback"),
        ("x_d", "x_m"),
        ("disp_c", "disp_m"),
        ("targDsp", "measDsp"),
        ("Sollweg", "Istweg"),
        ("Riferimento", "Spostamento misurato"),
        ("mubiao weiyi", "shice weiyi"),
        ("SetPoint", "ActDisp"),
        ("xref", "dmeas"),
        ("Consigna", "LVDT"),
        ("位移命令", "位移反馈"),
        ("目標変位", "応答変位"),
        ("目標位移", "致動器位移"),
        ("목표 변위", "측정 변위"),
        ("Hedef yer değiştirme", "Ölçülen yer değiştirme"),
        ("Dépl. cible", "Dépl. LVDT"),
        ("xref", "xlaser"),
    ],
)
def test_words_of_laboratories_name_the_channels_in_any_order(command, reading):
    table = {"Voltage command": VALVE, reading: MEASURED, "Load cell": FORCE, command: COMMAND, "t": TIME}
    assert columns_of(table) == {
        "command": command, "measured": reading, "force": "Load cell", "time": "t"
    }  # fmt: skip


@pytest.mark.parametrize(
    "rival", ["Compensated command (mm)", "Disp error (mm)", "Valve command (V)", "Command velocity (mm/s)"]
)
def test_changed_channels_errors_voltages_and_velocities_are_not_the_command(rival):
    table = {"Time": TIME, rival: np.roll(COMMAND, -3), "Command (m)": COMMAND, "Actual (m)": MEASURED}
    assert columns_of(table)["command"] == "Command (m)"


def test_differing_target_and_command_are_questioned():
    table = {"Time": TIME, "Target": COMMAND, "Command": np.roll(COMMAND, 3), "Measured": MEASURED}
    with pytest.raises(InputError, match=r"'Target' and 'Command'.*Choose one with `command`"):
        columns_of(table)
    table["Command"] = COMMAND
    assert columns_of(table)["command"] == "Target"


def test_following_column_is_measured_if_only_units_help():
    table = {"Time": TIME, "Ch2 [mm]": 1e3 * MEASURED, "Ch1 [mm]": 1e3 * COMMAND, "Ch3 [kN]": 1e-3 * FORCE}
    assert columns_of(table) == {
        "command": "Ch1 [mm]", "measured": "Ch2 [mm]", "force": "Ch3 [kN]", "time": "Time"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("columns", "question"),
    [
        (  # two sensors that follow the command
            {"cmd (mm)": COMMAND, "LVDT A (mm)": MEASURED, "LVDT B (mm)": 0.9 * np.roll(MEASURED, 1)},
            r"'LVDT A \(mm\)' and 'LVDT B \(mm\)'",
        ),
        (  # without names; two sensors of one motion are more alike than it is to its command
            {"a (mm)": 1e3 * MEASURED, "b (mm)": 0.9e3 * MEASURED, "c (mm)": 1e3 * COMMAND},
            r"'a \(mm\)' and 'b \(mm\)' and 'c \(mm\)'",
        ),
        ({"a": COMMAND, "b": MEASURED}, "No column for the command"),
        (
            {"command_m": COMMAND, "measured": 1e3 * MEASURED},
            "'measured' states no unit, and is 997 times",
        ),
    ],
)
def test_ambiguous_columns_are_questioned(columns, question):
    with pytest.raises(InputError, match=question):
        columns_of({"time": TIME, **columns})


def test_the_output_of_a_model_is_no_measurement():
    table = {"t": TIME, "Model output disp (mm)": 1e3 * COMMAND, "Actuator stroke (mm)": 1e3 * MEASURED}
    assert columns_of(table)["measured"] == "Actuator stroke (mm)"


def test_a_range_behind_a_name_is_no_unit():
    table = {"Time": TIME, "Command": COMMAND, "Measured": MEASURED, "Load cell 50 kN": FORCE}
    channels = read_recording(pd.DataFrame(table)).channels
    assert {str(channel.part): channel.factor for channel in channels}["force"] == 1.0


@pytest.mark.parametrize(("ending", "factor"), [("m_s2", 1.0), ("mm_s2", 1e-3), ("in_s2", 0.0254)])
def test_a_rate_with_underscores_is_a_unit(ending, factor):
    table = {"time_in_s": TIME, "command_m": COMMAND, "measured_m": MEASURED, "velocity_m_s": MEASURED}
    channels = read_recording(pd.DataFrame({**table, f"ground_acceleration_{ending}": FORCE})).channels
    found = {str(channel.part): (channel.column, channel.factor) for channel in channels}
    assert found["time"] == ("time_in_s", 1.0)
    assert found["ground acceleration"] == (f"ground_acceleration_{ending}", factor)


def test_per_cent_in_front_of_a_line_of_units_begins_no_comment(tmp_path):
    rows = np.column_stack([VALVE, TIME, 1e3 * COMMAND, 1e3 * MEASURED])
    path = tmp_path / "t.txt"
    np.savetxt(path, rows, delimiter="\t", header="Valve\tTime\tCommand\tFeedback\n%\ts\tmm\tmm", comments="")
    factors = {str(channel.part): channel.factor for channel in read_recording(path).channels}
    assert factors["command"] == factors["measured"] == 1e-3


def test_early_measurement_without_names_is_never_taken_for_the_command(tmp_path):
    """An overcompensated actuator leads; its noise contradicts, and the user is asked."""
    early = np.roll(MEASURED, -5)
    np.savetxt(tmp_path / "t.csv", np.column_stack([TIME, early, COMMAND]), delimiter=",")
    with pytest.raises(InputError, match="Which is the command"):
        read_recording(tmp_path / "t.csv")


def test_force_is_the_column_explained_by_the_motion():
    noise = np.random.default_rng(2).normal(size=TIME.size)
    table = {"t": TIME, "cmd_m": COMMAND, "meas_m": MEASURED, "Load A (N)": 50.0 * noise, "Load B (N)": FORCE}
    assert columns_of(table)["force"] == "Load B (N)"


def test_pairs_of_several_actuators_are_asked_about_by_a_test_of_one():
    table = {"t": TIME, "cmd_1": COMMAND, "meas_1": MEASURED, "cmd_2": 2 * COMMAND, "meas_2": 2 * MEASURED}
    with pytest.raises(InputError, match="channels of actuators 1, 2"):
        columns_of(table)
    assert (
        read_recording(pd.DataFrame(table), command="cmd_2", measured="meas_2").command[9] == 2 * COMMAND[9]
    )


def nameless(rivals, folder):
    """Time, command, measured and further columns without names."""
    np.savetxt(folder / "t.txt", np.column_stack([TIME, COMMAND, MEASURED, *rivals]))
    return read_recording(folder / "t.txt")


def test_nameless_force_is_explained_by_the_measured_motion(tmp_path):
    test = nameless([FORCE], tmp_path)
    np.testing.assert_allclose(test.force, FORCE)
    assert any("taken to be in N" in note for note in test.notes)


VELOCITY = np.gradient(MEASURED, 1.0 / RATE)


@pytest.mark.parametrize(
    "second",
    [VELOCITY, np.gradient(VELOCITY, 1.0 / RATE), VALVE, -FORCE],
    ids=["velocity", "acceleration", "valve", "reversed force"],
)
def test_nothing_else_without_a_name_is_taken_for_the_force(tmp_path, second):
    assert nameless([second], tmp_path).force is None


@pytest.mark.parametrize("second", [400.0 * COMMAND, 0.99 * MEASURED], ids=["voltage", "second sensor"])
def test_nameless_displacement_is_never_the_force(tmp_path, second):
    """It is asked about, or left."""
    try:
        force = nameless([second], tmp_path).force
    except InputError:
        force = None
    assert force is None


def test_flag_named_command_loses_to_a_moving_column():
    """OpenFresco's models log the flag atTarget beside the target."""
    flag = (np.arange(TIME.size) // 7 % 2).astype(float)
    table = {"Time": TIME, "Target": flag, "s1 [m]": COMMAND, "Disp Feedback [m]": MEASURED}
    with pytest.raises(InputError, match="do not all move together"):
        columns_of(table)
    assert columns_of({"Time": TIME, "atTarget": flag, "targDsp": COMMAND, "measDsp": MEASURED}) == {
        "time": "Time",
        "command": "targDsp",
        "measured": "measDsp",
    }


def test_name_ending_in_in_is_questioned_without_units():
    table = {"Time": TIME, "disp_in": COMMAND, "Disp Feedback": MEASURED}
    with pytest.raises(InputError, match="in inches, or an input"):
        columns_of(table)
    test = read_recording(pd.DataFrame(table), units="m")
    np.testing.assert_array_equal(test.command, COMMAND)
    inches = {"Time": TIME, "command_in": COMMAND, "measured_in": MEASURED}
    np.testing.assert_allclose(read_recording(pd.DataFrame(inches)).command, 0.0254 * COMMAND)


def test_a_changed_command_is_asked_about_where_an_unchanged_column_moves_as_it_does():
    table = {
        "Time": TIME,
        "Command filtered (m)": COMMAND,
        "Displacement A (m)": COMMAND,
        "Measured (m)": MEASURED,
    }
    with pytest.raises(InputError, match=r"'Command filtered \(m\)' and 'Displacement A \(m\)'"):
        columns_of(table)
    table["Displacement A (m)"] = 0.3 * np.roll(COMMAND, 900)
    assert columns_of(table)["command"] == "Command filtered (m)"
    millimetres = {**table, "Displacement A (mm)": 1e3 * COMMAND}
    with pytest.raises(InputError, match="Displacement A"):
        columns_of(millimetres)
