"""The updated model of a hybrid test as a file: calibration, specimen, and effects with their uncertainty.

The file is TOML with the tables of campaign.toml, so that people can read, copy and annotate it.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from reliab.core.described_files import read_toml, validate_description
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.stated_value import Physical, require_physical
from reliab.effects.effect import Effect, Parameter
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure


class ModelPart(BaseModel):
    """A table that has no keys but its own."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class StructureTable(ModelPart):
    """Nominal structure of one degree of freedom, as the operator assumes it."""

    frequency_hz: Annotated[float, Physical("natural frequency")] = Field(description="Natural frequency")
    damping_ratio: Annotated[float, Physical("damping ratio")] = Field(description="Damping ratio ξ")
    mass_kg: Annotated[float, Physical("mass")] | None = Field(
        default=None, description="Mass, which scales the force; without it forces are those of a unit mass"
    )
    experimental_fraction: Annotated[float, Physical("share of the stiffness in the laboratory")] = Field(
        default=1.0, description="Share α of the stiffness that stands in the laboratory"
    )

    def build(self) -> Structure:
        """Return the structure."""
        return Structure(
            frequency=self.frequency_hz,
            damping_ratio=self.damping_ratio,
            experimental_fraction=self.experimental_fraction,
        )


class ActuatorTable(ModelPart):
    """Nominal actuator. Left out where the command is not recorded."""

    gain: Annotated[float, Physical("actuator's gain")] = Field(
        default=1.0, description="Measured over commanded displacement"
    )
    delay_s: Annotated[float, Physical("actuator's delay", zero=True)] = Field(
        default=0.0, description="Time by which the piston is late"
    )

    def build(self) -> Actuator:
        """Return the actuator."""
        return Actuator(gain=self.gain, delay=self.delay_s)


class SpecimenTable(ModelPart):
    """Nominal specimen, where it is not the structure's own spring."""

    stiffness_n_per_m: Annotated[float, Physical("stiffness", zero=True)] = Field(
        default=0.0, description="Stiffness"
    )
    damping_n_s_per_m: Annotated[float, Physical("damping coefficient", zero=True)] = Field(
        default=0.0, description="Damping coefficient"
    )
    mass_kg: Annotated[float, Physical("mass", zero=True)] = Field(
        default=0.0, description="Mass that moves with the piston"
    )

    def build(self) -> Specimen:
        """Return the specimen."""
        return Specimen(stiffness=self.stiffness_n_per_m, damping=self.damping_n_s_per_m, mass=self.mass_kg)


MODEL_FILE = "model.toml"
_FORMAT = 1
_HEAD = """\
# Updated model of a hybrid test, in SI units; sd is the standard deviation of a value.
# Use it with: reliab criterion --model {file} --motions ...    or: reliab simulate --model {file} ...
"""

_Number = Annotated[float, Physical("number", zero=True, signed=True)]
_Deviation = Annotated[float, Physical("number", zero=True)]


@dataclass(frozen=True, kw_only=True)
class UpdatedModel:
    """A model of a hybrid test with the uncertainty of its parameters."""

    name: str  # Free text, the campaign's name
    test: HybridTest  # The model
    # Standard deviations, SI units, of "gain", "delay_s", "stiffness_n_per_m" and of effects' parameters by
    # "effect.parameter"; parameters that are missing here were not fitted
    deviations: Mapping[str, float] = field(default_factory=dict)
    # Sentences on what limits these values, written as comments
    limits: tuple[str, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        for parameter, value in self.deviations.items():
            require_physical("number", value, zero=True, label="standard deviation", where=parameter)


def write_model(path: Path | str, model: UpdatedModel) -> None:
    """Write an updated model."""
    path = Path(path)
    with refuse_unwritable("Cannot write the model's file", where=path), written_whole(path) as file:
        file.write_text(_text(model, path.name), encoding="utf-8")


def read_model(path: Path | str) -> UpdatedModel:
    """Read an updated model."""
    path = Path(path)
    description = _describe(path)
    test = HybridTest(
        structure=description.structure.build() if description.structure else None,
        mass=(description.structure.mass_kg if description.structure else None) or 1.0,
        actuator=description.actuator.build(),
        specimen=description.specimen.build() if description.specimen else None,
        effects=tuple(
            _effect(entry, f"{path.name}, effect {k}") for k, entry in enumerate(description.effects, 1)
        ),
    )
    return UpdatedModel(name=description.name, test=test, deviations=_deviations(description))


class _Actuator(ActuatorTable):
    gain_sd: _Deviation | None = None
    delay_s_sd: _Deviation | None = None


class _Specimen(SpecimenTable):
    stiffness_n_per_m: Annotated[float, Physical("stiffness", zero=True)]
    stiffness_n_per_m_sd: _Deviation | None = None
    damping_n_s_per_m: Annotated[float, Physical("damping coefficient", zero=True, signed=True)] = 0.0


class _Value(ModelPart):
    value: _Number
    sd: _Deviation | None = None
    units: str | None = None


class _Effect(ModelPart):
    name: str
    parameters: dict[str, _Value]


class _ModelFile(ModelPart):
    format: Literal[1]
    name: str = ""
    structure: StructureTable | None = None
    actuator: _Actuator = _Actuator()
    specimen: _Specimen | None = None
    effects: list[_Effect] = Field(default=[])


def _describe(path: Path) -> _ModelFile:
    remedy = f"Compare with a {MODEL_FILE} that `reliab diagnose --out` writes"
    content = read_toml(path, rule="A model must be a readable TOML file", remedy=remedy)
    rule = "A model must be described by known keys with allowed values"
    return validate_description(_ModelFile, content, rule=rule, remedy=remedy, where=path.name)


def _effect(entry: _Effect, location: str) -> Effect:
    kind: type[Effect] = find_effect(entry.name)
    parameters, values = {parameter.name: parameter for parameter in kind.parameters}, entry.parameters
    if set(parameters) != set(values):
        raise InputError(
            f"The parameters of {entry.name} are {', '.join(parameters)}",
            value=", ".join(values) or "none",
            remedy="Give each of them once",
            where=location,
        )
    for name, value in values.items():
        _check_units(parameters[name], value, location)
    return kind(**{name: value.value for name, value in values.items()})


def _check_units(parameter: Parameter, value: _Value, location: str) -> None:
    if value.units not in (None, parameter.units):
        raise InputError(
            f"The unit of {parameter.name} is {parameter.units}",
            value=repr(value.units),
            remedy=f"Convert the value and its sd to {parameter.units}",
            where=location,
        )


def _deviations(description: _ModelFile) -> dict[str, float]:
    deviations = {"gain": description.actuator.gain_sd, "delay_s": description.actuator.delay_s_sd}
    if description.specimen is not None:
        deviations["stiffness_n_per_m"] = description.specimen.stiffness_n_per_m_sd
    for effect in description.effects:
        deviations.update({f"{effect.name}.{name}": value.sd for name, value in effect.parameters.items()})
    return {name: value for name, value in deviations.items() if value is not None}


def _text(model: UpdatedModel, file: str) -> str:
    test, sd = model.test, model.deviations
    lines = [_HEAD.format(file=file), *(f"# {' '.join(limit.split())}" for limit in model.limits)]
    lines += [f"format = {_FORMAT}", f"name = {_quote(model.name)}"]
    if test.structure is not None:
        lines += _table(
            "[structure]",
            frequency_hz=test.structure.frequency,
            damping_ratio=test.structure.damping_ratio,
            mass_kg=test.mass,
            experimental_fraction=test.structure.experimental_fraction,
        )
    lines += _table(
        "[actuator]",
        gain=test.actuator.gain,
        gain_sd=sd.get("gain"),
        delay_s=test.actuator.delay,
        delay_s_sd=sd.get("delay_s"),
    )
    if test.specimen is not None:
        lines += _table(
            "[specimen]",
            stiffness_n_per_m=test.specimen.stiffness,
            stiffness_n_per_m_sd=sd.get("stiffness_n_per_m"),
            damping_n_s_per_m=test.specimen.damping,
            mass_kg=test.specimen.mass,
        )
    for effect in test.effects:
        lines += _effect_lines(effect, sd)
    return "\n".join(lines) + "\n"


def _effect_lines(effect: Effect, sd: Mapping[str, float]) -> list[str]:
    lines = ["", "[[effects]]", f"# {effect.description}", f"name = {_quote(str(effect.name))}"]
    for parameter, value in zip(effect.parameters, effect.values.tolist(), strict=True):
        key = f"{effect.name}.{parameter.name}"
        content: dict[str, Any] = {"value": value, "sd": sd.get(key), "units": parameter.units}
        lines += _table(f"[effects.parameters.{parameter.name}]", f"  # {parameter.meaning}", **content)
    return lines


def _table(head: str, remark: str = "", /, **content: float | str | None) -> list[str]:
    """Lines of a table without what is None."""
    rows = [
        f"{key} = {_quote(value) if isinstance(value, str) else repr(float(value))}"
        for key, value in content.items()
        if value is not None
    ]
    return ["", f"{head}{remark}", *rows]


def _quote(text: str) -> str:
    """Write a string of TOML, which JSON's strings are once DEL is escaped."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
