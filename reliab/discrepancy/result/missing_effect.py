"""A missing effect: one of the library with its parameters and rivals, or a term outside the library."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from reliab.core.arrays import Array
from reliab.core.plain_values import PlainResult
from reliab.core.significant_digits import percent, significant
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.terms.stated_damping import StatedDamping
from reliab.effects.effect import Effect, Parameter

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
_OTHERWISE = "A test with a stronger input of wider band, recorded on all four channels, would decide it"
_LEAST_RIVAL = 0.01  # probability of an effect that is named as another one's rival
_DAMPING = "structure_damping"
_STEP = 1e-4  # of a coordinate
_NOTHING = 1e-8  # SI value of a parameter whose lower bound stands a hair below zero


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A parameter: name, most probable value, standard deviation, units, central 90 % interval if sampled.

    `between` is the part of the standard deviation that comes from other models that hold the effect.
    """

    name: str
    value: float
    sd: float
    units: str
    interval: tuple[float, float] | None = None
    signed: bool = False  # Whether it may be negative, so that zero is a value like any other
    between: float = 0.0

    @property
    def determined(self) -> bool:
        """Whether the tests say how large it is: its deviation is below it where it is positive."""
        return self.signed or self.sd < self.value

    @property
    def words(self) -> tuple[str, str]:
        """Value with its unit and standard deviation, as they are shown."""
        if not self.determined:
            return "not determined", ""
        value = f"{self.value:.4g}"
        unit = "" if self.units == "-" else self.units
        return f"{value} {unit}".strip(), f"{self.sd:.1e}" if "e" in value else significant(self.sd, 2)

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of `parameters`."""
        sampled = {} if self.interval is None else {"interval_90": list(self.interval)}
        return {
            "value": self.value,
            "sd": self.sd,
            "units": self.units,
            "determined": self.determined,
            **sampled,
        }


@dataclass(frozen=True, kw_only=True)
class Rival(PlainResult):
    """Another effect in the place of a named one, with its probability and its error on held-out tests."""

    name: str
    held_out_nrmse: float
    probability: float


@dataclass(frozen=True, kw_only=True)
class MissingEffect:
    """An effect that the nominal model lacks."""

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
    def by_member(self) -> "tuple[MissingEffect, ...]":
        """The effect, or each member of a composition with its parameters, the first with what is left."""
        members = self.effect.members
        owners = {
            estimate.name: next((m for m in members if estimate.name in _names(m)), members[0])
            for estimate in self.estimates
            if members
        }
        return tuple(
            replace(
                self,
                member=member,
                estimates=tuple(e for e in self.estimates if owners[e.name] is member),
                on_bounds=tuple(name for name in self.on_bounds if owners[name] is member),
            )
            for member in members
        ) or (self,)

    def named_as(self, member: type[Effect]) -> "MissingEffect":
        """State a special form under the name of the effect that it refines, with the parameters of that."""
        names = _names(member)
        return replace(
            self,
            member=member,
            estimates=tuple(estimate for estimate in self.estimates if estimate.name in names),
            on_bounds=tuple(name for name in self.on_bounds if name in names),
        )

    @property
    def parameter_texts(self) -> tuple[str, ...]:
        """Each parameter with its value, standard deviation and unit, as they are shown."""
        texts = []
        for estimate in self.estimates:
            value, spread = estimate.words
            mark = " (on a bound)" if estimate.name in self.on_bounds else ""
            texts.append(f"{estimate.name} {value}{f' ± {spread}' if spread else ''}{mark}")
        return tuple(texts)

    @property
    def remark(self) -> str:
        """The effect from which it cannot be distinguished, and the test that would distinguish them."""
        rival = self.rivals[0] if self.rivals else None
        return remark(self.name, self.probability, None if rival is None else (rival.name, rival.probability))

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of `effects`."""
        return {
            "name": self.name,
            "block": str(self.effect.block),
            "probability": self.probability,
            "parameters": {estimate.name: estimate.to_dict() for estimate in self.estimates},
            "rivals": [rival.to_dict() for rival in self.rivals],
            "held_out_nrmse_with": self.error_with,
            "held_out_nrmse_without": self.error_without,
            "parameters_on_bounds": list(self.on_bounds),
            **({"position": self.effect.position} if self.effect.position else {}),
            **({"member_of": str(self.effect.name)} if self.member else {}),
        }


@dataclass(frozen=True, kw_only=True)
class Unknown(PlainResult):
    """A missing effect that is none of the known ones."""

    block: str  # Where it acts
    # Terms with their coefficients in SI units; empty where no term that was tried explains it
    expression: str
    description: str  # The same in words
    held_out_nrmse: float  # What the model with the expression leaves on held-out tests


def telling_test(effect: str, rival: str) -> str:
    """Return the test that would distinguish two effects, as a sentence without its final full stop."""
    pair = {str(effect), str(rival)}
    return next((text for names, text in _TELLS.items() if {str(n) for n in names} == pair), _OTHERWISE)


def remark(name: str, probability: float, rival: tuple[str, float] | None) -> str:
    """State from which other effect an effect cannot be distinguished, if one is probable at all."""
    words = name.replace("_", " ")
    if rival is None or rival[1] < _LEAST_RIVAL:
        return f"The data suggest {words}, but do not settle it. {_OTHERWISE}."
    rival_name = rival[0].replace("_", " ")
    return (
        f"The data do not distinguish {words} ({percent(probability, decimals=0)}) from {rival_name} "
        f"({percent(rival[1], decimals=0)}). {telling_test(name, rival[0])}."
    )


def _names(effect: type[Effect]) -> set[str]:
    return {parameter.name for parameter in effect.parameters}


def estimates(effect: type[Effect], fitted: Fit) -> tuple[Estimate, ...]:
    """Parameters of an effect with their standard deviations, SI units."""
    return _estimates(fitted, effect.parameters, fitted.space.places(effect))


def _estimates(fitted: Fit, parameters: Sequence[Parameter], places: slice) -> tuple[Estimate, ...]:
    values = fitted.space.values(fitted.coordinates)[places].tolist()
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance)[places].tolist()
    return tuple(
        Estimate(
            name=parameter.name,
            value=value if abs(value) > _NOTHING else 0.0,
            sd=sd,
            units=parameter.units,
            signed=parameter.signed,
        )
        for parameter, value, sd in zip(parameters, values, spread, strict=True)
    )


def widened(
    stated: tuple[Estimate, ...], others: Sequence[tuple[float, tuple[Estimate, ...]]]
) -> tuple[Estimate, ...]:
    """Add to standard deviations how far parameters differ between the models that hold the effect.

    `others` holds the probability and the estimates of each such model, the stated one included.
    """
    total = sum(share for share, _ in others)
    wide = []
    for k, one in enumerate(stated):
        square = sum(share * ((e[k].value - one.value) ** 2 + e[k].sd ** 2) for share, e in others) / total
        between = max(square - one.sd**2, 0.0) ** 0.5
        wide.append(replace(one, sd=float(np.hypot(one.sd, between)), between=between))
    return tuple(wide)


def calibration(fitted: Fit, *, restated: bool = False) -> tuple[Estimate, ...]:
    """Calibrated values with their standard deviations.

    `restated`: a damping that is not the stated one is calibrated, not missing.
    """
    parameters = [item.parameter for item in fitted.space.block.calibrations]
    calibrated = _estimates(fitted, parameters, slice(len(parameters)))
    if not restated:
        return calibrated
    return tuple(_restated(item, fitted) if item.name == _DAMPING else item for item in calibrated)


def _restated(damping: Estimate, fitted: Fit) -> Estimate:
    """Damping of the structure over the stated one, of the calibrated factor and the effect together."""
    space = fitted.space
    stated = space.block.removable[StatedDamping]
    place = space.places(StatedDamping).start
    factor = [c.parameter.name for c in space.block.calibrations].index(damping.name)

    def whole(coordinates: Array) -> float:
        values = space.values(coordinates)
        return float(values[factor] + values[place] / stated)

    value, steps = whole(fitted.coordinates), _STEP * np.eye(space.size)
    slopes = np.array([whole(fitted.coordinates + step) - value for step in steps]) / _STEP
    return replace(damping, value=value, sd=float(np.sqrt(slopes @ fitted.covariance @ slopes)))
