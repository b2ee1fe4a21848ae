"""The force of Bouc and Wen's hysteresis, with the losses and the slip of Baber, Wen and Noori."""

import math

from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers

_YIELDS = 1e-4  # of the elastic stiffness
_LARGEST_PART = 0.1  # of the yield displacement: largest part into which the path is divided
_MOST_PARTS = 50
_LARGEST_FORCE = 100.0  # of the yield force
_SLIP_WIDTH = 0.2  # of the yield force


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: f, d, γ, n, share that the spring lost, δ_η, δ_ν, ζ, share of f that rest takes, and the
    # speed to which it takes it. State: started, displacement, z, dissipated energy over f·d. The path of the
    # displacement decides, and its speed only where rest takes a share.
    gamma, exponent = coefficients[2], coefficients[3]
    beta = 1.0 - gamma - 2.0 * min(gamma, 0.0) ** 2
    travel = (motion[0] - state[1]) / coefficients[1] if state[0] != 0.0 else 0.0
    sign = 1.0 if travel >= 0.0 else -1.0
    z, energy = state[2], state[3]
    substeps = int(abs(travel) / _LARGEST_PART) + 1
    if substeps > _MOST_PARTS:
        # z nears its limit (ν(β + γ))^(−1/n), where there is one, by a factor of e on a way of z/n. Parts
        # twice as long would make it oscillate; after a hundred of these it is there.
        substeps = _MOST_PARTS
        weaker = (beta + gamma) * (1.0 + coefficients[6] * energy)
        if weaker > 0.0:
            steady = max(weaker ** (-1.0 / exponent) / exponent, _LARGEST_PART)
            steady *= 1.0 + coefficients[5] * energy
            substeps = max(_MOST_PARTS, int(abs(travel) / steady) + 1)
    increment, ahead = travel / substeps, substeps
    for _ in range(min(substeps, 2 * _MOST_PARTS)):
        ahead -= 1
        weaker = 1.0 + coefficients[6] * energy
        softer = increment / (1.0 + coefficients[5] * energy)
        if coefficients[7] > 0.0:
            softer *= 1.0 - coefficients[7] * math.exp(-((z / _SLIP_WIDTH) ** 2))
        direction = beta if sign * z >= 0.0 else -beta
        rise = softer * (1.0 - weaker * abs(z) ** exponent * (direction + gamma))
        middle = min(max(z + 0.5 * rise, -_LARGEST_FORCE), _LARGEST_FORCE)
        direction = beta if sign * middle >= 0.0 else -beta
        rise = softer * (1.0 - weaker * abs(middle) ** exponent * (direction + gamma))
        energy = max(energy + middle * (increment - rise), 0.0)
        z = min(max(z + rise, -_LARGEST_FORCE), _LARGEST_FORCE)
        if abs(rise) < _YIELDS * abs(increment):
            break
    energy = max(energy + ahead * increment * z, 0.0)  # it yields to the end of the step
    state[0], state[1], state[2], state[3] = 1.0, motion[0], z, energy
    if coefficients[8] != 0.0:
        z *= 1.0 - coefficients[8] * math.exp(-abs(motion[1]) / coefficients[9])
    return coefficients[0] * (z - coefficients[4] * motion[0] / coefficients[1])


SHARPEST = 50.0
"""Largest exponent n [-] that the steps follow; above it the force leaves its bounds."""


def require_followed(exponent: float) -> None:
    """Refuse an exponent [-] that the steps cannot follow."""
    if exponent > SHARPEST:
        raise InputError(
            f"The exponent of a hysteresis must be at most {SHARPEST:g}",
            value=f"{exponent:g}",
            remedy="Give 20 for a sharp corner",
        )


BOUC_WEN = Kernel(function=_force, states=4, linear=0, by_path=True)
"""Kernel of ten coefficients: those of a hysteresis, then growth of flexibility, fall of strength, slip, and
two zeros."""

SLIDING = Kernel(function=_force, states=4, linear=0)
"""The same, whose last coefficients are the share of the force that rest takes, and a speed."""
