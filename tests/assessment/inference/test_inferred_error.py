"""What a verdict says of the error that all channels of a test show."""

import numpy as np
import pytest
from assessment.inference.simulated_loop import earthquake, simulate

import reliab
from reliab.recordings.recording import Recording

STEP = 1.0 / 256.0
MASS = 500.0


def record_test(test, *, ground=False, force=None):
    return Recording(
        command=test.command,
        measured=test.measured,
        time_step=STEP,
        ground=test.ground if ground else None,
        force=force,
    )


def simulate_late(duration):
    ground = earthquake(duration=duration, time_step=STEP, seed=4)
    return simulate(
        frequency=1.0, damping_ratio=0.03, share=0.8, delay=0.002, ground=ground, time_step=STEP, noise=0.003
    )


@pytest.fixture(scope="module")
def late():
    return simulate_late(30.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "tighter",
    [
        {"f": "1±0.002"},
        {"xi": "0.03±0.0005"},
        {"alpha": "0.8±0.001"},
        {"scale": "1±0.0005"},
        {"skew": "0±0.02"},
    ],
)
def test_a_tighter_true_statement_never_widens_the_interval(late, tighter):
    stated_values = {"f": 1.0, "xi": 0.03, "alpha": 0.8, "specimen": "linear"}
    result = [
        reliab.assess(record_test(late), **{**stated_values, **larger}).error.rebuilt.rms
        for larger in ({}, tighter)
    ]
    width, narrower = (single.high - single.low for single in result)
    assert narrower < 1.05 * width
    assert all(single.low < late.rms < single.high for single in result)


def test_another_damping_ratio_than_stated_is_asked_back(late):
    result = reliab.assess(record_test(late), f=1.0, xi=0.2, alpha=0.8)
    assert result.verdict == "undecided"
    assert any("shows a damping ratio of 0." in reason for reason in result.reasons)


@pytest.mark.parametrize("recorded", ["displacements", "ground", "force"])
@pytest.mark.default_cases(3)
def test_channels_without_noise_are_judged(recorded):
    """Simulated ones, whose equation of motion leaves nothing but rounding."""
    ground = earthquake(duration=12.0, time_step=STEP, seed=5)
    shared = {"frequency": 0.96, "damping_ratio": 0.044, "share": 0.6, "delay": 0.002}
    test = simulate(**shared, ground=ground, time_step=STEP, noise=0.0)
    force = MASS * test.force if recorded == "force" else None
    recording = record_test(test, ground=recorded != "displacements", force=force)
    given = {"f": 0.96, "xi": 0.044, "alpha": 0.6, "specimen": "linear"}
    rms = reliab.assess(recording, **given, **({} if force is None else {"mass": MASS})).error.rms
    assert rms.low < test.rms < rms.high


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 4, 6])
def test_ground_acceleration_and_force_narrow_the_interval(seed):
    """Errors of 4 to 7 %, whose intervals do not end at zero."""
    ground = earthquake(duration=30.0, time_step=STEP, seed=seed)
    loop = {"frequency": 1.0, "damping_ratio": 0.03, "share": 0.8, "delay": 0.004}
    late = simulate(**loop, ground=ground, time_step=STEP, noise=0.002)
    stated_values = {"f": 1.01, "xi": 0.033, "alpha": 0.8, "specimen": "linear"}
    result = [
        reliab.assess(record_test(late, **larger), **stated_values, **reference).error.rebuilt.rms
        for larger, reference in (
            ({}, {}),
            ({"ground": True}, {}),
            ({"ground": True, "force": MASS * late.force}, {"mass": MASS}),
        )
    ]
    widths = [single.high - single.low for single in result]
    assert widths[1] < widths[0]
    assert widths[2] < widths[1]
    assert all(single.low < late.rms < single.high for single in result)


def test_possible_yielding_leaves_a_bad_test_bad():
    ground = earthquake(duration=30.0, time_step=STEP, seed=4)
    bad = simulate(frequency=1.0, damping_ratio=0.03, delay=0.006, ground=ground, time_step=STEP, noise=0.003)
    assert bad.rms > 0.1
    assert reliab.assess(record_test(bad), f=1.0, xi=0.03).verdict == "not_reliable"


def test_a_nonlinear_force_with_a_mass_is_learned_by_itself():
    late = simulate_late(15.0)
    peak = np.abs(late.measured).max()
    bent = MASS * late.force * (1.0 + 0.5 * (late.measured / peak) ** 2)
    result = reliab.assess(record_test(late, force=bent), f=1.0, xi=0.03, alpha=0.8, mass=MASS)
    assert result.error.specimen_known == "measured"
    assert any("learned from it" in warning for warning in result.warnings)
    stated_values = reliab.assess(
        record_test(late, force=bent), f=1.0, xi=0.03, alpha=0.8, mass=MASS, specimen="linear"
    )
    assert stated_values.error.specimen_known == "stated"
