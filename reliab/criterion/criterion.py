"""The criterion: how much amplitude error and delay a test may have."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array
from reliab.core.described_files import read_description
from reliab.core.errors import InputError
from reliab.core.plain_values import html_table
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import require_physical
from reliab.core.vocabulary import ERROR_NAMES, MILLI, PERCENT, Metric, Side
from reliab.criterion.laws.law import Law
from reliab.criterion.methods.method import validate_share
from reliab.criterion.population import Population
from reliab.criterion.scope import Provenance, confidence_to_promise

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

_SUMMARY_STRUCTURES = 20  # structures in a summary


@dataclass(frozen=True, kw_only=True)
class Criterion:
    """An ellipse (A − 1)²/a + d²/b ≤ 1 for each structure, with what it promises.

    A test whose indices lie inside has an error below `threshold` for a share `confidence` of ground
    motions, in the sense of `method`.

    Parameters
    ----------
    law : Law
        Limits a [-] and b [ms²] of a structure for an actuator that is late, d ≥ 0.
    lead_law : Law, optional
        The same for an actuator that is early, d < 0; None where nothing is known of leads.
    threshold : float
        Error of the whole test [-].
    metric : str
        Which error, "rms" or "mte".
    confidence : float
        Share of the population's ground motions, in (0, 1).
    method : str
        What the confidence means, by the name of a method.
    joint : bool
        Whether a and b hold together with the stated confidence, or each for itself.
    provenance : Provenance
        Where the criterion comes from.
    population, lead_population : Population, optional
        The motions behind it, from which probabilities follow; a published law has none.

    Raises
    ------
    InputError
        If the confidence is no share, the threshold not positive and finite, or the law for another error.

    Examples
    --------
    >>> from reliab.criterion.derivation import published_criterion
    >>> criterion = published_criterion("guo_2017_12")
    >>> round(float(criterion.index(1.004, 0.0005, 1.0, 0.02)), 3)
    0.542
    >>> Criterion.from_json(criterion.to_json()) == criterion
    True
    """

    law: Law
    lead_law: Law | None = None
    threshold: float
    metric: str
    confidence: float
    method: str
    joint: bool
    provenance: Provenance
    population: Population | None = field(default=None, compare=False)
    lead_population: Population | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        for law in (self.law, self.lead_law):
            if law is not None:
                law.validity.require_error(self.threshold, self.metric)
        validate_share(self.confidence, "confidence")
        Metric.parse(self.metric)
        require_physical("error threshold", self.threshold)

    def limits(
        self, frequency: ArrayLike, damping_ratio: ArrayLike, side: str = Side.LAG
    ) -> tuple[Array, Array]:
        """Ellipse parameters of structures.

        Parameters
        ----------
        frequency, damping_ratio : array_like
            Structures [Hz, -], broadcast against each other.
        side : str, optional
            "lag" for an actuator that is late, "lead" for one that is early.

        Returns
        -------
        a, b : numpy.ndarray
            Limits [-] and [ms²], finite; zero where no test is accepted.

        Raises
        ------
        InputError
            If a structure lies where the law does not hold, or the criterion has no limits for leads.
        """
        return self._law(side).limits(frequency, damping_ratio)

    def index(
        self, amplitude: ArrayLike, delay: ArrayLike, frequency: ArrayLike, damping_ratio: ArrayLike
    ) -> Array:
        """Index of reliability (A − 1)²/a + d²/b; a test is reliable up to 1.

        A negative delay is a lead and has limits of its own. The paper's printed laws have d² and no limits
        for leads: they count a lead as a lag of the same size.

        Parameters
        ----------
        amplitude : array_like
            Amplitude index A [-].
        delay : array_like
            Equivalent delay d [s], negative for a lead.
        frequency, damping_ratio : array_like
            The structure [Hz, -]; all four are broadcast against each other.

        Returns
        -------
        numpy.ndarray
            The index [-]; infinite where a limit is zero, since no test is accepted there.

        Raises
        ------
        InputError
            If an index of the test is not finite, a structure lies where the law does not hold, or a test
            leads and the criterion has no limits for leads.
        """
        offset, milliseconds, f, xi = _broadcast(amplitude, delay, frequency, damping_ratio)
        index = np.empty(offset.shape)
        for side, is_on_side in _sides(milliseconds):
            a, b = self.limits(f[is_on_side], xi[is_on_side], side)
            with np.errstate(divide="ignore", invalid="ignore"):
                sums = offset[is_on_side] ** 2 / a + milliseconds[is_on_side] ** 2 / b
            index[is_on_side] = np.where((a > 0.0) & (b > 0.0), sums, np.inf)
        return index

    def probability(
        self, amplitude: ArrayLike, delay: ArrayLike, frequency: ArrayLike, damping_ratio: ArrayLike
    ) -> Array:
        """Predictive probability that the error of a test stays below the threshold.

        Parameters
        ----------
        amplitude : array_like
            Amplitude index A [-].
        delay : array_like
            Equivalent delay d [s], negative for a lead.
        frequency, damping_ratio : array_like
            The structure [Hz, -]; all four are broadcast against each other.

        Returns
        -------
        numpy.ndarray
            Probability [-] over ground motions of further earthquakes.

        Raises
        ------
        InputError
            If the structure lies outside of what was simulated, the criterion was not derived from motions,
            or only from lags while a test leads.
        """
        if self.population is None:
            raise InputError(
                "This criterion gives no probability, since it has no ellipses of ground motions",
                value=f"the published law {self.law.name}",
                remedy="Derive a criterion from motions, a results store or a table of ellipses",
            )
        offset, milliseconds, f, xi = _broadcast(amplitude, delay, frequency, damping_ratio)
        probability = np.empty(offset.shape)
        for side, is_on_side in _sides(milliseconds):
            population = self.population if side == Side.LAG else self.lead_population
            if population is None:
                raise _no_leads()
            probability[is_on_side] = population.probability(
                1.0 + offset[is_on_side], milliseconds[is_on_side] / MILLI, f[is_on_side], xi[is_on_side]
            )
        return probability

    def plot(self, frequency: float = 1.0, damping_ratio: float = 0.02, axes: "Axes | None" = None) -> "Axes":
        """Draw the tolerable region of a structure [Hz, -]; returns its axes."""
        sides = tuple(Side) if self.knows_leads else (Side.LAG,)
        pairs = {side: self.limits(frequency, damping_ratio, side) for side in sides}
        return draw_region({side: (float(a), float(b)) for side, (a, b) in pairs.items()}, axes)

    @property
    def promise(self) -> float | None:
        """Share of the population's ground motions.

        None for a case that lies outside of the population, or a share too small to be kept.
        """
        return confidence_to_promise(self.confidence, self.provenance.position, self.provenance.promised_from)

    def to_dataframe(self) -> "pd.DataFrame":
        """Put the limits into a table, at the structures of the law's table, else at 1 Hz and 2 % damping."""
        import pandas as pd

        frequencies = getattr(self.law, "frequencies", (1.0,))
        ratios = getattr(self.law, "damping_ratios", (0.02,))
        rows = [(f, xi, *map(float, self.limits(f, xi))) for f in frequencies for xi in ratios]
        table = pd.DataFrame(rows, columns=["f", "xi", "a", "b"])
        return table.assign(amplitude_limit=np.sqrt(table["a"]), delay_limit_ms=np.sqrt(table["b"]))

    def summary(self) -> str:
        """Say what the criterion promises, and its limits as a table."""
        table = self.to_dataframe().to_string(
            index=False, max_rows=_SUMMARY_STRUCTURES, float_format="{:.4g}".format
        )
        return f"{repr(self).strip('<>')}\n{table}"

    def __repr__(self) -> str:
        return (
            f"<Criterion by {self.method}, law {self.law.name}: {ERROR_NAMES[Metric(self.metric)]} below "
            f"{self.threshold:g} for {self._share_in_words}>"
        )

    @property
    def _share_in_words(self) -> str:
        promise = self.promise
        share = "no stated share" if promise is None else significant(promise)
        return f"{share} of comparable ground motions"

    def _repr_html_(self) -> str:
        promise = {
            ERROR_NAMES[Metric(self.metric)]: f"below {percent(self.threshold)}",
            "confidence": f"{self._share_in_words}, by {self.method}",
            "limits": "a and b together" if self.joint else "a and b, separately",
        }
        return table_of_criterion(promise, self.law, self.provenance)

    def require_converged(self) -> None:
        """Refuse to decide by a posterior that has not converged."""
        if not self.provenance.settings.get("converged", True):
            raise InputError(
                "The posterior behind this criterion has not converged",
                value=f"one of the method {self.method}",
                remedy="Derive it again with more `steps`",
            )

    @property
    def knows_leads(self) -> bool:
        """Whether there are limits for tests that lead, or leads are counted as lags as the paper does."""
        return self.lead_law is not None or self.law.counts_leads_as_lags

    def _law(self, side: str) -> Law:
        if side == Side.LAG:
            return self.law
        if self.lead_law is not None:
            return self.lead_law
        if self.law.counts_leads_as_lags:
            return self.law
        raise _no_leads()

    def to_json(self) -> str:
        """Serialise with provenance; `from_json` reads it back."""
        from reliab.criterion.criterion_file import PLAIN, to_text

        return to_text(
            {name: getattr(self, name) for name in PLAIN},
            {name: getattr(self, name) for name in ("law", "lead_law")},
            {name: getattr(self, name) for name in ("population", "lead_population")},
            self.provenance,
        )

    @classmethod
    def from_json(cls, text: str) -> "Criterion":
        """Read a criterion that `to_json` wrote.

        Parameters
        ----------
        text : str
            The JSON.

        Returns
        -------
        Criterion
            The criterion.

        Raises
        ------
        InputError
            If the text is not such JSON, of another schema, lacks a key or has one too many, or holds a
            number that is not finite or limits that are no table.
        """
        from reliab.criterion.criterion_file import from_text

        return cls(**from_text(text))

    @classmethod
    def read(cls, path: str | Path) -> "Criterion":
        """Read a criterion's file; the errors of `from_json`, and one if it cannot be read."""
        rule, remedy = "A criterion's file must be readable", "Write one with `reliab criterion --out`"
        text = read_description(path, rule=rule, remedy=remedy, kind="criterion")
        from reliab.criterion.criterion_file import from_text

        return cls(**from_text(text, str(path)))


def _broadcast(
    amplitude: ArrayLike, delay: ArrayLike, frequency: ArrayLike, damping_ratio: ArrayLike
) -> tuple[Array, ...]:
    """Bring A − 1 [-], d [ms], f [Hz] and ξ [-] into one shape."""
    arrays = np.broadcast_arrays(
        *(np.asarray(values, dtype=np.float64) for values in (amplitude, delay, frequency, damping_ratio))
    )
    for name, values in (("amplitude A", arrays[0]), ("delay d", arrays[1])):
        if not np.isfinite(values).all():
            raise InputError(
                f"The {name} of a test must be finite",
                value=values[~np.isfinite(values)].flat[0],
                remedy="Check the recordings from which it was computed",
            )
    return arrays[0] - 1.0, MILLI * arrays[1], arrays[2], arrays[3]


def _sides(milliseconds: Array) -> list[tuple[str, NDArray[np.bool_]]]:
    """Sides of the tests with their delays, those with tests only."""
    lead = milliseconds < 0.0
    return [
        (side, is_on_side) for side, is_on_side in ((Side.LAG, ~lead), (Side.LEAD, lead)) if is_on_side.any()
    ]


def _no_leads() -> InputError:
    return InputError(
        "The measured displacement leads (d < 0), and the criterion has no limits for leads",
        remedy="Derive it again from records, stored results or ellipses that hold both sides",
    )


def table_of_criterion(promise: Mapping[str, str], law: Law, origin: Provenance) -> str:
    """Write what a criterion promises, by name, and where it comes from as a table in HTML."""
    rows = {
        **promise,
        "law": law.name,
        "natural frequency": _range(law.validity.frequency, "Hz"),
        "damping ratio": _range(law.validity.damping_ratio, ""),
        "motions": f"{origin.n_motions} of {origin.n_events} earthquakes",
        "window": origin.window,
    }
    return html_table("Criterion", rows, origin.warnings)


def _range(bounds: tuple[float, float], unit: str) -> str:
    low, high = bounds
    return f"{low:g} {unit}".strip() if low == high else f"{low:g} to {high:g} {unit}".strip()


def draw_region(limits: Mapping[Side, tuple[float, float]], axes: "Axes | None" = None) -> "Axes":
    """Draw the tolerable region of a structure.

    Lags and leads have an ellipse each, the largest inside the boundaries of its side. The boundaries of both
    sides meet on d = 0, their largest ellipses need not: the one for leads is a few per cent wider there. A
    test with d = 0 is judged as a lag.

    Returns with A − 1 [%] across and d [ms] upwards; a half of an ellipse for each side, with its limits
    beside its name.
    """
    from matplotlib import pyplot as plt

    plot_axes = plt.subplots(layout="constrained")[1] if axes is None else axes
    turn = np.linspace(0.0, np.pi, 181)
    for side, (a, b) in limits.items():
        name, sign = ("late", 1.0) if side is Side.LAG else ("early", -1.0)
        width, height = PERCENT * np.sqrt(a), np.sqrt(b)
        x_values, y_values = width * np.cos(turn), sign * height * np.sin(turn)
        plot_axes.fill(x_values, y_values, alpha=0.2)
        plot_axes.plot(x_values, y_values, label=f"{name}: up to {width:.2f} % or {height:.2f} ms")
    plot_axes.axhline(0.0, color="0.5", linewidth=0.6)
    plot_axes.set(xlabel="A − 1 [%]", ylabel="delay d [ms], negative for a lead")
    plot_axes.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return plot_axes
