"""The Bouc–Wen benchmark of Noël & Schoukens (2016) in its steady state: records that begin in motion."""

import numpy as np
import pytest
from scipy import fft

from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose

RATE, SAMPLES, FINER, TESTS = 750.0, 4096, 6, 4
MASS, DAMPING, STIFFNESS = 2.0, 10.0, 5e4
ALPHA, BETA, GAMMA, DELTA = 5e4, 1e3, 0.8, -1.1
FORCE = 50.0  # RMS of the multisines [N]
SAY = """
name = "benchmark"
[structure]
frequency_hz = 35.2
damping_ratio = 0.0112
mass_kg = 2.0
[sampling]
rate_hz = 750
"""


def multisines(rng):
    """Periodic forces between 5 and 150 Hz at the fine rate, shape (tests, n)."""
    n = SAMPLES * FINER
    spectrum = np.zeros((TESTS, n // 2 + 1), dtype=complex)
    band = fft.rfftfreq(n, 1.0 / (RATE * FINER))
    interior = (band > 5.0) & (band < 150.0)
    spectrum[:, interior] = np.exp(2j * np.pi * rng.random((TESTS, int(interior.sum()))))
    forces = fft.irfft(spectrum, n)
    return FORCE * forces / forces.std(axis=1, keepdims=True)


def steady_displacement(forces):
    """Displacements in the second period, by the classical Runge–Kutta method, shape (tests, samples)."""
    step, n = 1.0 / (RATE * FINER), forces.shape[1]

    def rates(state, force):
        y, v, z = state
        bent = BETA * (GAMMA * np.abs(v) * z + DELTA * v * np.abs(z))
        return np.stack([v, (force - STIFFNESS * y - DAMPING * v - z) / MASS, ALPHA * v - bent])

    state, samples = np.zeros((3, TESTS)), []
    for i in range(2 * n):
        if i >= n and i % FINER == 0:
            samples.append(state[0])
        now, then = forces[:, i % n], forces[:, (i + 1) % n]
        a = rates(state, now)
        b = rates(state + 0.5 * step * a, 0.5 * (now + then))
        c = rates(state + 0.5 * step * b, 0.5 * (now + then))
        d = rates(state + step * c, then)
        state = state + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return np.stack(samples, axis=1)


@pytest.mark.slow
def test_hysteresis_alone_predicts_a_test_from_motion(tmp_path):
    forces = multisines(np.random.default_rng(3))
    displacement = steady_displacement(forces)
    displacement += 1e-4 * displacement.std() * np.random.default_rng(4).standard_normal(displacement.shape)
    say = SAY
    for k in range(TESTS):
        columns = np.column_stack([np.arange(SAMPLES) / RATE, -forces[k, ::FINER] / MASS, displacement[k]])
        header = "time_s,ground_acceleration_mps2,measured_m"
        np.savetxt(tmp_path / f"{k}.csv", columns, delimiter=",", header=header, comments="")
        say += f'[[tests]]\nfile = "{k}.csv"\nmotion = "multisine {k}"\n'
    (tmp_path / "campaign.toml").write_text(say)
    diagnosis = diagnose(read_campaign(tmp_path))
    assert [effect.name for effect in diagnosis.effects] == ["hysteresis"]
    assert diagnosis.gap.after < 0.003
    shape = {estimate.name: estimate.value for estimate in diagnosis.effects[0].estimates}
    assert shape["exponent"] == pytest.approx(1.0, rel=0.02)
    beta = 1.0 - shape["gamma"] - 2.0 * min(shape["gamma"], 0.0) ** 2
    assert shape["gamma"] / beta == pytest.approx(DELTA / GAMMA, rel=0.02)
