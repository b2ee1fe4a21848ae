"""The loop against closed forms and against a plain integration of the delay equation."""

import math
from dataclasses import replace

import numpy as np
import pytest

from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper, spectral
from reliab.simulation.linear_loop.blocks import cut
from reliab.simulation.linear_loop.pole_recursion import transfer
from reliab.structures.structure import Structure


def runge_kutta(acceleration, time_step, structure, gain, delay, parts):
    """Measured displacement by fourth-order Runge–Kutta with cubic history, at the record's samples."""
    h = time_step / parts
    record = np.interp(
        np.arange((acceleration.size - 1) * parts * 2 + 1) / (2 * parts),
        np.arange(acceleration.size),
        acceleration,
    ).tolist()  # numbers of Python, which are faster one by one
    w0, xi, alpha = structure.circular_frequency, structure.damping_ratio, structure.experimental_fraction
    steps = (acceleration.size - 1) * parts
    x, v = [0.0] * (steps + 1), [0.0] * (steps + 1)

    def past(i: int, ahead: float) -> float:
        position = i + ahead - delay / h
        k = math.floor(position)
        if position < 0.0:
            return 0.0
        s = position - k
        if k >= i:  # inside the running step: from its begin
            return x[i] + (position - i) * h * v[i]
        return (
            (1 + 2 * s) * (1 - s) ** 2 * x[k]
            + s * (1 - s) ** 2 * h * v[k]
            + s**2 * (3 - 2 * s) * x[k + 1]
            + s**2 * (s - 1) * h * v[k + 1]
        )

    def slope(a: float, place: float, pace: float, late: float) -> tuple[float, float]:
        return pace, -a - 2 * xi * w0 * pace - w0**2 * ((1 - alpha) * place + alpha * gain * late)

    for i in range(steps):
        now, half, end = past(i, 0.0), past(i, 0.5), past(i, 1.0)
        a0, a1, a2 = record[2 * i : 2 * i + 3]
        k1 = slope(a0, x[i], v[i], now)
        k2 = slope(a1, x[i] + h / 2 * k1[0], v[i] + h / 2 * k1[1], half)
        k3 = slope(a1, x[i] + h / 2 * k2[0], v[i] + h / 2 * k2[1], half)
        k4 = slope(a2, x[i] + h * k3[0], v[i] + h * k3[1], end)
        x[i + 1] = x[i] + h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        v[i + 1] = v[i] + h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    return np.array([gain * past(i, 0.0) for i in range(0, steps + 1, parts)])


@pytest.mark.parametrize(
    ("structure", "gain", "delay"),
    [
        (Structure(frequency=1.0, damping_ratio=0.02), 0.99, 0.004),
        (Structure(frequency=2.0, damping_ratio=0.05, experimental_fraction=0.5), 1.03, 0.006),
        (Structure(frequency=0.5, damping_ratio=0.1), 1.0, 0.05),
    ],
)
def test_engines_solve_the_delay_equation(structure, gain, delay):
    rng = np.random.default_rng(11)
    t = np.arange(0.0, 8.0, 0.02)
    acceleration = rng.standard_normal(t.size) * np.exp(-(((t - 3.0) / 2.0) ** 2))
    reference = runge_kutta(acceleration, 0.02, structure, gain, delay, parts=40)
    excitation = Excitation(acceleration=acceleration, time_step=0.02)
    exact, step = spectral.response(excitation, structure, gain, delay)
    samples = np.interp(t, step * np.arange(exact.size), exact)
    assert np.abs(samples - reference).max() < 2e-4 * np.abs(reference).max()
    blocks = cut(excitation, structure, step=0.005)
    time_history = delay_stepper.response(blocks, structure, gain, delay)[1][::4]
    assert np.abs(time_history - reference).max() < 2e-4 * np.abs(reference).max()


def test_steady_state_of_the_delayed_loop_is_its_transfer_function():
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    drive = 2.0 * np.pi * 0.8
    t = np.arange(0.0, 120.0, 0.005)
    excitation = Excitation(acceleration=np.sin(drive * t), time_step=0.005)
    result, step = spectral.response(excitation, structure, 0.98, 0.006)
    late = step * np.arange(result.size) > 90.0
    amplitude = np.sqrt(2.0 * np.mean(result[late] ** 2))
    expected = abs(transfer(structure, np.asarray(0.98), np.asarray(0.006), np.asarray(1j * drive)))
    assert amplitude == pytest.approx(expected, rel=1e-3)


def test_exact_response_to_a_constant_acceleration_is_the_textbook_step_response():
    structure = Structure(frequency=0.7, damping_ratio=0.04)
    w0, xi = structure.circular_frequency, structure.damping_ratio
    excitation = Excitation(acceleration=np.full(2001, 1.5), time_step=0.01)
    blocks = cut(excitation, structure)
    t = blocks.step * np.arange(blocks.ideal.size)
    wd = w0 * np.sqrt(1 - xi**2)
    expected = -1.5 / w0**2 * (1 - np.exp(-xi * w0 * t) * (np.cos(wd * t) + xi * w0 / wd * np.sin(wd * t)))
    assert np.abs(blocks.ideal - expected).max() < 1e-12
    overshoot = 1.5 / w0**2 * (1 + np.exp(-np.pi * xi / np.sqrt(1 - xi**2)))
    assert blocks.ideal_peak == pytest.approx(overshoot, rel=1e-5)


@pytest.mark.parametrize("engine", list(Engine))
def test_perfect_actuator_has_no_error(random_excitation, engine):
    loop = Loop(
        excitation=random_excitation(1),
        structure=Structure(frequency=1.0, damping_ratio=0.02),
        engine=engine,
    )
    result = loop.deviation(loop.cells(gain=1.0, delay=0.0))
    assert result.peak[0] < 1e-7 * result.ideal_peak


def test_error_scales_with_nothing_but_the_shape_of_the_record(random_excitation):
    loop = Loop(excitation=random_excitation(2), structure=Structure(frequency=1.0, damping_ratio=0.02))
    record = loop.excitation
    louder = replace(loop, excitation=replace(record, acceleration=3.0 * record.acceleration))
    cells = loop.cells(gain=1.01, delay=0.001)
    single, three = loop.deviation(cells), louder.deviation(cells)
    assert three.mean_square[0] == pytest.approx(9.0 * single.mean_square[0], rel=1e-9)
    assert three.peak[0] / three.ideal_peak == pytest.approx(single.peak[0] / single.ideal_peak, rel=1e-9)


def test_slower_structure_under_a_slower_record_has_the_same_error(random_excitation):
    fast = Loop(
        excitation=random_excitation(6),
        structure=Structure(frequency=1.0, damping_ratio=0.03),
        engine=Engine.SPECTRAL,
    )
    record = fast.excitation
    slow = replace(
        fast,
        excitation=Excitation(acceleration=record.acceleration, time_step=2.0 * record.time_step),
        structure=replace(fast.structure, frequency=0.5),
    )
    single = fast.deviation(fast.cells(gain=0.99, delay=0.002))
    two = slow.deviation(slow.cells(gain=0.99, delay=0.004))
    assert two.mean_square[0] / two.ideal_peak**2 == pytest.approx(
        single.mean_square[0] / single.ideal_peak**2, rel=1e-4
    )
