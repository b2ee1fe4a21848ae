"""`reliab.assess` of a test with several actuators: its summary, its warnings and what it refuses."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
import pytest
from assessment.inference.simulated_loop import play
from coupled_structures import coupled_response, described, node

import reliab
from reliab.app import cli
from reliab.assessment.assess import assess
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.motions.motion import Motion
from reliab.recordings.recording import Recording
from reliab.report.kinds.assessment.frame import frame_assessment_report
from reliab.signals.filters import LowPass
from reliab.simulation.frames.frame_file import FrameUnderTest, read_frame, read_structure
from reliab.simulation.frames.tolerances_table import TolerancesTable
from reliab.simulation.frames.transfer_table import PlanarGeometry
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferFunction
from reliab.structures.partition import Partition

STEP = 1.0 / 256.0
FRAME = "frames/two_actuators.toml"


def shaking():
    time = np.arange(0.0, 20.0, STEP)
    motion = np.sin(9.0 * time) * np.sin(2.0 * time) * np.minimum(time / 4.0, 1.0) ** 3
    return time, motion * np.exp(-(((time - 9.0) / 6.0) ** 2))


@pytest.fixture(scope="module")
def recording_file(tmp_path_factory):
    """A test's file, and the frame's."""
    path = shipped("datasets", FRAME)
    frame = read_structure(path)
    time, motion = shaking()
    run = coupled_response(frame.partition, frame.transfer_system, motion, STEP)
    displacement = {"command": frame.kinematics @ run.command, "measured": frame.kinematics @ run.measured}
    noise = 1e-6 * np.random.default_rng(0).normal(size=(2, time.size))
    displacement["measured"] = displacement["measured"] + noise
    table = {"time_s": time} | {
        f"{name}_{place + 1}": history[place] for place in range(2) for name, history in displacement.items()
    }
    file = tmp_path_factory.mktemp("test") / "test.csv"
    pd.DataFrame(table).to_csv(file, index=False)
    error, peak = run.measured - run.reference, np.abs(run.reference).max(axis=1)
    return file, path, np.sqrt(np.mean(error**2, axis=1)) / peak


@pytest.fixture
def ground_file(recording_file):
    return pd.read_csv(recording_file[0]).assign(ground_acceleration_m_s2=shaking()[1])


@pytest.fixture(scope="module")
def assessment(recording_file):
    return reliab.assess(recording_file[0], recording_file[1])


def test_json_holds_each_degree_and_the_governing_one(recording_file, assessment):
    true = recording_file[2]
    answer = assessment.to_dict()
    json.dumps(answer, allow_nan=False)
    degrees = answer["error"]["degrees_of_freedom"]
    assert set(degrees) == {"x", "theta"}
    for name, error in zip(("x", "theta"), true, strict=True):
        rms = degrees[name]["rms"]
        assert rms["low"] <= error <= rms["high"]
        assert rms["low"] <= rms["value"] <= rms["high"]
    assert degrees["theta"]["rms"]["value"] == pytest.approx(true[1], rel=0.02)
    governing = answer["error"]["governing"]
    assert next(iter(degrees)) == governing
    assert answer["error"]["rms"] == degrees[governing]["rms"]
    assert 0.0 < answer["stability_margin"] < 1.0


@pytest.mark.slow
def test_large_rotations_are_read_by_the_geometry_of_the_actuators():
    """Rotations up to 0.4 rad, with which a matrix makes the error of x 1.8 % too large."""
    frame = read_structure(shipped("datasets", FRAME))
    run = coupled_response(frame.partition, frame.transfer_system, shaking()[1], STEP)
    large = 0.4 / np.abs(run.measured[1]).max()
    geometry = PlanarGeometry(
        motions=("x", "rotation"), pins=[[0.3, -0.25], [0.3, 0.25]], directions=[[1, 0], [1, 0]]
    )
    np.testing.assert_allclose(geometry.matrix, frame.kinematics)
    extension = {name: geometry.extensions(large * getattr(run, name)) for name in ("command", "measured")}
    recording = Recording(time_step=STEP, name="large", actuators=("1", "2"), **extension)
    error, peak = run.measured - run.reference, np.abs(run.reference).max(axis=1)
    true = np.sqrt(np.mean(error**2, axis=1)) / peak
    exact, by_matrix = (
        [degree.rms.value for degree in assess(recording, single).error.displacements]
        for single in (replace(frame, geometry=geometry), frame)
    )
    assert exact == pytest.approx(true, rel=2e-3)
    assert np.abs(np.array(by_matrix) / true - 1.0).max() > 0.01


@pytest.mark.slow
def test_a_recording_and_interface_coordinates_give_the_same(recording_file, tmp_path):
    """With exact sensors: those at the actuators are others than those at the interface."""
    file, path, _ = recording_file
    at_the_actuators = reliab.assess(file, path, exact=True)
    frame, table = read_structure(path), pd.read_csv(file)
    at_actuators = [table[[f"{name}_1", f"{name}_2"]].to_numpy().T for name in ("command", "measured")]
    text = path.read_text(encoding="utf-8").replace('channels = "actuators"', 'channels = "interface"')
    (tmp_path / "interface.toml").write_text(text, encoding="utf-8")
    command, measured_displacement = (frame.to_interface @ history for history in at_actuators)
    recording = Recording(
        command=command, measured=measured_displacement, time_step=STEP, actuators=("x", "theta")
    )
    result = reliab.assess(recording, read_structure(tmp_path / "interface.toml"), exact=True)
    displacements = result.error.displacements, at_the_actuators.error.displacements
    for displacement, another in zip(*displacements, strict=True):
        assert displacement.rms.value == pytest.approx(another.rms.value, rel=0.01)


def test_matrices_may_stand_in_files(tmp_path):
    text = shipped("datasets", FRAME).read_text(encoding="utf-8")
    frame = read_structure(shipped("datasets", FRAME))
    np.savetxt(tmp_path / "K.csv", frame.partition.stiffness, delimiter=",")
    begin, end = text.index("stiffness_matrix_n_per_m"), text.index("influence")
    (tmp_path / "frame.toml").write_text(
        text[:begin] + 'stiffness_matrix_n_per_m = "K.csv"\n' + text[end:], encoding="utf-8"
    )
    second = read_structure(tmp_path / "frame.toml")
    np.testing.assert_allclose(second.partition.stiffness, frame.partition.stiffness, rtol=1e-12)


BAD = pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("[1.0, -0.25]", "[1.0, 0.25]", "must not be singular"),
        ("    [1.0, -0.25],", "    [1.0, -0.25],\n    [1.0, 0.0],", "more actuators than degrees"),
        ("[1.4e6, -3.0e5]", "[9.4e6, -3.0e5]", "must be part of the frame"),
        ('["x", "theta"]\n# Rows', '["x", "y"]\n# Rows', "No such degree of freedom"),
        ("    [-4.0e5, 9.0e5, 2.0e5],\n", "    [-4.0e5, 9.0e5],\n", "rows of the matrix"),
    ],
)


@BAD
def test_a_bad_description_ends_in_a_sentence(recording_file, tmp_path, old, new, sentence):
    text = recording_file[1].read_text(encoding="utf-8")
    assert old in text
    bad = tmp_path / "bad.toml"
    bad.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=sentence):
        read_structure(bad)


@BAD
def test_a_bad_description_is_one_sentence_and_exit_code_2(
    recording_file, tmp_path, capsys, old, new, sentence
):
    bad = tmp_path / "bad.toml"
    bad.write_text(recording_file[1].read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    assert cli.run(["assess", str(recording_file[0]), "--structure", str(bad)]) == 2
    out, messages = capsys.readouterr()
    assert not out
    assert sentence in messages
    assert "Traceback" not in messages


def test_its_report_holds_each_degree_and_the_parts(assessment):
    document = frame_assessment_report(assessment, provenance={})
    errors = document.blocks[0].blocks[0]
    assert list(errors.frame["0"]) == ["x", "theta"]
    parts = document.blocks[4].blocks[0]
    assert "delay of actuator 2" in parts.frame["0"]
    assert " of theta 13" in document.verdict[-1]


@pytest.mark.slow
def test_its_report_is_written(recording_file, tmp_path):
    file, frame, _ = recording_file
    report = tmp_path / "report.pdf"
    assert cli.run(["assess", str(file), "--structure", str(frame), "--report", str(report)]) == 0
    assert report.read_bytes().startswith(b"%PDF")


def test_a_loop_beyond_its_critical_delay_has_no_margin(assessment):
    longest = max(actuator.delay for actuator in assessment.actuators)
    late = replace(assessment, limit=replace(assessment.limit, delay=0.5 * longest))
    assert late.stability_margin == pytest.approx(-1.0)


def test_gains_that_no_stable_loop_has_are_said(assessment):
    uncertain = replace(assessment, limit_of_gains=False)
    (sentence,) = set(uncertain.warnings) - set(assessment.warnings)
    assert "unstable even without delay" in sentence


def test_answers_for_one_actuator_refuse_several(recording_file):
    file, path, _ = recording_file
    with pytest.raises(InputError, match="driven at one degree of freedom"):
        read_frame(path)
    with pytest.raises(InputError, match="criterion"):
        reliab.assess(file, path, criterion="guo_2017_15")


def replace_readings(file, smooth_values):
    """The test of a file, whose displacement sensors show what a function makes of each motion."""
    table = pd.read_csv(file)
    return table.assign(
        **{name: smooth_values(table[name].to_numpy()) for name in ("measured_1", "measured_2")}
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("smooth_values", "stated_values"),
    [
        (lambda motion: LowPass(corner=30.0).apply(motion, STEP), {"filter": ["measured=30"]}),
        (partial(play, width=0.01), {"hysteresis": 0.01}),
    ],
)
def test_filters_and_hysteresis_of_all_sensors_are_taken_off(recording_file, smooth_values, stated_values):
    corrupt = reliab.assess(
        replace_readings(recording_file[0], smooth_values), recording_file[1], exact=True, **stated_values
    ).error.displacements
    assert [degree.rms.value for degree in corrupt] == pytest.approx(recording_file[2], rel=0.02)


@pytest.mark.slow
def test_a_given_ground_motion_is_as_good_as_a_recorded_one(recording_file, ground_file):
    """A record with rest about the test, which is found in it; over their peaks all errors are the same.

    The structure is exact: a recorded ground acceleration shows more of an uncertain one.
    """
    remainder = np.zeros(300)
    record = np.concatenate([remainder, shaking()[1], remainder])
    arguments = reliab.assess(
        recording_file[0],
        recording_file[1],
        motion=Motion(name="record", acceleration=record, time_step=STEP),
        exact=True,
    ).responses
    of_channel = reliab.assess(ground_file, recording_file[1], exact=True).responses
    for single, another in zip(arguments.each, of_channel.each, strict=True):
        assert single.rms.value == pytest.approx(another.rms.value, rel=1e-3)
        assert single.rms.high == pytest.approx(another.rms.high, rel=1e-3)
    second = np.random.default_rng(1).standard_normal(record.size)
    foreign = reliab.assess(
        recording_file[0], recording_file[1], motion=Motion(name="other", acceleration=second, time_step=STEP)
    ).responses
    assert foreign.other_motion
    assert not foreign.over_peaks


@pytest.mark.slow
def test_a_skew_and_a_scale_of_all_channels_are_taken_off(recording_file, assessment, tmp_path):
    """By the header of the test, which goes before the file of the laboratory, and by options."""
    file, path, _ = recording_file
    table = pd.read_csv(file)
    for name in ("measured_1", "measured_2"):
        table[name] = 1.02 * np.interp(table["time_s"] - 0.003, table["time_s"], table[name])
    header, channels = tmp_path / "header.csv", tmp_path / "channels.toml"
    header.write_text("# skew_ms: 3\n# scale: 1.02\n" + table.to_csv(index=False), encoding="utf-8")
    channels.write_text("[calibration]\nskew_ms = -5.0\nscale = 0.9\n", encoding="utf-8")
    corrupt, by_header, by_options = (
        {degree.name: degree.rms.value for degree in result.error.displacements}
        for result in (
            reliab.assess(table, path),
            reliab.assess(header, path, channels=channels),
            reliab.assess(table, path, skew=3, scale=1.02),
        )
    )
    sound = {degree.name: degree.rms.value for degree in assessment.error.displacements}
    assert by_header == by_options
    assert by_header == pytest.approx(sound, rel=0.05)
    assert corrupt != pytest.approx(sound, rel=0.5)


@pytest.mark.slow
def test_unstated_quantities_of_several_actuators_are_as_uncertain_as_equipment(recording_file, assessment):
    file, path, _ = recording_file
    exact = reliab.assess(file, path, exact=True)
    budget = {item["name"]: item for item in assessment.to_dict()["budget"]}
    assert budget["sensor_scale_2"]["quantity"] == "scale of the displacement sensor of actuator 2"
    assert 0.1 < budget["sensor_scale_2"]["size"] <= 0.3  # as far as the equations of motion show it
    assert budget["filter_delay_1"]["source"] == "default"
    assert budget["damping_ratio"]["source"] == "learned from this test"
    assert {item["name"] for item in exact.to_dict()["budget"]} == {
        "frequency",
        "damping_ratio",
        "sensor_noise",
        *(f"sensor_{name}_{number}" for name in ("offset", "drift") for number in (1, 2)),
    }
    for result, displacement in zip(assessment.error.displacements, exact.error.displacements, strict=True):
        assert result.rms.low < displacement.rms.value < result.rms.high
        assert result.rms.high - result.rms.low > displacement.rms.high - displacement.rms.low
    assert 0.01 <= assessment.probability <= 0.99


@pytest.mark.slow
def test_a_fault_of_one_channel_is_stated_with_the_error_without_it(recording_file):
    """An offset of which the equations of motion show that the loop did not feel it."""
    table = pd.read_csv(recording_file[0])
    table["measured_1"] += 0.05 * table["command_1"].abs().max()
    result = reliab.assess(table, recording_file[1], exact=True).to_dict()
    (fault,) = result["faults"]
    assert (fault["actuator"], fault["kind"], fault["in_loop"]) == ("1", "offset", None)
    assert fault["error_otherwise"] == pytest.approx(recording_file[2][1], rel=0.02)
    rms = result["error"]["degrees_of_freedom"]["theta"]["rms"]
    assert fault["error"] == rms["value"] == pytest.approx(recording_file[2][1], rel=0.02)
    assert rms["low"] < recording_file[2][1] < rms["high"]


@pytest.mark.slow
def test_offset_of_inclined_actuators_is_known_by_the_answer_of_their_command():
    partition = Partition(
        mass=np.eye(2),
        damping=np.eye(2),
        stiffness=np.diag([40.0, 60.0]),
        interface=np.eye(2),
        specimen_stiffness=np.diag([32.0, 6.0]),
        influence=[1.0, 0.6],
    )
    kinematics, time = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0), np.arange(0.0, 60.0, STEP)
    lag = TransferFunction(numerator=(300.0,), denominator=(1.0, 300.0))
    actuators = ActuatorMatrix(kinematics=kinematics, transfer=((lag, None), (None, lag)))
    shaking = np.random.default_rng(2).standard_normal(time.size // 16 + 1)
    shaking = np.interp(time, np.arange(shaking.size) * 16 * STEP, shaking)
    run = coupled_response(partition, actuators, shaking * np.sin(np.pi * time / 60.0), STEP)
    command, measured_displacement = kinematics @ run.command, kinematics @ run.measured
    offset = np.array([[0.2 * np.abs(command[0]).max()], [0.0]])
    answer = kinematics @ partition.static_transfer @ np.linalg.solve(kinematics, offset)
    frame = FrameUnderTest(
        has_several=True, name="", partition=partition, kinematics=kinematics, channels_at_interface=False
    )
    for felt_displacement in (True, False):
        recording = Recording(
            command=command - felt_displacement * answer,
            measured=measured_displacement - felt_displacement * answer + offset,
            time_step=STEP,
        )
        result = [effect.fault for effect in assess(recording, frame).faults]
        faults = [fault for fault in result if fault.actuator == "1"]
        assert [(fault.kind, fault.in_loop) for fault in faults] == [("offset", felt_displacement)]


@pytest.mark.slow
def test_actuators_moving_alike_keep_gains_near_one():
    partition, actuators = described(node)
    time = np.arange(0.0, 30.0, STEP)
    shaking = np.sin(9.0 * time) * np.sin(2.0 * time) * np.exp(-(((time - 15.0) / 6.0) ** 2))
    run = coupled_response(partition, actuators, shaking, STEP)
    recording = Recording(
        command=actuators.kinematics @ run.command,
        measured=actuators.kinematics @ run.measured,
        time_step=STEP,
    )
    frame = FrameUnderTest(
        has_several=True,
        name="",
        partition=partition,
        kinematics=actuators.kinematics,
        channels_at_interface=False,
    )
    result = assess(recording, frame)
    np.testing.assert_allclose(result.error.rebuilt.readings.tracking[0], np.eye(3), atol=0.2)
    assert result.limit_of_gains
    assert 0.0 < result.stability_margin < 1.0


def off(path, factor, **tolerances):
    """The frame with all natural frequencies off by a factor."""
    frame = read_structure(path)
    partition = frame.partition.scale(frequency=factor, damping_ratio=1.0, share=1.0)
    return replace(frame, partition=partition, tolerances=TolerancesTable(**tolerances))


@pytest.mark.slow
def test_a_recorded_ground_motion_agrees_with_the_structure(recording_file, ground_file):
    shown = reliab.assess(ground_file, recording_file[1]).error.ground
    assert shown.frequency == pytest.approx(1.0, abs=0.01)
    assert (shown.fits, shown.sign, shown.notes) == (True, 1.0, ())


@pytest.mark.slow
def test_an_inferred_budget_names_the_actuator_of_each_channel(recording_file, ground_file):
    budget = reliab.assess(ground_file, recording_file[1]).to_dict()["budget"]
    words = {item["name"]: item["quantity"] for item in budget}
    assert words["sensor_scale_2"] == "scale of the displacement sensor of actuator 2"
    assert words["damping_ratio"] == "damping ratio"


def test_a_recorded_ground_motion_contradicts_another_structure(recording_file, ground_file):
    """Frequencies 8 % too high."""
    doubt = reliab.assess(ground_file, off(recording_file[1], 1.08))
    assert doubt.to_dict()["verdict"] == "undecided"
    assert "shows a natural frequency of 2.2" in doubt.reasons[0]


@pytest.mark.slow
def test_frequencies_within_ordinary_equipment_are_learned_from_the_ground_motion(
    recording_file, ground_file
):
    specimen = reliab.assess(ground_file, off(recording_file[1], 1.03))
    assert specimen.error.ground.frequency == pytest.approx(1.0 / 1.03, abs=0.01)
    assert "natural frequency" not in " ".join(specimen.reasons)
    assert specimen.to_dict()["verdict"] == "not_reliable"
    for degree, true in zip(specimen.error.displacements, recording_file[2], strict=True):
        assert degree.rms.low < true < degree.rms.high
    rms = specimen.error.displacements[1].rms
    assert rms.value == pytest.approx(recording_file[2][1], abs=0.2 * (rms.high - rms.low))


@pytest.mark.slow
def test_a_ground_motion_of_another_test_is_noticed(recording_file, ground_file):
    rotation = ground_file.assign(ground_acceleration_m_s2=-shaking()[1])
    assert (
        "The ground acceleration has the opposite sign."
        in reliab.assess(rotation, recording_file[1]).warnings
    )
    second = ground_file.assign(ground_acceleration_m_s2=np.roll(shaking()[1], 700))
    other = reliab.assess(second, recording_file[1])
    assert any("does not belong to this test" in warning for warning in other.warnings)
    assert not other.error.ground.fits
    assert other.error.inferred.posterior.circumstances.channels.ground is None


def test_tests_of_several_actuators_are_ranked_by_their_largest_errors():
    frame = read_structure(shipped("datasets", FRAME))
    time, motion = shaking()
    tests, errors = [], []
    for corner in (2000.0, 6000.0):
        lag = TransferFunction(numerator=(corner,), denominator=(1.0, corner))
        rig = ActuatorMatrix(kinematics=frame.kinematics, transfer=((lag, None), (None, lag)))
        run = coupled_response(frame.partition, rig, motion, STEP)
        noise = 1e-6 * np.random.default_rng(0).normal(size=(2, time.size))
        channels = frame.kinematics @ run.command, frame.kinematics @ run.measured + noise
        tests.append(Recording(command=channels[0], measured=channels[1], time_step=STEP, name=f"{corner}"))
        error, peak = run.measured - run.reference, np.abs(run.reference).max(axis=1)
        errors.append((np.sqrt(np.mean(error**2, axis=1)) / peak).max())
    first, second = reliab.compare(tests, frame).tests
    assert (first.file, second.file) == ("6000.0", "2000.0")
    assert second.difference.low < errors[0] - errors[1] < second.difference.high
    assert second.to_dict()["A"] == second.assessment.to_dict()["A"]
