"""A missing effect: one of the library with its parameters and rivals, or a term outside the library."""

import math
from collections.abc import Sequence, Set as AbstractSet
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.significant_digits import percent, quantity_and_interval
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.result.gap import NO_CHANGE
from reliab.effects.effect import Effect, Parameter
from reliab.effects.stated_damping import StatedDamping

_TELLS = {
    frozenset({"first_order_lag", "second_order_dynamics"}):
        "A sweep to twice the servo's bandwidth shows whether the amplitude peaks or only falls",
    frozenset({"first_order_lag", "delay_drift"}):
        "A steady sine, or a sweep run downwards, separates time from frequency",
    frozenset({"second_order_dynamics", "delay_drift"}):
        "A steady sine, or a sweep run downwards, separates time from frequency",
    frozenset({"sensor_bias", "force_bias"}):
        "Record both channels with the specimen disconnected",
    frozenset({"coulomb_friction", "hysteresis"}):
        "Slow cycles of growing amplitude show whether the force jumps or bends at each reversal",
    frozenset({"coulomb_friction", "viscous_damping"}):
        "Cycles of one amplitude at two speeds show whether the dissipated energy depends on the speed",
    frozenset({"viscous_damping", "quadratic_damping"}):
        "Cycles at two speeds show whether the damping force grows with the speed or with its square",
    frozenset({"gap", "backlash"}):
        "Record command and force as well: slack in the actuator shows between command and displacement",
    frozenset({"added_mass", "cubic_stiffness"}):
        "Slow cycles of the same amplitude leave the inertia out",
}  # fmt: skip
_DECISIVE_TEST = "A test with a stronger input of wider band, recorded on all four channels, would decide it"
_LEAST_RIVAL = 0.01  # probability of an effect that is named as another one's rival
_DAMPING = "structure_damping"
_NOTHING = 1e-8  # SI value of a parameter whose lower bound stands a hair below zero


NORMAL_REACH_90 = 1.645
"""Standard deviations to either end of a central 90 % interval."""


@dataclass(frozen=True, kw_only=True)
class Estimate(PlainResult):
    """A parameter: name, most probable value, standard deviation, units, central 90 % interval if sampled.

    `between` is the part of the standard deviation that comes from other models that hold the effect.
    """

    keys: ClassVar[Keys] = {**same_names("value", "sd", "units", "determined"), "interval_90?": "interval"}

    name: str
    value: float
    sd: float
    units: str
    meaning: str = ""  # The parameter in words
    interval: tuple[float, float] | None = None
    signed: bool = False  # Whether it may be negative, so that zero is a value like any other
    between: float = 0.0
    bounds: tuple[float, float] = (-math.inf, math.inf)  # Range in which it was sought

    @property
    def determined(self) -> bool:
        """Whether the tests say how large it is: its deviation is below it where it is positive."""
        return self.signed or self.sd < self.value

    def within_bounds(self, interval: tuple[float, float]) -> tuple[float, float]:
        """Cut an interval at the ends of the range, below zero too unless it is signed."""
        least, largest = self.bounds
        if not self.signed or -_NOTHING < least < 0.0:
            least = max(least, 0.0)
        return max(interval[0], least), min(interval[1], largest)

    @property
    def size(self) -> str:
        """Value with its 90 % interval and unit, as they are shown.

        >>> Estimate(name="force_n", value=237_500.0, sd=73_000.0, units="N").size
        '238 kN (117 to 358)'
        >>> Estimate(name="offset_n", value=-0.004, sd=0.3, units="N", signed=True).size
        '0.00 N (−0.50 to 0.49)'
        """
        if not self.determined:
            return "not determined"
        reach = NORMAL_REACH_90 * self.sd
        low, high = self.within_bounds(self.interval or (self.value - reach, self.value + reach))
        return quantity_and_interval(self.value, low, high, self.units)


@dataclass(frozen=True, kw_only=True)
class Rival(PlainResult):
    """Another effect in the place of a named one, with its probability and its error on held-out tests."""

    name: str
    held_out_nrmse: float
    probability: float


@dataclass(frozen=True, kw_only=True)
class MissingEffect(PlainResult):
    """An effect that the nominal model lacks."""

    keys: ClassVar[Keys] = {
        "name": "name",
        "block": "effect.block",
        "probability": "probability",
        "parameters": "estimates.{name}",
        "rivals": "rivals",
        "held_out_nrmse_with": "error_with",
        "held_out_nrmse_without": "error_without",
        "parameters_on_bounds": "on_bounds",
        "position?": "effect.position",
        "member_of?": "composition",
    }

    effect: type[Effect]  # Which
    probability: float  # Sum of the probabilities of all fitted models that contain it
    estimates: tuple[Estimate, ...]  # Its parameters
    rivals: tuple[Rival, ...]  # Other effects that were tried in its place, the most probable first
    # error_with, error_without: Error on held-out tests of the model with it, and of the same model refitted
    # without it: RMS over that of the signal
    error_with: float
    error_without: float
    # Parameters that lie on a bound of their range, so that their values and deviations mean little
    on_bounds: tuple[str, ...] = ()
    member: type[Effect] | None = None  # Member of a composition, or simpler effect, as which it is reported

    @property
    def name(self) -> str:
        """Name of the effect."""
        return (self.member or self.effect).label()

    @property
    def changes_held_out(self) -> bool:
        """Whether the error on held-out tests is smaller with it."""
        return self.error_with < (1.0 - NO_CHANGE) * self.error_without

    @property
    def description(self) -> str:
        """The effect in words."""
        return (self.member or self.effect).description

    @property
    def split_members(self) -> "tuple[MissingEffect, ...]":
        """The effect, or each member of a composition with its parameters, the first with what is left."""
        first, *others = self.effect.members or (None,)
        if first is None:
            return (self,)
        left = {estimate.name for estimate in self.estimates}.difference(*map(_names, others))
        return self.report_as(first, left), *(self.report_as(member) for member in others)

    def report_as(self, member: type[Effect], names: AbstractSet[str] = frozenset()) -> "MissingEffect":
        """State a special form under the name of the effect that it refines, with the parameters of that."""
        own_names = names or _names(member)
        return replace(
            self,
            member=member,
            rivals=tuple(rival for rival in self.rivals if rival.name != member.label()),
            estimates=tuple(estimate for estimate in self.estimates if estimate.name in own_names),
            on_bounds=tuple(name for name in self.on_bounds if name in own_names),
        )

    @property
    def parameters(self) -> str:
        """All parameters in words, with their 90 % intervals and units, on one line."""
        marks = dict.fromkeys(self.on_bounds, ", on a bound of its range")
        return "; ".join(f"{item.meaning} {item.size}{marks.get(item.name, '')}" for item in self.estimates)

    @property
    def remark(self) -> str:
        """The effect from which it cannot be distinguished, and the test that would distinguish them."""
        rival = self.rivals[0] if self.rivals else None
        return remark(self.name, self.probability, None if rival is None else (rival.name, rival.probability))

    @property
    def composition(self) -> str:
        """Effect of which it is a member; empty if it is reported as itself."""
        return str(self.effect.name) if self.member else ""


@dataclass(frozen=True, kw_only=True)
class Unknown(PlainResult):
    """A missing effect that is none of the known ones."""

    block: str  # Where it acts
    # Terms with their coefficients in SI units; empty where no term that was tried explains it
    expression: str
    description: str  # The same in words
    held_out_nrmse: float  # What the model with the expression leaves on held-out tests
    formula: str = ""  # The expression with its coefficients in words

    keys: ClassVar[Keys] = same_names("block", "expression", "description", "held_out_nrmse")


def telling_test(effect: str, rival: str) -> str:
    """Return the test that would distinguish two effects, as a sentence without its final full stop."""
    pair = {str(effect), str(rival)}
    return next((text for names, text in _TELLS.items() if {str(n) for n in names} == pair), _DECISIVE_TEST)


def remark(name: str, probability: float, rival: tuple[str, float] | None) -> str:
    """State from which other effect an effect cannot be distinguished, if one is probable at all."""
    words = name.replace("_", " ")
    if rival is None or rival[1] < _LEAST_RIVAL:
        return f"The data suggest {words}, but do not settle it. {_DECISIVE_TEST}."
    rival_name = rival[0].replace("_", " ")
    return (
        f"The data do not distinguish {words} ({percent(probability, decimals=0)}) from {rival_name} "
        f"({percent(rival[1], decimals=0)}). {telling_test(name, rival[0])}."
    )


def _names(effect: type[Effect]) -> set[str]:
    return {parameter.name for parameter in effect.parameters}


def estimates(effect: type[Effect], fit: Fit) -> tuple[Estimate, ...]:
    """Parameters of an effect with their standard deviations, SI units."""
    return _estimates(fit, effect.parameters, fit.space.places(effect))


def _estimates(fit: Fit, parameters: Sequence[Parameter], places: slice) -> tuple[Estimate, ...]:
    values = fit.space.values(fit.coordinates)[places].tolist()
    spread = fit.space.standard_deviations(fit.coordinates, fit.covariance)[places].tolist()
    ranges = zip(*(fit.space.values(bound)[places].tolist() for bound in fit.space.bounds), strict=True)
    return tuple(
        Estimate(
            name=parameter.name,
            value=value if abs(value) > _NOTHING else 0.0,
            sd=sd,
            units=parameter.units,
            meaning=parameter.meaning,
            signed=parameter.signed,
            bounds=bounds,
        )
        for parameter, value, sd, bounds in zip(parameters, values, spread, ranges, strict=True)
    )


def widen_estimates(
    estimates_of_best: tuple[Estimate, ...], variants: Sequence[tuple[float, tuple[Estimate, ...]]]
) -> tuple[Estimate, ...]:
    """Add to standard deviations how far parameters differ between the models that hold the effect.

    `variants` holds the probability and the estimates of each such model, the stated one included.
    """
    total = sum(share for share, _ in variants)
    wide = []
    for k, estimate in enumerate(estimates_of_best):
        square = (
            sum(share * ((e[k].value - estimate.value) ** 2 + e[k].sd ** 2) for share, e in variants) / total
        )
        spread_between = max(square - estimate.sd**2, 0.0) ** 0.5
        wide.append(
            replace(estimate, sd=float(np.hypot(estimate.sd, spread_between)), between=spread_between)
        )
    return tuple(wide)


def calibration(fit: Fit, *, is_restated: bool = False, with_effects: bool = False) -> tuple[Estimate, ...]:
    """Calibrated values with their standard deviations, and those of the effects if they are asked for.

    `is_restated`: a damping that is not the stated one is calibrated, not missing.
    """
    parameters = [item.parameter for item in fit.space.block.calibrations]
    calibrations = _estimates(fit, parameters, slice(len(parameters)))
    if with_effects:
        effects = (item for effect in fit.space.effects for item in estimates(effect, fit))
        calibrations = (*calibrations, *effects)
    if not is_restated:
        return calibrations
    # Of the calibrated factor on the stated damping and of the effect together
    space, first = fit.space, [parameter.name for parameter in parameters].index(_DAMPING)
    places = [first, space.places(StatedDamping).start]
    weights = np.array([1.0, 1.0 / space.block.removable[StatedDamping]])
    covariance = space.covariance_of_values(fit.coordinates, fit.covariance)[np.ix_(places, places)]
    value = float(weights @ space.values(fit.coordinates)[places])
    damping = replace(calibrations[first], value=value, sd=float(np.sqrt(weights @ covariance @ weights)))
    return *calibrations[:first], damping, *calibrations[first + 1 :]
