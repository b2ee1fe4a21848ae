"""Where a criterion comes from, and for which tests it is valid."""

import csv
import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.shipped import shipped
from reliab.core.significant_digits import share_in_words, significant
from reliab.core.vocabulary import CurveName
from reliab.criterion.ellipse_table import Ellipses, EllipseTable, as_table
from reliab.version import __version__

SCHEMA_VERSION = 2
"""Version of the JSON of a criterion; version 1 had neither limits for leads nor inscribed ellipses."""

_SYNTHETIC = re.compile(r"SYN\d{3,}")  # as `reliab.motions.synthetic` names its earthquakes


def read_versions() -> dict[str, str]:
    """Versions of the packages that computed a criterion; without those that are not installed."""
    return dict(_versions())


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    versions = [("reliab", __version__), ("numpy", np.__version__), ("scipy", scipy.__version__)]
    with suppress(PackageNotFoundError):
        versions.append(("xarray", version("xarray")))
    return tuple(versions)


@dataclass(frozen=True, kw_only=True)
class Provenance:
    """Source of the ellipses, what was computed with, and what should be known before use."""

    source: str  # Where the ellipses came from, in words
    # Kind of the motions, "ground motions" or "synthetic ground motions", for headlines
    motions: str = "ground motions"
    n_motions: int = 0  # n_motions, n_events: Motions and earthquakes behind the criterion
    n_events: int = 0
    # SHA-256 over the sorted checksums of all records (or over a and b where records are unknown)
    records_checksum: str = ""
    window: str = "record"  # Stretch of the record over which the error was taken
    # Share α of the stiffness in the laboratory [-] for which the boundaries were computed
    experimental_fraction: float = 1.0
    # Ellipses behind the limits: "inscribed" in the motions' boundaries, or "ellipse", fitted to them
    curve: str = CurveName.ELLIPSE
    packages: dict[str, str] = field(default_factory=read_versions)  # Package versions
    settings: dict[str, Any] = field(default_factory=dict)  # Parameters of the method
    warnings: tuple[str, ...] = ()  # Plain sentences for the user
    population: str = ""  # The ground motions for which the criterion speaks, as the end of a sentence
    # Least value, 5 % and 95 % quantile and greatest value over these motions of what is known of them:
    # `magnitude`, `length` [s], `cycles`, and of responses `effective_duration` [s], `frequency_ratio` and
    # `sensitivity` [-]
    scope: dict[str, list[float]] = field(default_factory=dict)
    # Where the case that the criterion was carried to lies among them: "inside", "at the edge", "outside"
    position: str = "inside"
    # Share of the population's ground motions [-] from which one is promised: smaller ones cannot be kept
    promised_from: float = 0.0


def kind_of_motions(events: Sequence[str]) -> str:
    """Say whether motions are those of the built-in synthetic suite, by the names of their earthquakes.

    Returns "synthetic ground motions" if all are synthetic, "partly synthetic ground motions" if some are,
    and "ground motions" otherwise.

    >>> kind_of_motions(["SYN001", "SYN002"]), kind_of_motions(["KOBE", "SYN002"]), kind_of_motions(["KOBE"])
    ('synthetic ground motions', 'partly synthetic ground motions', 'ground motions')
    """
    synthetic = [_SYNTHETIC.fullmatch(event) is not None for event in events]
    if synthetic and all(synthetic):
        return "synthetic ground motions"
    return "partly synthetic ground motions" if any(synthetic) else "ground motions"


def records_checksum(ellipses: Ellipses) -> str:
    """One checksum for all records behind ellipses, whatever their order.

    `ellipses`: ellipses with the coordinate `checksum`; without it, the values of a and b stand for the
    records.
    """
    if isinstance(ellipses, EllipseTable):
        checksums, pair = ellipses.motion_values.get("checksum"), (ellipses.a, ellipses.b)
    else:
        checksums = ellipses["checksum"].values if "checksum" in ellipses.coords else None
        pair = (ellipses["a"].values, ellipses["b"].values)
    if checksums is not None:
        parts = sorted(str(checksum) for checksum in checksums)
    else:
        parts = [values.astype("<f8").tobytes().hex() for values in pair]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


_TABLE = "real_suite/earthquakes.csv"
_NAMES = {
    "magnitude": ("magnitude", ""),
    "length": ("length of the record", " s"),
    "effective_duration": ("effective duration of the response", " s"),
    "cycles": ("number of cycles", ""),
    "frequency_ratio": ("ratio of the error's frequency to the structure's", ""),
    "sensitivity": ("error that an amplitude error of ξ would cause", ""),
}


def confidence_to_promise(confidence: float, position: str, least: float) -> float | None:
    """Tell which share of a population's ground motions a criterion promises.

    `confidence`: share that was asked for [-]; `position`: where the case lies among the population, one of
    :class:`Position`; `least`: share from which one can be kept [-]. Returns the share; None outside of the
    population, and for a share below the least.

    >>> confidence_to_promise(0.95, "inside", 0.8)
    0.95
    >>> confidence_to_promise(0.95, "outside", 0.8), confidence_to_promise(0.5, "inside", 0.8)
    (None, None)
    """
    return None if position == Position.OUTSIDE or confidence < least else confidence


class Position(StrEnum):
    """Where a test lies among the motions behind a criterion."""

    INSIDE = "inside"
    EDGE = "at the edge"
    OUTSIDE = "outside"


_PLACES = {Position.EDGE: "at the edge of", Position.OUTSIDE: "outside"}


@dataclass(frozen=True, kw_only=True)
class ScopeComparison:
    """A test compared with the motions behind a criterion."""

    position: Position  # The least favourable of all quantities
    sentences: tuple[str, ...]  # One for each quantity that is not inside


def compare_with_scope(scope: Mapping[str, Sequence[float]], test: Mapping[str, float]) -> ScopeComparison:
    r"""Tell whether a test lies among the motions behind a criterion.

    `scope`: least value, 5 % and 95 % quantile and greatest value over the motions of each quantity, as a
    criterion's provenance holds them: `magnitude`, `length` [s], `cycles`, and those of responses:
    `effective_duration` [s], `frequency_ratio` [-], `sensitivity` [-]; `test`: the same quantities of the
    test, those that are known. Inside between the 5 % and 95 % quantiles, at the edge between the
    least and the greatest value, outside beyond them; of several quantities the least favourable.

    >>> compared = compare_with_scope({"length": (10.0, 20.0, 90.0, 100.0)}, {"length": 8.0})
    >>> print(compared.position, *compared.sentences, sep="\n")
    outside
    The length of the record, 8 s, is outside the range of the motions behind the criterion (10 to 100 s).
    """
    positions, sentences = [Position.INSIDE], []
    for name, value in test.items():
        if name not in scope:
            continue
        least, low, high, greatest = scope[name]
        position = Position.INSIDE if low <= value <= high else Position.EDGE
        position = position if least <= value <= greatest else Position.OUTSIDE
        positions.append(position)
        if position is not Position.INSIDE:
            words, unit = _NAMES[name]
            sentences.append(
                f"The {words}, {significant(value)}{unit}, is {_PLACES[position]} the range of the motions "
                f"behind the criterion ({significant(least)} to {significant(greatest)}{unit})."
            )
    worst = max(positions, key=list(Position).index)
    return ScopeComparison(position=worst, sentences=tuple(sentences))


def scope_of(
    ellipses: Ellipses, response_measures: Mapping[str, Array] | None = None
) -> dict[str, list[float]]:
    """Least value, 5 % and 95 % quantile and greatest value of what is known of a population's motions.

    `response_measures`: what is known of the responses to them, by its name.
    """
    table = as_table(ellipses)
    ranges: dict[str, list[float]] = {}
    magnitudes = magnitudes_of(table.events.tolist())
    if magnitudes is not None:
        ranges["magnitude"] = range_of(magnitudes)
    if "duration" in table.motion_values:
        lengths = table.motion_values["duration"].astype(np.float64)
        ranges["length"] = range_of(lengths)
        ranges["cycles"] = range_of(np.outer(lengths, table.coordinates["f"]))
    return {**ranges, **{name: range_of(values) for name, values in (response_measures or {}).items()}}


def population_of(ellipses: Ellipses) -> str:
    """Say in one sentence of which ground motions a population consists."""
    table = as_table(ellipses)
    events = np.unique(table.events)
    sentence = f"{table.n_motions} ground motions of {events.size} earthquakes"
    scope = table.attrs.get("scope") or scope_of(table)
    if "magnitude" in scope:
        sentence += f" of magnitude {scope['magnitude'][0]:.1f} to {scope['magnitude'][3]:.1f}"
    if "length" in scope:
        sentence += f", records of {scope['length'][0]:.0f} to {scope['length'][3]:.0f} s"
    carried_population = table.attrs.get("carried_to")
    return f"{sentence}, {carried_population}" if carried_population else sentence


def populations_in_words(shares_with_population: Iterable[tuple[float | None, str]]) -> list[str]:
    r"""Say for which ground motions criteria are valid, given by the share of each [-] and its population.

    A share is None where nothing is promised.

    >>> print(*populations_in_words([(0.5, "all lengths"), (0.95, "every length")]), sep="\n")
    At 50 %, valid for ground motions like these: all lengths.
    At 95 %, valid for ground motions like these: every length.
    """
    shares: dict[str, list[str]] = {}
    for share, population in shares_with_population:
        if population:
            shares.setdefault(population, []).append(share_in_words(share))
    if len(shares) == 1:
        return [f"Valid for ground motions like these: {population}." for population in shares]
    return [
        f"At {' and '.join(dict.fromkeys(share_list))}, valid for ground motions like these: {population}."
        for population, share_list in shares.items()
    ]


def magnitudes_of(events: Sequence[str]) -> list[float] | None:
    """Magnitude of each motion's earthquake; None unless all are earthquakes of the shipped table."""
    table = _earthquakes()
    return [float(table[event]["magnitude"]) for event in events] if set(events) <= set(table) else None


def regions_of(events: Sequence[str]) -> list[str] | None:
    """Region of each motion's earthquake; None unless all are earthquakes of the shipped table."""
    table = _earthquakes()
    return [table[event]["region"] for event in events] if set(events) <= set(table) else None


@cache
def _earthquakes() -> dict[str, dict[str, str]]:
    """Rows of the shipped table by the name of the earthquake."""
    with shipped("datasets", _TABLE).open(encoding="utf-8", newline="") as file:
        return {row["event"]: row for row in csv.DictReader(file)}


def range_of(values: Sequence[float] | Array) -> list[float]:
    """Least value, 5 % and 95 % quantile and greatest value."""
    return [float(value) for value in np.quantile(np.asarray(values), (0.0, 0.05, 0.95, 1.0))]
