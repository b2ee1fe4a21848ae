"""Errors over windows that begin and end anywhere, against histories stepped by the definition."""

import numpy as np
import pytest

from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper, pole_recursion
from reliab.structures.structure import Structure

TIME = np.arange(0.0, 12.0, 0.01)
END_IN_STRONG_MOTION = np.random.default_rng(1).standard_normal(TIME.size) * TIME
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)


def by_poles(blocks, late):
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
        found = delay_stepper.deviation(blocks, STRUCTURE, gain, delay)
        measured = delay_stepper.response(blocks, STRUCTURE, gain[0], delay[0])[1]
    else:
        (late,) = cells.recursions(blocks.step)
        alone = kernel == "poles"
        found = pole_recursion.deviation(blocks, late.coefficients) if alone else loop.deviation(cells)
        measured = by_poles(blocks, late)
    inside = (measured - blocks.ideal)[blocks.before :]
    inside[-1] = inside[-2] + blocks.end * (inside[-1] - inside[-2])
    peak = np.abs(inside).max()
    assert (
        peak * (1.0 - 1e-5) <= found.peak[0] <= peak * 1.02
    )  # a parabola through three samples rises above them
    squares = np.trapezoid(inside[:-1] ** 2) + 0.5 * blocks.end * (inside[-2] ** 2 + inside[-1] ** 2)
    assert found.mean_square[0] == pytest.approx(squares / blocks.intervals, rel=1e-5)
