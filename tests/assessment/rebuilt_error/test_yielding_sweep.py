"""The error of frames whose specimens yield, against an integration of the equations of motion."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from reliab.assessment.rebuild import rebuild
from reliab.assessment.rebuilt_error.yielding_sweep import errors_with_specimens, yielding_specimen
from reliab.assessment.turning import errors_with, yielded
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


def displacements(frame, yields, gains):
    """Interface displacements with actuators of some gains, by a general integrator [m], shape (p, n)."""
    interface = frame.interface
    numerical_damping = frame.damping - interface @ frame.specimen_damping @ interface.T
    numerical_stiffness = frame.stiffness - interface @ frame.specimen_stiffness @ interface.T

    def slope(time, state):
        x, v, z = state[:2], state[2:4], state[4:]
        displacement, rate = gains * (interface.T @ x), gains * (interface.T @ v)
        elastic = HARDENING * displacement + (1.0 - HARDENING) * yields * z
        force = frame.specimen_stiffness @ elastic + frame.specimen_damping @ rate
        loads = (
            -INFLUENCE * shaken(time) - numerical_damping @ v - numerical_stiffness @ x - interface @ force
        )
        loading = 0.5 * np.sign(rate * z) + 0.5
        return np.concatenate([v, loads, rate / yields * (1.0 - np.abs(z) ** SHARPNESS * loading)])

    begin = np.zeros(4 + yields.size)
    solution = scipy.integrate.solve_ivp(
        slope, (0.0, TIME[-1]), begin, "LSODA", TIME, rtol=1e-6, atol=1e-8, max_step=2.0 * STEP
    )
    return interface.T @ solution.y[:2]


def displacement(gain):
    """Displacement of the one interface [m]."""
    return displacements(FRAME, np.array([YIELD]), np.array([gain]))[0]


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
    rms = errors_with(rebuilt, Metric.RMS, yielded, (ductility,))[ductility]
    assert rms == pytest.approx(np.sqrt(np.mean(error**2)) / peak, rel=0.01)
    mte = errors_with(rebuilt, Metric.MTE, yielded, (ductility,))[ductility]
    assert mte == pytest.approx(np.abs(error).max() / peak, rel=0.02)
    assert rebuilt.rms.value != pytest.approx(rms, rel=0.2)


def test_hardly_yielding_specimen_has_the_error_of_a_linear_one(rebuilt):
    assert errors_with(rebuilt, Metric.RMS, yielded, (0.1,))[0.1] == pytest.approx(
        rebuilt.rms.value, rel=2e-3
    )


def test_error_of_several_yielding_displacements_equals_their_integration():
    """Each loses a displacement of its own, and the stiffness of the specimen couples them."""
    both = replace(
        FRAME,
        interface=np.eye(2),
        specimen_stiffness=np.array([[120.0, -30.0], [-30.0, 60.0]]),
        specimen_damping=np.diag([0.5, 0.2]),
        specimen_mass=np.zeros((2, 2)),
        names=(),
    )
    yields, gains = np.array([0.004, 0.007]), np.array([0.95, 1.02])
    command, exact = displacements(both, yields, gains), displacements(both, yields, np.ones(2))
    measured = gains[:, np.newaxis] * command
    error, peaks = measured - exact, np.abs(exact).max(axis=1)
    assert (np.abs(measured).max(axis=1) > 2.0 * yields).all()
    result = rebuild(command, measured, STEP, both, draws=32)
    specimen = [yielding_specimen(size, HARDENING, SHARPNESS) for size in yields]
    (found,) = errors_with_specimens([specimen], result.histories, both)
    rms = np.sqrt(np.mean(error**2, axis=1)) / peaks
    np.testing.assert_allclose(np.sqrt(found[:, 0]) / found[:, 2], rms, rtol=0.02)
    np.testing.assert_allclose(found[:, 1] / found[:, 2], np.abs(error).max(axis=1) / peaks, rtol=0.03)
    linear = np.array([degree.rms.value for degree in result.displacements])
    assert (np.abs(linear / rms - 1.0) > 0.2).any()
