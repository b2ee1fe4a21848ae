"""Effects of a specimen are named in each of the forms in which textbooks write them."""

import numpy as np
import pytest
from benchmarks.blind_evaluation import foretold
from scipy import signal

from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import Verdict

RATE, DURATION, TESTS = 512.0, 12.0, 4
STIFFNESS = 4.0e4
YIELD = 0.4  # of the largest displacement
BETA, EXPONENT = 0.5, 2.0
LARGEST = 0.02
STEP_UNIT = STIFFNESS * 0.1 * LARGEST  # about the force's RMS
PARTS = 20


def motion(rng):
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    band = signal.butter(2, [0.4, 2.5], "band", fs=RATE, output="sos")
    displacement = signal.sosfiltfilt(band, rng.standard_normal(time.size))
    displacement *= np.exp(-(((time - 5.0) / 3.0) ** 2)) * np.clip(time, 0.0, 1.0) ** 2
    return LARGEST * displacement / np.abs(displacement).max()


def hysteretic(displacement):
    """Dimensionless hysteretic variable z along a displacement, by small steps of Euler's method."""
    z, history = 0.0, [0.0]
    for step in np.diff(displacement).tolist():  # numbers of Python, which are faster one by one
        part = step / PARTS / (YIELD * LARGEST)
        for _ in range(PARTS):
            z += part * (1.0 - abs(z) ** EXPONENT * (1.0 if part * z > 0.0 else 1.0 - 2.0 * BETA))
        history.append(z)
    return np.array(history)


def textbook(displacement, exponent):
    """Force αkx + (1 − α)k·d·z, whose stiffness of small motions is the nominal one."""
    return STIFFNESS * (
        exponent * displacement + (1.0 - exponent) * YIELD * LARGEST * hysteretic(displacement)
    )


def add_friction(displacement, share):
    """Force kx + share·k·d·z."""
    return STIFFNESS * (displacement + share * YIELD * LARGEST * hysteretic(displacement))


def sliding(displacement, share, turn=0.01):
    """Force kx + share·k·d·tanh(v/v₀), whose friction turns over a hundredth of the largest velocity."""
    velocity = np.gradient(displacement, 1.0 / RATE)
    direction = np.tanh(velocity / (turn * np.abs(velocity).max()))
    return STIFFNESS * (displacement + share * YIELD * LARGEST * direction)


def write_tests(folder, specimen, force, *, count=TESTS, noise=0.005, steps=0.0):
    """Write a campaign of displacements and forces with noise, and a force in steps of a part of its RMS."""
    rng = np.random.default_rng(11)
    say = f'name = "specimen"\n[specimen]\n{specimen}\n[sampling]\nrate_hz = {RATE}\n'
    for k in range(count):
        displacement = motion(rng)
        channels = (displacement, force(displacement))
        noisy = [item + noise * item.std() * rng.standard_normal(item.size) for item in channels]
        if steps > 0.0:
            noisy[1] = np.round(noisy[1] / (steps * STEP_UNIT)) * steps * STEP_UNIT
        columns = np.column_stack([np.arange(displacement.size) / RATE, *noisy])
        header = "time_s,measured_m,force_n"
        np.savetxt(folder / f"{k}.csv", columns, delimiter=",", header=header, comments="")
        say += f'[[tests]]\nfile = "{k}.csv"\nmotion = "record {k}"\n'
    (folder / "campaign.toml").write_text(say)
    return read_campaign(folder)


def closed_share(gap):
    """Closed share of a gap's energy; without a floor, which only makes it larger, where that is unknown."""
    share = 1.0 - (gap["nrmse_after"] / gap["nrmse_before"]) ** 2
    return share if gap["closed_fraction"] is None else gap["closed_fraction"]


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("force", "value", "name", "size", "reference"),
    [
        (add_friction, 0.3, "hysteresis", "displacement_m", YIELD * LARGEST),
        (textbook, 0.5, "hysteresis", "displacement_m", YIELD * LARGEST),
        pytest.param(
            *(sliding, 0.2, "coulomb_friction", "force_n", 0.2 * STIFFNESS * YIELD * LARGEST),
            marks=pytest.mark.slow,  # by default the campaign rig_a has dry friction
        ),
    ],
)
def test_the_effect_is_named(tmp_path, force, value, name, size, reference):
    specimen = f"stiffness_n_per_m = {STIFFNESS}"
    campaign = write_tests(tmp_path, specimen, lambda displacement: force(displacement, value), count=3)
    diagnosis = diagnose(campaign).to_dict()
    assert [effect["name"] for effect in diagnosis["effects"]] == [name]
    assert diagnosis["verdict"] == "named"
    assert closed_share(diagnosis["gap"]) > 0.99
    assert diagnosis["effects"][0]["parameters"][size]["value"] == pytest.approx(reference, rel=0.1)


@pytest.mark.slow
def test_force_bending_over_a_sixth_of_the_velocity_is_no_dry_friction(tmp_path):
    campaign = write_tests(
        tmp_path,
        f"stiffness_n_per_m = {STIFFNESS}",
        lambda displacement: sliding(displacement, 0.2, turn=1.0 / 6.0),
    )
    diagnosis = diagnose(campaign)
    assert diagnosis.verdict is not Verdict.NO_MISSING_EFFECT
    assert "coulomb_friction" not in {effect.name for effect in diagnosis.effects}


@pytest.mark.slow
def test_stated_mass_of_a_springless_specimen_is_kept(tmp_path):
    def dragged(displacement):
        velocity = np.gradient(displacement, 1.0 / RATE)
        return 95.0 * np.gradient(velocity, 1.0 / RATE) + 300.0 * velocity

    diagnosis = diagnose(write_tests(tmp_path, "mass_kg = 95.0", dragged)).to_dict()
    assert [effect["name"] for effect in diagnosis["effects"]] == ["viscous_damping"]


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("share", "verdict"), [(0.02, "no_missing_effect"), (1.0, "unknown_effect")])
def test_line_counts_unless_it_is_far_below_the_noise(tmp_path, share, verdict):
    def hummed(displacement):
        spring = STIFFNESS * displacement
        size = np.sqrt(2.0 * share) * 0.005 * spring.std()
        return spring + size * np.sin(2.0 * np.pi * 31.0 * np.arange(displacement.size) / RATE)

    diagnosis = diagnose(write_tests(tmp_path, f"stiffness_n_per_m = {STIFFNESS}", hummed)).to_dict()
    assert diagnosis["verdict"] == verdict


def damp_by_direction(displacement):
    """Spring beside a linear damper that is 1.4 times as strong forwards, and 0.6 times backwards [N]."""
    velocity = np.gradient(displacement, 1.0 / RATE)
    return STIFFNESS * displacement + 2000.0 * velocity * (1.0 + 0.4 * np.sign(velocity))


def slide_on_bearings(displacement):
    """Pendulum bearing whose friction of 400 N falls to 200 N where it slides slowly [N]."""
    velocity, stretch, forces = np.gradient(displacement, 1.0 / RATE), 0.0, []
    for step, speed in zip(np.diff(displacement, prepend=0.0), np.abs(velocity), strict=True):
        stretch = min(max(stretch + step / (0.03 * LARGEST), -1.0), 1.0)
        forces.append(400.0 * (1.0 - 0.5 * np.exp(-speed / (0.1 * np.abs(velocity).max()))) * stretch)
    return 0.3 * STIFFNESS * displacement + np.array(forces)


def yield_gradually(displacement, springs=300):
    """Hyperbola x/(1 + |x|/d) as elastic-plastic springs in parallel, by its second derivative [N]."""
    unit = 0.3 * LARGEST
    limits = np.geomspace(1e-3, 50.0, springs)
    slopes = 1.0 / (1.0 + limits) ** 2
    shares, stretches, forces = -np.diff(slopes, append=0.0), np.zeros(springs), []
    for step in np.diff(displacement, prepend=0.0) / unit:
        stretches = np.clip(stretches + step, -limits, limits)
        forces.append(STIFFNESS * unit * float(shares @ stretches))
    return np.array(forces)


def carry_a_tuned_mass(displacement, mass=30.0, frequency=1.2, ratio=0.05, parts=20):
    """Spring that carries a mass on a spring and a damper of its own, by small steps [N]."""
    rate, step = 2.0 * np.pi * frequency, 1.0 / RATE / parts
    place, speed, forces = 0.0, 0.0, []
    for x, velocity in zip(
        displacement.tolist(), np.gradient(displacement, 1.0 / RATE).tolist(), strict=True
    ):
        for _ in range(parts):
            pull = 2.0 * ratio * rate * (velocity - speed) + rate**2 * (x - place)
            speed += step * pull
            place += step * speed
        forces.append(mass * pull)
    return 0.1 * STIFFNESS * displacement + np.array(forces)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("force", "name", "parameter", "reference"),
    [
        (carry_a_tuned_mass, "attached_oscillator", "frequency_hz", 1.2),
        (damp_by_direction, "directional_damping", "asymmetry", 0.4),
        (slide_on_bearings, "velocity_dependent_friction", "slow_share", 0.5),
        (yield_gradually, "hysteresis", "displacement_m", 0.3 * LARGEST),
    ],
)
def test_special_form_is_named_where_the_simple_effect_leaves_more_than_noise(
    tmp_path, force, name, parameter, reference
):
    diagnosis = diagnose(write_tests(tmp_path, "", force)).to_dict()
    (effect,) = diagnosis["effects"]
    assert (diagnosis["verdict"], effect["name"]) == ("named", name)
    assert effect["parameters"][parameter]["value"] == pytest.approx(reference, rel=0.15)
    assert diagnosis["gap"]["nrmse_after"] < 0.1 * diagnosis["gap"]["nrmse_linear"]


def slide_behind_play(displacement, slip=(900.0, 600.0), stiffness=1.0e6, play=0.08 * LARGEST):
    """Sliding joint on an elastic brace whose pins have clearance: no force while it is crossed [N]."""
    slid, forces = 0.0, []
    for x in displacement.tolist():
        push = max(x - 0.5 * play - slid, 0.0) + min(x + 0.5 * play - slid, 0.0)
        force = min(max(stiffness * push, -slip[1]), slip[0])
        slid += push - force / stiffness
        forces.append(force)
    return np.array(forces)


@pytest.mark.slow
def test_sliding_damper_with_loose_pins_is_named_by_both(tmp_path):
    """Before, it was a hysteresis that degrades, without any degradation."""
    diagnosis = diagnose(write_tests(tmp_path, "", slide_behind_play)).to_dict()
    hysteresis, play = diagnosis["effects"]
    assert (hysteresis["name"], play["name"]) == ("hysteresis", "series_play")
    assert {hysteresis["member_of"], play["member_of"]} == {"hysteresis_with_play"}
    assert play["parameters"]["width_m"]["value"] == pytest.approx(0.08 * LARGEST, rel=0.03)
    assert hysteresis["parameters"]["force_n"]["value"] == pytest.approx(750.0, rel=0.03)
    assert hysteresis["parameters"]["asymmetry"]["value"] == pytest.approx(0.2, abs=0.03)
    assert play["held_out_nrmse_without"] > 3.0 * play["held_out_nrmse_with"]
    assert diagnosis["verdict"] == "named"


@pytest.mark.slow
def test_error_on_a_further_test_includes_the_converter(tmp_path):
    """What is known of the steps of a converter is taken off the tests that are fitted, not off a new one."""
    stated_value = f"stiffness_n_per_m = {STIFFNESS}"
    diagnosis = diagnose(
        write_tests(
            tmp_path, stated_value, lambda displacement: STIFFNESS * displacement, noise=1e-4, steps=0.2
        )
    )
    (block,) = diagnosis.blocks
    assert diagnosis.verdict is Verdict.NO_MISSING_EFFECT
    assert block.problem.conversion
    (row,) = foretold(block)
    assert row["covers"]
