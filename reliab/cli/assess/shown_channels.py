"""Which columns of a file were taken as what: one line on the terminal."""

from collections.abc import Sequence
from typing import Any

from reliab.cli.output import say


def show_channels(channels: Sequence[dict[str, Any]]) -> None:
    """Print the columns that were recognised, each with its unit and the reason."""
    if channels:
        read = (f"{channel['channel']} = {_column(channel)}" for channel in channels)
        say(f"Channels: {'; '.join(read)}.")


def _column(channel: dict[str, Any]) -> str:
    unit = channel["unit"] or "no unit"
    return f"{channel['column']!r} ({unit}; {channel['reason']})"
