"""How far each quantity of a test may be off: as stated, or as the equipment of a laboratory leaves it."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from enum import StrEnum
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.core.described_files import parse_toml, read_toml
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.stated_value import require_physical
from reliab.core.vocabulary import MILLI

if TYPE_CHECKING:
    from reliab.simulation.frames.frame_file import FrameUnderTest

_SLOW = 1.0 / 1000.0  # s: controllers of real-time hybrid tests mostly run at 1024 Hz and more
_RULE = "A laboratory's sizes are a TOML file of numbers that are not negative"
_REMEDY = "Write for example xi = 0.1, with the names of reliab/assessment/budget/defaults.toml"


_QUANTITIES: Mapping[str, str] = {
    **dict.fromkeys(
        ("f", "xi", "alpha", "scale", "hysteresis", "ground_scale", "force_scale"),
        "relative standard deviation",
    ),
    **dict.fromkeys(("skew_ms", "filter_delay_ms", "feedback_lag_ms"), "time"),
    "skew_samples": "skew",
    "yielding": "probability",
    "integration": "number",
}


@dataclass(frozen=True, kw_only=True)
class Equipment:
    """Uncertainties of a test from equipment and preparation, one standard deviation each.

    >>> ordinary_equipment().xi
    0.15
    """

    # f, xi, alpha, scale: Of natural frequency, damping ratio, share of the stiffness in the laboratory and
    # scale of the measured displacement over the command, relative [-]
    f: float
    xi: float
    alpha: float
    scale: float
    # skew_samples, skew_ms: Of the skew between the channels, as a share of a sample, and its largest value
    # [ms]; None where nobody said how fast the converters of a slow recording ran
    skew_samples: float
    # filter_delay_ms, feedback_lag_ms: Of the delay that filters of the channels do not have in common, and
    # of the force's lag [ms]
    filter_delay_ms: float
    hysteresis: float  # Of the measured displacement, width of the loop over the span of the motion [-]
    feedback_lag_ms: float
    # Probability that a specimen yielded whose force was not recorded and of which nothing is stated [-]
    yielding: float
    skew_ms: float | None = None
    # ground_scale, force_scale: Of the recorded ground acceleration, and of the recorded force over the mass,
    # relative [-]
    ground_scale: float = 0.003
    force_scale: float = 0.01
    integration: float = 0.3  # Of the error of a time step, over (ω·step)² of the specimen's force [-]

    def __post_init__(self) -> None:
        for size in fields(self):
            if (value := getattr(self, size.name)) is not None:
                require_physical(_QUANTITIES[size.name], value, zero=True, label=f"size {size.name}")

    @property
    def is_exact(self) -> bool:
        """Whether whatever a test does not state is taken as exact."""
        return self == exact_equipment()

    def skew(self, time_step: float) -> float:
        """Skew of channels that are recorded at a time step [s], in seconds."""
        sample_skew = self.skew_samples * time_step
        return sample_skew if self.skew_ms is None else min(sample_skew, self.skew_ms / MILLI)

    def fix_skew(self, time_step: float) -> "Equipment":
        """Fix the skew at that of channels recorded at a time step [s], whatever joins their samples."""
        return replace(self, skew_ms=MILLI * self.skew(time_step))

    def doubt_of_skew(self, time_step: float) -> str:
        """Say what is assumed of the skew of a recording below 1000 Hz; empty where its largest is stated."""
        if self.skew_ms is not None or time_step <= _SLOW:
            return ""
        return (
            f"No skew stated: ±{significant(MILLI * self.skew(time_step), 2)} ms is assumed, as for "
            f"converters at the {significant(1.0 / time_step, 3)} Hz of this recording. If a faster "
            "controller sampled the channels, give its `skew`."
        )


@cache
def ordinary_equipment() -> Equipment:
    """Read the sizes of ordinary equipment, with their sources: `reliab/assessment/budget/defaults.toml`."""
    text = files(__package__).joinpath("defaults.toml").read_text(encoding="utf-8")
    return Equipment(**parse_toml(text, rule=_RULE, remedy=_REMEDY, where="defaults.toml"))


@cache
def exact_equipment() -> Equipment:
    """Take whatever a test does not state as exact: channels, structure and specimen."""
    return Equipment(**{size.name: 0.0 for size in fields(Equipment) if size.default is not None})


def read_equipment(path: str | Path) -> Equipment:
    """Read the sizes of a laboratory's own equipment, a TOML file with the names of `defaults.toml`.

    Those that it leaves out stay as they ship; another name, or a negative number, is refused.
    """
    sizes = read_toml(path, rule=_RULE, remedy=_REMEDY)
    for name, value in sizes.items():
        if name not in _QUANTITIES or isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(_RULE, value=f"{name} = {value!r}", remedy=_REMEDY, where=str(path))
    try:
        return replace(ordinary_equipment(), **sizes)
    except InputError as error:
        raise error.at(str(path)) from None


class PriorSource(StrEnum):
    """Where a size comes from."""

    STATED = "stated"
    LEARNED = "learned from this test"
    DEFAULT = "default"


DEVIATION_OF_HYSTERESIS = 0.2
"""Of a hysteresis that is stated without its deviation, as a calibration gives it [-]."""


_LARGEST_ASSUMED = 0.99


_REPLACED_QUANTITIES = {  # what is not assumed of the whole where parts of the structure are stated
    "damping": "damping_ratio",
    "floor_mass": "frequency",
    "storey_stiffness": "frequency",
    "storey_damping": "damping_ratio",
    "mode_frequency": "frequency",
    "mass_entry": "frequency",
    "stiffness_entry": "frequency",
    "damping_entry": "damping_ratio",
    "mode_damping_ratio": "damping_ratio",
    "specimen_stiffness": "experimental_fraction",
}


WHOLE_QUANTITIES = ("frequency", "damping_ratio", "experimental_fraction")
"""Quantities of the whole structure, which a calibrated model knows."""


def tolerances_of_structure(frame: "FrameUnderTest | None", *, calibrated: bool) -> dict[str, float]:
    """Relative standard deviations that a frame's file states, by names of quantities and parts.

    A factor of M acts as its inverse does on C, K and k_e. Where parts of the structure are stated, nothing
    is assumed of the whole beside them. `calibrated`: whether a model knows the whole structure.
    """
    known = dict.fromkeys(WHOLE_QUANTITIES, 0.0) if calibrated else {}
    if frame is None:
        return known
    tolerances = frame.tolerances
    parts = tolerances.part_deviations(frame.partition.size)
    deviations = {
        "frequency": tolerances.frequency_deviation,
        "damping_ratio": tolerances.damping_ratio,
        "experimental_fraction": tolerances.specimen_deviation,
    }
    replaced_quantities = {_REPLACED_QUANTITIES[name.rstrip("_0123456789")] for name in parts}
    return known | {
        name: deviation
        for name, deviation in {**deviations, **parts}.items()
        if deviation or name in replaced_quantities
    }


def limit_certainty(probability: float, *, assumed: bool) -> float:
    """Limit a probability to 0.01 to 0.99 where sizes are assumed: rare sizes are not known so well."""
    if assumed:
        return min(max(probability, 1.0 - _LARGEST_ASSUMED), _LARGEST_ASSUMED)
    return probability
