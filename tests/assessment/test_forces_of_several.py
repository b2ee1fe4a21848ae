"""Recorded forces of several actuators: what they show, and what is refused of them."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from coupled_structures import coupled_response

from reliab import assess
from reliab.app.cli import run as run_command
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import read_structure

STEP = 1.0 / 256.0


@pytest.fixture(scope="module")
def frame():
    return read_structure(shipped("datasets", "frames/two_actuators.toml"))


@pytest.fixture(scope="module")
def recorded_test(frame):
    """Displacements and forces at two actuators, with noise, and the true error of x and theta."""
    rng, time = np.random.default_rng(3), np.arange(0.0, 12.5, STEP)
    ground = rng.normal(size=time.size) * np.exp(-(((time - 4.0) / 2.5) ** 2))
    tested = coupled_response(frame.partition, frame.transfer_system, ground, STEP)
    velocity = np.gradient(tested.measured, STEP, axis=1)
    part = frame.partition
    force = part.specimen_stiffness @ tested.measured + part.specimen_damping @ velocity
    force += part.specimen_mass @ np.gradient(velocity, STEP, axis=1)
    command, measured = frame.kinematics @ tested.command, frame.kinematics @ tested.measured
    force = np.linalg.inv(frame.kinematics).T @ force  # the work of both is the same
    measured, force = (
        row + 0.003 * row.std(axis=1, keepdims=True) * rng.normal(size=row.shape) for row in (measured, force)
    )
    error = np.sqrt(np.mean((tested.measured - tested.reference) ** 2, axis=1))
    true = error / np.abs(tested.reference).max(axis=1)
    return Recording(command=command, measured=measured, force=force, time_step=STEP), true


def test_they_narrow_the_errors_and_settle_whether_the_specimen_yielded(frame, recorded_test):
    recording, true = recorded_test
    alone, with_forces = (assess(test, frame) for test in (replace(recording, force=None), recording))
    errors = (alone.error.displacements, with_forces.error.displacements)
    for before, after, value in zip(*errors, true, strict=True):
        assert after.rms.low < value < after.rms.high
        assert after.rms.high - after.rms.low < 0.7 * (before.rms.high - before.rms.low)
    assert with_forces.turning.error_if_yielding is None
    assert alone.turning.error_if_yielding is not None


def test_each_load_cell_has_its_own_scale_and_lag(frame, recorded_test):
    recording, true = recorded_test
    time = STEP * np.arange(recording.samples)
    late = np.interp(time - 0.5 * STEP, time, recording.force[1])
    error = assess(replace(recording, force=np.stack([recording.force[0], 1.02 * late])), frame).error
    shown = error.posterior.means
    assert shown["mass_2"] - shown["mass_1"] == pytest.approx(0.02, abs=0.005)
    assert shown["force_lag_2"] - shown["force_lag_1"] == pytest.approx(0.5 * STEP, abs=0.2 * STEP)
    assert all(
        degree.rms.low < value < degree.rms.high
        for degree, value in zip(error.displacements, true, strict=True)
    )


def test_a_file_and_its_record_hold_all_forces(frame, recorded_test, tmp_path):
    recording, _ = recorded_test
    table = {"time_s": STEP * np.arange(recording.samples)}
    for place in range(2):
        table[f"command_{place + 1}_m"] = recording.command[place]
        table[f"measured_{place + 1}_m"] = recording.measured[place]
        table[f"force_{place + 1}_kN"] = 1e-3 * recording.force[place]
    pd.DataFrame(table).to_csv(tmp_path / "test.csv", index=False)
    files = [str(tmp_path / name) for name in ("test.csv", "test.nc")]
    assert run_command(["record", files[0], "--out", files[1]]) == 0
    assert run_command(["record", files[1], "--check"]) == 0
    answer = assess(files[1], frame).to_dict()
    channels = [channel["channel"] for channel in answer["recording"]["channels"]]
    assert [name for name in channels if "force" in name] == ["force_1", "force_2"]
    expected = assess(recording, frame).error.rms.value
    assert answer["error"]["rms"]["value"] == pytest.approx(expected, rel=1e-6)
    pd.DataFrame(table).drop(columns="force_2_kN").to_csv(files[0], index=False)
    assert "No force was recorded" in " ".join(assess(files[0], frame).to_dict()["warnings"])


@pytest.mark.parametrize(
    ("factor", "words"),
    [(-1.0, "Reverse the sign"), (1e-3, "kilonewtons for newtons"), (0.0, "does not change")],
)
def test_a_force_of_another_sign_or_unit_is_refused(frame, recorded_test, factor, words):
    recording, _ = recorded_test
    force = recording.force * np.array([[1.0], [factor]])
    with pytest.raises(InputError, match=words) as refusal:
        assess(replace(recording, force=force), frame)
    assert "actuator 2" in str(refusal.value)


def test_forces_of_a_nonlinear_specimen_leave_the_verdict_open(frame, recorded_test):
    recording, _ = recorded_test
    moved = recording.measured[0] / np.abs(recording.measured[0]).max()
    force = recording.force.copy()
    force[0] += 0.3 * np.abs(force[0]).max() * moved**3
    alone, result = (
        assess(replace(recording, force=forces), frame, specimen="linear") for forces in (None, force)
    )
    assert result.verdict == "undecided"
    assert any("looks nonlinear" in reason for reason in result.reasons)
    assert any("not learned from its forces" in step for step in result.would_decide)
    assert result.error.rms.value == pytest.approx(alone.error.rms.value)  # the force was not weighed


def test_forces_must_be_those_of_all_actuators(recorded_test):
    recording, _ = recorded_test
    with pytest.raises(InputError, match="Each actuator needs a force"):
        replace(recording, force=recording.force[0])
