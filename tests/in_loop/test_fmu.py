"""The FMU is compiled from its sources and run by FMPy; it stops a simulated test at its alarm."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from compiled_monitor import UNSTABLE, build, follow

from reliab.app.api.monitor import export_monitor
from reliab.assessment.monitor import Monitor
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel, write_model
from reliab.structures.structure import Structure

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed here (it comes with the extra test)")
pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler is installed here")
RATE, DELAY, XI = 256, 12, 0.02


KINDS = ("fmu", "fmu3")


def compile_unit(kind, folder, **declared_values):
    """The monitor of a structure, unpacked and compiled from its sources."""
    from fmpy.build import build_platform_binary

    export_monitor((kind, folder / "monitor.fmu"), rate=RATE, **(declared_values or {"f": 1, "xi": XI}))
    content = fmpy.extract(str(folder / "monitor.fmu"), unzipdir=str(folder / "unpacked"))
    (folder / "build").mkdir()
    build_platform_binary(content, build_dir=folder / "build")
    return Path(content)


@pytest.fixture(scope="module")
def units(tmp_path_factory):
    """An FMU of each version, compiled when its kind is first asked for."""

    class Units(dict):
        def __missing__(self, kind):
            self[kind] = compile_unit(kind, tmp_path_factory.mktemp(kind))
            return self[kind]

    return Units()


@pytest.mark.parametrize("kind", KINDS)
def test_the_description_is_valid_and_the_bytes_depend_on_the_structure_only(kind, tmp_path):
    from fmpy.validation import validate_fmu

    for name in ("a.fmu", "b.fmu"):
        export_monitor((kind, tmp_path / name), f=1, xi=XI, rate=RATE)
    assert validate_fmu(str(tmp_path / "a.fmu")) == []
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("kind", KINDS)
def test_the_unit_gives_the_error_of_python(units, kind):
    time = np.arange(8 * RATE) / RATE
    command = 0.01 * np.sin(2.0 * np.pi * 0.9 * time)  # which has no rest from which an offset is learned
    reading = 0.98 * command + 1e-6 * np.random.default_rng(1).normal(size=time.size) * (time > 0.0)
    inputs = np.rec.fromarrays([time, command, reading], names="time,command,measured")
    table = fmpy.simulate_fmu(
        str(units[kind]),
        stop_time=time[-1],
        output_interval=1.0 / RATE,
        input=inputs,
        output=["error", "rms", "status"],
        use_event_mode=False,
    )
    monitor = Monitor(Structure(frequency=1.0, damping_ratio=XI), 1.0 / RATE, sensor_offset=0.0)
    monitor.feed(command, reading)
    count = table["error"].size - 1
    assert count >= time.size - 2
    assert np.abs(table["error"][1:] - monitor.error[:count]).max() < 1e-12 * 0.01


UNIT_KINDS = ("two_actuators", "model")


@pytest.fixture(scope="module")
def exported_units(tmp_path_factory):
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
@pytest.mark.parametrize("label", UNIT_KINDS)
def test_units_of_several_actuators_and_of_models_give_the_error_of_the_sources(
    kind, label, exported_units, tmp_path
):
    from fmpy.validation import validate_fmu

    content = compile_unit(kind, tmp_path, **exported_units[label])
    assert validate_fmu(str(tmp_path / "monitor.fmu")) == []
    actuators = 2 if label == "two_actuators" else 1
    numbers = [f"_{k + 1}" for k in range(actuators)] if actuators > 1 else [""]
    time = np.arange(6 * RATE) / RATE
    command = 0.01 * np.sin(np.arange(1, actuators + 1)[:, np.newaxis] * 5.0 * time)
    reading = 0.98 * command + 1e-6 * np.random.default_rng(1).normal(size=command.shape) * (time > 0.0)
    names = ["time", *(f"{channel}{k}" for channel in ("command", "measured") for k in numbers)]
    inputs = np.rec.fromarrays([time, *command, *reading], names=names)
    output = [f"{name}{k}" for name in ("error", "rms", "mte") for k in numbers]
    table = fmpy.simulate_fmu(
        str(content),
        stop_time=time[-1],
        output_interval=1.0 / RATE,
        input=inputs,
        output=output,
        use_event_mode=False,
    )
    (tmp_path / "c").mkdir()
    export_monitor(("c", tmp_path / "c"), rate=RATE, **exported_units[label])
    ours = follow(build(tmp_path / "c"), command, reading)
    count = table["time"].size - 1
    assert count >= time.size - 2
    for k, number in enumerate(numbers):
        assert np.abs(table[f"error{number}"][1:] - ours.error[k, :count]).max() < 1e-12 * 0.01
        assert table[f"rms{number}"][-1] == pytest.approx(ours.rms[k, count - 1], rel=1e-12)


PLANTS = {
    "fmu": """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="plant" guid="plant">
  <CoSimulation modelIdentifier="plant"><SourceFiles><File name="fmi2.c"/></SourceFiles></CoSimulation>
  <ModelVariables>
    <ScalarVariable name="command" valueReference="0" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="measured" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/><Unknown index="2"/></Outputs></ModelStructure>
</fmiModelDescription>
""",
    "fmu3": """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="plant" instantiationToken="plant">
  <CoSimulation modelIdentifier="plant"/>
  <ModelVariables>
    <Float64 name="command" valueReference="0" causality="output"/>
    <Float64 name="measured" valueReference="1" causality="output"/>
    <Float64 name="time" valueReference="2" causality="independent" variability="continuous"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="0"/><Output valueReference="1"/></ModelStructure>
</fmiModelDescription>
""",
}


@pytest.fixture(scope="module")
def plants(tmp_path_factory, units):
    """FMUs of a structure with an actuator that is four times too late, by the wrappers of ours."""
    return {kind: compile_plant(kind, tmp_path_factory.mktemp("plant"), units[kind]) for kind in KINDS}


def compile_plant(kind, folder, unit):
    """A plant in the place of the monitor."""
    from fmpy.build import build_platform_binary

    (folder / "sources").mkdir()
    (folder / "modelDescription.xml").write_text(PLANTS[kind], encoding="utf-8")
    text = (Path(__file__).parent / "plant.h").read_text(encoding="utf-8")
    for mark, value in {"@DELAY@": DELAY, "@STEP@": 1.0 / RATE}.items():
        text = text.replace(mark, repr(value))
    (folder / "sources" / "unit.h").write_text(text, encoding="utf-8")
    if kind == "fmu":
        shutil.copy(unit / "sources" / "fmi2.c", folder / "sources")
    else:
        shutil.copy(unit / "sources" / "fmi3.c", folder / "sources")
        build = (unit / "sources" / "buildDescription.xml").read_text(encoding="utf-8")
        build = build.replace('<SourceFile name="reliab_monitor.c"/>', "").replace("reliab_monitor", "plant")
        (folder / "sources" / "buildDescription.xml").write_text(build, encoding="utf-8")
    (folder / "build").mkdir()
    build_platform_binary(folder, build_dir=folder / "build")
    return folder


class Unit:
    """An instance of an FMU of either version, ready to be stepped."""

    def __init__(self, folder):
        description = fmpy.read_model_description(str(folder))
        self.slave = fmpy.instantiate_fmu(str(folder), description, fmi_type="CoSimulation")
        self.number = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.is_second = description.fmiVersion == "2.0"
        if self.is_second:
            self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.samples = 0

    def put(self, **values):
        """Set numbers by name."""
        write = self.slave.setReal if self.is_second else self.slave.setFloat64
        write([self.number[name] for name in values], list(values.values()))

    def get(self, *names):
        """Ask for numbers by name."""
        read = self.slave.getReal if self.is_second else self.slave.getFloat64
        return read([self.number[name] for name in names])

    @property
    def status(self):
        """Sum of the alarms."""
        read = self.slave.getInteger if self.is_second else self.slave.getInt32
        return read([self.number["status"]])[0]

    def step(self):
        """Take one sample."""
        now, self.samples = self.samples / RATE, self.samples + 1
        self.slave.doStep(currentCommunicationPoint=now, communicationStepSize=1.0 / RATE)

    def end(self):
        """Free the instance."""
        self.slave.terminate()
        self.slave.freeInstance()


def commands_of(plant, monitor=None, seconds=60):
    """Commands of a simulated loop until the monitor's alarm of the energy, or to the end."""
    units = [Unit(folder) for folder in (plant, monitor) if folder is not None]
    commands = []
    for _ in range(seconds * RATE):
        command, reading = units[0].get("command", "measured")
        commands.append(command)
        if monitor is not None:
            units[1].put(command=command, measured=reading)
        for unit in units:
            unit.step()
        if monitor is not None and units[1].status & UNSTABLE:
            break
    for unit in units:
        unit.end()
    return np.array(commands)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_co_simulation_of_two_units_is_stopped_at_the_alarm(units, plants, kind):
    alarm_time, free_run = commands_of(plants[kind], units[kind]), commands_of(plants[kind])
    assert alarm_time.size < free_run.size
    assert np.array_equal(alarm_time, free_run[: alarm_time.size])
    assert np.abs(alarm_time).max() < 0.1 * np.abs(free_run).max()


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_an_offset_is_stated_before_the_first_sample_and_not_after(units, kind):
    fit, declared_values = Unit(units[kind]), Unit(units[kind])
    declared_values.put(sensor_offset=2e-3)
    declared_values.slave.setBoolean([declared_values.number["offsets_are_stated"]], [True])
    assert declared_values.get("sensor_offset") == [2e-3]
    for unit in (fit, declared_values):
        for k in range(8):
            unit.put(command=1e-3 * k, measured=1e-3 * k + 2e-3)
            unit.step()
    assert abs(fit.get("error")[0]) > 1e-3
    assert abs(declared_values.get("error")[0]) < 1e-15
    with pytest.raises(Exception, match="failed"):
        declared_values.put(sensor_offset=0.0)
    for unit in (fit, declared_values):
        unit.end()


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("kind", KINDS)
def test_steps_of_another_length_are_refused(units, kind):
    with pytest.raises(Exception, match="DoStep failed"):
        fmpy.simulate_fmu(str(units[kind]), stop_time=1.0, output_interval=0.01)


def test_missing_values_are_requested(tmp_path):
    with pytest.raises(InputError, match="rate"):
        export_monitor(("fmu", tmp_path / "a.fmu"), f=1, xi=XI)
