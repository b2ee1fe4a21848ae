"""Reading a campaign folder: campaign.toml and the files of the tests, in any format of a laboratory.

The numerical substructure is a structure of one degree of freedom::

    [structure]
    frequency_hz = 1.0                       # nominal values, as the operator assumes them
    damping_ratio = 0.02
    mass_kg = 1000.0                         # scales force; absent: force per unit mass
    experimental_fraction = 1.0

or a frame, described by the tables of `frame.toml` (:mod:`reliab.simulation.frames.frame_file`)::

    [structure.frame]
    mass_matrix_kg = [[1000.0, 0.0], [0.0, 1000.0]]
    stiffness_matrix_n_per_m = [[4e5, -2e5], [-2e5, 2e5]]
    [structure.damping]
    ratio = 0.02
    [structure.specimen]
    degree_of_freedom = 1
    stiffness_n_per_m = 1e5

The command is then the displacement of the frame at the interface, the force that of the specimen.
"""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag, ValidationError

from reliab.core.described_files import faults_in_words, keys_of, parse_toml, read_description
from reliab.core.errors import InputError
from reliab.core.shipped import is_own_data, shipped
from reliab.core.stated_value import Physical
from reliab.core.untrusted_files import resolve_within
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.recordings.channels_file import ChannelTables, read_declarations
from reliab.recordings.reading import ChannelHistories, histories_of, read_test
from reliab.recordings.recording import FEWEST_SAMPLES, Part, StatedChannels
from reliab.simulation.frames.frame_file import frame_of_tables, require_one_actuator
from reliab.simulation.hybrid_test.model_file import ActuatorTable, ModelPart, SpecimenTable, StructureTable
from reliab.structures.partition import Partition

_CHANNELS: Final[Mapping[str, Channel]] = {
    str(Part.GROUND): Channel.GROUND,
    str(Part.COMMAND): Channel.COMMAND,
    str(Part.MEASURED): Channel.MEASURED,
    str(Part.FORCE): Channel.FORCE,
}
_RATE_TOLERANCE = 2e-3

CAMPAIGN_FILE = "campaign.toml"
MOST_SAMPLES = 3_000_000
"""Largest number of samples of all tests, a thousand tests of 23 s at 128 Hz. By extrapolation from 4 and 16
tests a diagnosis then takes about 4 GB and two hours."""


def read_channels(
    path: Path, rate: float, channel_statements: StatedChannels, test: str = ""
) -> tuple[dict[Channel, NDArray[np.float64]], tuple[str, ...]]:
    """Read the channels of one test, in SI units, and what was assumed.

    `rate` [Hz]; `test` names one of several in the file.
    """
    histories = histories_of(read_test(path, test or None), channel_statements, needed_parts=())
    channels = {_CHANNELS[key]: values for key, values in histories.values.items() if key in _CHANNELS}
    fault = _fault(histories, channels, rate)
    if fault is not None:
        rule, value, remedy = fault
        raise InputError(rule, value=value, remedy=remedy, where=histories.columns.location)
    return channels, histories.notes


def _fault(
    histories: ChannelHistories, channels: Mapping[Channel, NDArray[np.float64]], rate: float
) -> tuple[str, object, str] | None:
    """Rule that the channels of a test break, the value that breaks it, and the remedy."""
    for key, channel in histories.channels.items():
        if key in _CHANNELS and not channel.unit:
            remedy = f"Name it {_CHANNELS[key]}, or state its unit under [channels] in campaign.toml"
            return "A channel of a campaign must state its unit", repr(channel.column), remedy
    if not channels:
        remedy = "Name its columns under [channels] in campaign.toml"
        found = ", ".join(histories.channels)
        return "A test of a campaign must hold channels of one actuator", found, remedy
    size = min(values.size for values in channels.values())
    if size < FEWEST_SAMPLES:
        rule = f"A test must have at least {FEWEST_SAMPLES} samples"
        return rule, size, "Leave it out, or record longer"
    if abs(histories.time_step * rate - 1.0) > _RATE_TOLERANCE:
        rates = f"{1.0 / histories.time_step:.6g} Hz against {rate:g} Hz"
        remedy = "Correct rate_hz, or state the unit of the times"
        return "The times must agree with rate_hz of campaign.toml", rates, remedy
    return None


def campaign_folder(folder: Path | str) -> Path:
    """Take the path of a campaign, or the name of one that ships where there is no such path.

    >>> campaign_folder("rig_a").parts[-2:]
    ('campaigns', 'rig_a')
    """
    folder = Path(folder)
    shipped_folder = shipped("datasets", "campaigns") / folder
    is_name = len(folder.parts) == 1 and not is_own_data(folder, CAMPAIGN_FILE)
    return shipped_folder if is_name and (shipped_folder / CAMPAIGN_FILE).is_file() else folder


class FrameTables(ModelPart):
    """A frame in place of the structure of one degree of freedom, by tables of `frame.toml`."""

    frame: dict[str, Any] = Field(description="Mass and stiffness, as `[frame]` of `frame.toml`")
    damping: dict[str, Any] = Field(description="Damping, as `[damping]` of `frame.toml`")
    specimen: dict[str, Any] = Field(description="Specimen and interface, as `[specimen]` of `frame.toml`")


class SamplingTable(ModelPart):
    """How all tests were sampled."""

    rate_hz: Annotated[float, Physical("sampling rate")] = Field(description="Samples in a second")


class TestTable(ModelPart):
    """A test; the table is repeated for each."""

    file: Annotated[str, Field(min_length=1)] = Field(
        description="File in the folder of the campaign, of any format that `reliab assess` reads"
    )
    test: Annotated[str, Field(max_length=200)] = Field(
        default="", description="Name of the test, where the file holds several"
    )
    motion: str = Field(default="", description="Kind of motion that drove the test")
    held_out: bool = Field(
        default=False,
        description="Whether the test is held out to verify what is found; if none is marked, the last "
        "one is",
    )

    @property
    def name(self) -> str:
        """File, and the test in it where it holds several."""
        return f"{self.file}, {self.test}" if self.test else self.file


def _kind_of_structure(table: object) -> str:
    """Distinguish a frame from a structure of one degree of freedom by its tables."""
    return "(frame)" if isinstance(table, dict) and "frame" in table else "(one_mode)"


class CampaignDescription(ModelPart):
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


def read_campaign(folder: Path | str) -> Campaign:
    """Read a campaign folder.

    Parameters
    ----------
    folder : path
        Folder with `campaign.toml` and the files of the tests, or the name of a campaign that ships
        ("rig_a").

    Returns
    -------
    Campaign
        The nominal model and the tests.

    Raises
    ------
    InputError
        If a file is missing or breaks a rule, or the tests are too long together; the message says where and
        what to do.
    """
    folder = campaign_folder(folder)
    description = _read_description(resolve_within(folder, CAMPAIGN_FILE, where=str(folder)))
    _check_files(folder, description.tests)
    # Those that are marked, else the last one; of a single test only a third is held out.
    marked = [test.held_out for test in description.tests]
    held_out = marked if any(marked) and len(marked) > 1 else [False] * (len(marked) - 1) + [len(marked) > 1]
    rate = description.sampling.rate_hz
    channel_statements = StatedChannels(declarations=read_declarations(description.channels), rate_hz=rate)
    tests, samples = [], 0
    for test, out in zip(description.tests, held_out, strict=True):
        channels, notes = read_channels(folder / test.file, rate, channel_statements, test.test)
        tests.append(
            MeasuredTest(file=test.name, motion=test.motion, held_out=out, channels=channels, notes=notes)
        )
        samples += tests[-1].size
        if samples > MOST_SAMPLES:  # refused as soon as it is known, before it fills the memory
            raise InputError(
                f"The tests of a campaign may have {MOST_SAMPLES:,} samples together at most",
                value=f"{samples:,} in the first {len(tests)} of {len(description.tests)} tests",
                remedy="Resample them, keep the strong part of each, or name fewer tests",
                where=CAMPAIGN_FILE,
            )
    structure, actuator, specimen = description.structure, description.actuator, description.specimen
    one_mode = structure if isinstance(structure, StructureTable) else None
    return Campaign(
        name=description.name or folder.name,
        structure=None if one_mode is None else one_mode.build(),
        mass=(one_mode.mass_kg if one_mode else None) or 1.0,
        actuator=None if actuator is None else actuator.build(),
        specimen=None if specimen is None else specimen.build(),
        rate=rate,
        tests=tuple(tests),
        partition=_as_partition(structure, description) if isinstance(structure, FrameTables) else None,
    )


def _check_files(folder: Path, tests: list[TestTable]) -> None:
    """Refuse files outside the folder, and a test named twice: data that fit a model cannot verify it."""
    files: list[tuple[str, str]] = []
    for place, test in enumerate(tests, start=1):
        path = resolve_within(folder, test.file, where=f"{CAMPAIGN_FILE}, test {place}")
        files.append((os.path.realpath(path), test.test))
        if files[-1] in files[:-1]:
            raise InputError(
                "A file must be listed for one test only",
                value=repr(test.name),
                remedy="Remove the second one, or correct its name",
                where=f"{CAMPAIGN_FILE}, test {place}",
            )


def _as_partition(table: FrameTables, description: CampaignDescription) -> Partition:
    """Build the frame with its specimen, and refuse entries that are repeated or have no meaning."""
    if description.specimen is not None:
        raise InputError(
            "The specimen of a frame must be described in [structure.specimen]",
            value="a further table [specimen]",
            remedy="Leave [specimen] out",
            where=CAMPAIGN_FILE,
        )
    partition = require_one_actuator(
        frame_of_tables(table.model_dump(), CAMPAIGN_FILE), CAMPAIGN_FILE
    ).partition
    if partition.effects:
        raise InputError(
            "The nominal specimen of a campaign must be linear; a diagnosis finds its nonlinear effects",
            value=", ".join(effect.name for effect in partition.effects),
            remedy="Leave [[structure.specimen.effects]] out",
            where=CAMPAIGN_FILE,
        )
    return partition


def _read_description(path: Path) -> CampaignDescription:
    rule, remedy = (
        f"A campaign must be a folder with a readable {CAMPAIGN_FILE}",
        f"Name a folder that holds {CAMPAIGN_FILE} and its tests, or rig_a, which comes with reliab",
    )
    text = read_description(path, rule=rule, remedy=remedy)
    content = parse_toml(text, rule=rule, remedy=remedy, where=str(path))
    try:
        return CampaignDescription.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        line = _line_of(text, keys_of(first["loc"]))
        rule = "A campaign must be described by known keys with allowed values"
        raise InputError(
            "A campaign must have at least one test" if first["type"] == "too_short" else rule,
            value=faults_in_words(error),
            remedy="Compare with datasets/campaigns/README.md, which `reliab samples` writes",
            where=f"{path.name}, line {line}" if line else path.name,
        ) from error


def _line_of(text: str, location: list[str]) -> int | None:
    """Line of a key, as far as it follows from its name and the order of its table."""
    names = [key for key in location if not key.isdigit()]
    if not names:
        return None
    lines, begin = text.splitlines(), 0
    if len(names) > 1:
        heading = re.compile(rf"\s*\[+\s*{re.escape(names[0])}\s*\]+")
        tables = [number for number, line in enumerate(lines) if heading.match(line)]
        begin = dict(enumerate(tables)).get(next((int(key) for key in location if key.isdigit()), 0), 0)
    key = re.compile(rf"\s*\[*\s*{re.escape(names[-1])}\b")
    matches = (number for number in range(begin, len(lines)) if key.match(lines[number]))
    return next(matches, begin or -1) + 1 or None
