"""The whole loop, where only ground acceleration and one displacement were recorded."""

import math
from copy import copy
from dataclasses import replace
from functools import cached_property, lru_cache
from types import MappingProxyType

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.stated_value import RANGES
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import (
    damping,
    delay,
    gain,
    open_stiffness,
    scale_of_excitation,
    stiffness,
    structure_damping,
)
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.effects.added_mass import AddedMass
from reliab.effects.effect import Effect, Role, Scales
from reliab.effects.excitation_scale import ExcitationScale
from reliab.effects.force_bias import ForceBias
from reliab.effects.general.general_terms import general_terms
from reliab.effects.registry import library
from reliab.effects.sensor_bias import SensorBias
from reliab.effects.stated_damping import StatedDamping
from reliab.effects.viscous_damping import ViscousDamping
from reliab.simulation.hybrid_test.closed_loop import move_piston
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, read_displacement

_COARSEST_RATE = 500.0  # Hz; at half of this the error of the integration looks like an added mass at 50 dB
_FEWEST_STEPS = 60.0  # of the integration in a natural period; what they miss is 70 dB below the signal
_ROUNDING = 0.05
_SPRINGS = 9
_DIED_AWAY = 100.0  # ratio of a free vibration's amplitudes
_SKETCH_SHARE = 0.25  # of the rate of integration, for derivatives
_FEWEST_SKETCHED = 30.0  # of their steps in a natural period
_LOOSE = 0.2  # spread of a gain that no channel shows by itself
_DAMPING = 0.01  # spread of 2ξω₀m with a frequency and a mass as they are stated
_MOST_OF_DAMPING = 0.03  # a larger deviation is an effect: with it an added mass could not be told
_LEAST_DAMPING_RATIO = RANGES["damping ratio"].lowest  # a structure has some
_RIG_ROLES = (Role.DELAY, Role.PISTON, Role.INTEGRATION)


class LoopBlock(ObservedBlock):
    """Ground acceleration → measured displacement, the loop being closed.

    A force bias shifts the displacement as a sensor bias does, and a wrong scale of the excitation is
    calibration where no rig states it: neither is a candidate. A mass without a rig scales excitation,
    stiffness and damping alike: it is named only where it exceeds what calibration makes up for.
    """

    block = Block.NUMERICAL
    channel = Channel.MEASURED
    inputs = (Channel.GROUND,)
    offsets = (SensorBias,)
    twins = MappingProxyType(
        {
            AddedMass: (StatedDamping, ViscousDamping),
            StatedDamping: (AddedMass, ViscousDamping),
            ViscousDamping: (AddedMass, StatedDamping),
        }
    )

    def __init__(self, campaign: Campaign, scales: Scales, motions: tuple[Motion3, ...]) -> None:
        super().__init__(campaign, scales)
        self.motions = motions
        self.open_stiffness = open_stiffness(self.nominal)
        self._rig = rig = campaign.actuator is not None
        effects = library().values()
        calibrated_effects = (ForceBias, SensorBias, ExcitationScale)
        possible = (
            effect
            for effect in effects
            if effect not in calibrated_effects
            and effect.refines is None
            and (rig or effect.role not in _RIG_ROLES)
        )
        self.candidates = (*possible, *((StatedDamping,) if rig and self._damping > 0.0 else ()))
        acting = (*_RIG_ROLES, Role.FORCE) if rig else (Role.FORCE,)
        terms = (*general_terms(Block.ACTUATOR), *general_terms(Block.SPECIMEN))
        self.outside = tuple(term for term in terms if term.role in acting)
        # That of the whole oscillator where no rig stands between structure and specimen
        self.structure_damping = 0.0 if rig else self._damping
        structure = campaign.structure
        if structure is not None and structure.damping_ratio > 0.0:
            self.memory = math.log(_DIED_AWAY) / (structure.damping_ratio * structure.circular_frequency)
        natural = 0.0 if structure is None else structure.frequency
        self.integrate_at(max(_COARSEST_RATE, _FEWEST_STEPS * natural))
        if rig:
            self.calibrations = (
                gain(self.nominal, _LOOSE),
                delay(self.nominal),
                stiffness(self.nominal),
                structure_damping(_DAMPING, _MOST_OF_DAMPING),
            )
        else:
            scale = scale_of_excitation(self._scale())
            self.calibrations = (stiffness(self.nominal), damping(self.nominal), scale)

    def integrate_at(self, rate: float) -> None:
        """Integrate at a rate near a wanted one [Hz]."""
        self._wanted = rate
        self.every = max(1, int(self.rate // rate))
        self.parts = max(1, math.ceil(rate / self.rate - _ROUNDING))
        self._grounds = [
            _resample(test.channels[Channel.GROUND], self.parts, self.every) for test in self.tests
        ]
        self._moved = lru_cache(maxsize=4 * len(self.tests))(self._move)  # of the last model in two threads

    @cached_property
    def sketch(self) -> ObservedBlock:
        """The same, integrated at a longer step."""
        thinned_block = copy(self)
        natural = 0.0 if self.nominal.structure is None else self.nominal.structure.frequency
        thinned_block.integrate_at(max(_SKETCH_SHARE * self._wanted, _FEWEST_SKETCHED * natural))
        return thinned_block

    @property
    def removable(self) -> dict[type[Effect], float]:
        """Damping and mass that are present; those of the controller's own structure are exact."""
        effects = super().removable
        effects[StatedDamping] = self._damping
        if not self._rig:
            effects[ViscousDamping] += self._damping
            effects[AddedMass] += self.nominal.mass
        return effects

    @property
    def _damping(self) -> float:
        """Damping of the controller's structure as stated [N·s/m]."""
        return self.nominal.mass * self.nominal.substructure.damping

    def predict(self, model: HybridTest, test: int) -> Array:
        """Displacement that the sensor reads [m], shape (⌈n / every⌉,)."""
        model = apply_damping(model)
        readings = model.acting(Role.DISPLACEMENT_READING)
        other_effects = tuple(effect for effect in model.effects if effect not in readings)
        return read_displacement(model, self._moved(replace(model, effects=other_effects), test))

    def _move(self, model: HybridTest, test: int) -> Motion3:
        step = self.every / self.rate / self.parts
        return move_piston(model, self._grounds[test], step).thin(self.parts)

    def _scale(self) -> float:
        """Scale at which the excitation explains most of a test, of springs within the calibration."""
        test = next(k for k, candidate in enumerate(self.tests) if not candidate.held_out)
        measured = self.measured(test)[:: self.every]
        reading = measured - measured.mean()
        share, scale = 0.0, 1.0
        spring = stiffness(self.nominal)
        for factor in np.linspace(spring.parameter.lower, spring.parameter.upper, _SPRINGS):
            response = self.predict(spring.apply(self.nominal, factor), test)
            response = response - response.mean()
            energy, projection = float(response @ response), float(response @ reading)
            if projection**2 > share * energy:
                share, scale = projection**2 / energy, projection / energy
        return scale


def apply_damping(model: HybridTest) -> HybridTest:
    """Return a model whose structure has the damping that its effects give it."""
    changes = [effect for effect in model.effects if isinstance(effect, StatedDamping)]
    if not changes or model.structure is None:
        return model
    damping = model.mass * model.substructure.damping
    factor = 1.0 + sum(change.damping_n_s_per_m for change in changes) / damping
    ratio = max(factor * model.structure.damping_ratio, _LEAST_DAMPING_RATIO)
    other_effects = tuple(effect for effect in model.effects if not isinstance(effect, StatedDamping))
    return replace(model, structure=replace(model.structure, damping_ratio=ratio), effects=other_effects)


def _resample(ground: Array, parts: int, thinning: int) -> Array:
    """Ground motion at `parts` times the rate, or each `thinning`-th sample, band-limited.

    The last sample is the last one that was recorded.
    """
    if parts > 1:
        fine: Array = scipy.signal.resample_poly(ground, parts, 1, padtype="line")
        return fine[: (ground.size - 1) * parts + 1]
    if thinning == 1:
        return ground
    weights = scipy.signal.firwin(16 * thinning + 1, 0.8 / thinning)
    return np.asarray(scipy.signal.oaconvolve(ground, weights, mode="same")[::thinning])
