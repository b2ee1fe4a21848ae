"""Parts of an error: amplitude, delay and what is neither, against least squares and transforms."""

from dataclasses import replace

import numpy as np
import pytest
from rebuilt_error.by_transform import respond_spectrally

from reliab.assessment.inference.band import AnalysisBand
from reliab.assessment.parts import divide, fit_followers, part_of, part_of_tracking
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.histories import Histories, samples_in_step
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / 256.0
TIME = STEP * np.arange(2048)
STRUCTURE = Partition.from_structure(Structure(frequency=1.5, damping_ratio=0.05, experimental_fraction=0.6))
BAND = AnalysisBand.choose(samples=TIME.size, time_step=STEP, lowest=1.5, highest=60.0, decay=0.47)


@pytest.fixture(scope="module")
def histories():
    command = 0.02 * np.sin(2.0 * np.pi * 1.2 * TIME) * np.sin(0.4 * TIME) ** 2
    measured_displacement = 0.98 * np.interp(TIME - 0.005, TIME, command)
    return Histories(
        command=command[np.newaxis],
        measured=measured_displacement[np.newaxis],
        fed_back=(command - measured_displacement)[np.newaxis],
        time_step=STEP,
        standing=np.zeros(1),
        carry=np.eye(1),
    )


def response(difference, structure=STRUCTURE):
    return respond_spectrally(structure, difference, STEP)


def test_parts_of_no_error_have_no_share(histories):
    perfect = replace(histories, measured=histories.command, fed_back=np.zeros((1, TIME.size)))
    for part in divide(perfect, STRUCTURE, BAND).parts().by_name.values():
        assert np.abs(part.history).max() < 1e-12
    nothing = part_of(np.zeros(5), np.zeros(5), 1.0)
    assert (nothing.share, nothing.rms, nothing.remaining_mte) == (0.0, 0.0, 0.0)


def test_a_part_over_time_keeps_its_mean_square(histories):
    parts = divide(histories, STRUCTURE, BAND).parts()
    for name, part in parts.by_name.items():
        square = np.mean(part.history**2)
        stretches = parts.rms_over_time(STEP, 2.0)[name]
        assert stretches.size == 4
        assert np.mean(stretches**2) == pytest.approx(square)
    uneven = parts.rms_over_time(STEP, 3.0)["delay"]
    history = parts.by_name["delay"].history
    assert uneven == pytest.approx([np.sqrt(np.mean(h**2)) for h in np.split(history, [768, 1536])])


def test_parts_are_gain_delay_and_rest_of_least_squares(histories):
    parts = divide(histories, STRUCTURE, BAND).parts()
    command, measured_displacement = histories.command[0], histories.measured[0]
    rate = np.gradient(command, STEP)
    basis = np.stack([command, -rate, np.ones(TIME.size)])
    gain, delay, _ = np.linalg.lstsq(basis.T, measured_displacement, rcond=None)[0]
    gains, delays, _ = fit_followers(command, measured_displacement, STEP)
    assert (gains.item(), delays.item()) == pytest.approx((gain, delay))
    difference = command - measured_displacement
    error = response(difference) - difference
    ideal = np.abs(measured_displacement - error).max()
    for name, wrong in (("amplitude", (1.0 - gain) * command), ("delay", delay * rate)):
        piece, part = response(wrong) - wrong, parts.by_name[name]
        assert part.history == pytest.approx(piece, abs=1e-6)
        assert part.rms == pytest.approx(np.sqrt(mean_square(piece)) / ideal, rel=1e-3)
        assert part.share == pytest.approx(piece @ error / (error @ error), rel=1e-3)
        remainder = error - piece
        assert part.remaining_rms == pytest.approx(np.sqrt(mean_square(remainder)) / ideal, rel=1e-3)
        assert part.remaining_mte == pytest.approx(np.abs(remainder).max() / ideal, rel=1e-3)


def test_exactly_described_actuator_accounts_for_the_whole_error(histories):
    part = part_of_tracking(histories, STRUCTURE, BAND, histories.measured[0])
    assert part.share == pytest.approx(1.0)
    assert part.remaining_rms == pytest.approx(0.0, abs=1e-12)
    half = part_of_tracking(histories, STRUCTURE, BAND, 0.5 * (histories.measured + histories.command)[0])
    assert half.share == pytest.approx(0.5)
    assert half.rms == pytest.approx(0.5 * part.rms)
    ideal = np.abs(histories.measured[0] - part.history).max()
    assert half.remaining_mte == pytest.approx(0.5 * np.abs(part.history).max() / ideal)


def test_a_step_of_the_sweep_resolves_structure_and_motion():
    """64 samples in a period of the structure; a quarter of the motion's period for up to 4096 samples."""
    stiff = Partition.from_structure(Structure(frequency=0.5, damping_ratio=0.05))
    noise = SensorNoise(time_step=1.0 / 1024.0, weights=np.zeros(6), band=32.0)
    of_structure = samples_in_step_of_structure(stiff, noise.time_step)
    assert samples_in_step(of_structure, [noise], 20_000) == 8
    assert samples_in_step(of_structure, [replace(noise, band=128.0)], 4096) == 2
    assert samples_in_step(of_structure, [replace(noise, band=128.0)], 4096 * 5 + 1) == 6
    assert samples_in_step(of_structure, [replace(noise, band=2.0)], 100) == 32
    assert samples_in_step(of_structure, [replace(noise, band=400.0)], 100) == 1
