"""The monitor as an FMU (FMI 2.0 or 3.0, co-simulation) whose sources a target compiles itself."""

import io
import uuid
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Final

from reliab.in_loop.sources import CONFIGURATION, LoopMonitor, monitor_sources

_BUILD_DEPTH: Final = 2
"""The version of FMI that names sources in the model's description, not in one of their own."""

_ARCHIVE_DATE = (1980, 1, 1, 0, 0, 0)  # so that the bytes depend on the content only
_SPACE = uuid.UUID("4f3d8a52-6f0e-5a53-9d52-9c4b7be1a040")
_SOURCES = ("reliab_monitor.c", "reliab_monitor.h", CONFIGURATION)


def pack_fmu(monitor: LoopMonitor, version: int) -> bytes:
    """Return the file of an FMU of version 2 or 3; it is stepped at the time step of its monitor."""
    texts = monitor_sources(monitor)
    guid = str(uuid.uuid5(_SPACE, "".join(texts[name] for name in _SOURCES)))
    actuators = len(monitor.coefficients.carry)
    variables = list_variables(actuators)
    description = (
        describe_for_3(variables, actuators) if version > _BUILD_DEPTH else describe_for_2(variables)
    )
    values = {"@GUID@": guid, "@STEP@": f"{monitor.time_step:.17g}", **description}
    archive_bytes = io.BytesIO()
    with zipfile.ZipFile(archive_bytes, "w", zipfile.ZIP_DEFLATED) as archive:
        for place, name in _templates(version).items():
            _write(archive, place, _fill_template(name, values))
        for name in _SOURCES:
            _write(archive, f"sources/{name}", texts[name])
        _write(archive, "documentation/README.md", texts["README.md"])
    return archive_bytes.getvalue()


def _templates(version: int) -> dict[str, str]:
    """Name the templates by their places in the FMU."""
    wrapper = f"fmi{version}.c"
    places = {
        "modelDescription.xml": f"modelDescription{version}.xml",
        f"sources/{wrapper}": wrapper,
        "sources/unit.h": "unit.h",
    }
    if version > _BUILD_DEPTH:
        places["sources/buildDescription.xml"] = "buildDescription.xml"
    return places


def _fill_template(name: str, values: dict[str, str]) -> str:
    """Return a template with its values."""
    text = files("reliab.in_loop").joinpath("template", name).read_text(encoding="utf-8")
    for mark, value in values.items():
        text = text.replace(mark, value)
    return text


def _write(archive: zipfile.ZipFile, name: str, text: str) -> None:
    entry = zipfile.ZipInfo(name, _ARCHIVE_DATE)
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, text)


_NAMES_IN_2 = {"Float64": "Real", "Int32": "Integer", "Boolean": "Boolean"}
_STATUS = "1: may diverge, 2: error above twice the threshold, 4: fault; sums of them"


@dataclass(frozen=True, kw_only=True)
class Variable:
    """A variable of the FMU."""

    name: str
    number: int  # Its value reference, as `template/unit.h` numbers them
    description: str
    unit: str = ""
    kind: str = "Float64"  # Float64, Int32 or Boolean
    causality: str = "output"  # input, output or parameter

    @property
    def is_output(self) -> bool:
        """Whether it is computed."""
        return self.causality == "output"


def list_variables(actuators: int) -> list[Variable]:
    """Return inputs, outputs and parameters; those of one actuator have no numbers in their names."""
    place = {k: f"_{k + 1}" if actuators > 1 else "" for k in range(actuators)}
    channels = ("command", "Command displacement"), ("measured", "Measured displacement")
    inputs = [
        Variable(
            name=f"{name}{place[k]}",
            number=2 * k + channel,
            description=text,
            unit="m",
            causality="input",
        )
        for k in place
        for channel, (name, text) in enumerate(channels)
    ]
    errors = (
        ("error", "Measured displacement minus exact response", "m"),
        ("rms", "RMS^R so far", ""),
        ("mte", "MTE^R so far", ""),
    )
    outputs = [
        Variable(name=f"{name}{place[k]}", number=block * actuators + k, description=text, unit=unit)
        for block, (name, text, unit) in enumerate(errors, 2)
        for k in place
    ]
    damping = "Net damping ratio of the loop; NaN before it is known"
    outputs += [
        Variable(name="net_damping", number=5 * actuators, description=damping),
        Variable(name="status", number=5 * actuators + 1, description=_STATUS, kind="Int32"),
    ]
    if actuators > 1:
        label = "Number of the displacement with the largest error so far"
        outputs.append(Variable(name="governing", number=5 * actuators + 3, description=label, kind="Int32"))
    return [*inputs, *outputs, *_parameters(place)]


def _parameters(place: dict[int, str]) -> list[Variable]:
    """List what may be stated of the sensors before a test."""
    actuators = len(place)
    quantities = (
        ("sensor_offset", "Offset of the displacement sensor"),
        ("standing", "Command minus measured displacement in equilibrium, when the test begins"),
    )
    numbers = [
        Variable(
            name=f"{name}{place[k]}",
            number=(5 + block) * actuators + 4 + k,
            description=text,
            unit="m",
            causality="parameter",
        )
        for block, (name, text) in enumerate(quantities)
        for k in place
    ]
    whether = Variable(
        name="offsets_are_stated",
        number=7 * actuators + 4,
        description="Whether the offsets are those stated here; otherwise they are learned at rest",
        kind="Boolean",
        causality="parameter",
    )
    return [*numbers, whether]


def describe_for_2(variables: Sequence[Variable]) -> dict[str, str]:
    """Return the parts of a model's description in FMI 2.0."""
    places = [place for place, variable in enumerate(variables, 1) if variable.is_output]
    outputs = "".join(f'<Unknown index="{place}"/>' for place in places)
    return {"@VARIABLES@": "\n".join(map(_scalar, variables)), "@OUTPUTS@": outputs}


def describe_for_3(variables: Sequence[Variable], actuators: int) -> dict[str, str]:
    """Return the parts of a model's description in FMI 3.0, which has the time as a variable."""
    numbers = [variable.number for variable in variables if variable.is_output]
    time = (
        f'    <Float64 name="time" valueReference="{5 * actuators + 2}" causality="independent" '
        'variability="continuous" unit="s" description="Time of the last sample"/>'
    )
    return {
        "@VARIABLES@": "\n".join([*map(_type_element, variables), time]),
        "@OUTPUTS@": "".join(f'<Output valueReference="{number}"/>' for number in numbers),
        "@INITIAL@": "".join(f'<InitialUnknown valueReference="{number}"/>' for number in numbers),
    }


def _attributes(variable: Variable) -> str:
    variability = "fixed" if variable.causality == "parameter" else "discrete"
    initial = ' initial="calculated"' if variable.is_output else ""
    return (
        f'name="{variable.name}" valueReference="{variable.number}" causality="{variable.causality}" '
        f'variability="{variability}"{initial} description="{variable.description}"'
    )


def _values(variable: Variable) -> str:
    """Write the unit and the start value."""
    unit = f' unit="{variable.unit}"' if variable.unit else ""
    start = "false" if variable.kind == "Boolean" else "0"
    return unit + ("" if variable.is_output else f' start="{start}"')


def _scalar(variable: Variable) -> str:
    kind = _NAMES_IN_2[variable.kind]
    return f"    <ScalarVariable {_attributes(variable)}><{kind}{_values(variable)}/></ScalarVariable>"


def _type_element(variable: Variable) -> str:
    return f"    <{variable.kind} {_attributes(variable)}{_values(variable)}/>"
