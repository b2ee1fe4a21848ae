"""The numerical substructure: ground acceleration and command → the force that would balance them.

The command is exact, so that its derivatives are, too: the force that must have come back to the controller
follows from the equation of motion and is compared with the measured one. An error of the integration is a
transfer function from the demanded to the command's acceleration, which is inverted. Above half of the
controller's rate the command contains no information on the demanded acceleration; there the nominal specimen
is used. Below, whatever was demanded above is folded onto it at the controller's instants, so that models
with such an error are judged only up to the frequency to which the command explains the force. The last
demands of a record are answered after its end, which is left out. Natural frequency, damping ratio and mass
are calibrated, because an operator may state them wrongly; a wrong value would otherwise look like an error
of the integration, and so would an offset of the recorded force that the controller did not feel, or a force
that was recorded by another clock.
"""

from copy import copy
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import (
    Calibration,
    force_not_fed_back,
    structure_damping,
    structure_frequency,
    structure_mass,
)
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.terms.clock_offset import ClockOffset, LateGround, with_clock
from reliab.effects.effect import Parameter, RecordEffect, Role, Scales
from reliab.effects.force_bias import ForceBias
from reliab.effects.integration_error import IntegrationError
from reliab.effects.registry import library
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3

_RETURN = 1.0  # s, within which a record is closed to a period
_STEPS_TO_ANSWER = 2.0  # of an integration, after which the command shows what was demanded
_PER_SECOND_DIFFERENCE = 1.0 / 12.0  # of the second derivative of a cubic spline, to first order


class BalanceBlock(ObservedBlock):
    """(ground acceleration, command) → force."""

    block = Block.NUMERICAL
    channel = Channel.FORCE
    inputs = (Channel.GROUND, Channel.COMMAND)

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        self.calibrations = (
            curvature_between_samples(),
            structure_frequency(),
            structure_damping(),
            structure_mass(),
            force_not_fed_back(),
        )
        self.offsets = ()
        roles = (Role.RECORD, Role.INTEGRATION)
        effects = (effect for effect in library().values() if effect.role in roles)
        self.candidates = (*effects, ClockOffset, LateGround)
        self.outside = ()
        nominal = self.nominal
        self._circular_frequency = nominal.structure.circular_frequency if nominal.structure else 0.0
        self._spring = nominal.specimen.stiffness / nominal.mass if nominal.specimen else 0.0
        self.motions = tuple(motion_of_command(test, campaign.step) for test in campaign.tests)
        self._informed = self.highest_signal
        self._command = lru_cache(maxsize=len(self.tests))(self._read_command)
        self._ground = lru_cache(maxsize=2 * len(self.tests))(self._read_ground)

    @property
    def highest(self) -> float:
        """Highest frequency at which models are judged [Hz]."""
        return self._informed

    @property
    def unanswered(self) -> float:
        """Time at the end of a record [s] whose demands the command answers after it."""
        step = next(p for p in IntegrationError.parameters if p.name == "step_s")
        return _STEPS_TO_ANSWER * step.upper

    def judged_up_to(self, frequency: float) -> "BalanceBlock":
        """Return the same block judged up to a frequency [Hz] only."""
        narrow = copy(self)
        narrow._informed = min(frequency, self.highest_signal)  # noqa: SLF001 - the same class
        return narrow

    def with_ground_in_time(self) -> "BalanceBlock":
        """Return the same block whose ground acceleration is taken to be recorded in time."""
        in_time = copy(self)
        in_time.candidates = tuple(effect for effect in self.candidates if effect is not LateGround)
        return in_time

    def read_late(self, lag: float) -> "BalanceBlock":
        """Return the same block with a force that was recorded so much later than it acted.

        `lag` [s].
        """
        late = copy(self)
        late.nominal = self.nominal.adding(ClockOffset(lag_s=lag))
        return late

    def predict(self, model: HybridTest, test: int) -> Array:
        """Force that balances ground motion and command [N], shape (n,)."""
        records = tuple(effect for effect in model.acting(Role.RECORD) if isinstance(effect, RecordEffect))
        ground = self._ground(records, test)
        displacement, velocity, acceleration = self.motions[test].values
        structure = model.substructure
        returned = ground.values + structure.damping * velocity + structure.stiffness * displacement
        for effect in model.acting(Role.INTEGRATION):
            if isinstance(effect, IntegrationError):
                lead = structure.damping * effect.velocity_lead
                returned = returned + lead * acceleration
                moved = self._command(test)
                likely = -ground.spectrum - (structure.stiffness + self._spring) * moved[0].spectrum
                likely -= structure.damping * moved[1].spectrum + lead * moved[2].spectrum
                acceleration = self._demanded(effect, moved[2], likely)
        offset = sum(effect.bias_n for effect in model.effects if isinstance(effect, ForceBias))
        force = np.asarray(offset - model.mass * (returned + acceleration))
        return with_clock(model, force, 1.0 / self.rate)

    def _demanded(self, effect: IntegrationError, moved: "ClosedSignal", likely: Spectrum) -> Array:
        """Acceleration that the controller demanded, `likely` where its own instants are too far apart."""
        frequency = fft.rfftfreq(moved.length, 1.0 / self.rate)
        resolved = frequency < 0.5 / effect.step_s
        likely[resolved] = moved.spectrum[resolved] / effect.transfer(
            frequency[resolved], self._circular_frequency
        )
        return np.asarray(fft.irfft(likely, moved.length)[: moved.values.size])

    def _read_ground(self, records: tuple[RecordEffect, ...], test: int) -> "ClosedSignal":
        ground = self.tests[test].channels[Channel.GROUND]
        for effect in records:
            ground = effect.applied(ground, 1.0 / self.rate)
        return ClosedSignal(ground, self.rate)

    def _read_command(self, test: int) -> tuple["ClosedSignal", ...]:
        return tuple(ClosedSignal(values, self.rate) for values in self.motions[test].values)


class ClosedSignal:
    """A signal, and its spectrum when it has returned to its begin on a straight line.

    The spectrum is linear in the signal, and is computed when it is first asked for.

    `rate` [Hz].
    """

    def __init__(self, values: Array, rate: float) -> None:
        self.values = values
        self.length = fft.next_fast_len(values.size + int(_RETURN * rate), real=True)

    @cached_property
    def spectrum(self) -> Spectrum:
        """Discrete Fourier transform of `length` values, shape (length // 2 + 1,)."""
        way = np.linspace(self.values[-1], self.values[0], self.length - self.values.size + 1)[1:]
        return np.asarray(fft.rfft(np.concatenate([self.values, way])), dtype=np.complex128)


def motion_of_command(test: MeasuredTest, step: float) -> Motion3:
    """Motion of the command, whose acceleration is as straight between samples as the ground's only in part.

    The spline takes all of it for straight, which makes the smooth rest s = x'' + a_g larger by −h²s''/12.
    The ground is taken for straight here; how much of its curvature is missed is calibrated.
    """
    motion = Motion3.interpolate(test.channels[Channel.COMMAND], step)
    values = motion.values.copy()
    values[2, 1:-1] += np.diff(values[2] + test.channels[Channel.GROUND], 2) / 12.0
    return Motion3(values=values, step=step)


@dataclass(frozen=True, kw_only=True)
class CurvedGround(RecordEffect):
    """A ground acceleration that is curved between samples where a model takes it for straight.

    The second derivative of the cubic spline through a command that answers the ground is exact where the
    ground is straight between samples, and too large by −δ²/12 of the sampled ground where it is smooth. A
    record that was played with straight lines m times as fine as it was sampled lies in between: 1 − m⁻².
    """

    name = "curved_ground"
    block = Block.NUMERICAL
    role = Role.RECORD
    description = "the ground acceleration is curved between its samples"
    parameters = (
        Parameter(
            name="curvature_between_samples",
            units="-",
            meaning="share of the curvature of a smooth ground acceleration",
            signed=True,
            typical=0.5,
            lower=-1e-9,
            upper=1.0,
            starts=(0.0,),
        ),
    )

    curvature_between_samples: float  # Share c of that difference, from 0 (straight) to 1 (smooth)

    def applied(self, acceleration: NDArray[np.float64], step: float) -> NDArray[np.float64]:
        """Ground acceleration [m/s²] that makes up for what the spline takes for straight."""
        del step
        changed = acceleration.copy()
        share = _PER_SECOND_DIFFERENCE * self.curvature_between_samples
        changed[1:-1] -= share * np.diff(acceleration, 2)
        return changed


def curvature_between_samples() -> Calibration:
    """Share of the curvature of a smooth ground acceleration between its samples."""
    return Calibration(
        parameter=CurvedGround.parameters[0],
        apply=lambda model, value: model.adding(CurvedGround(curvature_between_samples=max(value, 0.0))),
    )
