"""Forces of specimens after published equations, none exactly as the library has them.

Every function takes time, displacement and velocity of shape (n,), the peaks of both, and a generator, and
returns the force [N] of shape (n,) for a specimen of unit scale.
"""

import numpy as np

FINE = 4  # steps of an evolution to a sample


def _evolved(time, displacement, velocity, rate, states=1):
    """Integrate states from zero along a motion by Heun's rule at a fine step; shape (states, n)."""
    fine = np.linspace(time[0], time[-1], FINE * (time.size - 1) + 1)
    x, v = np.interp(fine, time, displacement), np.interp(fine, time, velocity)
    step = fine[1] - fine[0]
    z = np.zeros(states)
    out = np.zeros((states, time.size))
    for i in range(1, fine.size):
        first = rate(x[i - 1], v[i - 1], z)
        second = rate(x[i], v[i], z + step * first)
        z = z + 0.5 * step * (first + second)
        if i % FINE == 0:
            out[:, i // FINE] = z
    return out


def dahl(time, x, v, reach, speed, rng):
    """Friction after Dahl (1968): F' = σ·v·|1 − F/F_c·sgn(v)|^i·sgn(1 − F/F_c·sgn(v))."""
    del speed
    stiffness, power = 1.0 / (rng.uniform(0.03, 0.2) * reach), rng.uniform(1.2, 2.0)

    def rate(_x, v, z):
        rest = 1.0 - z * np.sign(v)
        return stiffness * v * np.abs(rest) ** power * np.sign(rest)

    return _evolved(time, x, v, rate)[0]


def lugre(time, x, v, reach, speed, rng):
    """Friction after Canudas de Wit et al. (1995): bristles, Stribeck's curve, viscous part."""
    static, stribeck = rng.uniform(1.1, 1.4), rng.uniform(0.02, 0.1) * speed
    stiffness = 1.0 / (rng.uniform(0.02, 0.06) * reach)
    damping = 0.3 * np.sqrt(stiffness) * 0.01

    def slope(v, z):
        level = 1.0 + (static - 1.0) * np.exp(-((v / stribeck) ** 2))
        return v - stiffness * np.abs(v) * z / level

    z = _evolved(time, x, v, lambda _x, v, z: slope(v, z))[0]
    return stiffness * z + damping * slope(v, z) + rng.uniform(0.0, 0.1) * v / speed


def bouc_wen_hardening(time, x, v, reach, speed, rng):
    """The benchmark of Noël & Schoukens (2016), α 5e4, β 1e3, γ 0.8, δ −1.1, ν 1, scaled to the motion."""
    del speed, rng
    scale = 1.5e-3 / reach

    def rate(_x, v, z):
        v = scale * v
        return 5e4 * v - 1e3 * (0.8 * np.abs(v) * z - 1.1 * v * np.abs(z))

    z = _evolved(time, x, v, rate)[0]
    return z / np.abs(z).max()


def baber_noori(time, x, v, reach, speed, rng):
    """Bouc–Wen–Baber–Noori (1985): loss of strength and stiffness with energy, pinched about z = 0."""
    del speed
    yields, strength, stiff = (
        rng.uniform(0.1, 0.3) * reach,
        rng.uniform(0.005, 0.03),
        rng.uniform(0.005, 0.03),
    )
    slip, width = rng.uniform(0.2, 0.6), rng.uniform(0.1, 0.3)

    def rate(_x, v, state):
        z, energy = state
        nu, eta = 1.0 + strength * energy, 1.0 + stiff * energy
        pinched = 1.0 - slip * np.exp(-((z * np.sign(v) - 0.1) ** 2) / width**2)
        change = pinched / eta * v / yields * (1.0 - nu * (0.5 * np.sign(v * z) + 0.5) * np.abs(z) ** 1.6)
        return np.array([change, z * v / yields])

    return _evolved(time, x, v, rate, states=2)[0]


def stribeck(time, x, v, reach, speed, rng):
    """Dry friction that falls from its static to its sliding value with speed (Stribeck 1902)."""
    del time, x, reach
    static, width = rng.uniform(1.1, 1.5), rng.uniform(0.05, 0.3) * speed
    return np.tanh(v / (0.002 * speed)) * (1.0 + (static - 1.0) * np.exp(-((np.abs(v) / width) ** 0.8)))


def bilinear_gap(time, x, v, reach, speed, rng):
    """What a clearance takes from a spring, contact being rounded and stiffer on one side."""
    del time, v, speed
    gap, softness, asymmetry = rng.uniform(0.1, 0.3) * reach, 0.01 * reach, rng.uniform(0.0, 0.15)
    over = softness * (np.logaddexp(0.0, (x - gap) / softness) - np.logaddexp(0.0, (-x - gap) / softness))
    return (over * (1.0 + asymmetry * (x > 0.0)) - x) / reach


def shear_thinning(time, x, v, reach, speed, rng):
    """Fluid damper after Carreau: c·v·(1 + (λv)²)^((p − 1)/2), warming up during the test."""
    del x, reach
    power, corner = rng.uniform(0.25, 0.6), rng.uniform(20.0, 80.0) / speed
    warm = 1.0 - rng.uniform(0.0, 0.1) * time / time[-1]
    force = v * (1.0 + (corner * v) ** 2) ** (0.5 * (power - 1.0))
    return warm * force / np.abs(force).max()


def rubber(time, x, v, reach, speed, rng):
    """A spring that stiffens like a tangent."""
    del time, v, speed
    turn = rng.uniform(0.7, 1.15)
    return (np.tan(turn * np.clip(x / reach, -1.15, 1.15)) - turn * x / reach) / (np.tan(turn) - turn)


def orifice(time, x, v, reach, speed, rng):
    """An orifice damper: c·|v|^p·sgn(v) with p about, but not at, two."""
    del time, x, reach
    return np.sign(v) * (np.abs(v) / speed) ** rng.uniform(1.75, 2.3)


SPECIMENS = {
    "dahl": (dahl, {"hysteresis", "coulomb_friction", "degrading_hysteresis"}),
    "lugre": (
        lugre,
        {"coulomb_friction", "hysteresis", "directional_friction", "velocity_dependent_friction"},
    ),
    "bouc_wen_hardening": (bouc_wen_hardening, {"hysteresis", "degrading_hysteresis"}),
    "baber_noori": (baber_noori, {"hysteresis", "degrading_hysteresis"}),
    "stribeck": (stribeck, {"coulomb_friction", "directional_friction", "velocity_dependent_friction"}),
    "bilinear_gap": (bilinear_gap, {"gap"}),
    "shear_thinning": (shear_thinning, {"power_law_damping"}),
    "rubber": (rubber, {"cubic_stiffness"}),
    "orifice": (orifice, {"quadratic_damping"}),
}
"""Equation and the names of the library that stand for it, by world."""
