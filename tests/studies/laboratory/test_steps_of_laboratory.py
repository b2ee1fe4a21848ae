"""Steps of the simulated laboratory against the methods that they are named after, written out."""

import numpy as np
import pytest
from reliab_studies.laboratory.laboratory import _runge_kutta_step

from reliab.simulation.transfer_systems.transfer_function import ServoHydraulic


@pytest.mark.parametrize("step", [0.3, 0.01])
def test_matrices_of_a_step_are_the_classical_runge_kutta_method(step):
    random = np.random.default_rng(3)
    dynamics, loads = random.normal(size=(4, 4)), random.normal(size=(4, 2))
    state, begin, middle, end = random.normal(size=4), *random.normal(size=(3, 2))

    def rate(y, load):
        return dynamics @ y + loads @ load

    k1 = rate(state, begin)
    k2 = rate(state + 0.5 * step * k1, middle)
    k3 = rate(state + 0.5 * step * k2, middle)
    k4 = rate(state + step * k3, end)
    reference = state + step * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    transition, begin_matrix, middle_matrix, end_matrix = _runge_kutta_step(dynamics, loads, step)
    outcome = transition @ state + begin_matrix @ begin + middle_matrix @ middle + end_matrix @ end
    np.testing.assert_allclose(outcome, reference, rtol=1e-12)


def test_each_deviation_reaches_its_own_constant_of_the_actuator():
    nominal = ServoHydraulic(leakage=3.0, valve_damping=400.0, valve_stiffness=9e4)
    outcome = nominal.perturb(np.array([0.5, -30.0, 2e3]))
    assert (outcome.leakage, outcome.valve_damping, outcome.valve_stiffness) == (3.5, 370.0, 9.2e4)
    assert (outcome.input_gain, outcome.valve_gain) == (nominal.input_gain, nominal.valve_gain)
