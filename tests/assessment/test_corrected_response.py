"""What a test should have been: all degrees of freedom, forces, accelerations, drifts and energy."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from coupled_structures import coupled_response

import reliab
from reliab.app.cli import run
from reliab.assessment.assess import assess
from reliab.assessment.corrected_response import correct_response
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.assessment.substructures import Substructures
from reliab.core.shipped import shipped
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import read_structure
from reliab.structures.frame import Frame, reference_response
from reliab.structures.partition import Partition

_STEP = 1.0 / 512.0
_TIMES = np.arange(0.0, 16.0, _STEP)
_NOISE = np.random.default_rng(4).standard_normal(_TIMES.size)
_GROUND = np.convolve(_NOISE, np.hanning(40), mode="same") * np.minimum(_TIMES / 4.0, 1.0) / 5.0


def _two_storeys() -> tuple[Frame, Partition]:
    """A frame of three degrees of freedom, whose first two are driven together with a lever."""
    frame = Frame(
        mass=np.diag([1000.0, 900.0, 800.0]),
        damping=2e-3 * np.array([[4e5, -2e5, 0.0], [-2e5, 4e5, -2e5], [0.0, -2e5, 2e5]]),
        stiffness=np.array([[4e5, -2e5, 0.0], [-2e5, 4e5, -2e5], [0.0, -2e5, 2e5]]),
        names=("1", "2", "3"),
    )
    partition = Partition(
        mass=frame.mass,
        damping=frame.damping,
        stiffness=frame.stiffness,
        interface=np.array([[1.0], [0.5], [0.0]]),
        specimen_stiffness=np.array([[8e4]]),
        specimen_damping=np.array([[100.0]]),
    )
    return frame, partition


def test_all_displacements_follow_from_the_interface_and_the_ground() -> None:
    """Against the undivided structure under the same ground motion, of which the interface alone is told."""
    frame, partition = _two_storeys()
    shared = Substructures.from_partition(partition)
    true = reference_response(frame, _GROUND, _STEP)
    result = shared.displacements(partition.interface.T @ true, _GROUND, _STEP)
    np.testing.assert_allclose(result, true, rtol=0.0, atol=2e-4 * np.abs(true).max())


def test_forces_on_masses_follow_from_absolute_accelerations() -> None:
    """Springs, dashpots and the specimen's force, beside twice the derivative of the displacements."""
    frame, partition = _two_storeys()
    shared = Substructures.from_partition(partition)
    true = reference_response(frame, _GROUND, _STEP)
    force, felt_displacement = shared.force_of_linear(partition.interface.T @ true, _STEP)
    result = shared.accelerations(true, force, _STEP)
    expected = np.gradient(np.gradient(true, _STEP, axis=1), _STEP, axis=1) + _GROUND
    inner, peak = slice(5, -5), np.abs(felt_displacement).max()
    tolerance = 5e-3 * np.abs(expected).max()
    np.testing.assert_allclose(result[:, inner], expected[:, inner], rtol=0.0, atol=tolerance)
    remainder = shared.force_of_computer(true, _GROUND, _STEP)
    np.testing.assert_allclose(remainder[:, inner], felt_displacement[:, inner], rtol=0.0, atol=0.02 * peak)


def test_degrees_of_freedom_without_mass_follow_too() -> None:
    frame, partition = _two_storeys()
    light = replace(frame, mass=np.diag([1000.0, 900.0, 1e-3]))
    bare = replace(partition, mass=np.diag([1000.0, 900.0, 0.0]))
    true = reference_response(light, _GROUND, _STEP)
    shared = Substructures.from_partition(bare)
    result = shared.displacements(partition.interface.T @ true, _GROUND, _STEP)
    np.testing.assert_allclose(result, true, rtol=0.0, atol=5e-3 * np.abs(true).max())
    force, _ = shared.force_of_linear(partition.interface.T @ true, _STEP)
    assert not shared.accelerations(result, force, _STEP)[2].any()


@pytest.fixture(scope="module")
def coupled_test() -> tuple[FrameAssessment, np.ndarray, np.ndarray]:
    """A test of the frame that ships; its true displacements, and those of the specimen."""
    frame = read_structure(shipped("datasets", "frames/two_actuators.toml"))
    ran = coupled_response(frame.partition, frame.transfer_system, _GROUND, _STEP)
    noise = np.random.default_rng(0).normal(size=ran.measured.shape)
    read = frame.kinematics @ ran.measured
    recording = Recording(
        command=frame.kinematics @ ran.command,
        measured=read + 0.003 * read.std(axis=1, keepdims=True) * noise,
        time_step=_STEP,
        actuators=("1", "2"),
        ground=_GROUND,
    )
    partition = frame.partition
    full_test = Frame(
        mass=partition.mass,
        damping=partition.damping,
        stiffness=partition.stiffness,
        influence=partition.influence,
    )
    return assess(recording, frame), reference_response(full_test, _GROUND, _STEP), ran.measured


def _shaken_by(result: FrameAssessment, ground: np.ndarray | None) -> xr.Dataset:
    """Judge and correct the same test with another ground acceleration."""
    assessment = assess(replace(result.recording, ground=ground), result.frame)
    assert isinstance(assessment, FrameAssessment)
    return correct_response(assessment)


@pytest.mark.slow
def test_several_actuators_are_corrected_at_all_degrees_of_freedom(
    coupled_test: tuple[FrameAssessment, np.ndarray, np.ndarray],
) -> None:
    """A roof that nobody measured is right too."""
    result, true, displacement = coupled_test
    correction = correct_response(result)
    for place, name in enumerate(("x", "theta")):
        remainder = np.std(correction[f"exact_{name}"].to_numpy() - true[place])
        assert remainder < 0.3 * np.std(displacement[place] - true[place])
    for name, row in zip(("x", "theta", "roof"), true, strict=True):
        low, high = (correction[f"exact_{end}_{name}"].to_numpy() for end in ("low", "high"))
        assert np.mean((low <= row) & (row <= high)) > 0.75
        motion_variance = 0.06 if name == "theta" else 5e-3  # which hardly moves
        assert correction[f"exact_{name}"].to_numpy() == pytest.approx(
            row, abs=motion_variance * np.abs(row).max()
        )
    drift = np.abs(true[2] - true[0]).max()
    assert correction.attrs["drift_peak_roof"] == pytest.approx(drift, rel=5e-3)
    assert correction.attrs["drift_peak_low_roof"] <= drift <= correction.attrs["drift_peak_high_roof"]
    force = result.frame.partition.specimen_stiffness @ true[:2]
    expected = pytest.approx(force[0], abs=0.05 * np.abs(force[0]).max())
    assert correction["specimen_force_x"].to_numpy() == expected
    assert "degrees of freedom" not in correction.attrs["note"]


@pytest.mark.slow
def test_foreign_ground_motion_is_refused(
    coupled_test: tuple[FrameAssessment, np.ndarray, np.ndarray],
) -> None:
    """Its sign may be the opposite one; without it, or with another one, the interface alone is corrected."""
    result, true, _ = coupled_test
    opposite = _shaken_by(result, -_GROUND)
    assert opposite["exact_roof"].to_numpy() == pytest.approx(true[2], abs=5e-3 * np.abs(true[2]).max())
    second = np.random.default_rng(2).normal(size=_GROUND.size)
    for ground, says in (
        (None, "need the ground acceleration"),
        (second, "assumed to belong to another test"),
    ):
        correction = _shaken_by(result, ground)
        assert "exact_roof" not in correction
        assert "exact_x" in correction
        assert says in correction.attrs["note"]
        assert np.isfinite(correction["specimen_force_theta"]).all()


@pytest.mark.slow
def test_the_note_says_when_the_correction_is_not_small(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "corrected.nc"
    assert run(["assess", "sample_test", "--f", "1", "--xi", "0.02", "--corrected", str(out)]) == 0
    note = xr.load_dataset(out).attrs["note"]
    assert "The largest correction is" in note
    assert " ".join(note.split()) in " ".join(capsys.readouterr().out.split())


@pytest.mark.slow
@pytest.mark.parametrize("family", ["linear", "bilinear"])
def test_every_storey_of_a_frame_with_a_measured_specimen_is_corrected(family: str) -> None:
    """Against a loop of another scheme with a perfect actuator, storey by storey."""
    nonlinear_frames = pytest.importorskip("nonlinear_frames")
    time = np.arange(0.0, 20.0, nonlinear_frames.STEP)
    noise = np.random.default_rng(4).standard_normal(time.size)
    ground = 0.3 * np.convolve(noise, np.hanning(100), mode="same") * np.minimum(time / 4.0, 1.0)
    draw = np.random.default_rng(1)
    while not 0.01 < (test := nonlinear_frames.simulate_frame_test(family, ground, draw)).error < 0.1:
        pass
    recording = replace(test.recording, ground=ground)
    correction = correct_response(reliab.assess(recording, test.frame, specimen="measured"))
    for name, true in zip(test.frame.partition.frame.names, test.exact_floors.T, strict=True):
        peak = np.abs(true).max()
        assert correction[f"exact_{name}_m"].to_numpy() == pytest.approx(true, abs=0.02 * peak)
        assert correction.attrs[f"exact_peak_{name}_m"] == pytest.approx(peak, rel=0.02)
    force = correction["specimen_force_n"].to_numpy()
    assert np.std(force - test.exact_force) < 0.02 * np.std(test.exact_force)
    true = np.trapezoid(test.exact_force, test.exact)
    assert correction.attrs["specimen_energy_j"] == pytest.approx(true, rel=0.1)
