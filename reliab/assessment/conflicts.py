"""Stated values that the channels of a test contradict: those far from their posterior."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.budget.sizes import PriorSource, ordinary_equipment
from reliab.assessment.inference.posterior import TestPosterior, infer
from reliab.assessment.inference.quantities import QUANTITIES, UncertainQuantity
from reliab.assessment.inference.uncertain_quantity import Prior, Shape
from reliab.assessment.rebuilt_error.noise import estimate_noises
from reliab.assessment.rebuilt_error.specimen_check import examine_specimen
from reliab.assessment.recorded_ground import ShownGround
from reliab.assessment.verdict import Contradiction
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import StatedValue
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

FAR = 3.0
"""Standard deviations of what the prior lets expect, beyond which a value is contradicted."""

_STRUCTURE_OPTIONS = ("f", "xi", "alpha")
_ERROR_OPTIONS = (*_STRUCTURE_OPTIONS, "scale", "skew", "filter_delay", "feedback_lag", "hysteresis")
_UNITS = {"f": " Hz", "mass": " kg"}
# How near a value that is stated as exact is taken to be: relative, or in the SI unit, one standard deviation
_EXACTNESS = {
    "frequency": 0.0017,
    "damping_ratio": 0.0067,
    "experimental_fraction": 0.0067,
    "feedback_lag": 3e-5,
    "time_shift": 3e-5,
}
_STRUCTURE = ("frequency", "damping_ratio", "experimental_fraction")
_LAG = ("frequency", "experimental_fraction", "feedback_lag")
_SKEW = ("time_shift",)
_OF_EXACT = "Correct it, or state how uncertain it is: the error is then inferred with what the test shows."


@dataclass(frozen=True, kw_only=True)
class IdentifiedParameter:
    """A parameter estimated from the test, together with its stated value."""

    value: float  # value, deviation: Value and standard error, in the parameter's own unit (Hz, -, s)
    deviation: float
    stated: float  # What the user stated


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


def find_conflicts(
    shown: TestPosterior,
    structure: Structure,
    stated_values: Mapping[str, StatedValue],
    opened: Collection[str] = (),
) -> Iterator[Contradiction]:
    """Say which stated or assumed values lie far from what the channels show.

    Those of other channels than command and measured displacement have no remedy: their values as shown were
    used, and the error does not rest on them. `opened`: quantities that were stated as exact and are open in
    `shown`; none of the others can then be contradicted.
    """
    for unknown in shown.unknowns:
        if opened and unknown.name not in opened:
            continue
        exactness = _EXACTNESS[unknown.name] / unknown.prior.deviation if opened else 1.0
        far = shown.conflict(unknown, exactness)
        two_sided = unknown.prior.shape in (Shape.NORMAL, Shape.LOGNORMAL)
        if far > FAR or (two_sided and far < -FAR):
            option = unknown.quantity.option
            yield Contradiction(
                finding=_finding(unknown, shown, structure, stated_values, is_exact=bool(opened)),
                remedy=_OF_EXACT if opened else unknown.quantity.remedy if option in _ERROR_OPTIONS else "",
                option=option,
                of_structure=bool(opened) or option in _STRUCTURE_OPTIONS,
            )


def _finding(
    unknown: UncertainQuantity,
    posterior: TestPosterior,
    structure: Structure,
    stated_values: Mapping[str, StatedValue],
    *,
    is_exact: bool,
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
    size = "" if is_exact else f" ± {significant(prior_deviation, 1)}"
    return (
        f"The recording shows a {quantity.words} of {significant(shown_value, 4)} ± "
        f"{significant(deviation, 1)}{unit}; "
        f"{significant(base, 4)}{size}{unit} was {'taken as exact' if is_exact else source}."
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


def open_exact(
    posterior: TestPosterior, *, has_ground: bool
) -> Iterator[tuple[TestPosterior, tuple[str, ...]]]:
    """Let quantities that were stated as exact be as uncertain as they ordinarily are; give their names, too.

    With the ground acceleration channels show the damping ratio if the lag of the fed-back force is as
    stated, and with a recorded force that lag if the damping ratio is: each acts as the other. A force shows
    the skew of the channels.
    """
    known, usual = posterior.circumstances, ordinary_equipment()
    force, stated = known.specimen_force, {unknown.name for unknown in posterior.unknowns}
    sizes = {quantity.name: quantity.ordinary(known, usual) for quantity in QUANTITIES}
    if force:  # which shows the share of a structure that is all specimen, too
        sizes["experimental_fraction"] = usual.alpha
    shown = {_STRUCTURE: has_ground, _LAG: has_ground and force, _SKEW: force}
    for names in (names for names, is_shown in shown.items() if is_shown):
        priors = {
            quantity.name: Prior(deviation=sizes[quantity.name], shape=quantity.shape)
            for quantity in QUANTITIES
            if quantity.name in names and quantity.name not in stated and sizes[quantity.name]
        }
        opened = replace(known, learned={**priors, **known.learned})
        yield infer(opened, evidence=tuple(replace(item) for item in posterior.evidence)), tuple(priors)


def identify_structure(shown: Sequence[TestPosterior], structure: Structure, misfit: float) -> Identification:
    """Put what the channels show of the structure into an identification, from the first that shows it."""
    feedback_lag = shown[0].circumstances.feedback_lag

    def identify(name: str, stated: float, size: float) -> IdentifiedParameter | None:
        found = next((posterior for posterior in shown if name in posterior.means), None)
        if found is None:
            return None
        value = stated + size * found.means[name]
        return IdentifiedParameter(value=value, deviation=size * found.deviations[name], stated=stated)

    def exact(stated: float) -> IdentifiedParameter:
        return IdentifiedParameter(value=stated, deviation=0.0, stated=stated)

    f, ratio = structure.frequency, structure.damping_ratio
    share = structure.experimental_fraction
    return Identification(
        frequency=identify("frequency", f, f) or exact(f),
        damping_ratio=identify("damping_ratio", ratio, ratio) or exact(ratio),
        experimental_fraction=identify("experimental_fraction", share, share),
        feedback_lag=identify("feedback_lag", feedback_lag, 1.0),
        misfit=misfit,
    )


_FEWEST_PERIODS = 5.0


@dataclass(frozen=True, kw_only=True)
class OwnEquation:
    """What the test shows about its structure."""

    # Frequency, damping ratio and, with a recorded force, share and lag; None where the ground acceleration
    # is not recorded or does not belong to the test
    identified: Identification | None = None
    # Names of stated values that the test contradicts: "f", "xi", "alpha", "feedback_lag"
    wrong: tuple[str, ...] = ()
    contradictions: tuple[str, ...] = ()  # The same in sentences
    nonlinear: str = ""  # A sentence, where the recorded force shows a nonlinear specimen; else empty
    notes: tuple[str, ...] = ()  # What was found about the recorded ground acceleration, in sentences
    doubts: tuple[Contradiction, ...] = ()  # Where it contradicts the test, or the test what was stated

    @property
    def all_contradictions(self) -> tuple[str, ...]:
        """Where the test contradicts what was stated, and a linear specimen, in sentences."""
        return *self.contradictions, *filter(None, [self.nonlinear])


def compare_with_stated(
    posterior: TestPosterior,
    structure: Structure,
    ground: ShownGround,
    stated_values: Mapping[str, StatedValue],
    *,
    nonlinear: str,
) -> OwnEquation:
    """Compare stated values with what the channels show.

    Where everything is taken as exact, a quantity of the structure and one of the channels can look alike, so
    that a value that differs is told, and the verdict left open, but none is replaced. `nonlinear`: as of
    `OwnEquation`.
    """
    shown: list[tuple[TestPosterior, tuple[str, ...]]] = [(posterior, ())]
    if posterior.circumstances.equipment.is_exact:
        shown += open_exact(posterior, has_ground=ground.fits)
    conflicts = {
        conflict.option if names else conflict.finding: conflict
        for opened_posterior, names in shown
        for conflict in find_conflicts(opened_posterior, structure, stated_values, names)
    }
    posteriors = [opened_posterior for opened_posterior, _ in shown]
    return OwnEquation(
        identified=identify_structure(posteriors, structure, ground.misfit or 0.0) if ground.fits else None,
        wrong=tuple(conflict.option for conflict in conflicts.values() if conflict.option),
        contradictions=tuple(conflict.finding for conflict in conflicts.values()),
        nonlinear=nonlinear,
        notes=ground.notes,
        doubts=(*ground.doubts, *(conflict for conflict in conflicts.values() if conflict.remedy)),
    )


def looks_nonlinear(recording: Recording, structure: Structure) -> str:
    """Say that the recorded force is that of a nonlinear specimen; empty where it is not."""
    if recording.force is None or recording.duration * structure.frequency < _FEWEST_PERIODS:
        return ""
    step, measured = recording.time_step, np.atleast_2d(recording.measured)
    noises = estimate_noises(np.atleast_2d(recording.command), measured, step)
    smooth = np.stack([noise.smooth(row) for noise, row in zip(noises, measured, strict=True)])
    check = examine_specimen(smooth, np.atleast_2d(recording.force), step, structure.frequency)
    if not check.nonlinear:
        return ""
    share = percent(check.share, decimals=1)
    return (
        f"The specimen looks nonlinear, or holds masses of its own: {share} of its force follows no spring, "
        "dashpot or mass. The error was computed for a linear specimen."
    )
