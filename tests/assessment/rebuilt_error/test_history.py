"""The rebuilt history against simulations that share nothing with the product."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rebuilt_error.by_transform import respond_spectrally
from rebuilt_error.laboratory import (
    BACKLASH,
    DELAY,
    LAG,
    LEAD,
    RATE,
    RATE_LIMIT,
    SECOND_ORDER,
    STROKE,
    Lab,
    Outcome,
    run,
    synthetic_ground,
)
from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuild import rebuild
from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

STEP = 1.0 / RATE

LABS = {
    "gain and delay": Lab(1.0, 0.02, 1.0, DELAY, (0.995, 0.001, 0.0, 0.0)),
    "drifting delay": Lab(1.0, 0.02, 1.0, DELAY, (1.0, 0.0005, 3e-5, 0.0)),
    "first-order lag, share 0.6": Lab(1.0, 0.02, 0.6, LAG, (1.0, 0.002, 0.0, 0.0)),
    "rate limit": Lab(1.0, 0.02, 1.0, RATE_LIMIT, (1.0, 0.001, 0.4, 0.0)),
    "backlash": Lab(1.0, 0.02, 1.0, BACKLASH, (5e-4, 0.0, 0.0, 0.0)),
    "lead": Lab(1.0, 0.02, 1.0, LEAD, (1.0, 0.001, 0.0, 0.0)),
    "second order, share 0.4": Lab(2.0, 0.04, 0.4, SECOND_ORDER, (1.0, 400.0, 0.7, 0.0)),
    "stroke": Lab(1.0, 0.05, 1.0, STROKE, (1.0, 0.02, 0.0, 0.0)),
    "soft structure": Lab(0.3, 0.02, 1.0, DELAY, (0.998, 0.002, 0.0, 0.0)),
    "late force": Lab(1.0, 0.02, 1.0, DELAY, (1.0, 0.0005, 0.0, 0.0), feedback_lag=0.0006),
}


def structure_of(lab: Lab) -> Structure:
    return Structure(frequency=lab.f, damping_ratio=lab.xi, experimental_fraction=lab.alpha)


@pytest.fixture(scope="module", params=LABS)
def test_of(request) -> tuple[Lab, Outcome]:
    lab = LABS[request.param]
    return lab, run(lab, synthetic_ground(1, 20.0))


@pytest.mark.default_cases(3)
def test_history_and_errors_are_those_of_the_simulation(test_of):
    lab, outcome = test_of
    monitor = Monitor(structure_of(lab), STEP, feedback_lag=lab.feedback_lag)
    monitor.feed(outcome.command, outcome.measured)
    true = outcome.measured - outcome.ideal
    assert outcome.rms > 0.003
    assert np.sqrt(np.mean((monitor.error - true) ** 2) / np.mean(true**2)) < 1e-4
    assert monitor.now.rms == pytest.approx(outcome.rms, rel=1e-4)
    assert monitor.now.mte == pytest.approx(outcome.mte, rel=3e-3)


@pytest.mark.default_cases(3)
def test_error_from_the_band_of_the_motion_is_that_of_the_simulation(test_of):
    """Of all samples but the last, whose motion goes on after the record."""
    lab, outcome = test_of
    rebuilt = rebuild(
        outcome.command, outcome.measured, STEP, structure_of(lab), feedback_lag=lab.feedback_lag
    )
    true = outcome.measured - outcome.ideal
    inside = slice(0, int(true.size - 0.5 / (lab.f * STEP)))
    assert np.sqrt(np.mean((rebuilt.displacements[0].error - true)[inside] ** 2) / np.mean(true**2)) < 0.015
    assert rebuilt.rms.value == pytest.approx(outcome.rms, rel=4e-3)
    assert rebuilt.mte.value == pytest.approx(outcome.mte, rel=6e-3)
    assert rebuilt.rms.low < outcome.rms < rebuilt.rms.high
    assert rebuilt.mte.low < outcome.mte < rebuilt.mte.high


def test_unstated_lag_of_the_force_hides_an_error():
    lab = LABS["late force"]
    outcome = run(lab, synthetic_ground(1, 20.0))
    forgotten = rebuild(outcome.command, outcome.measured, STEP, structure_of(lab))
    assert forgotten.rms.value < 0.7 * outcome.rms


@pytest.mark.parametrize("mass", [0.0, 0.2])
def test_recursion_and_transform_agree(mass):
    two = Partition(
        mass=np.diag([1.0, 1.5]),
        damping=np.array([[0.3, -0.1], [-0.1, 0.1]]),
        stiffness=np.array([[200.0, -100.0], [-100.0, 100.0]]),
        interface=np.array([1.0, -1.0]),
        specimen_stiffness=50.0,
        specimen_damping=0.05,
        specimen_mass=mass,
    )
    time = np.arange(0.0, 20.0, STEP)
    difference = np.sin(8.0 * time) * np.sin(0.3 * time) ** 3
    stepped_response = respond(Recursion.from_displacement(two, STEP), difference)[0]
    transformed = respond_spectrally(two, difference, STEP)
    assert np.abs(stepped_response - transformed).max() < 1e-5 * np.abs(stepped_response).max()


def test_recursion_is_exact_for_straight_lines_between_samples():
    full_test = Partition.from_structure(
        Structure(frequency=0.8, damping_ratio=0.1, experimental_fraction=0.7)
    )
    nodes = np.random.default_rng(2).normal(size=12)
    w0 = 2.0 * np.pi * 0.8

    def slope(time, state):
        push = 0.7 * w0**2 * np.interp(time, 0.2 * np.arange(12), nodes)
        return [state[1], push - 0.2 * w0 * state[1] - w0**2 * state[0]]

    path = solve_ivp(
        slope, (0.0, 2.2), [0.0, 0.0], t_eval=0.2 * np.arange(12), max_step=0.002, rtol=1e-9, atol=1e-12
    )
    stepped_response = respond(Recursion.from_displacement(full_test, 0.2), nodes)[0]
    assert np.abs(stepped_response - path.y[0]).max() < 1e-6


def three_storeys(time_constant: float, ground):
    """Floors of a shear frame whose first storey is tested; a lag actuator; Runge–Kutta."""
    mass, spring, dashpot = 1000.0, 4.0e5, 800.0
    shape = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    numerical = spring * shape - spring * np.diag([1.0, 0.0, 0.0])
    damping = dashpot * shape + 30.0 * np.eye(3)

    def slope(state, a_g):
        x, v, m = state[:3], state[3:6], state[6]
        piston = x[0] if time_constant == 0.0 else m
        force = spring * piston
        rates = -a_g - (damping @ v + numerical @ x + np.array([force, 0.0, 0.0])) / mass
        displacement = 0.0 if time_constant == 0.0 else (x[0] - m) / time_constant
        return np.concatenate([v, rates, [displacement]])

    state, rows = np.zeros(7), [np.zeros(7)]
    for a, b in pairwise(ground):
        k1 = slope(state, a)
        k2 = slope(state + 0.5 * STEP * k1, 0.5 * (a + b))
        k3 = slope(state + 0.5 * STEP * k2, 0.5 * (a + b))
        k4 = slope(state + STEP * k3, b)
        state = state + STEP / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        rows.append(state)
    full_test = Partition(
        mass=mass * np.eye(3),
        damping=damping,
        stiffness=spring * shape,
        interface=np.array([1.0, 0.0, 0.0]),
        specimen_stiffness=spring,
    )
    return np.array(rows).T, full_test


@pytest.mark.slow
def test_one_tested_storey_of_three():
    ground = synthetic_ground(3, 8.0)
    tested_frame, full_test = three_storeys(0.003, ground)
    ideal, _ = three_storeys(0.0, ground)
    monitor = Monitor(full_test, STEP)
    monitor.feed(tested_frame[0], tested_frame[6])
    true = tested_frame[6] - ideal[0]
    assert np.sqrt(np.mean((monitor.error - true) ** 2) / np.mean(true**2)) < 1e-4


def test_constant_wrong_force_bends_the_structure_by_its_stiffness():
    two = Partition(
        mass=np.diag([1.0, 1.5]),
        damping=np.array([[12.0, -4.0], [-4.0, 6.0]]),
        stiffness=np.array([[200.0, -100.0], [-100.0, 100.0]]),
        interface=np.array([1.0, -1.0]),
        specimen_stiffness=50.0,
    )
    still = respond(Recursion.from_force(two, 0.05), np.full(2000, 3.0))[..., -1]
    bent = np.linalg.solve(two.stiffness, 3.0 * two.interface)
    np.testing.assert_allclose(still, two.interface.T @ bent[:, 0], rtol=1e-6, atol=1e-12)
