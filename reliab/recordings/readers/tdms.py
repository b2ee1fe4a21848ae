"""LabVIEW TDMS files, through npTDMS; the properties of a waveform give unit, begin and step."""

import logging
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from reliab.core.errors import InputError
from reliab.core.files import LIMITS
from reliab.recordings.readers.columns import Columns, Series, seconds, series_of, start_of
from reliab.recordings.readers.layouts import Tree, tests_of_tree
from reliab.recordings.recording import require_few_samples

_SIGNATURE: Final = b"TDSm"
_DECIMATED_GROUP: Final = re.compile(r"Decimated Data_Level\d+$")  # thinned copies beside a test
_SCALE: Final = re.compile(r"NI_Scale\[\d+\]_Scale_Type")
_KNOWN_SCALES: Final = frozenset(
    (
        "Linear",
        "Polynomial",
        "Table",
        "Strain",
        "RTD",
        "Thermistor",
        "Thermocouple",
        "Add",
        "Subtract",
        "AdvancedAPI",
    )
)
_LONGEST: Final = 40  # characters of a property that a message repeats
_INCOMPLETE: Final = "The file ends within its last segment, as after a logger that was stopped."


def recognises(head: bytes) -> bool:
    """Whether a file begins as TDMS."""
    return head.startswith(_SIGNATURE)


def read_tdms(path: Path, _delimiter: str | None = None) -> list[Columns]:
    """Read the groups of a TDMS file."""
    try:
        from nptdms import TdmsFile
        from nptdms.log import log_manager
    except ModuleNotFoundError:
        raise InputError(
            "TDMS needs the library npTDMS, which is not installed",
            remedy='Install it with pip install "reliab[recordings]", or export the test as text',
            where=path.name,
        ) from None
    log_manager.set_level(logging.CRITICAL)  # what npTDMS notices of a file becomes a note or an error
    with path.open("rb") as file, TdmsFile.open(file) as content:
        groups = [group for group in content.groups() if not _DECIMATED_GROUP.search(group.name)]
        groups = groups or content.groups()
        _require_bounded([channel for group in groups for channel in group.channels()], path)
        tree: dict[str, Tree] = {}
        for group in groups:
            tree[group.name] = _group(group, content.properties)
        tests = tests_of_tree(path, tree if len(tree) != 1 else next(iter(tree.values())))
        incomplete = content.file_status.incomplete_final_segment
    return [replace(test, notes=(_INCOMPLETE,)) for test in tests] if incomplete else tests


def _require_bounded(channels: list[Any], path: Path) -> None:
    """Refuse what would not fit in memory, before it is read."""
    for channel in channels:
        require_few_samples(len(channel), f"{path.name}, {channel.name}")
    LIMITS["test"].require_few_numbers(8 * sum(map(len, channels)), path.name)


def _group(group: Any, file_properties: Mapping[str, object]) -> dict[str, Tree]:  # noqa: ANN401 - npTDMS is untyped
    tree: dict[str, Tree] = {
        name: np.asarray(value) for name, value in group.properties.items() if isinstance(value, int | float)
    }
    for channel in group.channels():
        series = _series(channel, {**file_properties, **group.properties})
        if series is not None:
            tree[channel.name] = series
    return tree


def _series(channel: Any, inherited: Mapping[str, object]) -> Series | None:  # noqa: ANN401
    """History of a channel; None where it has no numbers. `inherited`: properties of group and file."""
    if channel.data_type is None or len(channel) < 2:  # noqa: PLR2004 - a single number is no history
        return None
    values = np.asarray(channel[:])
    if values.dtype.kind == "M":
        return Series(values=seconds(values), unit="s", start=start_of(values))
    if values.dtype.kind not in "iufb":
        return None
    return _list_scales(series_of(values, channel.properties), {**inherited, **channel.properties})


def _list_scales(series: Series, attributes: Mapping[str, object]) -> Series:
    """List the scales that npTDMS has applied; without a word it applies none where it does not know one."""
    kinds = {str(kind) for name, kind in attributes.items() if _SCALE.fullmatch(name)}
    if not kinds or attributes.get("NI_Scaling_Status") == "scaled":
        return series
    if unknown := sorted(kinds - _KNOWN_SCALES):
        return replace(series, unclear=f"a scale of the type {unknown[0][:_LONGEST]!r}")
    return replace(
        series, corrections=(*series.corrections, f"scale of the file ({', '.join(sorted(kinds))})")
    )
