"""Deviations under shared drives, against the recursion that each actuator has for itself."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.core.vocabulary import Metric
from reliab.motions.loading import load_motions
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import drive_stepping, pole_recursion
from reliab.simulation.linear_loop.delay_stepper import response
from reliab.simulation.linear_loop.drive_stepping import DrivenRecord, DriveResponse, shared_drives
from reliab.structures.structure import Structure
from reliab.tracking.indices.response_error import relative_error

TIME = np.arange(0.0, 30.0, 0.01)
HOSTILE = {
    "impulse": (np.abs(TIME - 3.0) < 0.005).astype(float),
    "harmonic at the structure's frequency": np.sin(2.0 * np.pi * TIME),
    "harmonic far below it": np.sin(0.2 * np.pi * TIME),
    "harmonic above it": np.sin(2.0 * np.pi * 9.0 * TIME),
    "alternating samples": np.where(np.arange(TIME.size) % 2, 1.0, -1.0),
    "step that stays": (TIME > 2.0).astype(float),
    "end in strong motion": np.random.default_rng(1).standard_normal(TIME.size) * TIME,
    "very weak": 1e-30 * np.random.default_rng(2).standard_normal(TIME.size),
}


def grid(loop: Loop):
    """Actuators with an even spacing of gains and of delays up to three tenths of a block."""
    xi = loop.structure.damping_ratio
    gain, delay = np.meshgrid(
        1.0 + xi * np.linspace(-1.0, 1.0, 5), 0.29 * loop.blocks.step * np.linspace(0, 1, 5)
    )
    return loop.cells(gain=gain, delay=delay)


def precise_cells(loop, driven):
    """Tell for which cells single precision is enough."""
    time_history = DriveResponse.step_through(loop.blocks, loop.driven_record, driven)
    _, precise = drive_stepping.deviation(loop.blocks, loop.driven_record, driven, time_history)
    return precise


def differences(loop, cells):
    """Largest relative differences of RMS^R and MTE^R from the recursions of single actuators."""
    (late,) = cells.recursions(loop.blocks.step)
    assert cells.driven(loop.blocks.step, late).place.size == cells.gain.size
    ours, oracle = loop.deviation(cells), pole_recursion.deviation(loop.blocks, late.coefficients)
    displacement = oracle.mean_square > 1e-18 * loop.blocks.ideal_peak**2
    assert displacement.sum() >= 24
    squares = np.sqrt(ours.mean_square[displacement] / oracle.mean_square[displacement])
    return np.abs(squares - 1.0).max(), np.abs(
        ours.peak[displacement] / oracle.peak[displacement] - 1.0
    ).max()


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("window", [(0.0, -1.0), (1.5, 4.2), (2.999, 3.2)])
def test_hostile_records_keep_the_tolerance(name, window):
    excitation = Excitation(acceleration=HOSTILE[name], time_step=0.01, window=window)
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.03))
    rms, mte = differences(loop, grid(loop))
    assert rms < 3e-5
    assert mte < 1e-3  # the last parabola of the recursions ends with the window


@pytest.mark.parametrize(("frequency", "damping_ratio"), [(0.25, 0.01), (0.5, 0.1), (2.0, 0.02), (8.0, 0.05)])
def test_structures_from_soft_to_stiff_keep_the_tolerance(random_excitation, frequency, damping_ratio):
    structure = Structure(frequency=frequency, damping_ratio=damping_ratio, experimental_fraction=0.8)
    loop = Loop(excitation=random_excitation(3), structure=structure)
    rms, mte = differences(loop, grid(loop))
    assert rms < 3e-5
    assert mte < 2e-4


def test_real_records_keep_the_tolerance_of_the_exact_solution(real_motions_folder):
    rng = np.random.default_rng(16)
    motions = load_motions(real_motions_folder)
    for index in rng.integers(0, len(motions), 10):
        motion = motions[int(index)]
        structure = Structure(frequency=float(rng.choice([0.25, 1.0, 2.0])), damping_ratio=0.02)
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        loop = Loop(excitation=excitation, structure=structure)
        cells = loop.cells(gain=[0.985, 1.004, 1.02], delay=[0.0, 0.0004, 0.0018])
        ours, exact = loop.deviation(cells), replace(loop, engine=Engine.SPECTRAL).deviation(cells)
        rms, mte = (relative_error(ours, metric) / relative_error(exact, metric) - 1.0 for metric in Metric)
        assert np.abs(rms).max() < 1e-4
        assert np.abs(mte).max() < 1e-3


def test_paper_grid_needs_no_recursions_of_single_actuators():
    gain, delay = np.meshgrid(np.linspace(0.98, 1.02, 41), np.linspace(0.0, 0.002, 21))
    for frequency in (0.25, 1.0, 2.0):
        loop = Loop(
            excitation=Excitation(acceleration=HOSTILE["impulse"], time_step=0.01),
            structure=Structure(frequency=frequency, damping_ratio=0.02),
        )
        cells = loop.cells(gain=gain, delay=delay)
        (late,) = cells.recursions(loop.blocks.step)
        assert cells.driven(loop.blocks.step, late).place.size == gain.size


def test_perfect_actuator_does_not_deviate():
    loop = Loop(
        excitation=Excitation(acceleration=HOSTILE["impulse"], time_step=0.01),
        structure=Structure(frequency=1.0, damping_ratio=0.02),
    )
    assert loop.deviation(loop.cells(gain=1.0, delay=0.0)).peak[0] < 1e-12 * loop.blocks.ideal_peak


def test_long_delays_and_violent_growth_are_left_to_other_kernels():
    """A delay of a block needs more drives; e³⁰ would overflow squares in single precision."""
    structure = Structure(frequency=8.0, damping_ratio=0.002)
    record = np.random.default_rng(4).standard_normal(60_000)
    loop = Loop(excitation=Excitation(acceleration=record, time_step=0.01), structure=structure)
    step = loop.blocks.step
    cells = loop.cells(gain=1.0, delay=[0.01 * step, 0.25 * step, step])
    (late,) = cells.recursions(step)
    driven = cells.driven(step, late)
    assert driven.place.tolist() == [0, 1]
    assert precise_cells(loop, driven).tolist() == [True, False]
    assert np.isfinite(loop.deviation(cells).peak[:2]).all()


def test_deviation_below_its_drive_is_left_to_double_precision():
    excitation = Excitation(acceleration=HOSTILE["alternating samples"], time_step=0.01)
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.03))
    cells = loop.cells(gain=[0.98, 1.0], delay=[0.001, 0.0])
    driven = cells.driven(loop.blocks.step, cells.recursions(loop.blocks.step)[0])
    assert precise_cells(loop, driven).tolist() == [False, True]


@pytest.mark.parametrize("engine", [Engine.POLE, Engine.DELAY])
def test_peak_at_the_begin_of_a_window_is_not_extrapolated(engine):
    """The deviation of a resonant record falls from the first sample of this window on."""
    excitation = Excitation(acceleration=HOSTILE["impulse"], time_step=0.01, window=(3.42, 3.57))
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.03), engine=engine)
    complete = replace(loop, excitation=replace(excitation, window=(0.0, 3.42)))
    cells = loop.cells(gain=1.0, delay=0.0045)
    histories = response(complete.blocks, loop.structure, 1.0, 0.0045)
    first = abs(histories[1, -1] - complete.blocks.ideal[-1])
    assert loop.deviation(cells).peak[0] == pytest.approx(first, rel=2e-3)


def test_silence_has_no_drives():
    loop = Loop(
        excitation=Excitation(acceleration=np.zeros(500), time_step=0.01),
        structure=Structure(frequency=1.0, damping_ratio=0.02),
    )
    record = DrivenRecord.from_blocks(loop.blocks, shared_drives(loop.structure, loop.blocks.step))
    assert not record.drives.any()
