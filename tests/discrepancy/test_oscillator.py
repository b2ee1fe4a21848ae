"""An oscillator without a rig, of any frequency, shaken by an excitation of unknown scale and sign."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import fft

from reliab.discrepancy.blocks.loop import LoopBlock
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import begin_search, diagnose
from reliab.discrepancy.segment import motions_of, scales_of

RATE = 610.0
FREQUENCY, DAMPING_RATIO = 68.0, 0.047
SAMPLES, TESTS, FINER = 2048, 4, 16
SCALE = -1.8e5  # of volts to m/s²
CUBIC = 0.3  # of the linear stiffness, at three standard deviations of the displacement
SAY = """
name = "oscillator"
[structure]
frequency_hz = 66.0
damping_ratio = 0.047
[sampling]
rate_hz = 610
"""


def multisines(rng):
    """Band-limited excitations of unit variance at the fine rate, shape (tests, n)."""
    n = SAMPLES * FINER
    spectrum = np.zeros((TESTS, n // 2 + 1), dtype=complex)
    band = fft.rfftfreq(n, 1.0 / (RATE * FINER))
    interior = (band > 1.0) & (band < 200.0)
    spectrum[:, interior] = np.exp(2j * np.pi * rng.random((TESTS, int(interior.sum()))))
    excitations = fft.irfft(spectrum, n)
    return excitations / excitations.std()


def responses(excitations, cubic):
    """Displacements by the classical Runge–Kutta method, shape (tests, samples)."""
    w0, step = 2.0 * np.pi * FREQUENCY, 1.0 / (RATE * FINER)

    def rates(x, v, u):
        return v, -2.0 * DAMPING_RATIO * w0 * v - w0**2 * (x + cubic * x**3) - SCALE * u

    x, v, result = np.zeros(TESTS), np.zeros(TESTS), []
    for i in range(SAMPLES * FINER):
        result.append(x)
        u, u_next = excitations[:, i], excitations[:, (i + 1) % excitations.shape[1]]
        middle = 0.5 * (u + u_next)
        a = rates(x, v, u)
        b = rates(x + 0.5 * step * a[0], v + 0.5 * step * a[1], middle)
        c = rates(x + 0.5 * step * b[0], v + 0.5 * step * b[1], middle)
        d = rates(x + step * c[0], v + step * c[1], u_next)
        x = x + step / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0])
        v = v + step / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1])
    return np.stack(result[::FINER], axis=1)


@pytest.fixture(scope="module")
def linear():
    """Excitations and the responses of the linear oscillator, whose standard deviation is 0.05 m."""
    volts = multisines(np.random.default_rng(4))
    displacement = responses(volts, 0.0)
    scale = 0.05 / displacement.std()
    return scale * volts, scale * displacement


@pytest.fixture
def campaign(tmp_path, linear):
    def write_tests(cubic_share):
        volts, displacement = linear
        cubic = cubic_share / (3.0 * 0.05) ** 2
        if cubic_share:
            displacement = responses(volts, cubic)
        displacement = displacement + 2e-4 * np.random.default_rng(5).standard_normal(displacement.shape)
        time = np.arange(SAMPLES) / RATE
        say = SAY
        for k in range(TESTS):
            columns = np.column_stack([time, volts[k, ::FINER], displacement[k]])
            header = "time_s,ground_acceleration_mps2,measured_m"
            np.savetxt(tmp_path / f"{k}.csv", columns, delimiter=",", header=header, comments="")
            say += f'[[tests]]\nfile = "{k}.csv"\nmotion = "multisine {k}"\n'
        (tmp_path / "campaign.toml").write_text(say)
        return read_campaign(tmp_path), cubic * (2.0 * np.pi * FREQUENCY) ** 2

    return write_tests


@pytest.mark.slow
def test_a_linear_oscillator_is_calibrated(campaign):
    recording, _ = campaign(0.0)
    diagnosis = diagnose(recording).to_dict()
    assert diagnosis["verdict"] == "no_missing_effect"
    assert diagnosis["gap"]["nrmse_after"] < 0.006
    assert not any("stated wrongly" in remark for remark in diagnosis["remarks"])


@pytest.mark.slow
@pytest.mark.parametrize(("nominal", "is_open"), [(66.0, False), (60.0, True)])
def test_frequency_beyond_calibration_leaves_noise_with_a_free_stiffness(campaign, nominal, is_open):
    recording, _ = campaign(0.0)
    recording = replace(recording, structure=replace(recording.structure, frequency=nominal))
    motions = motions_of(recording)
    block = LoopBlock(recording, scales_of(recording, motions), motions)
    null = begin_search(block).null
    values = dict(
        zip([p.name for p in null.space.parameters], null.space.values(null.coordinates), strict=True)
    )
    assert (null.space.block is not block) is is_open
    assert values["stiffness"] == pytest.approx((FREQUENCY / nominal) ** 2, rel=2e-3)


@pytest.mark.slow
def test_frequency_beyond_calibration_is_told_without_an_effect(campaign):
    recording, _ = campaign(0.0)
    diagnosis = diagnose(replace(recording, structure=replace(recording.structure, frequency=60.0)))
    assert diagnosis.verdict == "no_missing_effect"
    assert diagnosis.statement.startswith("The tests did not run with what was stated (stiffness")


@pytest.mark.slow
def test_a_hardening_oscillator_is_named(campaign):
    recording, stiffness = campaign(CUBIC)
    diagnosis = diagnose(recording).to_dict()
    assert [effect["name"] for effect in diagnosis["effects"]] == ["cubic_stiffness"]
    assert diagnosis["effects"][0]["parameters"]["cubic_n_per_m3"]["value"] == pytest.approx(
        stiffness, rel=0.02
    )
    assert diagnosis["gap"]["nrmse_after"] < 0.006
    assert not any("stated wrongly" in remark for remark in diagnosis["remarks"])


@pytest.mark.slow
def test_damper_in_one_channel_may_be_a_wrong_damping_ratio(campaign):
    recording, _ = campaign(0.0)
    nominal = replace(recording.structure, damping_ratio=0.8 * DAMPING_RATIO)
    diagnosis = diagnose(replace(recording, structure=nominal)).to_dict()
    assert [effect["name"] for effect in diagnosis["effects"]] == ["viscous_damping"]
    assert any("stated wrongly" in remark for remark in diagnosis["remarks"])
