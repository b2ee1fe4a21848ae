"""Find the size at which an effect has a wished effect-to-noise ratio."""

import math
from dataclasses import dataclass

import numpy as np

from blind_campaigns.case import ONE_CHANNEL, Case, decibels, root_mean_square
from blind_campaigns.catalogue import Definition, Scales
from blind_campaigns.loop_refit import loop_residual
from blind_campaigns.ratio import calibrated_residual, effect_change, effect_to_noise
from blind_campaigns.simulator import Response
from blind_campaigns.system import Array, Effect

_COARSE_HZ = 1024.0
_SMALLEST = 1e-6


@dataclass(frozen=True, kw_only=True)
class Sizing:
    """An effect whose size is still open, in a campaign that may hide others already."""

    case: Case
    definition: Definition
    scales: Scales
    shape: Array
    largest_command: float

    def effect(self, size: float) -> Effect:
        """Return the effect of a size."""
        return self.definition.make(size, self.scales, self.shape)

    def ratio(self, size: float) -> float:
        """Return the ratio [dB] at a size, +∞ where the loop runs away."""
        effect = self.effect(size)
        case = self.case.having(self.case.rig.adding(effect))
        responses = case.run(_COARSE_HZ)
        if not believable(responses, self.largest_command):
            return math.inf
        return block_ratio(case, effect, responses)


def believable(responses: list[Response], largest_command: float) -> bool:
    """Return whether all tests stayed bounded and below a largest displacement [m]."""
    return all(
        run.bounded
        and np.abs(run.command).max() < largest_command
        and np.abs(run.piston).max() < largest_command
        for run in responses
    )


def block_ratio(case: Case, effect: Effect, responses: list[Response], *, evaluations: int = 4) -> float:
    """Return the ratio [dB] in an observed block, or of the whole loop where only that is observed."""
    if case.observation in ONE_CHANNEL:
        left = loop_residual(case, effect, evaluations=evaluations)
        return decibels(root_mean_square(left) / case.noise_rms["measured_m"])
    change = effect_change(case, effect, responses)
    return effect_to_noise(case, change, calibrated_residual(change))


def sized_effect(
    sizing: Sizing, *, target_db: float, snr_db: float, tolerance_db: float = 1.0
) -> Effect | None:
    """Return the effect whose ratio is the target, or None where no admissible size reaches it."""
    largest = sizing.definition.largest
    low, high = _SMALLEST, None
    size = float(np.clip(10.0 ** ((target_db - snr_db) / 20.0), _SMALLEST, 0.5 * largest))
    for _ in range(9):
        ratio = sizing.ratio(size)
        if abs(ratio - target_db) < tolerance_db:
            return sizing.effect(size)
        if ratio < target_db:
            low = max(low, size)
            if size >= largest:
                return None
        else:
            high = size
        size = _next_size(low, high, size, target_db - ratio, largest)
    return None


def _next_size(low: float, high: float | None, size: float, missing_db: float, largest: float) -> float:
    """Return the size that a proportional law asks for, kept inside the bracket."""
    guess = size * 10.0 ** (np.clip(missing_db, -40.0, 40.0) / 22.0) if math.isfinite(missing_db) else 0.0
    if high is None:
        return float(min(guess, largest))
    if not low < guess < high:
        guess = math.sqrt(low * high)
    return float(guess)
