"""All engines against each other, in whole records and windows."""

from dataclasses import replace

import numpy as np
import pytest

from reliab import ellipses
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion, resample
from reliab.motions.suite import MotionSuite
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper, pole_recursion
from reliab.simulation.linear_loop.cells import Cells
from reliab.structures.structure import Structure, critical_delay
from reliab.sweep.request import ExplicitGrid, excitation_of
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window


def random_case(rng: np.random.Generator, excitation: Excitation) -> tuple[Loop, Cells]:
    xi = float(rng.choice([0.02, 0.05, 0.1]))
    structure = Structure(
        frequency=float(rng.choice([0.25, 0.5, 1.0, 1.5, 2.0])),
        damping_ratio=xi,
        experimental_fraction=float(rng.choice([1.0, 1.0, 0.6])),
    )
    gain = 1.0 + xi * rng.uniform(-1.0, 1.0)
    delay = rng.uniform(0.0, 0.9) * min(0.3, float(critical_delay(structure, gain)))
    loop = Loop(excitation=excitation, structure=structure)
    return loop, loop.cells(gain=gain, delay=delay)


def differences(loop: Loop, cells: Cells, second: Engine) -> dict[Metric, float]:
    """Largest relative difference of each error between two engines, each of which runs once."""
    ours, oracle = loop.deviation(cells), replace(loop, engine=second).deviation(cells)
    return {
        metric: float(np.abs(relative_error(ours, metric) / relative_error(oracle, metric) - 1.0).max())
        for metric in Metric
    }


def square_and_peak(blocks, measured):
    """Mean square and peak of the deviation within the window, by the trapezoidal rule."""
    deviation = (measured - blocks.ideal)[blocks.before :]
    deviation[-1] = deviation[-2] + blocks.end * (deviation[-1] - deviation[-2])
    last = 0.5 * blocks.end * (deviation[-2] ** 2 + deviation[-1] ** 2)
    square = (np.trapezoid(deviation[:-1] ** 2) + last) / blocks.intervals
    return square, np.abs(deviation).max()


@pytest.mark.default_cases(6)
@pytest.mark.parametrize("seed", range(60))
def test_automatic_engine_agrees_with_the_spectral_one(random_excitation, seed):
    rng = np.random.default_rng(seed)
    loop, cells = random_case(rng, random_excitation(rng))
    result = differences(loop, cells, Engine.SPECTRAL)
    assert result[Metric.RMS] < 1e-4
    assert result[Metric.MTE] < 2e-3


@pytest.mark.parametrize("count", [6, pytest.param(300, marks=pytest.mark.slow)])
def test_engines_agree_on_many_cells_of_the_real_records(real_motions_folder, count):
    rng = np.random.default_rng(2017)
    motions = load_motions(real_motions_folder)
    for index in rng.integers(0, len(motions), count):
        motion = motions[int(index)]
        result = differences(*random_case(rng, excitation_of(motion, Window())), Engine.SPECTRAL)
        assert result[Metric.RMS] < 1e-4
        assert result[Metric.MTE] < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(("rate", "rms", "mte"), [(200.0, 1e-5, 2e-4), (50.0, 6e-5, 8e-4)])
def test_pole_engine_agrees_with_an_independent_kernel(rate, rms, mte):
    """The other kernel steps one pole at the record's own step, and errs by as much as is allowed here."""
    from benchmarks.independent_kernel import Kernel

    motion = resample(load_motions("synthetic")[0], rate)
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    cells = ExplicitGrid().cells(structure)
    loop = Loop(
        excitation=Excitation(acceleration=motion.acceleration, time_step=motion.time_step),
        structure=structure,
        engine=Engine.POLE,
    )
    ours, usual = loop.deviation(cells), cells.delay < 0.9 * critical_delay(structure, cells.gain)
    second = Kernel(structure, cells.gain, cells.delay, motion.time_step).errors(motion.acceleration)
    for metric, errors, tolerance in zip(Metric, second, (rms, mte), strict=True):
        assert np.abs(errors - relative_error(ours, metric))[usual].max() < tolerance


@pytest.mark.parametrize("delay", [0.0, 1e-4, 0.001, 0.004, 0.0149, 0.016, 0.05])
def test_delay_stepper_agrees_with_the_spectral_engine_on_both_sides_of_a_block(random_excitation, delay):
    excitation = random_excitation(5)
    loop = Loop(
        excitation=excitation,
        structure=Structure(frequency=0.3, damping_ratio=0.08),
        engine=Engine.DELAY,
    )
    cells = loop.cells(gain=[0.97, 1.02], delay=delay)
    assert differences(loop, cells, Engine.SPECTRAL)[Metric.RMS] < 1e-4


@pytest.mark.parametrize("window", [(0.0, -1.0), (3.003, 9.0047)])
def test_delays_shorter_than_a_block_follow_the_history_of_the_general_stepper(random_excitation, window):
    excitation = random_excitation(6, window=window)
    structure = Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=0.7)
    loop = Loop(excitation=excitation, structure=structure, engine=Engine.DELAY)
    blocks, delays = loop.blocks, [0.0, 0.004, 0.0099]
    result = loop.deviation(loop.cells(gain=1.02, delay=delays))
    for cell, delay in enumerate(delays):
        _, reading = delay_stepper.response(blocks, structure, 1.02, delay)
        mean_square, peak = square_and_peak(blocks, reading)
        assert result.mean_square[cell] == pytest.approx(mean_square, rel=1e-9)
        assert result.peak[cell] == pytest.approx(peak, rel=2e-3)


def test_pole_and_delay_engines_agree_beyond_the_stability_limit(random_excitation):
    excitation = random_excitation(8)
    structure = Structure(frequency=1.5, damping_ratio=0.02)
    loop = Loop(excitation=excitation, structure=structure, engine=Engine.POLE)
    cells = loop.cells(gain=1.0, delay=1.5 * critical_delay(structure))
    assert differences(loop, cells, Engine.DELAY)[Metric.RMS] < 1e-4


@pytest.mark.default_cases(2)
@pytest.mark.parametrize(("frequency", "earliest", "latest"), [(0.25, 0.0, 0.12), (0.5, -0.1, 0.1)])
def test_result_does_not_depend_on_other_cells(random_excitation, frequency, earliest, latest):
    rng = np.random.default_rng(3)
    excitation = random_excitation(rng)
    loop = Loop(excitation=excitation, structure=Structure(frequency=frequency, damping_ratio=0.1))
    gain, delay = rng.uniform(0.9, 1.1, 150), rng.uniform(earliest, latest, 150)
    joint = loop.deviation(loop.cells(gain=gain, delay=delay))
    for cell in (0, 70, 149):
        separate = loop.deviation(loop.cells(gain=gain[cell], delay=delay[cell]))
        assert separate.mean_square[0] == pytest.approx(joint.mean_square[cell], rel=1e-10)
        assert separate.peak[0] == pytest.approx(joint.peak[cell], rel=1e-10)


def test_window_inside_the_record_is_the_same_for_all_engines(random_excitation):
    rng = np.random.default_rng(4)
    excitation = random_excitation(rng, window=(3.21, 11.47))
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.03))
    cells = loop.cells(gain=[0.99, 1.01], delay=[0.001, 0.002])
    for engine in (Engine.DELAY, Engine.SPECTRAL):
        assert differences(loop, cells, engine)[Metric.RMS] < 1e-4


@pytest.mark.parametrize(
    ("engine", "damping_ratio", "delay", "rule"),
    [
        (Engine.SPECTRAL, 0.02, 0.0065, r"6\.3679 ms"),  # the limit of stability
        (Engine.POLE, 0.1, 0.2, "engine 'pole' would change"),
    ],
)
def test_engine_refuses_delays_outside_its_range(random_excitation, engine, damping_ratio, delay, rule):
    structure = Structure(frequency=1.0, damping_ratio=damping_ratio)
    loop = Loop(excitation=random_excitation(0), structure=structure, engine=engine)
    with pytest.raises(InputError, match=rule):
        loop.deviation(loop.cells(gain=1.0, delay=delay))


@pytest.mark.parametrize("damping_ratio", [0.7, 0.95, 0.9999])
@pytest.mark.parametrize("fraction", [1.0, 0.4])
def test_loops_without_oscillation_are_solved(damping_ratio, fraction):
    """A weak actuator leaves a highly damped structure without a pair of poles that oscillates."""
    time = np.arange(0.0, 20.0, 0.005)
    record = np.exp(-((time / 5.0 - 1.5) ** 2)) * (np.sin(5.0 * time) + np.sin(17.0 * time))
    structure = Structure(frequency=1.0, damping_ratio=damping_ratio, experimental_fraction=fraction)
    meeting = max(1.0 + (damping_ratio**2 - 1.0) / fraction, 0.4)  # gain at which both poles meet
    loop = Loop(excitation=Excitation(acceleration=record, time_step=0.005), structure=structure)
    for delays in ([0.0, 0.004, 0.04], [-0.004, -0.04]):
        gain, delay = np.meshgrid([0.3, meeting, meeting + 1e-9, 0.7, 1.7], delays)
        result = differences(loop, loop.cells(gain=gain, delay=delay), Engine.SPECTRAL)
        assert result[Metric.RMS] < 1e-3
        assert result[Metric.MTE] < 2e-3


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("damping_ratio", [0.7, 0.99])
def test_ellipses_of_highly_damped_structures_are_numbers(damping_ratio):
    time = np.arange(0.0, 8.0, 0.01)
    motion = Motion(name="M", acceleration=np.sin(8.0 * time) * np.exp(-time), time_step=0.01)
    boundary = ellipses(MotionSuite.from_motions([motion]), f=1.0, xi=damping_ratio)
    for name in ("a", "b"):
        assert (boundary[name].to_numpy() > 0.0).all()
        assert np.isfinite(boundary[name].to_numpy()).all()


TIME = np.arange(0.0, 12.0, 0.01)
END_IN_STRONG_MOTION = np.random.default_rng(1).standard_normal(TIME.size) * TIME
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)


def sum_poles(blocks, late):
    k = late.coefficients[:, 0]
    slow, fast = np.zeros((2, blocks.left.size + 1))
    for y, c in ((slow, k[:6]), (fast, k[6:])):
        for i in range(blocks.left.size):
            y[i + 1] = c[0] * y[i] + c[2] * blocks.left[i] + c[3] * blocks.right[i]
            if i:
                y[i + 1] += c[1] * y[i - 1] + c[4] * blocks.left[i - 1] + c[5] * blocks.right[i - 1]
    return slow + fast


@pytest.mark.parametrize("window", [(0.0, 0.31), (2.0, 2.08), (2.0, 2.9), (6.11, 9.503), (1.0, -1.0)])
@pytest.mark.parametrize("kernel", ["shared drives", "poles", "short delay", "delay"])
def test_mean_square_and_peak_are_those_of_the_history(kernel, window):
    excitation = Excitation(acceleration=END_IN_STRONG_MOTION, time_step=0.01, window=window)
    loop = Loop(excitation=excitation, structure=STRUCTURE)
    blocks, gain = loop.blocks, np.array([1.03])
    delay = np.array([{"short delay": 0.6, "delay": 2.3}.get(kernel, 0.1) * blocks.step])
    cells = loop.cells(gain=gain, delay=delay)
    if "delay" in kernel:
        result = delay_stepper.deviation(blocks, STRUCTURE, gain, delay)
        reading = delay_stepper.response(blocks, STRUCTURE, gain[0], delay[0])[1]
    else:
        (late,) = cells.recursions(blocks.step)
        separate = kernel == "poles"
        result = pole_recursion.deviation(blocks, late.coefficients) if separate else loop.deviation(cells)
        reading = sum_poles(blocks, late)
    mean_square, peak = square_and_peak(blocks, reading)
    # a parabola through three samples rises above them
    assert peak * (1.0 - 1e-5) <= result.peak[0] <= peak * 1.02
    assert result.mean_square[0] == pytest.approx(mean_square, rel=1e-5)
