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

The numerical substructure may be a frame (:mod:`reliab.structures.inner_motion`).
"""

from copy import copy
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import fft

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import (
    Calibration,
    force_not_fed_back,
    structure_damping,
    structure_frequency,
    structure_mass,
)
from reliab.discrepancy.blocks.observed import SuperposedBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.effects.clock_offset import ClockOffset, LateGround
from reliab.effects.curved_ground import CUBIC_SPLINE_ERROR, CurvedGround
from reliab.effects.effect import RecordEffect, Role, Scales
from reliab.effects.force_bias import ForceBias
from reliab.effects.integration_error import IntegrationError
from reliab.effects.registry import library
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3
from reliab.structures.inner_motion import InnerMotion

_RETURN = 1.0  # s, within which a record is closed to a period
_STEPS_TO_ANSWER = 2.0  # of an integration, after which the command shows what was demanded
_DISPLACEMENT, _VELOCITY, _ACCELERATION, _ONE = range(4)


class BalanceTerm(NamedTuple):
    """A part of the force, up to a factor, or of what a coarse integration demanded."""

    source: int | tuple[RecordEffect, ...]  # Row of the command's motion, one, or what acts on the ground
    coarse: IntegrationError | None = None  # Integration whose answer it is, below half of its rate
    step: float = 0.0  # Step of an integration [s], of which only what lies above half of its rate is taken


class NumericalBlock(SuperposedBlock[BalanceTerm]):
    """(ground acceleration, command) → force."""

    block = Block.NUMERICAL
    channel = Channel.FORCE
    inputs = (Channel.GROUND, Channel.COMMAND)
    is_narrow = True

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        super().__init__(campaign, scales)
        self.motions = tuple(motion_of_command(test, campaign.step) for test in campaign.tests)
        self.forget_terms()

    def history(self, source: int | tuple[RecordEffect, ...], test: int) -> Array:
        """Row of the command's motion, or the ground acceleration after what acts on it, shape (n,)."""
        if isinstance(source, int):
            motion = self.motions[test].values
            return np.ones(motion.shape[1]) if source == _ONE else np.asarray(motion[source])
        if not source:
            return self.tests[test].channels[Channel.GROUND]
        *earlier, last = source
        return last.applied(self.history(tuple(earlier), test), 1.0 / self.rate)


class BalanceBlock(NumericalBlock):
    """The force of a structure of one degree of freedom."""

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        super().__init__(campaign, scales)
        self.calibrations = (
            curvature_between_samples(),
            structure_frequency(),
            structure_damping(),
            structure_mass(),
            force_not_fed_back(),
        )
        effects = (effect for effect in library().values() if effect.role in (Role.RECORD, Role.INTEGRATION))
        self.candidates = (*effects, ClockOffset, LateGround)
        structure, specimen = self.nominal.structure, self.nominal.specimen
        self._circular_frequency = structure.circular_frequency if structure else 0.0
        self._spring = specimen.stiffness / self.nominal.mass if specimen else 0.0
        step = next(p for p in IntegrationError.parameters if p.name == "step_s")
        self.answer_time = _STEPS_TO_ANSWER * step.upper
        self._transform = lru_cache(maxsize=5 * len(self.tests))(self._transform_closed)

    def limit_band(self, frequency: float) -> "BalanceBlock":
        """Return the same block judged up to a frequency [Hz] only."""
        narrow = copy(self)
        narrow.highest = min(frequency, self.highest_signal)
        return narrow

    def fix_ground_clock(self) -> "BalanceBlock":
        """Return the same block whose ground acceleration is taken to be recorded in time."""
        punctual_block = copy(self)
        punctual_block.candidates = tuple(effect for effect in self.candidates if effect is not LateGround)
        return punctual_block

    def read_late(self, lag: float) -> "BalanceBlock":
        """Return the same block with a force that was recorded so much later than it acted.

        `lag` [s].
        """
        late = copy(self)
        late.nominal = self.nominal.adding(ClockOffset(lag_s=lag))
        return late

    def terms(self, model: HybridTest, test: int) -> list[tuple[float, BalanceTerm]]:
        """Parts of the force that balances ground motion and command [N], each with its factor."""
        del test
        mass, structure, ground = model.mass, model.substructure, _record_effects(model)
        damping, stiffness = mass * structure.damping, mass * structure.stiffness
        terms = [
            (_offset(model), BalanceTerm(_ONE)),
            (-mass, BalanceTerm(ground)),
            (-damping, BalanceTerm(_VELOCITY)),
            (-stiffness, BalanceTerm(_DISPLACEMENT)),
        ]
        effects = (effect for effect in model.effects if isinstance(effect, IntegrationError))
        coarse = next(effects, None)
        if coarse is None:
            return [*terms, (-mass, BalanceTerm(_ACCELERATION))]
        lead, step = damping * coarse.velocity_lead, coarse.step_s
        return [
            *terms,
            (-lead, BalanceTerm(_ACCELERATION)),
            (-mass, BalanceTerm(_ACCELERATION, coarse=coarse)),
            # Above half of the controller's rate the demand is that of the nominal specimen.
            (mass, BalanceTerm(ground, step=step)),
            (stiffness + mass * self._spring, BalanceTerm(_DISPLACEMENT, step=step)),
            (damping, BalanceTerm(_VELOCITY, step=step)),
            (lead, BalanceTerm(_ACCELERATION, step=step)),
        ]

    def signal(self, term: BalanceTerm, test: int) -> Array:
        """Compute a part of the force in a test, shape (n,)."""
        history = self.history(term.source, test)
        if not (term.coarse or term.step):
            return history
        spectrum, length = self._transform(term.source, test), _period_length(history, self.rate)
        frequency = fft.rfftfreq(length, 1.0 / self.rate)
        share = np.zeros(frequency.size, dtype=np.complex128)
        if term.coarse:
            is_resolved = frequency < 0.5 / term.coarse.step_s
            share[is_resolved] = 1.0 / term.coarse.transfer(frequency[is_resolved], self._circular_frequency)
        else:
            share[frequency >= 0.5 / term.step] = 1.0
        return np.asarray(fft.irfft(share * spectrum, length)[: history.size])

    def _transform_closed(self, source: int | tuple[RecordEffect, ...], test: int) -> Spectrum:
        """Fourier transform of a history that returns to its begin on a straight line."""
        history = self.history(source, test)
        length = _period_length(history, self.rate)
        way = np.linspace(history[-1], history[0], length - history.size + 1)[1:]
        return np.asarray(fft.rfft(np.concatenate([history, way])), dtype=np.complex128)


def _period_length(history: Array, rate: float) -> int:
    return int(fft.next_fast_len(history.size + int(_RETURN * rate), real=True))


def _record_effects(model: HybridTest) -> tuple[RecordEffect, ...]:
    return tuple(effect for effect in model.effects if isinstance(effect, RecordEffect))


def _offset(model: HybridTest) -> float:
    """Offset of the recorded force in a model [N]."""
    return sum(effect.bias_n for effect in model.effects if isinstance(effect, ForceBias))


class FrameBalanceBlock(NumericalBlock):
    """The force of a frame.

    Effects on the record are searched for here; errors of the integration of a frame are not.
    """

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        super().__init__(campaign, scales)
        if campaign.partition is None:
            raise InputError("The balance of a frame needs a frame", remedy="Add a [structure.frame] table")
        self.calibrations = (curvature_between_samples(), force_not_fed_back())
        records = (effect for effect in library().values() if effect.role is Role.RECORD)
        self.candidates = (*records, LateGround)
        self._inner = InnerMotion(campaign.partition, campaign.step)

    def terms(self, model: HybridTest, test: int) -> list[tuple[float, BalanceTerm]]:
        """Force that balances the command, that of the ground motion, and the offset of the load cell [N]."""
        del test
        ground = BalanceTerm(_record_effects(model))
        return [(_offset(model), BalanceTerm(_ONE)), (1.0, BalanceTerm(_DISPLACEMENT)), (1.0, ground)]

    def signal(self, term: BalanceTerm, test: int) -> Array:
        """Compute the force that balances the command or the ground motion [N], shape (n,)."""
        motion = self.motions[test].values
        if term.source == _ONE:
            return self.history(_ONE, test)
        if term.source == _DISPLACEMENT:
            return self._inner.force(np.zeros(motion.shape[1]), motion)
        return self._inner.force(self.history(term.source, test), np.zeros_like(motion))


def motion_of_command(test: MeasuredTest, step: float) -> Motion3:
    """Motion of the command, whose acceleration is as straight between samples as the ground's only in part.

    The spline takes all of it for straight, which makes the smooth rest s = x'' + a_g larger by −h²s''/12.
    The ground is taken for straight here; how much of its curvature is missed is calibrated.
    """
    motion = Motion3.interpolate(test.channels[Channel.COMMAND], step)
    values = motion.values.copy()
    values[2, 1:-1] += np.diff(values[2] + test.channels[Channel.GROUND], 2) * CUBIC_SPLINE_ERROR
    return Motion3(values=values, step=step)


def curvature_between_samples() -> Calibration:
    """Share of the curvature of a smooth ground acceleration between its samples."""
    return Calibration(
        parameter=CurvedGround.parameters[0],
        apply=lambda model, value: model.adding(CurvedGround(curvature_between_samples=max(value, 0.0))),
    )
