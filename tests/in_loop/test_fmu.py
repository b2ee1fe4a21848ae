"""The FMU is compiled from its sources and run by FMPy; it stops a simulated test at its alarm."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from compiled_monitor import built, followed

from reliab.api import export_monitor
from reliab.assessment.rebuilt_error import Monitor
from reliab.effects import find_effect
from reliab.errors import InputError
from reliab.shipped import shipped
from reliab.simulation.hybrid_test import HybridTest, UpdatedModel, write_model
from reliab.structures import Structure

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed here (it comes with the extra test)")
pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler is installed here")
RATE, DELAY, XI = 256, 12, 0.02


KINDS = ("fmu", "fmu3")


def compiled_unit(kind, folder, **stated):
    """The monitor of a structure, unpacked and compiled from its sources."""
    from fmpy.build import build_platform_binary

    export_monitor((kind, folder / "monitor.fmu"), rate=RATE, **(stated or {"f": 1, "xi": XI}))
    unpacked = fmpy.extract(str(folder / "monitor.fmu"), unzipdir=str(folder / "unpacked"))
    (folder / "build").mkdir()
    build_platform_binary(unpacked, build_dir=folder / "build")
    return Path(unpacked)


@pytest.fixture(scope="module")
def units(tmp_path_factory):
    """An FMU of each version, asked for by its kind."""
    return {kind: compiled_unit(kind, tmp_path_factory.mktemp(kind)) for kind in KINDS}


@pytest.fixture
def unit(units):
    """The FMU of FMI 2.0."""
    return units["fmu"]


@pytest.mark.parametrize("kind", KINDS)
def test_the_description_is_valid_and_the_bytes_depend_on_the_structure_only(kind, tmp_path):
    from fmpy.validation import validate_fmu

    for name in ("a.fmu", "b.fmu"):
        export_monitor((kind, tmp_path / name), f=1, xi=XI, rate=RATE)
    assert validate_fmu(str(tmp_path / "a.fmu")) == []
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()


@pytest.mark.parametrize("kind", KINDS)
def test_the_unit_gives_the_error_of_python(units, kind):
    time = np.arange(8 * RATE) / RATE
    command = 0.01 * np.sin(2.0 * np.pi * 0.9 * time)  # which has no rest from which an offset is learned
    measured = 0.98 * command + 1e-6 * np.random.default_rng(1).normal(size=time.size) * (time > 0.0)
    inputs = np.rec.fromarrays([time, command, measured], names="time,command,measured")
    table = fmpy.simulate_fmu(
        str(units[kind]),
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


FOLLOWED = ("two_actuators", "model")


@pytest.fixture(scope="module")
def further(tmp_path_factory):
    """What is exported of several actuators, and of a specimen with a model."""
    folder = tmp_path_factory.mktemp("further")
    friction = find_effect("coulomb_friction")(force_n=0.05, regularisation_velocity_m_per_s=0.01)
    test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=XI), effects=(friction,))
    write_model(folder / "model.toml", UpdatedModel(name="friction", test=test))
    return {
        "two_actuators": {"structure": shipped("datasets", "frames/two_actuators.toml")},
        "model": {"model": folder / "model.toml"},
    }


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", FOLLOWED)
def test_units_of_several_actuators_and_of_models_give_the_error_of_the_sources(
    kind, what, further, tmp_path
):
    from fmpy.validation import validate_fmu

    unpacked = compiled_unit(kind, tmp_path, **further[what])
    assert validate_fmu(str(tmp_path / "monitor.fmu")) == []
    actuators = 2 if what == "two_actuators" else 1
    numbers = [f"_{k + 1}" for k in range(actuators)] if actuators > 1 else [""]
    time = np.arange(6 * RATE) / RATE
    command = 0.01 * np.sin(np.arange(1, actuators + 1)[:, np.newaxis] * 5.0 * time)
    measured = 0.98 * command + 1e-6 * np.random.default_rng(1).normal(size=command.shape) * (time > 0.0)
    names = ["time", *(f"{channel}{k}" for channel in ("command", "measured") for k in numbers)]
    inputs = np.rec.fromarrays([time, *command, *measured], names=names)
    output = [f"{name}{k}" for name in ("error", "rms", "mte") for k in numbers]
    table = fmpy.simulate_fmu(
        str(unpacked),
        stop_time=time[-1],
        output_interval=1.0 / RATE,
        input=inputs,
        output=output,
        use_event_mode=False,
    )
    (tmp_path / "c").mkdir()
    export_monitor(("c", tmp_path / "c"), rate=RATE, **further[what])
    ours = followed(built(tmp_path / "c"), command, measured)
    count = table["time"].size - 1
    assert count >= time.size - 2
    for k, number in enumerate(numbers):
        assert np.abs(table[f"error{number}"][1:] - ours.error[k, :count]).max() < 1e-12 * 0.01
        assert table[f"rms{number}"][-1] == pytest.approx(ours.rms[k, count - 1], rel=1e-12)


PLANT = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="plant" guid="plant">
  <CoSimulation modelIdentifier="plant"><SourceFiles><File name="fmi2.c"/></SourceFiles></CoSimulation>
  <ModelVariables>
    <ScalarVariable name="command" valueReference="0" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="measured" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>
"""


@pytest.fixture(scope="module")
def plant(tmp_path_factory, units):
    """An FMU of a structure with an actuator that is four times too late, by the wrapper of ours."""
    from fmpy.build import build_platform_binary

    folder = tmp_path_factory.mktemp("plant")
    (folder / "sources").mkdir()
    (folder / "modelDescription.xml").write_text(PLANT, encoding="utf-8")
    text = (Path(__file__).parent / "plant.h").read_text(encoding="utf-8")
    for mark, value in {"@DELAY@": DELAY, "@STEP@": 1.0 / RATE}.items():
        text = text.replace(mark, repr(value))
    (folder / "sources" / "unit.h").write_text(text, encoding="utf-8")
    shutil.copy(units["fmu"] / "sources" / "fmi2.c", folder / "sources")
    (folder / "build").mkdir()
    build_platform_binary(folder, build_dir=folder / "build")
    return folder


def started(folder):
    """An instance of an FMU, ready to be stepped."""
    from fmpy import read_model_description
    from fmpy.fmi2 import FMU2Slave

    description = read_model_description(str(folder))
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=description.modelName,
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave


def commands_of(plant, monitor=None, seconds=60):
    """Commands of a simulated loop until the monitor's alarm of the energy, or to the end."""
    slaves = [started(folder) for folder in (plant, monitor) if folder is not None]
    commands = []
    for k in range(seconds * RATE):
        channels = slaves[0].getReal([0, 1])
        commands.append(channels[0])
        if monitor is not None:
            slaves[1].setReal([0, 1], channels)
        for slave in slaves:
            slave.doStep(currentCommunicationPoint=k / RATE, communicationStepSize=1.0 / RATE)
        if monitor is not None and slaves[1].getInteger([6])[0] & 1:
            break
    for slave in slaves:
        slave.terminate()
        slave.freeInstance()
    return np.array(commands)


def test_a_co_simulation_of_two_units_is_stopped_at_the_alarm(unit, plant):
    stopped, unstopped = commands_of(plant, unit), commands_of(plant)
    assert stopped.size < unstopped.size
    assert np.array_equal(stopped, unstopped[: stopped.size])
    assert np.abs(stopped).max() < 0.1 * np.abs(unstopped).max()


@pytest.mark.parametrize("kind", KINDS)
def test_steps_of_another_length_are_refused(units, kind):
    with pytest.raises(Exception, match="DoStep failed"):
        fmpy.simulate_fmu(str(units[kind]), stop_time=1.0, output_interval=0.01)


def test_what_is_not_stated_is_asked_for(tmp_path):
    with pytest.raises(InputError, match="rate"):
        export_monitor(("fmu", tmp_path / "a.fmu"), f=1, xi=XI)
