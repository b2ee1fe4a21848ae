"""Structures with several actuators under a ground motion, against other engines and the definition."""

import numpy as np
import pytest
from coupled_structures import coupled_response, described, node, two_storeys

from reliab.core.errors import InputError
from reliab.simulation.engine import Engine
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_loop import FrameLoop, stable_with
from reliab.simulation.transfer_systems.transfer_function import (
    ActuatorMatrix,
    TransferFunction,
    gain_and_delay,
)
from reliab.structures.critical_delay import stability_limit
from reliab.structures.partition import Partition

STEP = 0.01


def ground(seed=3, seconds=12.0):
    time = np.arange(0.0, seconds, STEP)
    rng = np.random.default_rng(seed)
    rough = np.convolve(rng.standard_normal(time.size), np.ones(9) / 9.0, mode="same")
    return rough * np.exp(-(((time - 4.0) / 3.0) ** 2))


def loop_of(partition, kinematics, actuator=None):
    excitation = Excitation(acceleration=ground(), time_step=STEP)
    return FrameLoop(excitation=excitation, partition=partition, kinematics=kinematics, actuator=actuator)


def errors(deviation):
    return np.stack([np.sqrt(deviation.mean_square), deviation.peak]) / deviation.ideal_peak


@pytest.mark.parametrize("actuator", [None, 0, 1])
def test_gains_stray_as_exact_steps_have_it(actuator):
    partition, actuators = described(node if actuator is None else two_storeys)
    loop = loop_of(partition, actuators.kinematics, actuator)
    fine = np.interp(np.arange(0.0, 11.99, STEP / 10.0), np.arange(ground().size) * STEP, ground())
    size = partition.degrees

    def entry(i):
        gain = 1.03 if actuator in {None, i} else 1.0
        return TransferFunction(numerator=(gain,), denominator=(1.0,))

    wrong = ActuatorMatrix(
        kinematics=actuators.kinematics,
        transfer=tuple(tuple(entry(i) if i == j else None for j in range(size)) for i in range(size)),
    )
    run = coupled_response(partition, wrong, fine, STEP / 10.0)
    deviation, peaks = run.measured - run.reference, np.abs(run.reference).max(axis=1)
    rms = (np.sqrt(np.mean(deviation**2, axis=1)) / peaks)[loop.is_output].max()
    peak = (np.abs(deviation).max(axis=1) / peaks)[loop.is_output].max()
    np.testing.assert_allclose(
        errors(loop.deviation(loop.cells(gain=1.03, delay=0.0)))[:, 0], [rms, peak], rtol=2e-3
    )


def test_a_delay_of_one_actuator_strays_as_exact_steps_of_a_rational_one_have_it():
    partition, actuators = described(two_storeys)
    loop, delay = loop_of(partition, actuators.kinematics, 1), 0.004
    fine = np.interp(np.arange(0.0, 11.99, STEP / 10.0), np.arange(ground().size) * STEP, ground())
    half = delay**2 / 12.0
    late = TransferFunction(numerator=(half, -delay / 2.0, 1.0), denominator=(half, delay / 2.0, 1.0))
    wrong = ActuatorMatrix(kinematics=actuators.kinematics, transfer=((gain_and_delay(), None), (None, late)))
    run = coupled_response(partition, wrong, fine, STEP / 10.0)
    deviation, peaks = run.measured - run.reference, np.abs(run.reference).max(axis=1)
    rms = (np.sqrt(np.mean(deviation**2, axis=1)) / peaks)[loop.is_output].max()
    rms_of_delay = errors(loop.deviation(loop.cells(gain=1.0, delay=delay)))[0, 0]
    assert rms_of_delay == pytest.approx(rms, rel=2e-3)


def test_a_diverging_test_is_infinitely_wrong():
    partition, actuators = described(two_storeys)
    loop, limit = loop_of(partition, actuators.kinematics), stability_limit(partition).delay
    deviation = errors(loop.deviation(loop.cells(gain=1.0, delay=[0.5 * limit, 30.0 * limit])))
    assert np.isfinite(deviation[:, 0]).all()
    assert np.isinf(deviation[:, 1]).all()
    late = [[gain_and_delay(delay=30.0 * limit) if i == j else None for j in range(2)] for i in range(2)]
    rig = ActuatorMatrix(kinematics=actuators.kinematics, transfer=tuple(map(tuple, late)))
    assert not stable_with(partition, rig)


def test_two_like_structures_side_by_side_err_as_one_does():
    w0 = 2.0 * np.pi * 1.3

    def partition(count, damping):
        return Partition(
            mass=np.eye(count),
            damping=damping * w0 * np.eye(count),
            stiffness=w0**2 * np.eye(count),
            interface=np.eye(count),
            specimen_stiffness=0.6 * w0**2 * np.eye(count),
        )

    options = {"gain": [1.02, 0.99], "delay": [0.003, -0.004]}
    both = {}
    for count in (1, 2):
        excitation = Excitation(acceleration=ground(), time_step=STEP)
        loop = FrameLoop(excitation=excitation, partition=partition(count, 0.08), engine=Engine.SPECTRAL)
        both[count] = errors(loop.deviation(loop.cells(**options)))
    np.testing.assert_allclose(both[2], both[1], rtol=1e-9)


def test_nearly_still_displacement_is_not_judged():
    partition = Partition(
        mass=np.eye(2),
        damping=0.2 * np.eye(2),
        stiffness=40.0 * np.eye(2),
        interface=np.eye(2),
        specimen_stiffness=40.0 * np.eye(2),
        influence=[1.0, 1e-4],
    )
    assert loop_of(partition, np.eye(2)).is_output.tolist() == [True, False]


def test_gains_must_be_positive():
    partition, actuators = described(two_storeys)
    loop = loop_of(partition, actuators.kinematics)
    with pytest.raises(InputError, match="positive and finite"):
        loop.cells(gain=[1.0, -0.5], delay=0.0)


def test_a_rig_is_stable_up_to_the_critical_delay_of_all_its_actuators():
    partition, actuators = described(two_storeys)
    limit = stability_limit(partition).delay

    def rig(delay):
        late = [[gain_and_delay(delay=delay) if i == j else None for j in range(2)] for i in range(2)]
        return ActuatorMatrix(kinematics=actuators.kinematics, transfer=tuple(map(tuple, late)))

    assert stable_with(partition, rig(0.999 * limit))
    assert not stable_with(partition, rig(1.001 * limit))
