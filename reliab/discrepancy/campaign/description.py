"""The tables of `campaign.toml`: the keys allowed, their meaning, and what they may be."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from reliab.recordings import ChannelTables

_Positive = Annotated[float, Field(ge=1e-30, le=1e30)]  # whose squares are numbers
_NotNegative = Annotated[float, Field(ge=0.0, le=1e30)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class StructureTable(_Table):
    """Nominal structure of one degree of freedom, as the operator assumes it."""

    frequency_hz: _Positive = Field(description="Natural frequency")
    damping_ratio: Annotated[float, Field(gt=0.0, lt=1.0)] = Field(description="Damping ratio ξ")
    mass_kg: _Positive | None = Field(
        default=None, description="Mass, which scales the force; without it forces are those of a unit mass"
    )
    experimental_fraction: Annotated[float, Field(gt=0.0, le=1.0)] = Field(
        default=1.0, description="Share α of the stiffness that stands in the laboratory"
    )


class FrameTables(_Table):
    """A frame in place of the structure of one degree of freedom, by tables of `frame.toml`."""

    frame: dict[str, Any] = Field(description="Mass and stiffness, as `[frame]` of `frame.toml`")
    damping: dict[str, Any] = Field(description="Damping, as `[damping]` of `frame.toml`")
    specimen: dict[str, Any] = Field(description="Specimen and interface, as `[specimen]` of `frame.toml`")


class ActuatorTable(_Table):
    """Nominal actuator. Left out where the command is not recorded."""

    gain: _Positive = Field(default=1.0, description="Measured over commanded displacement")
    delay_s: _NotNegative = Field(default=0.0, description="Time by which the piston is late")


class SpecimenTable(_Table):
    """Nominal specimen, where it is not the structure's own spring."""

    stiffness_n_per_m: _NotNegative = Field(default=0.0, description="Stiffness")
    damping_n_s_per_m: _NotNegative = Field(default=0.0, description="Damping coefficient")
    mass_kg: _NotNegative = Field(default=0.0, description="Mass that moves with the piston")


class SamplingTable(_Table):
    """How all tests were sampled."""

    rate_hz: _Positive = Field(description="Samples in a second")


class TestTable(_Table):
    """A test; the table is repeated for each."""

    file: Annotated[str, Field(min_length=1)] = Field(
        description="File in the folder of the campaign, of any format that `reliab assess` reads"
    )
    test: Annotated[str, Field(max_length=200)] = Field(
        default="", description="Name of the test, where the file holds several"
    )
    motion: str = Field(default="", description="What drove the test")
    held_out: bool = Field(
        default=False,
        description="Whether the test is kept to verify what is found; if none is marked, the last one is",
    )

    @property
    def name(self) -> str:
        """File, and the test in it where it holds several."""
        return f"{self.file}, {self.test}" if self.test else self.file


def _kind_of_structure(table: object) -> str:
    """Distinguish a frame from a structure of one degree of freedom by its tables."""
    return "(frame)" if isinstance(table, dict) and "frame" in table else "(one_mode)"


class CampaignDescription(_Table):
    """A rig and its tests."""

    name: str = Field(default="", description="Free text; without it the name of the folder")
    structure: (
        Annotated[
            Annotated[StructureTable, Tag("(one_mode)")] | Annotated[FrameTables, Tag("(frame)")],
            Discriminator(_kind_of_structure),
        ]
        | None
    ) = Field(default=None, description="Numerical substructure; left out where there is none")
    actuator: ActuatorTable | None = Field(default=None, description="Nominal actuator")
    specimen: SpecimenTable | None = Field(default=None, description="Nominal specimen")
    sampling: SamplingTable = Field(description="Sampling of all tests")
    channels: ChannelTables = Field(
        default=ChannelTables(),
        description="Columns, units, signs and zeros, as `[channels]` of `channels.toml`",
    )
    tests: Annotated[list[TestTable], Field(min_length=1)] = Field(description="One table for each test")
