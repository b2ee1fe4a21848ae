"""The channels of one test of a campaign, from any file of a laboratory."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.campaign.campaign import Channel
from reliab.errors import InputError
from reliab.recordings import (
    FEWEST_SAMPLES,
    LARGEST_READING,
    Histories,
    Part,
    StatedChannels,
    histories_of,
    read_test,
)

_CHANNELS: Final[Mapping[str, Channel]] = {
    str(Part.GROUND): Channel.GROUND,
    str(Part.COMMAND): Channel.COMMAND,
    str(Part.MEASURED): Channel.MEASURED,
    str(Part.FORCE): Channel.FORCE,
}
_RATE_TOLERANCE = 2e-3


def read_channels(
    path: Path, rate: float, said: StatedChannels, test: str = ""
) -> tuple[dict[Channel, NDArray[np.float64]], tuple[str, ...]]:
    """Read the channels of one test, in SI units, and what was assumed.

    `rate` [Hz]; `test` names one of several in the file.
    """
    histories = histories_of(read_test(path, test or None), said, needed=())
    where = histories.columns.where
    channels = {_CHANNELS[key]: values for key, values in histories.values.items() if key in _CHANNELS}
    _require_units(histories)
    if not channels:
        raise InputError(
            "A test of a campaign must hold channels of one actuator",
            value=", ".join(histories.channels),
            remedy="Name its columns under [channels] in campaign.toml",
            where=where,
        )
    for channel, values in channels.items():
        _require_numbers(values, channel, where)
    if abs(histories.time_step * rate - 1.0) > _RATE_TOLERANCE:
        raise InputError(
            "The times must agree with rate_hz of campaign.toml",
            value=f"{1.0 / histories.time_step:.6g} Hz against {rate:g} Hz",
            remedy="Correct rate_hz, or state the unit of the times",
            where=where,
        )
    return channels, histories.notes


def _require_units(histories: Histories) -> None:
    for key, channel in histories.channels.items():
        if key in _CHANNELS and not channel.unit:
            raise InputError(
                "A channel of a campaign must state its unit",
                value=repr(channel.column),
                remedy=f"Name it {_CHANNELS[key]}, or state its unit under [channels] in campaign.toml",
                where=histories.columns.where,
            )


def _require_numbers(values: NDArray[np.float64], channel: Channel, where: str) -> None:
    if values.size < FEWEST_SAMPLES:
        raise InputError(
            f"A test must have at least {FEWEST_SAMPLES} samples",
            value=values.size,
            remedy="Leave it out, or record longer",
            where=where,
        )
    wrong = np.flatnonzero(~(np.abs(values) < LARGEST_READING))
    if wrong.size:
        raise InputError(
            f"Every value must be a finite number below {LARGEST_READING:g}",
            value=f"{values[wrong[0]]:g} in {channel}, sample {wrong[0] + 1}",
            remedy="Repair the recording",
            where=where,
        )
