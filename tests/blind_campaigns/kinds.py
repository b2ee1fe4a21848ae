"""What a campaign may hide, which effects that can be, and how they can be seen."""

from enum import StrEnum

import numpy as np

from blind_campaigns.case import ONE_CHANNEL, Observation
from blind_campaigns.catalogue import Definition, registry


class Kind(StrEnum):
    """What a campaign hides."""

    SINGLE = "single"
    FAINT = "faint"
    DOUBLE = "double"
    TRIPLE = "triple"
    NONE = "none"
    MISCALIBRATED = "miscalibrated"
    OUTSIDE = "outside"
    ONE_CHANNEL = "one_channel"


SHARES = {
    Kind.SINGLE: 0.30,
    Kind.FAINT: 0.10,
    Kind.DOUBLE: 0.12,
    Kind.TRIPLE: 0.06,
    Kind.NONE: 0.05,
    Kind.MISCALIBRATED: 0.10,
    Kind.OUTSIDE: 0.15,
    Kind.ONE_CHANNEL: 0.12,
}
"""How often each kind is drawn when none is asked for."""

_COUNTS = {Kind.DOUBLE: 2, Kind.TRIPLE: 3, Kind.NONE: 0, Kind.MISCALIBRATED: 0}
INERTIAL_ENEMIES = {"rate_limit", "stroke_saturation", "backlash", "integration_error"}
_SEEN_WITH_COMMAND = (Observation.FULL, Observation.COMMAND_MEASURED, Observation.ACTUATOR_ONLY)
_SEEN_WITH_FORCE = (Observation.FULL, Observation.MEASURED_FORCE, Observation.SPECIMEN_ONLY)


def observations(definition: Definition) -> tuple[Observation, ...]:
    """Return the ways of observing in which an effect shows and is no offset in disguise."""
    if definition.block in {"excitation", "numerical"} or definition.name == "force_bias":
        return (Observation.FULL,)
    if definition.name == "sensor_drift":
        return (*_SEEN_WITH_COMMAND, Observation.MEASURED_FORCE, Observation.SPECIMEN_ONLY)
    return _SEEN_WITH_FORCE if definition.block == "specimen" else _SEEN_WITH_COMMAND


def one_channel_observations(definition: Definition) -> tuple[Observation, ...]:
    """Return the one-channel campaigns in which an effect is not a mere change of calibration."""
    if definition.name in {"force_bias", "excitation_scale"}:
        return ()
    if definition.block in {"actuator", "numerical"} or definition.name == "added_mass":
        return (Observation.ONE_CHANNEL_RIG,)
    return ONE_CHANNEL


def draw_kind(rng: np.random.Generator) -> Kind:
    """Return a kind at random, in the usual shares."""
    return Kind(rng.choice(list(SHARES), p=list(SHARES.values())))


def draw_definitions(rng: np.random.Generator, kind: Kind) -> list[Definition]:
    """Return the kinds of effect to hide, each kind equally likely."""
    everything = list(registry().values())
    inside = [definition for definition in everything if definition.in_library]
    if kind is Kind.OUTSIDE:
        pool = [definition for definition in everything if not definition.in_library]
    elif kind is Kind.ONE_CHANNEL:
        pool = [definition for definition in inside if one_channel_observations(definition)]
    else:
        pool = inside
    while True:
        chosen = [pool[i] for i in rng.permutation(len(pool))[: _COUNTS.get(kind, 1)]]
        if _compatible(chosen):
            return chosen


def _compatible(definitions: list[Definition]) -> bool:
    """Return whether effects can meet: an inertia force needs a piston whose velocity is continuous."""
    names = {definition.name for definition in definitions}
    if "added_mass" in names and names & INERTIAL_ENEMIES:
        return False
    if not definitions:
        return True
    return any(all(seen in observations(d) for d in definitions) for seen in Observation)
