"""Sizes of what a laboratory's equipment leaves unknown, for tests that state nothing themselves."""

from dataclasses import dataclass, fields, replace
from functools import cache
from importlib.resources import files
from pathlib import Path

from reliab.described_files import parse_toml, read_toml
from reliab.errors import InputError
from reliab.significant import significant
from reliab.vocabulary import MILLI

_SLOW = 1.0 / 1000.0  # s: controllers of real-time hybrid tests mostly run at 1024 Hz and more
_RULE = "A laboratory's sizes are a TOML file of numbers that are not negative"
_REMEDY = "Write for example xi = 0.1, with the names of reliab/assessment/budget/defaults.toml"


@dataclass(frozen=True, kw_only=True)
class Equipment:
    """What equipment and preparation leave unknown of a test, one standard deviation each.

    Attributes
    ----------
    f, xi, alpha, scale : float
        Of natural frequency, damping ratio, share of the stiffness in the laboratory and scale of the
        measured displacement over the command, relative [-].
    skew_samples : float
    skew_ms : float or None
        Of the skew between the channels, as a share of a sample, and its largest value [ms]; None where
        nobody said how fast the converters of a slow recording ran.
    filter_delay_ms, feedback_lag_ms : float
        Of the delay that filters of the channels do not have in common, and of the force's lag [ms].
    hysteresis : float
        Of the measured displacement, width of the loop over the span of the motion [-].
    yielding : float
        Probability that a specimen yielded whose force was not recorded and of which nothing is stated [-].

    Examples
    --------
    >>> ordinary_equipment().xi
    0.15
    """

    f: float
    xi: float
    alpha: float
    scale: float
    skew_samples: float
    filter_delay_ms: float
    hysteresis: float
    feedback_lag_ms: float
    yielding: float
    skew_ms: float | None = None

    def skew(self, time_step: float) -> float:
        """Skew of channels that are recorded at a time step [s], in seconds."""
        of_samples = self.skew_samples * time_step
        return of_samples if self.skew_ms is None else min(of_samples, self.skew_ms / MILLI)

    def doubt_of_skew(self, time_step: float) -> str:
        """Say what is assumed of the skew of a recording below 1000 Hz; empty where its largest is stated."""
        if self.skew_ms is not None or time_step <= _SLOW:
            return ""
        return (
            f"The recording has {significant(1.0 / time_step, 3)} samples a second, and the skew of its "
            f"channels was not stated: {significant(MILLI * self.skew(time_step), 2)} ms is assumed, one "
            "standard deviation, as converters have it that run no faster. Where it was thinned from a "
            "faster controller, state the skew of that, for the test or in the file of its equipment."
        )


@cache
def ordinary_equipment() -> Equipment:
    """Read the sizes of ordinary equipment, `reliab/assessment/budget/defaults.toml`.

    Returns
    -------
    Equipment
        With their sources beside them in the file.
    """
    text = files(__package__).joinpath("defaults.toml").read_text(encoding="utf-8")
    return Equipment(**parse_toml(text, rule=_RULE, remedy=_REMEDY, where="defaults.toml"))


def read_equipment(path: str | Path) -> Equipment:
    """Read the sizes of a laboratory's own equipment.

    Parameters
    ----------
    path : str or pathlib.Path
        A TOML file with the names of `defaults.toml`; those that it leaves out stay as they ship.

    Returns
    -------
    Equipment
        Its sizes.

    Raises
    ------
    InputError
        If the file cannot be read, or a name or number in it is not one of these.
    """
    sizes = read_toml(path, rule=_RULE, remedy=_REMEDY)
    known = {field.name for field in fields(Equipment)}
    for name, value in sizes.items():
        if name not in known or isinstance(value, bool) or not isinstance(value, int | float) or value < 0:
            raise InputError(_RULE, value=f"{name} = {value!r}", remedy=_REMEDY, where=str(path))
    return replace(ordinary_equipment(), **sizes)
