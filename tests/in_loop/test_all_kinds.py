"""Two hundred drawn tests of every kind and rate: C, the FMU and Python have the same errors."""

import re
import shutil
import subprocess
import zipfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from compiled_monitor import COMPILERS, assert_same, compare, needs_compiler
from drawn_tests import KINDS

from reliab.in_loop.fmu import pack_fmu

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed here (it comes with the extra test)")
pytestmark = [needs_compiler, pytest.mark.slow]
RATES = (256, 1024, 4096)
COUNT = 204
SEED = 4000
SECONDS = 6.0  # of each test that an FMU follows
HEADERS = Path(fmpy.__file__).parent / "c-code"


def compile_unit(monitor, version, folder):
    """The FMU of a monitor, unpacked, its listed sources compiled."""
    (folder / "monitor.fmu").write_bytes(pack_fmu(monitor, version))
    with zipfile.ZipFile(folder / "monitor.fmu") as archive:
        archive.extractall(folder)
    listing = "modelDescription.xml" if version == 2 else "sources/buildDescription.xml"
    text = (folder / listing).read_text(encoding="utf-8")
    sources = re.findall(r'(?:File|SourceFile) name="([^"]+)"', text)
    system = fmpy.platform if version == 2 else fmpy.platform_tuple
    library = folder / "binaries" / system / f"reliab_monitor{fmpy.sharedLibraryExtension}"
    library.parent.mkdir(parents=True)
    command = [COMPILERS[0], "-std=c99", "-O2", "-fPIC", "-shared", f"-I{HEADERS}", *sources, "-lm"]
    subprocess.run([*command, "-o", str(library)], cwd=folder / "sources", check=True)  # noqa: S603
    return folder


def beginning(samples):
    """The first seconds of a test: a step of FMPy takes its time."""
    deadline = slice(round(SECONDS / samples.monitor.time_step))
    rows = {name: getattr(samples, name)[:, deadline] for name in ("command", "measured", "error")}
    return replace(samples, **rows)


def errors_of_unit(samples, version, folder):
    """Errors that the FMU gives, stepped by FMPy's instance; offsets are stated as its parameters."""
    step = samples.monitor.time_step
    description = fmpy.read_model_description(str(compile_unit(samples.monitor, version, folder)))
    number = {variable.name: variable.valueReference for variable in description.modelVariables}
    unit = fmpy.instantiate_fmu(str(folder), description, fmi_type="CoSimulation")
    actuators = len(samples.command)
    names = [f"_{k + 1}" for k in range(actuators)] if actuators > 1 else [""]
    places = {
        name: [number[f"{name}{k}"] for k in names]
        for name in ("command", "measured", "error", "sensor_offset", "standing")
    }
    put, get = (unit.setReal, unit.getReal) if version == 2 else (unit.setFloat64, unit.getFloat64)
    if version == 2:
        unit.setupExperiment(startTime=0.0)
    put(places["sensor_offset"] + places["standing"], list(samples.begin))
    unit.setBoolean([number["offsets_are_stated"]], [True])
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    inputs, errors = places["command"] + places["measured"], np.empty_like(samples.command)
    for k, row in enumerate(np.concatenate([samples.command, samples.measured]).T):
        put(inputs, row.tolist())
        unit.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
        errors[:, k] = get(places["error"])
    unit.terminate()
    unit.freeInstance()
    return errors


def test_c_and_the_unit_have_the_errors_of_python_in_tests_of_every_kind_and_rate(tmp_path):
    """By turns a structure of one degree of freedom, a frame, several actuators, and a nonlinear specimen."""
    count = Counter()
    largest = 0.0
    for place in range(COUNT):
        turn, kind = place // len(KINDS), list(KINDS)[place % len(KINDS)]
        rate = RATES[(turn + turn // 12) % 3]  # of each of the twelve effects another one in each round
        version = 2 + int(np.random.default_rng(place).integers(2))
        samples = KINDS[kind](SEED + turn, rate)
        folder = tmp_path / f"{place}"
        ours = compare(folder, samples)
        (folder / "unit").mkdir()
        start = beginning(samples)
        errors = errors_of_unit(start, version, folder / "unit")
        assert_same(errors, start)
        for histories, model in ((ours.error, samples), (errors, start)):
            largest = max(largest, float((np.abs(histories - model.error).max(axis=1) / model.peaks).max()))
        count.update([kind, rate, f"FMI {version}.0", "alarm" * (samples.alarm is not None)])
        shutil.rmtree(folder)
    print(dict(count), f"largest difference {largest:.2g} of the peak")  # noqa: T201 - measured
    assert min(count[kind] for kind in KINDS) == COUNT // 4
    assert min(count[rate] for rate in RATES) == COUNT // 3
    assert min(count["FMI 2.0"], count["FMI 3.0"], count["alarm"]) > 20
