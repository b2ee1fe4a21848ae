"""The error of a frame whose specimen yields, against an integration of both frames' equations of motion."""

import numpy as np
import pytest
import scipy

from reliab.assessment.rebuild import rebuild
from reliab.assessment.turning import errors_of_ductilities
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition

STEP = 1.0 / 256.0
TIME = STEP * np.arange(round(8.0 / STEP))
INTERFACE, INFLUENCE, GAIN = np.array([1.0, 0.0]), np.ones(2), 0.95
STIFFNESS, DAMPING, YIELD, HARDENING, SHARPNESS = 120.0, 0.9, 0.004, 0.03, 8.0
FRAME = Partition(
    mass=np.eye(2),
    damping=np.array([[1.6, -0.6], [-0.6, 0.6]]),
    stiffness=np.array([[250.0, -100.0], [-100.0, 100.0]]),
    interface=INTERFACE,
    specimen_stiffness=STIFFNESS,
    specimen_damping=DAMPING,
)


def shaken(time):
    return np.sin(np.pi * time / 8.0) ** 2 * (np.sin(5.0 * time) + 0.6 * np.sin(17.0 * time + 1.0))


def displacement(gain):
    """Displacement of the interface with an actuator of a gain, by a general integrator [m]."""
    numerical_damping = FRAME.damping - DAMPING * np.outer(INTERFACE, INTERFACE)
    numerical_stiffness = FRAME.stiffness - STIFFNESS * np.outer(INTERFACE, INTERFACE)

    def slope(time, state):
        x, v, z = state[:2], state[2:4], state[4]
        displacement, rate = gain * x[0], gain * v[0]
        force = STIFFNESS * (HARDENING * displacement + (1.0 - HARDENING) * YIELD * z) + DAMPING * rate
        loads = (
            -INFLUENCE * shaken(time) - numerical_damping @ v - numerical_stiffness @ x - INTERFACE * force
        )
        loading = 0.5 * np.sign(rate * z) + 0.5
        return np.concatenate([v, loads, [rate / YIELD * (1.0 - abs(z) ** SHARPNESS * loading)]])

    solution = scipy.integrate.solve_ivp(
        slope, (0.0, TIME[-1]), np.zeros(5), "LSODA", TIME, rtol=1e-6, atol=1e-8, max_step=2.0 * STEP
    )
    return solution.y[0]


@pytest.fixture(scope="module")
def command():
    return displacement(GAIN)


@pytest.fixture(scope="module")
def rebuilt(command):
    return rebuild(command, GAIN * command, STEP, FRAME, draws=256)


def test_error_of_a_yielding_frame_equals_its_integration(command, rebuilt):
    exact = displacement(1.0)
    error, peak = GAIN * command - exact, np.abs(exact).max()
    ductility = GAIN * float(np.abs(command).max()) / YIELD
    assert ductility > 2.0
    rms = errors_of_ductilities(rebuilt, Metric.RMS, (ductility,))[ductility]
    assert rms == pytest.approx(np.sqrt(np.mean(error**2)) / peak, rel=0.01)
    mte = errors_of_ductilities(rebuilt, Metric.MTE, (ductility,))[ductility]
    assert mte == pytest.approx(np.abs(error).max() / peak, rel=0.02)
    assert rebuilt.rms.value != pytest.approx(rms, rel=0.2)


def test_hardly_yielding_specimen_has_the_error_of_a_linear_one(rebuilt):
    assert errors_of_ductilities(rebuilt, Metric.RMS, (0.1,))[0.1] == pytest.approx(
        rebuilt.rms.value, rel=2e-3
    )
