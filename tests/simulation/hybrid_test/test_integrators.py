"""Integrators of the numerical substructure against solutions written out here."""

import numpy as np
import pytest
import scipy

from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.integrators import ExactIntegrator, LinearSubstructure
from reliab.structures.structure import Structure


def record(step, duration=20.0):
    t = np.arange(0.0, duration + step / 2, step)
    return np.sin(2 * np.pi * 0.8 * t) * np.exp(-(((t - 6.0) / 3.0) ** 2))


def test_the_exact_scheme_ends_each_step_in_equilibrium_on_the_exact_motion():
    """A ramp r(t) = qt/step from rest, against the solution of the ordinary differential equation."""
    substructure, step, load = LinearSubstructure(damping=3.0, stiffness=400.0), 0.02, 5.0
    motion, exact = np.zeros(3), ExactIntegrator()
    coefficients = exact.coefficients(substructure, step)
    exact.kernel(motion, 0.0, load, coefficients, np.zeros(0))
    exact.kernel(motion, load, 2.0 * load, coefficients, np.zeros(0))

    def slope(t, state):
        return [state[1], load * t / step - 3.0 * state[1] - 400.0 * state[0]]

    solution = scipy.integrate.solve_ivp(slope, (0.0, 2.0 * step), [0.0, 0.0], rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(motion[:2], solution.y[:, -1], rtol=1e-9)
    assert motion[2] == pytest.approx(2.0 * load - 3.0 * motion[1] - 400.0 * motion[0], rel=1e-12)


def march(structure, ground, step, gamma):
    """Displacement at the controller's instants, the whole spring being in the rig; Euler without a γ."""
    omega = structure.circular_frequency
    damping, x, v, path = 2.0 * structure.damping_ratio * omega, 0.0, 0.0, [0.0]
    acceleration = -ground[0]
    for shaken in ground[1:]:
        if gamma is None:
            x, v = x + step * v, v + step * acceleration
            acceleration = -shaken - damping * v - omega**2 * x
        else:
            x += step * v + 0.5 * step**2 * acceleration
            remainder = -shaken - omega**2 * x - damping * (v + step * (1.0 - gamma) * acceleration)
            later = remainder / (1.0 + step * gamma * damping)
            v += step * ((1.0 - gamma) * acceleration + gamma * later)
            acceleration = later
        path.append(x)
    return np.array(path)


@pytest.mark.parametrize(("gamma", "shift"), [(0.5, 0.0), (0.9, 0.4), (None, -1.0)])
@pytest.mark.parametrize("fine", [1, 4])
def test_integration_error_is_its_scheme_at_the_controllers_instants(gamma, shift, fine):
    structure, coarse = Structure(frequency=1.0, damping_ratio=0.05), 0.016
    ground, step = record(coarse), coarse / fine
    damping = 0.5 * structure.circular_frequency * shift * coarse
    effect = find_effect("integration_error")(numerical_damping_ratio=damping, step_s=coarse)
    play_output = np.interp(np.arange((ground.size - 1) * fine + 1) / fine, np.arange(ground.size), ground)
    result = run_closed_loop(HybridTest(structure=structure, effects=(effect,)), play_output, step)
    target = march(structure, ground, coarse, gamma)
    assert np.allclose(result.command.values[0, ::fine], target, atol=1e-9 * np.abs(target).max())
