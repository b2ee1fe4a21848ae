"""The whole loop, where only ground acceleration and one displacement were recorded."""

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from reliab.discrepancy.blocks.calibration import delay, gain, scale_of_excitation, stiffness
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign import Campaign, Channel
from reliab.discrepancy.outside import outside_terms
from reliab.loop.effects import Effect, Role, Scales, library
from reliab.loop.effects.excitation_scale import ExcitationScale
from reliab.loop.effects.force_bias import ForceBias
from reliab.loop.effects.sensor_bias import SensorBias
from reliab.loop.hybrid_test import HybridTest, Motion3, run_closed_loop
from reliab.vocabulary import Block

Array = NDArray[np.float64]

_COARSEST_RATE = 500.0  # Hz; at half of this the error of the integration passes for an added mass at 50 dB
_OF_THE_RIG = (Role.DELAY, Role.PISTON, Role.INTEGRATION)


class LoopBlock(ObservedBlock):
    """Ground acceleration → measured displacement, the loop being closed.

    A force bias shifts the displacement as a sensor bias does, and a wrong scale of the excitation is
    calibration where no rig states it: neither is a candidate.

    Parameters
    ----------
    campaign : Campaign
        A campaign with a structure, ground acceleration and measured displacement.
    scales : Scales
        How large things are.
    motions : tuple of Motion3
        Smoothed motions.
    """

    block = Block.NUMERICAL
    channel = Channel.MEASURED

    def __init__(self, campaign: Campaign, scales: Scales, motions: tuple[Motion3, ...]) -> None:
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.every = max(1, int(campaign.rate // _COARSEST_RATE))
        self.scales = scales
        self.nominal = campaign.nominal
        self.motions = motions
        rig = campaign.actuator is not None
        if rig:
            self.calibrations = (gain(self.nominal), delay(self.nominal), stiffness(self.nominal))
        else:
            self.calibrations = (stiffness(self.nominal), scale_of_excitation())
        self.offsets = (SensorBias,)
        self.candidates = tuple(effect for effect in library().values() if _possible(effect, rig=rig))
        acting = (*_OF_THE_RIG, Role.FORCE) if rig else (Role.FORCE,)
        terms = (*outside_terms(Block.ACTUATOR), *outside_terms(Block.SPECIMEN))
        self.outside = tuple(term for term in terms if term.role in acting)
        self._grounds = [_thinned(test.channels[Channel.GROUND], self.every) for test in self.tests]

    def predict(self, model: HybridTest, test: int) -> Array:
        """Displacement that the sensor reads [m], shape (⌈n / every⌉,)."""
        return run_closed_loop(model, self._grounds[test], self.every / self.rate).measured


def _possible(effect: type[Effect], *, rig: bool) -> bool:
    if effect in (ForceBias, SensorBias, ExcitationScale):
        return False
    return rig or effect.role not in _OF_THE_RIG


def _thinned(ground: Array, every: int) -> Array:
    """Each `every`-th sample, after a filter without delay that lets the signal pass."""
    if every == 1:
        return ground
    weights = signal.firwin(16 * every + 1, 0.8 / every)
    return np.asarray(signal.oaconvolve(ground, weights, mode="same")[::every])
