"""Convolutions, bins and delays of histories, against closed forms."""

from itertools import pairwise
from math import factorial

import numpy as np
import pytest
import scipy

from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.assessment.rebuilt_error.size import (
    LARGEST_DRAW_SIZE,
    require_fitting,
    samples_in_step_of_structure,
)
from reliab.assessment.recorded_force import SmoothingKernel
from reliab.core.errors import InputError
from reliab.signals.spectra import analyse, average_over_bins, synthesise
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure


@pytest.mark.parametrize("size", [64, 97, 130])
@pytest.mark.parametrize("hop", [2, 16, 30])
def test_a_lapped_transform_is_undone_and_keeps_inner_products(size, hop):
    first, second = np.random.default_rng(size + hop).standard_normal((2, size))
    assert synthesise(np.stack([analyse(first, hop), analyse(second, hop)]), size) == pytest.approx(
        np.stack([first, second])
    )
    # an orthonormal basis: what stands for histories that begin and end at rest has their inner products
    inner = slice(hop + 1, size - 2 * hop)
    still = np.zeros((2, size))
    still[:, inner] = np.stack([first, second])[:, inner]
    coefficients = analyse(still[0], hop), analyse(still[1], hop)
    assert np.vdot(*coefficients) == pytest.approx(still[0] @ still[1])


@pytest.mark.parametrize("size", [17, 20, 31, 40])
def test_beyond_its_ends_a_history_is_continued_about_them_and_then_stands_still(size):
    """A history that holds its continuation has the same coefficients as long as it lasts."""
    hop, end = 16, -1.5
    history = np.append(np.random.default_rng(size).standard_normal(size - 1), end)
    continued = np.concatenate([history, 2.0 * end - history[-2::-1], np.full(3 * hop, end)])
    coefficients = analyse(history, hop)
    assert coefficients == pytest.approx(analyse(continued, hop)[: len(coefficients)])


def test_a_coefficient_stands_at_its_frequency():
    hop, step = 32, 0.01
    for k in (3, 10, 25):
        frequency = (k + 0.5) / (2.0 * hop * step)
        powers = analyse(np.sin(2.0 * np.pi * frequency * step * np.arange(640)), hop)[2:-3] ** 2
        assert int(np.argmax(powers.sum(axis=0))) == k


@pytest.mark.parametrize("ahead", [50, 64])
def test_a_history_is_continued_point_symmetrically(ahead):
    """A straight line goes on beyond both ends: its frames at the ends have the slope's coefficients."""
    line = 3.0 + 0.5 * np.arange(float(ahead))
    longer = 3.0 + 0.5 * np.arange(-32.0, ahead + 32.0)
    assert analyse(line, 16)[0] == pytest.approx(analyse(longer, 16)[2])


def test_bins_are_equally_wide_on_a_logarithmic_axis():
    frequency = np.arange(1.0, 201.0)
    power = np.random.default_rng(1).exponential(size=200)
    centre, mean, count = average_over_bins(frequency, power, 12)
    edges = np.exp(np.linspace(np.log(0.999), np.log(200.2), 13))
    members = [(frequency >= low) & (frequency < high) for low, high in pairwise(edges)]
    members = [member for member in members if member.any()]
    assert centre == pytest.approx([frequency[member].mean() for member in members])
    assert mean == pytest.approx([power[member].mean() for member in members])
    assert count.tolist() == [member.sum() for member in members]


@pytest.mark.parametrize("lag", [0.02, 0.05, 0.1, 0.13, 0.31])
def test_a_delay_is_exact_for_cubics_and_constant_before_the_first_sample(lag):
    step = 0.05
    time = step * np.arange(40)
    values = 1.0 - 2.0 * time + 3.0 * time**2 - 0.7 * time**3
    late = delay_history(values, lag, step)
    past = int(np.ceil(lag / step)) + 3
    position = time - lag
    assert late[past:] == pytest.approx((1.0 - 2.0 * position + 3.0 * position**2 - 0.7 * position**3)[past:])
    assert late[0] == pytest.approx(1.0)
    full_test = delay_history(values, 3 * step, step)
    assert full_test[3:] == pytest.approx(values[:-3])
    assert full_test[:3] == pytest.approx(np.full(3, 1.0))


@pytest.mark.parametrize("lag", [-1e-3, np.inf, np.nan])
def test_a_lag_is_finite_and_not_negative(lag):
    with pytest.raises(InputError, match="lag"):
        delay_history(np.zeros(5), lag, 0.01)


@pytest.mark.parametrize(("frequency", "step"), [(1.0, 0.005), (2.5, 0.001)])
def test_a_kernel_gives_the_derivatives_of_polynomials(frequency, step):
    """By parts, ∫φ''(t − s) s² ds = 2∫φ; ∫(1 − u²)⁶ du over (−1, 1) is 2¹³(6!)²/13!."""
    kernel = SmoothingKernel.from_frequency(frequency, step)
    mass = 2.0**13 * factorial(6) ** 2 / factorial(13)
    reach = kernel.values[0].size // 2
    assert reach * step == pytest.approx(0.5 / frequency)
    assert kernel.every == int(1.0 / (24.0 * frequency * step))
    time = step * np.arange(6 * reach)
    smooth_values = time[reach:-reach][:: kernel.every]
    assert kernel.smooth_derivative(np.full(time.size, 3.0), 0) == pytest.approx(
        np.full(smooth_values.size, 3.0 * mass)
    )
    assert kernel.smooth_derivative(2.0 * time, 1) == pytest.approx(
        np.full(smooth_values.size, 2.0 * mass), rel=1e-6
    )
    assert kernel.smooth_derivative(time**2, 2) == pytest.approx(
        np.full(smooth_values.size, 2.0 * mass), rel=1e-4
    )
    assert kernel.smooth_derivative(time, 0) == pytest.approx(mass * smooth_values)
    assert kernel.smooth_derivative(time, 2) == pytest.approx(np.zeros(smooth_values.size), abs=1e-6 / step)


def test_a_kernel_reaches_eight_samples_at_least():
    assert SmoothingKernel.from_frequency(10.0, 0.01).values[0].size == 17
    assert SmoothingKernel.from_frequency(10.0, 0.01).every == 1


def test_the_highest_mode_is_swept_at_64_samples_a_period():
    full_test = Partition(
        mass=np.eye(2),
        damping=np.zeros((2, 2)),
        stiffness=np.diag([(2.0 * np.pi) ** 2, (8.0 * np.pi) ** 2]),
        interface=np.ones(2),
        specimen_stiffness=1.0,
    )
    assert samples_in_step_of_structure(full_test, 1.0 / 1280.0) == 5
    assert samples_in_step_of_structure(full_test, 1.0 / 1279.0) == 4
    assert (
        samples_in_step_of_structure(
            Partition.from_structure(Structure(frequency=4.0, damping_ratio=0.1)), 0.1
        )
        == 1
    )


def test_a_test_fits_up_to_the_last_sample():
    require_fitting(3 * LARGEST_DRAW_SIZE, 3, 0.01)
    with pytest.raises(InputError, match=r"8\.33 h.*at 1,000,000 samples.*found 8\.33 h"):
        require_fitting(3 * LARGEST_DRAW_SIZE + 1, 3, 0.01)


def test_a_kernel_takes_a_sine_to_its_derivatives():
    """A sine comes out smaller by the kernel's own transform, and its derivatives by ω each."""
    kernel = SmoothingKernel.from_frequency(1.0, 0.002)
    omega = 2.0 * np.pi * 0.8
    time = 0.002 * np.arange(4000)
    reach = kernel.values[0].size // 2
    place = 0.002 * np.arange(-reach, reach + 1)
    gain = scipy.integrate.quad(lambda u: (1.0 - u * u) ** 6 * np.cos(omega * u * reach * 0.002), -1.0, 1.0)[
        0
    ]
    assert kernel.values[0] @ np.cos(omega * place) == pytest.approx(gain, rel=1e-6)
    middle = time[reach:-reach][:: kernel.every]
    for order, expected in enumerate(
        (np.sin(omega * middle), omega * np.cos(omega * middle), -(omega**2) * np.sin(omega * middle))
    ):
        assert kernel.smooth_derivative(np.sin(omega * time), order) == pytest.approx(
            gain * expected, abs=1e-5 * gain * omega**order
        )
