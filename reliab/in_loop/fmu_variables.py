"""The variables of the FMU: named, numbered and described once, written for FMI 2.0 and 3.0."""

from collections.abc import Sequence
from dataclasses import dataclass

_STATUS = "1: may diverge, 2: error above twice the threshold, 4: fault; sums of them"


@dataclass(frozen=True, kw_only=True)
class Variable:
    """A variable of the FMU."""

    name: str
    number: int  # Its value reference, as `template/unit.h` numbers them
    description: str
    unit: str = ""
    is_input: bool = False
    is_whole: bool = False


def list_variables(actuators: int) -> list[Variable]:
    """Return inputs and outputs; those of one actuator have no numbers in their names."""
    place = {k: f"_{k + 1}" if actuators > 1 else "" for k in range(actuators)}
    channels = ("command", "Command displacement"), ("measured", "Measured displacement")
    inputs = [
        Variable(name=f"{name}{place[k]}", number=2 * k + channel, description=what, unit="m", is_input=True)
        for k in place
        for channel, (name, what) in enumerate(channels)
    ]
    errors = (
        ("error", "Measured displacement minus exact response", "m"),
        ("rms", "RMS^R so far", ""),
        ("mte", "MTE^R so far", ""),
    )
    outputs = [
        Variable(name=f"{name}{place[k]}", number=block * actuators + k, description=what, unit=unit)
        for block, (name, what, unit) in enumerate(errors, 2)
        for k in place
    ]
    damping = "Net damping ratio of the loop; NaN before it is known"
    outputs += [
        Variable(name="net_damping", number=5 * actuators, description=damping),
        Variable(name="status", number=5 * actuators + 1, description=_STATUS, is_whole=True),
    ]
    if actuators > 1:
        which = "Number of the displacement with the largest error so far"
        outputs.append(Variable(name="governing", number=5 * actuators + 3, description=which, is_whole=True))
    return [*inputs, *outputs]


def describe_for_2(variables: Sequence[Variable]) -> dict[str, str]:
    """Return the parts of a model's description in FMI 2.0."""
    places = [place for place, variable in enumerate(variables, 1) if not variable.is_input]
    outputs = "".join(f'<Unknown index="{place}"/>' for place in places)
    return {"@VARIABLES@": "\n".join(map(_scalar, variables)), "@OUTPUTS@": outputs}


def describe_for_3(variables: Sequence[Variable], actuators: int) -> dict[str, str]:
    """Return the parts of a model's description in FMI 3.0, which has the time as a variable."""
    numbers = [variable.number for variable in variables if not variable.is_input]
    time = (
        f'    <Float64 name="time" valueReference="{5 * actuators + 2}" causality="independent" '
        'variability="continuous" unit="s" description="Time of the last sample"/>'
    )
    return {
        "@VARIABLES@": "\n".join([*map(_typed, variables), time]),
        "@OUTPUTS@": "".join(f'<Output valueReference="{number}"/>' for number in numbers),
        "@INITIAL@": "".join(f'<InitialUnknown valueReference="{number}"/>' for number in numbers),
    }


def _attributes(variable: Variable) -> str:
    causality = 'causality="input"' if variable.is_input else 'causality="output"'
    initial = "" if variable.is_input else ' initial="calculated"'
    return (
        f'name="{variable.name}" valueReference="{variable.number}" {causality} '
        f'variability="discrete"{initial} description="{variable.description}"'
    )


def _measure(variable: Variable) -> str:
    unit = f' unit="{variable.unit}"' if variable.unit else ""
    return unit + (' start="0"' if variable.is_input else "")


def _scalar(variable: Variable) -> str:
    kind = "Integer" if variable.is_whole else "Real"
    return f"    <ScalarVariable {_attributes(variable)}><{kind}{_measure(variable)}/></ScalarVariable>"


def _typed(variable: Variable) -> str:
    kind = "Int32" if variable.is_whole else "Float64"
    return f"    <{kind} {_attributes(variable)}{_measure(variable)}/>"
