"""Frames before many actuators: oracles of other kinds, and the limit of one mode."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from reliab.core.errors import InputError
from reliab.effects.registry import find_effect
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_loop import FrameLoop
from reliab.simulation.transfer_systems.transfer_function import gain_and_delay
from reliab.structures.frame import Frame, Specimen, modal_damping
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame
from reliab.structures.structure import Structure
from reliab.tracking.boundary.suite_boundary import motion_contours


def solve_by_steps(partition, ground, step, gain, delay, end):
    """Command over time by an adaptive integrator, one delay after the other, with dense history."""
    n, gamma = partition.frame.size, partition.direction
    stiffness, damping = partition.specimen.stiffness, partition.specimen.damping
    mass = partition.frame.mass @ partition.frame.influence
    inverse = np.linalg.inv(partition.numerical_mass)
    instants = step * np.arange(ground.size)
    pieces = []

    def command(time):
        if time <= 0.0:
            return 0.0, 0.0
        z = pieces[min(int(time / delay), len(pieces) - 1)](time)
        return gamma @ z[:n], gamma @ z[n:]

    def slope(time, z):
        x, v = command(time - delay)
        load = -mass * np.interp(time, instants, ground, right=0.0) - gamma * gain * (
            stiffness * x + damping * v
        )
        load -= partition.numerical_damping @ z[n:] + partition.numerical_stiffness @ z[:n]
        return np.concatenate([z[n:], inverse @ load])

    state = np.zeros(2 * n)
    for piece in range(int(np.ceil(end / delay))):
        span = piece * delay, (piece + 1) * delay
        solution = solve_ivp(
            slope, span, state, method="DOP853", rtol=1e-9, atol=1e-13, dense_output=True, max_step=step
        )
        pieces.append(solution.sol)
        state = solution.y[:, -1]
    return command


@pytest.mark.parametrize("seed", [1, 2])
def test_spectral_engine_is_the_method_of_steps(random_partition, seed):
    partition = random_partition(seed, size=2 + seed % 2, mass=False)
    ground = np.sin(2 * np.pi * 2.1 * 0.02 * np.arange(41)) * np.hanning(41)
    gain, delay = 1.03, 0.04
    command = solve_by_steps(partition, ground, 0.02, gain, delay, 0.8)
    loop = FrameLoop(excitation=Excitation(acceleration=ground, time_step=0.02), partition=partition)
    test = replace(loop.exact, longest_step=1 / 4096).response(gain_and_delay(gain, delay))
    reading, step = test.measured[0], test.step
    places = np.arange(0, reading.size, 60)
    expected = np.array([gain * command(step * place - delay)[0] for place in places])
    assert np.abs(reading[places] - expected).max() <= 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize("seed", range(4))
def test_pole_pairs_are_the_spectral_engine(random_partition, shaken, seed):
    partition = random_partition(seed)
    excitation = Excitation(acceleration=shaken, time_step=0.02)
    drifts = np.eye(partition.frame.size) - np.eye(partition.frame.size, k=-1)  # of the storeys
    for output in (None, *drifts[1:]):
        loop = FrameLoop(excitation=excitation, partition=partition, output=output, engine=Engine.POLE)
        oracle = FrameLoop(excitation=excitation, partition=partition, output=output, engine=Engine.SPECTRAL)
        gain, delay = [1.0, 1.0, 0.97, 1.02, 1.0], [1e-3, 6e-3, 0.0, 2e-3, -2e-3]
        pole_result = loop.deviation(loop.cells(gain=gain, delay=delay))
        exact = oracle.deviation(oracle.cells(gain=gain, delay=delay))
        np.testing.assert_allclose(pole_result.mean_square, exact.mean_square, rtol=4e-4)
        np.testing.assert_allclose(pole_result.peak, exact.peak, rtol=2e-3)
        assert pole_result.ideal_peak == pytest.approx(exact.ideal_peak, rel=1e-3)


def test_one_degree_of_freedom_is_the_one_mode_loop(shaken):
    structure = Structure(frequency=1.3, damping_ratio=0.03, experimental_fraction=0.7)
    excitation = Excitation(acceleration=shaken, time_step=0.02, window=(2.0, 11.0))
    single = Loop(excitation=excitation, structure=structure)
    frame = FrameLoop(excitation=excitation, partition=Partition.from_structure(structure, mass=30.0))
    actuators = {"gain": [1.0, 0.98, 1.01, 1.0], "delay": [1e-3, 0.0, 2e-3, 0.03]}
    expected, pole_result = (
        single.deviation(single.cells(**actuators)),
        frame.deviation(frame.cells(**actuators)),
    )
    np.testing.assert_allclose(pole_result.mean_square, expected.mean_square, rtol=1e-3)
    np.testing.assert_allclose(pole_result.peak, expected.peak, rtol=1e-3)


def one_mode_partition(mode=0):
    """Three storeys of which the specimen drives one mode only: its spring acts along M φ."""
    mass, stiffness = shear_frame([1000.0, 1000.0, 1000.0], [8e5, 8e5, 8e5])
    frame = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.03))
    shape = frame.modes.shapes[:, mode]
    direction = mass @ shape
    share = 0.6 * frame.modes.circular_frequency[mode] ** 2
    influence = frame.modes.shapes[:, mode]  # the ground excites this mode only
    frame = Frame(mass=mass, stiffness=stiffness, damping=frame.damping, influence=influence)
    return Partition.from_frame(frame=frame, interface=direction, specimen=Specimen(stiffness=share))


@pytest.mark.parametrize("mode", [0, 1])
def test_specimen_driving_one_mode_has_boundary_of_one_mode(shaken, mode):
    partition = one_mode_partition(mode)
    np.testing.assert_allclose(np.delete(partition.stiffness_shares, mode), 0.0, atol=1e-12)
    excitation = Excitation(acceleration=shaken, time_step=0.02)
    frequency = float(partition.frame.modes.frequency[mode])
    structure = Structure(frequency=frequency, damping_ratio=0.03, experimental_fraction=0.6)
    loops = (
        FrameLoop(excitation=excitation, partition=partition),
        Loop(excitation=excitation, structure=structure),
    )
    (frame,), (single,) = (motion_contours(loop, (0.05,)) for loop in loops)
    delay = np.interp(single.amplitude, frame.amplitude, frame.delay)
    is_inside = (single.amplitude > frame.amplitude[1]) & (single.amplitude < frame.amplitude[-2])
    assert is_inside.sum() > 5
    np.testing.assert_allclose(delay[is_inside], single.delay[is_inside], rtol=0.01)


def test_a_growing_test_is_followed_by_both_engines_and_a_violent_one_is_infinitely_wrong(
    shaken, benchmark_partition
):
    excitation = Excitation(acceleration=shaken, time_step=0.02)
    loop = FrameLoop(excitation=excitation, partition=benchmark_partition(1))
    pole_result = loop.deviation(loop.cells(gain=1.0, delay=[0.010, 0.014, 0.020]))
    assert np.all(np.diff(pole_result.mean_square) > 0.0)
    oracle = FrameLoop(excitation=excitation, partition=benchmark_partition(1), engine=Engine.SPECTRAL)
    exact = oracle.deviation(oracle.cells(gain=1.0, delay=[0.010, 0.014, 0.020, 0.1]))
    np.testing.assert_allclose(exact.mean_square[:3], pole_result.mean_square, rtol=2e-3)
    assert np.isinf(exact.mean_square[3])


def frame_with_brace(share, output=(0.0, 0.0, 1.0)):
    """Three storeys with a share of the first one's stiffness in the laboratory, and an output."""
    mass, stiffness = shear_frame([2000.0, 2000.0, 1500.0], [1.2e6, 1.0e6, 8.0e5])
    frame = Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.02))
    specimen = Specimen(stiffness=share * 1.2e6)
    partition = Partition.from_frame(frame=frame, interface=[1.0, 0.0, 0.0], specimen=specimen)
    return partition, None if output is None else np.array(output)


OUTPUTS = (None, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 1.0))


@pytest.mark.default_cases(6)
@pytest.mark.parametrize("output", OUTPUTS)
@pytest.mark.parametrize("share", [0.5, 0.98, 0.99, 0.999, 0.9999, 1.0])
def test_an_actuator_at_rest_leaves_the_floors_to_the_computer_alone(shaken, share, output):
    """Whether or not what is left to the computer oscillates, is overdamped or drifts freely."""
    partition, output_row = frame_with_brace(share, output)
    remainder = FrameLoop(
        excitation=Excitation(acceleration=shaken, time_step=0.02), partition=partition, output=output_row
    ).rest_deviation()
    times = np.arange(0.0, 0.02 * (shaken.size - 1) + 1e-9, 0.005)
    ground = np.interp(times, 0.02 * np.arange(shaken.size), shaken)

    def floors(mass, damping, stiffness):
        """Exact for the piecewise-linear record, by matrix exponentials."""
        nothing, single = np.zeros((3, 3)), np.eye(3)
        state_rows = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
        matrix = np.vstack([np.hstack([nothing, single]), state_rows])
        load = np.concatenate([np.zeros(3), -np.linalg.solve(mass, partition.frame.mass @ np.ones(3))])
        outputs = np.hstack([single, nothing])
        return lsim((matrix, load[:, np.newaxis], outputs, np.zeros((3, 1))), ground, times)[1].T

    frame = partition.frame
    ideal = floors(frame.mass, frame.damping, frame.stiffness)
    separate = floors(partition.numerical_mass, partition.numerical_damping, partition.numerical_stiffness)
    deviation = ideal[0] if output_row is None else output_row @ (separate - ideal)
    assert remainder.peak[0] == pytest.approx(np.abs(deviation).max(), rel=2e-3)
    assert remainder.mean_square[0] == pytest.approx(np.mean(deviation**2), rel=5e-3)


@given(
    share=st.sampled_from([0.9, 0.9997, 1.0]),
    gain=st.floats(1e-13, 3.0),
    delay=st.floats(-0.05, 5.0),
    output=st.sampled_from(OUTPUTS),
)
@settings(max_examples=25)
def test_whatever_the_actuator_the_error_is_a_number_or_beyond_every_threshold(share, gain, delay, output):
    """And no warning of the numerics is given, which the settings of the tests turn into an error."""
    partition, output_row = frame_with_brace(share, output)
    ground = np.sin(np.arange(200) / 5.0) * np.hanning(200)
    loop = FrameLoop(
        excitation=Excitation(acceleration=ground, time_step=0.02),
        partition=partition,
        output=output_row,
        engine=Engine.POLE,
    )
    cells = loop.cells(gain=gain, delay=delay)
    neglected_part = loop.reduced_loop.error(
        loop.reduced_loop.poles(cells.gain, cells.delay), cells.gain, cells.delay
    )
    for error in (loop.deviation(cells).mean_square, loop.deviation(cells).peak, neglected_part):
        assert not np.isnan(error).any()


def test_frame_refuses_unsupported_options(shaken, benchmark_partition):
    excitation = Excitation(acceleration=shaken, time_step=0.02)
    partition = benchmark_partition(1)
    with pytest.raises(InputError, match="needs 3 weights"):
        FrameLoop(excitation=excitation, partition=partition, output=np.ones(2))
    with pytest.raises(InputError, match="automatic, spectral or, with one actuator, pole"):
        FrameLoop(excitation=excitation, partition=partition, engine=Engine.DELAY)
    with pytest.raises(InputError, match="gains must be positive"):
        FrameLoop(excitation=excitation, partition=partition).cells(gain=-1.0, delay=0.0)
    friction = find_effect("cubic_stiffness")(cubic_n_per_m3=1e9)
    rough = Partition.from_frame(
        frame=partition.frame,
        interface=partition.direction,
        specimen=partition.specimen,
        effects=(friction,),
    )
    with pytest.raises(InputError, match="needs a linear specimen"):
        FrameLoop(excitation=excitation, partition=rough)
