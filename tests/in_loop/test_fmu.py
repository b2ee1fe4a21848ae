"""The FMU is compiled from its sources and run by FMPy; it stops a simulated test at its alarm."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from reliab.api import export_monitor
from reliab.assessment.rebuilt_error import Monitor
from reliab.errors import InputError
from reliab.structures import Structure

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed here (it comes with the extra test)")
pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler is installed here")
RATE, DELAY, W0, XI = 256, 12, 2.0 * np.pi, 0.02


@pytest.fixture(scope="module")
def unit(tmp_path_factory):
    """The monitor of a structure, unpacked and compiled from its sources."""
    from fmpy.build import build_platform_binary

    folder = tmp_path_factory.mktemp("fmu")
    export_monitor(("fmu", folder / "monitor.fmu"), f=1, xi=XI, rate=RATE)
    unpacked = fmpy.extract(str(folder / "monitor.fmu"), unzipdir=str(folder / "unpacked"))
    (folder / "build").mkdir()
    build_platform_binary(unpacked, build_dir=folder / "build")
    return Path(unpacked)


def test_the_description_is_valid_and_the_bytes_depend_on_the_structure_only(tmp_path):
    from fmpy.validation import validate_fmu

    for name in ("a.fmu", "b.fmu"):
        export_monitor(("fmu", tmp_path / name), f=1, xi=XI, rate=RATE)
    assert validate_fmu(str(tmp_path / "a.fmu")) == []
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()


def test_the_unit_gives_the_error_of_python(unit):
    time = np.arange(8 * RATE) / RATE
    command = 0.01 * np.sin(2.0 * np.pi * 0.9 * time)  # which has no rest from which an offset is learned
    measured = 0.98 * command + 1e-6 * np.random.default_rng(1).normal(size=time.size) * (time > 0.0)
    inputs = np.rec.fromarrays([time, command, measured], names="time,command,measured")
    table = fmpy.simulate_fmu(
        str(unit),
        stop_time=time[-1],
        output_interval=1.0 / RATE,
        input=inputs,
        output=["error", "rms", "status"],
        use_event_mode=False,
    )
    monitor = Monitor(Structure(frequency=1.0, damping_ratio=XI), 1.0 / RATE, sensor_offset=0.0)
    monitor.feed(command, measured)
    count = table["error"].size - 1
    assert count >= time.size - 2
    assert np.abs(table["error"][1:] - monitor.error[:count]).max() < 1e-12 * 0.01


def test_a_simulated_loop_is_stopped_at_the_alarm(unit):
    """A structure with an actuator that is four times too late, stepped beside the unit."""
    from fmpy import read_model_description
    from fmpy.fmi2 import FMU2Slave

    description = read_model_description(str(unit))
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=str(unit),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="monitor",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    states, alarm = loop(), None
    history = []
    for k, (command, measured) in zip(range(60 * RATE), states, strict=False):
        history.append(command)
        slave.setReal([0, 1], [command, measured])
        slave.doStep(currentCommunicationPoint=k / RATE, communicationStepSize=1.0 / RATE)
        if slave.getInteger([6])[0] & 1:
            alarm = k
            break
    slave.terminate()
    slave.freeInstance()
    assert alarm is not None
    unstopped = [command for _, (command, _) in zip(range(60 * RATE), loop(), strict=False)]
    assert np.abs(history).max() < 0.1 * np.abs(unstopped).max()


def loop():
    """Command and measured displacement of a loop that shares no code with ours, step by step."""
    x = v = 0.0
    past = [0.0] * (DELAY + 1)
    shaken = np.random.default_rng(9)
    while True:
        measured = past[-1 - DELAY]
        yield x, measured
        acceleration = -shaken.normal() - 2.0 * XI * W0 * v - W0**2 * measured
        v += acceleration / RATE
        x += v / RATE
        past.append(x)


def test_steps_of_another_length_are_refused(unit):
    with pytest.raises(Exception, match="fmi2DoStep failed"):
        fmpy.simulate_fmu(str(unit), stop_time=1.0, output_interval=0.01)


def test_what_is_not_stated_is_asked_for(tmp_path):
    with pytest.raises(InputError, match="rate"):
        export_monitor(("fmu", tmp_path / "a.fmu"), f=1, xi=XI)
