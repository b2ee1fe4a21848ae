"""Options by which a test is judged, of every command that judges tests: structure, channels, criterion."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from glob import glob
from pathlib import Path
from typing import Annotated, ClassVar, TypeVar

import typer

from reliab.cli.completion import metrics
from reliab.cli.demand import Demand
from reliab.cli.options import (
    ChannelSkew,
    CriterionFile,
    EquipmentFile,
    ErrorThreshold,
    FeedbackLag,
    HeldByForce,
    MassOfStructure,
    SensorScale,
    SpecimenKnown,
    StatedDampingRatio,
    StatedShare,
    StructureFile,
    TakenAsExact,
)
from reliab.errors import InputError

_Value = TypeVar("_Value")


@dataclass(frozen=True, kw_only=True)
class JudgesTests(Demand):
    """Options of a command that judges tests; arguments of `reliab.assess`."""

    f: Annotated[
        list[str] | None,
        typer.Option(
            "--f",
            metavar="HZ",
            help="Natural frequency, 1 or with its standard deviation 1±0.01.",
        ),
    ] = None
    xi: StatedDampingRatio = None
    alpha: StatedShare = None
    scale: SensorScale = None
    feedback_lag: FeedbackLag = None
    mass: MassOfStructure = None
    skew: ChannelSkew = None
    command_scale: Annotated[
        str | None, typer.Option("--command-scale", metavar="RATIO", help="Scale of the command, 1±0.001.")
    ] = None
    hysteresis: Annotated[
        str | None,
        typer.Option(
            "--hysteresis",
            metavar="SHARE",
            help="Hysteresis of the displacement sensor: width of its loop over the span, 0.001±0.0003.",
        ),
    ] = None
    resolution: Annotated[
        str | None,
        typer.Option(
            "--resolution", metavar="MM", help="Step of the converter of the measured displacement [mm]."
        ),
    ] = None
    filter: Annotated[
        list[str] | None,
        typer.Option(
            "--filter",
            metavar="CHANNEL=HZ",
            help="Low-pass filters before the converters: measured=200, command=200/4 with the order.",
        ),
    ] = None
    equipment: EquipmentFile = None
    exact: TakenAsExact = False
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion",
            metavar="FILE",
            help="Ground motion of the test; the index is then judged by the boundary of this motion, or "
            "errors of a frame's floors and storeys are stated over their own peaks.",
        ),
    ] = None
    criterion: CriterionFile = None
    model: Annotated[
        Path | None,
        typer.Option(
            "--model",
            metavar="MODEL.toml",
            help="Model of a nonlinear specimen, as `reliab diagnose` writes it.",
        ),
    ] = None
    specimen: SpecimenKnown = None
    force_channel: HeldByForce = None
    structure: StructureFile = None
    threshold: ErrorThreshold = None
    confidence: Annotated[
        list[float] | None,
        typer.Option(
            "--confidence",
            metavar="SHARE",
            help="Share of the population's ground motions, 0.95.",
        ),
    ] = None
    metric: Annotated[
        str | None,
        typer.Option(
            "--metric",
            autocompletion=metrics,
            metavar="rms|mte",
            help="Error of the whole test: RMS^R (default) or MTE^R.",
        ),
    ] = None

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
