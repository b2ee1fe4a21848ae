"""Stated values that the channels of a test contradict: those far from their posterior."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from reliab.assessment.budget.sizes import PriorSource, ordinary_equipment
from reliab.assessment.inference.posterior import TestPosterior, infer
from reliab.assessment.inference.quantities import UncertainQuantity
from reliab.assessment.inference.uncertain_quantity import Prior, Shape
from reliab.assessment.verdict import Contradiction
from reliab.core.significant_digits import significant
from reliab.core.stated_value import StatedValue
from reliab.structures.structure import Structure

_FAR = 3.0  # standard deviations of what the prior lets expect
_STRUCTURE_OPTIONS = ("f", "xi", "alpha")
_ERROR_OPTIONS = (*_STRUCTURE_OPTIONS, "scale", "skew", "filter_delay", "feedback_lag", "hysteresis")
_UNITS = {"f": " Hz", "mass": " kg"}
_SIGNIFICANT = 3.0  # standard deviations
_MATTERS = {"frequency": 0.005, "damping_ratio": 0.02, "experimental_fraction": 0.02, "feedback_lag": 1e-4}


@dataclass(frozen=True, kw_only=True)
class IdentifiedParameter:
    """A parameter estimated from the test, together with its stated value."""

    value: float  # value, deviation: Value and standard error, in the parameter's own unit (Hz, -, s)
    deviation: float
    stated: float  # What the user stated

    def departs(self, least: float) -> bool:
        """Whether the stated value is wrong by three standard errors and by more than `least`."""
        off = abs(self.value - self.stated)
        return off > _SIGNIFICANT * self.deviation and off > least


@dataclass(frozen=True, kw_only=True)
class Identification:
    """Parameters of the structure as the channels show them."""

    frequency: IdentifiedParameter  # f [Hz]
    damping_ratio: IdentifiedParameter  # ξ [-]
    # experimental_fraction, feedback_lag: α [-], and the lag of the fed-back force [s]; None where they are
    # exact
    experimental_fraction: IdentifiedParameter | None
    feedback_lag: IdentifiedParameter | None
    # What the ground acceleration does not explain over what it does, while it acts [-]
    misfit: float

    def disagreements(self) -> tuple[str, ...]:
        """Names of stated values from which the test differs significantly and not negligibly."""
        return tuple(
            name
            for name, least in _MATTERS.items()
            if (estimate := getattr(self, name)) is not None
            and estimate.departs(least if name == "feedback_lag" else least * abs(estimate.stated))
        )


def find_conflicts(
    posterior: TestPosterior, structure: Structure, stated_values: Mapping[str, StatedValue]
) -> Iterator[Contradiction]:
    """Say which stated or assumed values lie far from what the channels show.

    Those of other channels than command and measured displacement have no remedy: their values as shown were
    used, and the error does not rest on them.
    """
    for unknown in posterior.unknowns:
        far = posterior.conflicts[unknown.name]
        two_sided = unknown.prior.shape in (Shape.NORMAL, Shape.LOGNORMAL)
        if far > _FAR or (two_sided and far < -_FAR):
            yield Contradiction(
                finding=_finding(unknown, posterior, structure, stated_values),
                remedy=unknown.quantity.remedy if unknown.quantity.option in _ERROR_OPTIONS else "",
                option=unknown.quantity.option,
                of_structure=unknown.quantity.option in _STRUCTURE_OPTIONS,
            )


def _finding(
    unknown: UncertainQuantity,
    posterior: TestPosterior,
    structure: Structure,
    stated_values: Mapping[str, StatedValue],
) -> str:
    quantity = unknown.quantity
    base = _value_as_stated(unknown, structure, stated_values)
    factor = abs(base) if quantity.relative else quantity.factor
    unit = _UNITS.get(quantity.option, "") if quantity.relative else f" {quantity.unit}"
    shown_value = base + factor * posterior.means[unknown.name]
    deviation, prior_deviation = (
        factor * size for size in (posterior.deviations[unknown.name], unknown.prior.deviation)
    )
    source = "stated" if unknown.prior.source is PriorSource.STATED or base else "assumed"
    return (
        f"The recording shows a {quantity.words} of {significant(shown_value, 4)} ± "
        f"{significant(deviation, 1)}{unit}; "
        f"{significant(base, 4)} ± {significant(prior_deviation, 1)}{unit} was {source}."
    )


def _value_as_stated(
    unknown: UncertainQuantity, structure: Structure, stated_values: Mapping[str, StatedValue]
) -> float:
    """Return the value that was stated, in the unit in which it is told."""
    option = unknown.quantity.option
    structure_values = {
        "f": structure.frequency,
        "xi": structure.damping_ratio,
        "alpha": structure.experimental_fraction,
    }
    if option in structure_values:
        return structure_values[option]
    nothing = StatedValue(1.0 if unknown.quantity.relative else 0.0)
    return stated_values.get(option, nothing).value


def identify_exact(posterior: TestPosterior, structure: Structure, misfit: float) -> Identification:
    """Say what the channels show of a structure that is stated as exact.

    They show the damping ratio if the lag of the fed-back force is as stated, and with a recorded force that
    lag if the damping ratio is: each acts as the other.
    """
    known, usual = posterior.circumstances, ordinary_equipment()

    # a force tells the share of a structure that is all specimen as stated, too
    share = {"experimental_fraction": Prior(deviation=usual.alpha)} if known.specimen_force else {}

    def identify(*names: str) -> Identification:
        equipment = replace(known.equipment, **{name: getattr(usual, name) for name in names})
        circumstances = replace(known, equipment=equipment, learned={**share, **known.learned})
        return identify_structure(infer(circumstances), structure, misfit)

    shown = identify("f", "xi", "alpha")
    if not known.specimen_force:
        return shown
    return replace(shown, feedback_lag=identify("f", "alpha", "feedback_lag_ms").feedback_lag)


def identify_structure(posterior: TestPosterior, structure: Structure, misfit: float) -> Identification:
    """Put what the channels show of the structure into an identification."""
    feedback_lag = posterior.circumstances.feedback_lag

    def identify_parameter(name: str, stated_value: float, size: float) -> IdentifiedParameter | None:
        if name not in posterior.means:
            return None
        value = stated_value + size * posterior.means[name]
        return IdentifiedParameter(
            value=value, deviation=size * posterior.deviations[name], stated=stated_value
        )

    f, ratio = structure.frequency, structure.damping_ratio
    share = structure.experimental_fraction
    return Identification(
        frequency=identify_parameter("frequency", f, f)
        or IdentifiedParameter(value=f, deviation=0.0, stated=f),
        damping_ratio=identify_parameter("damping_ratio", ratio, ratio)
        or IdentifiedParameter(value=ratio, deviation=0.0, stated=ratio),
        experimental_fraction=identify_parameter("experimental_fraction", share, share),
        feedback_lag=identify_parameter("feedback_lag", feedback_lag, 1.0),
        misfit=misfit,
    )


def damping_from_channels(posterior: TestPosterior, structure: Structure) -> StatedValue:
    """Damping ratio that the channels show, of which nothing was stated."""
    ratio = structure.damping_ratio
    value = ratio * (1.0 + posterior.means["damping_ratio"])
    return StatedValue(value, ratio * posterior.deviations["damping_ratio"])
