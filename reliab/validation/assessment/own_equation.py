"""Check of the stated structure by the test's own equation of motion."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.loop.structure import Structure
from reliab.rebuilt_error.identification import Identification, Identified, identify
from reliab.rebuilt_error.specimen_check import examine_specimen
from reliab.stated_value import StatedValue
from reliab.validation.assessment.recording import Recording

Array = NDArray[np.float64]

_LARGEST_MISFIT = 0.3
"""Largest residual over ground acceleration; above it the channel is not this test's ground motion."""

_FEWEST_PERIODS = 5.0
_AGREES = 2.0  # stated standard deviations
_TOO_SHORT = "The test is too short for its structure to be identified from the recorded ground acceleration."
_QUANTITIES = {
    "frequency": ("f", "a natural frequency", " Hz", 1.0),
    "damping_ratio": ("xi", "a damping ratio", "", 1.0),
    "experimental_fraction": ("alpha", "a share of the stiffness in the laboratory", "", 1.0),
    "feedback_lag": ("feedback_lag", "a lag of the fed-back force", " ms", 1e3),
}


@dataclass(frozen=True, kw_only=True)
class OwnEquation:
    """What the test shows about its structure.

    Attributes
    ----------
    identified : Identification or None
        Frequency, damping ratio and, with a recorded force, share and lag; None where the ground acceleration
        is not recorded or does not belong to the test.
    wrong : tuple of str
        Names of stated values that the test contradicts: "f", "xi", "alpha", "feedback_lag".
    contradictions : tuple of str
        The same in sentences.
    nonlinear : str
        A sentence, where the recorded force shows a nonlinear specimen; else empty.
    notes : tuple of str
        What was found about the recorded ground acceleration, in sentences.
    """

    identified: Identification | None = None
    wrong: tuple[str, ...] = ()
    contradictions: tuple[str, ...] = ()
    nonlinear: str = ""
    notes: tuple[str, ...] = ()

    def structure(self, stated: Structure) -> Structure:
        """Structure with the identified frequency and share, where they contradict the stated ones.

        Damping ratio and feedback lag have the same effect on a test, and stay as stated.
        """
        if self.identified is None:
            return stated
        share = self.identified.experimental_fraction
        return Structure(
            frequency=self.identified.frequency.value if "f" in self.wrong else stated.frequency,
            damping_ratio=stated.damping_ratio,
            experimental_fraction=min(share.value, 1.0)
            if share is not None and "alpha" in self.wrong
            else stated.experimental_fraction,
        )


def examine_equation(
    recording: Recording,
    structure: Structure,
    stated: Mapping[str, StatedValue],
    smoothed: Array,
) -> OwnEquation:
    """Compare a test with the values stated for it.

    Parameters
    ----------
    recording : Recording
        The test.
    structure : Structure
        The structure as stated.
    stated : mapping of str to StatedValue
        What is stated, with standard deviations; "feedback_lag" in milliseconds. With the structure's "mass"
        [kg] a recorded force enters the equation.
    smoothed : numpy.ndarray
        Measured displacement without the noise above the motion's band [m], shape (n,).

    Returns
    -------
    OwnEquation
        What was found; nothing where neither ground acceleration nor force is recorded.
    """
    nonlinear = _nonlinear(recording, structure, smoothed)
    if recording.ground is None:
        return OwnEquation(nonlinear=nonlinear)
    mass = stated["mass"].value if "mass" in stated else None
    force = recording.force / mass if recording.force is not None and mass is not None else None
    if recording.duration * structure.frequency < _FEWEST_PERIODS:
        return OwnEquation(nonlinear=nonlinear, notes=(_TOO_SHORT,))
    lag = stated.get("feedback_lag", StatedValue(0.0)).value / _QUANTITIES["feedback_lag"][-1]
    candidates = [
        identify(
            recording.command,
            recording.measured,
            sign * recording.ground,
            recording.time_step,
            structure,
            force=force,
            feedback_lag=lag,
        )
        for sign in (1.0, -1.0)
    ]
    identified = min(candidates, key=lambda candidate: candidate.misfit)
    if identified.misfit > _LARGEST_MISFIT:
        return OwnEquation(nonlinear=nonlinear, notes=(_other_ground(identified.misfit),))
    notes = () if identified is candidates[0] else ("The ground acceleration has the opposite sign.",)
    estimates = {
        _QUANTITIES[name][0]: (name, getattr(identified, name))
        for name in identified.disagreements()
        if not _within(getattr(identified, name), stated.get(_QUANTITIES[name][0]), _QUANTITIES[name][-1])
    }
    return OwnEquation(
        identified=identified,
        wrong=tuple(estimates),
        contradictions=tuple(_sentence(name, value) for name, value in estimates.values()),
        nonlinear=nonlinear,
        notes=notes,
    )


def _within(estimate: Identified, stated: StatedValue | None, factor: float) -> bool:
    deviation = 0.0 if stated is None else stated.deviation
    return abs(factor * (estimate.value - estimate.stated)) <= _AGREES * deviation


def _sentence(name: str, estimate: Identified) -> str:
    _, words, unit, factor = _QUANTITIES[name]
    value, deviation, stated = (
        factor * number for number in (estimate.value, estimate.deviation, estimate.stated)
    )
    return (
        f"The test's own equation of motion shows {words} of {value:.4g} ± {deviation:.1g}{unit}; "
        f"{stated:.4g}{unit} was stated."
    )


def _other_ground(misfit: float) -> str:
    return (
        "The recorded ground acceleration does not belong to this test (the equation of motion leaves "
        f"{misfit:.0%} of it unexplained): check channel and unit. The structure was not identified from it."
    )


def _nonlinear(recording: Recording, structure: Structure, smoothed: Array) -> str:
    periods = recording.duration * structure.frequency
    if recording.force is None or periods < _FEWEST_PERIODS:
        return ""
    nonlinearity = examine_specimen(smoothed, recording.force, recording.time_step, structure.frequency)
    if not nonlinearity.nonlinear:
        return ""
    return (
        f"The specimen looks nonlinear: {nonlinearity.share:.1%} of its force follows no spring, dashpot "
        "or mass. "
        "The error was computed for a linear specimen."
    )
