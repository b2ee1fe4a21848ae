"""Options by which a test is judged, of every command that judges tests: structure, channels, criterion."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from glob import glob
from pathlib import Path
from typing import ClassVar, TypeVar

from reliab.cli.completion import metrics
from reliab.cli.demand import Demand, option
from reliab.cli.options import (
    CHANNEL_SKEW,
    CRITERION_FILE,
    EQUIPMENT_FILE,
    ERROR_THRESHOLD,
    FEEDBACK_LAG,
    HELD_BY_FORCE,
    MASS_OF_STRUCTURE,
    SENSOR_SCALE,
    SPECIMEN_KNOWN,
    STATED_DAMPING_RATIO,
    STATED_SHARE,
    STRUCTURE_FILE,
    TAKEN_AS_EXACT,
)
from reliab.errors import InputError

_Value = TypeVar("_Value")


@dataclass(frozen=True, kw_only=True)
class JudgesTests(Demand):
    """Options of a command that judges tests; arguments of `reliab.assess`."""

    f: list[str] | None = option("HZ", "Natural frequency, 1 or with its standard deviation 1±0.01.")
    xi: str | None = STATED_DAMPING_RATIO
    alpha: str | None = STATED_SHARE
    scale: str | None = SENSOR_SCALE
    feedback_lag: str | None = FEEDBACK_LAG
    mass: str | None = MASS_OF_STRUCTURE
    skew: str | None = CHANNEL_SKEW
    command_scale: str | None = option("RATIO", "Scale of the command, 1±0.001.")
    hysteresis: str | None = option(
        "SHARE", "Hysteresis of the displacement sensor: width of its loop over the span, 0.001±0.0003."
    )
    resolution: str | None = option("MM", "Step of the converter of the measured displacement [mm].")
    filter: list[str] | None = option(
        "CHANNEL=HZ", "Low-pass filters before the converters: measured=200, command=200/4 with the order."
    )
    equipment: Path | None = EQUIPMENT_FILE
    exact: bool = TAKEN_AS_EXACT
    motion: Path | None = option(
        "FILE",
        "Ground motion of the test; the index is then judged by the boundary of this motion, or "
        "errors of a frame's floors and storeys are stated over their own peaks.",
    )
    criterion: Path | None = CRITERION_FILE
    model: Path | None = option(
        "MODEL.toml", "Model of a nonlinear specimen, as `reliab diagnose` writes it."
    )
    specimen: str | None = SPECIMEN_KNOWN
    force_channel: list[str] | None = HELD_BY_FORCE
    structure: Path | None = STRUCTURE_FILE
    threshold: float | None = ERROR_THRESHOLD
    confidence: list[float] | None = option("SHARE", "Share of the population's ground motions, 0.95.")
    metric: str | None = option(
        "rms|mte", "Error of the whole test: RMS^R (default) or MTE^R.", autocompletion=metrics
    )

    idle_beside: ClassVar[Mapping[str, Collection[str]]] = {
        "criterion": ("threshold", "confidence", "metric"),
        "structure": ("f", "xi", "alpha", "mass", "model", "confidence"),
    }


def files_of(tests: Sequence[Path] | None, out: Path | None) -> list[Path]:
    """Files of the tests, also those that a pattern such as ``*.csv`` names where the shell does not."""
    files = []
    for path in tests or []:
        names = [] if path.exists() else glob(str(path))  # noqa: PTH207 - absolute patterns too
        files += [Path(name) for name in sorted(names)] or [path]
    return [file for file in files if file != out]


def only_value(values: Sequence[_Value] | None, name: str) -> _Value | None:
    """Take the value of an option that may be repeated for a design, but not for a test."""
    if not values:
        return None
    if len(values) > 1:
        raise InputError(
            f"A test has one `{name}`", value=len(values), remedy="Give several with `design` only"
        )
    return values[0]
