"""`channels.toml`: what a laboratory states once of its channels, for all its tests."""

from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

from reliab.core.described_files import read_toml, validate_description
from reliab.core.errors import InputError
from reliab.core.stated_value import Physical, StatedValue
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import ChannelDeclaration, Part, StatedChannels

_RULE: Final = "This is no file of channels"
_REMEDY: Final = "Compare it with one that `reliab calibrate --out` writes"
_PARTS: Final = {
    "time": Part.TIME,
    "command": Part.COMMAND,
    "measured": Part.MEASURED,
    "force": Part.FORCE,
    "ground": Part.GROUND,
}
_Name = Annotated[str, Field(min_length=1, max_length=200)]
_Reading = Annotated[float, Physical("number", zero=True, signed=True)]
_LowPass = Annotated[str, Field(pattern=r"^[0-9.]{1,12}(/[1-8])?$")]
_NotNegative = Annotated[float, Physical("number", zero=True)]
_Time = Annotated[float, Physical("time", zero=True)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class ChannelTable(_Table):
    """One channel: its names in files, and how its readings become displacement, force or acceleration."""

    column: Annotated[list[_Name], Field(max_length=50)] | _Name = Field(
        default=[],
        description="Name of the column, or several names, of which the first that a file holds is used",
    )
    unit: Annotated[str, Field(max_length=20)] = Field(default="", description="Unit, in place of the file's")
    sign: Literal[-1, 1] = Field(default=1, description="1, or -1 where the channel is reversed")
    scale: Annotated[float, Physical("number")] = Field(
        default=1.0, description="Factor by which readings are multiplied"
    )
    zero: _Reading = Field(
        default=0.0, description="Reading at rest, in the unit of the file, which is subtracted"
    )

    def declaration(self) -> ChannelDeclaration:
        """Return the same for the recognition."""
        columns = (self.column,) if isinstance(self.column, str) else tuple(self.column)
        return ChannelDeclaration(
            columns=columns,
            unit=self.unit,
            sign=self.sign,
            scale=self.scale,
            zero=self.zero,
            is_scaled=bool({"scale", "zero"} & self.model_fields_set),
        )


class ChannelTables(_Table):
    """The channels of a test."""

    time: ChannelTable | None = Field(default=None, description="Times of the samples")
    command: ChannelTable | None = Field(default=None, description="Commanded displacement")
    measured: ChannelTable | None = Field(default=None, description="Measured displacement")
    force: ChannelTable | None = Field(default=None, description="Restoring force of the specimen")
    ground: ChannelTable | None = Field(default=None, description="Ground acceleration")


class ChannelSamplingTable(_Table):
    """How tests were sampled, where their files do not say so."""

    rate_hz: Annotated[float, Physical("sampling rate")] | None = Field(
        default=None, description="Samples in a second"
    )


class CalibrationTable(_Table):
    """What the measured channel adds to a motion, as `reliab calibrate` measures it."""

    skew_ms: Annotated[float, Physical("time", zero=True, signed=True)] | None = Field(
        default=None, description="Time by which the measured channel is late [ms]"
    )
    skew_sd_ms: _Time = Field(default=0.0, description="Its standard deviation [ms]")
    scale: Annotated[float, Physical("scale")] | None = Field(
        default=None, description="Reading of the measured channel over that of the command's"
    )
    scale_sd: _NotNegative = Field(default=0.0, description="Its standard deviation")
    hysteresis: Annotated[float, Physical("hysteresis", zero=True)] | None = Field(
        default=None,
        description="Difference of the readings at one position that is reached from either side, over "
        "the range",
    )
    hysteresis_sd: _NotNegative = Field(default=0.0, description="Its standard deviation")
    resolution_m: _NotNegative | None = Field(default=None, description="Step between readings [m]")
    noise_m: _NotNegative | None = Field(default=None, description="Noise of the measured channel, RMS [m]")
    command_noise_m: _NotNegative | None = Field(
        default=None, description="Noise of the command's channel, RMS [m]"
    )

    def quantities(self) -> dict[str, StatedValue]:
        """Return skew [ms], scale, hysteresis [-] and resolution [mm], as far as they are stated."""
        values = {
            "skew": (self.skew_ms, self.skew_sd_ms),
            "scale": (self.scale, self.scale_sd),
            # none found is a finding, with its deviation
            "hysteresis": (self.hysteresis or (0.0 if self.hysteresis_sd else None), self.hysteresis_sd),
            "resolution": (MILLI * self.resolution_m if self.resolution_m else None, 0.0),
        }
        return {
            name: StatedValue(value, deviation)
            for name, (value, deviation) in values.items()
            if value is not None
        }


class FilterTable(_Table):
    """Low-pass filters before the converters, of which none is calibrated with the channels."""

    command: _LowPass | None = Field(
        default=None,
        description="Filter of the command, 200 [Hz] or 200/4 with its order, 2 where none is given",
    )
    measured: _LowPass | None = Field(default=None, description="The same of the measured displacement")

    def texts(self) -> dict[str, str]:
        """Return the filters by channel, as options state them."""
        return {name: text for name, text in (("command", self.command), ("measured", self.measured)) if text}


class ChannelsDescription(_Table):
    """A laboratory's file `channels.toml`."""

    channels: ChannelTables = Field(
        default=ChannelTables(), description="Names, units, signs, zeros and scales"
    )
    sampling: ChannelSamplingTable = Field(
        default=ChannelSamplingTable(), description="Sampling of all tests"
    )
    calibration: CalibrationTable = Field(
        default=CalibrationTable(),
        description="What the measured channel adds to the motion, which `assess` removes",
    )
    filters: FilterTable = Field(
        default=FilterTable(), description="Low-pass filters, unless a calibrated skew includes their delay"
    )


def read_channels_file(path: str | Path) -> StatedChannels:
    """Read a file `channels.toml`."""
    content = read_toml(path, rule=_RULE, remedy=_REMEDY)
    tables = validate_description(ChannelsDescription, content, rule=_RULE, remedy=_REMEDY, where=str(path))
    if tables.filters.texts() and tables.calibration.skew_ms is not None:
        raise InputError(
            "`skew_ms` already includes the delay of the filters",
            remedy="Leave `filters` out",
            where=str(path),
        )
    return StatedChannels(
        declarations=read_declarations(tables.channels),
        rate_hz=tables.sampling.rate_hz,
        calibration=tables.calibration.quantities(),
        filters=tables.filters.texts(),
    )


def read_declarations(tables: ChannelTables) -> dict[Part, ChannelDeclaration]:
    """Return what tables state of the channels, by part."""
    part_tables = {part: getattr(tables, name) for name, part in _PARTS.items()}
    return {part: table.declaration() for part, table in part_tables.items() if table is not None}
