"""A recorded force that is reversed, in another unit or of another column is refused in a sentence."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
import scipy

from reliab.assessment.assess import assess
from reliab.assessment.plausibility import require_plausible
from reliab.assessment.recorded_force import (
    doubts_of_force,
    doubts_of_sign,
    remark_on_force,
    require_restoring_force,
)
from reliab.assessment.recorded_ground import mass_from_ground, require_unit_of_force
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

RATE, CIRCULAR = 512.0, 2.0 * np.pi
STIFFNESS = 1000.0 * CIRCULAR**2  # 1 Hz, 1000 kg


def yielding(displacement, limit):
    """Force of an elastic-perfectly-plastic spring of unit stiffness."""
    force = np.zeros_like(displacement)
    for i, step in enumerate(np.diff(displacement)):
        force[i + 1] = np.clip(force[i] + step, -limit, limit)
    return force


def swinging(motion, frequency, damping_ratio=0.03):
    """Inertia force of a unit mass on a spring of its own, by small steps [N]."""
    rate, step = 2.0 * np.pi * frequency, 1.0 / RATE
    place, speed, forces = float(motion.x[0]), float(motion.v[0]), []
    for x, v in zip(motion.x.tolist(), motion.v.tolist(), strict=True):
        forces.append(2.0 * damping_ratio * rate * (v - speed) + rate**2 * (x - place))
        speed += step * forces[-1]
        place += step * speed
    return np.array(forces)


class Motion(NamedTuple):
    """Displacement, velocity and acceleration of a specimen."""

    x: np.ndarray
    v: np.ndarray
    a: np.ndarray


SPECIMENS = {
    "spring": lambda m: m.x,
    "spring and dashpot": lambda m: m.x + 0.05 * m.v,
    "dashpot": lambda m: m.v,
    "spring and mass": lambda m: m.x + 0.01 * m.a,
    "mass": lambda m: 0.03 * m.a,
    "friction": lambda m: np.sign(m.v),
    "hardening": lambda m: m.x + 0.5 * (m.x / np.abs(m.x).max()) ** 2 * m.x,
    "yielding": lambda m: yielding(m.x, 0.25 * np.abs(m.x).max()) + 0.02 * m.x,
    "structure on a table": lambda m: swinging(m, 2.5),
    "spring and tuned mass": lambda m: m.x + 0.01 * swinging(m, 0.95),
    "preloaded spring": lambda m: m.x + 3.0 * np.abs(m.x).max(),
}


@pytest.fixture(scope="module")
def displacement():
    """The response of a 1 Hz structure to coloured noise that swells and fades, and its derivatives."""
    time = np.arange(0.0, 30.0, 1.0 / RATE)
    ground = np.random.default_rng(4).normal(size=time.size) * np.sin(np.pi * time / 30.0) ** 2
    structure = scipy.signal.StateSpace(
        [[0.0, 1.0], [-(CIRCULAR**2), -0.04 * CIRCULAR]], [[0.0], [-1.0]], np.eye(2), np.zeros((2, 1))
    )
    _, states, _ = scipy.signal.lsim(structure, ground, time)
    x, v = states.T / np.abs(states[:, 0]).max()
    return time, 0.02 * x, 0.02 * v


def record_test(displacement, specimen, *, sign=1.0, late=0.006, noise=1e-3):
    """A test whose rig is late, with the force of its specimen in newtons."""
    time, x, v = displacement
    reach, speed = np.interp(time - late, time, x), np.interp(time - late, time, v)
    shape = SPECIMENS[specimen](Motion(reach, speed, np.gradient(speed, time)))
    generator = np.random.default_rng(1)
    force = sign * STIFFNESS * shape
    return Recording(
        command=x,
        measured=reach + noise * np.std(x) * generator.normal(size=x.size),
        force=force + 0.01 * np.std(force) * generator.normal(size=x.size),
        time_step=1.0 / RATE,
    )


@pytest.mark.parametrize("specimen", SPECIMENS)
def test_a_force_that_resists_is_accepted_and_its_reverse_refused(displacement, specimen):
    require_plausible(record_test(displacement, specimen))
    with pytest.raises(InputError, match=r"does not resist the motion.*sign were reversed.*Reverse the sign"):
        require_plausible(record_test(displacement, specimen, sign=-1.0))


@pytest.mark.parametrize("mass", [None, 1000.0])
def test_a_reversed_force_is_refused_with_and_without_a_mass(displacement, mass):
    stated_values = {} if mass is None else {"mass": StatedValue(mass)}
    with pytest.raises(InputError, match="does not resist the motion"):
        assess(
            record_test(displacement, "spring", sign=-1.0),
            Structure(frequency=1.0, damping_ratio=0.02),
            stated=stated_values,
        )


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1e3, "kilonewtons"),
        (1e-3, "kilonewtons"),
        (1e-6, "meganewtons"),
        (4.4482, "pounds-force"),
        (9.81, "kilograms-force"),
        (4448.0, "kips"),
        (60.0, "60 times the stated one"),
    ],
)
def test_a_force_in_another_unit_is_refused(displacement, factor, words):
    test = record_test(displacement, "spring")
    with pytest.raises(InputError, match=f"does not fit the stated specimen.*{words}"):
        require_plausible(replace(test, force=factor * test.force), stiffness=STIFFNESS)


@pytest.mark.parametrize(
    ("factor", "share", "mass"), [(1.0, 1.0, "1000 kg"), (1e-3, 1.0, "1 kg"), (1.0, 0.25, "4000 kg")]
)
def test_a_force_whose_unit_nothing_examines_is_said_with_its_mass(displacement, factor, share, mass):
    test = record_test(displacement, "spring", late=0.002)
    structure = Structure(frequency=1.0, damping_ratio=0.02, experimental_fraction=share)
    examined = require_plausible(replace(test, force=factor * test.force))
    messages = remark_on_force(examined, structure, {})
    assert f"a mass of {mass}. Give `mass`" in messages


def test_no_mass_tells_the_unit_of_a_dashpot(displacement):
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    assert remark_on_force(require_plausible(record_test(displacement, "dashpot")), structure, {}) == ""


@pytest.mark.parametrize(("unit", "words"), [(4.4482216, "pounds-force"), (9.80665, "kilograms-force")])
@pytest.mark.parametrize("power", [1.0, -1.0])
@pytest.mark.parametrize("share", [1.0, 0.4])
def test_a_linear_force_in_pounds_or_kilograms_is_refused(displacement, unit, words, power, share):
    """Factors that a yielding specimen could have, too; a linear one cannot."""
    test = record_test(displacement, "spring")
    structure = Structure(frequency=1.0, damping_ratio=0.02, experimental_fraction=share)
    options = {"stated": {"mass": StatedValue(1000.0)}}
    with pytest.raises(InputError, match=f"does not fit the stated specimen.*{words}"):
        assess(replace(test, force=share * unit**power * test.force), structure, **options)


@pytest.mark.parametrize(
    ("factor", "is_learnable"), [(0.3, True), (2.6, True), (0.005, False), (60.0, False)]
)
def test_a_specimen_that_softened_may_be_learned_from_its_force(displacement, factor, is_learnable):
    test = record_test(displacement, "spring")
    test = replace(test, force=factor * test.force)
    with pytest.raises(InputError, match="does not fit the stated specimen") as refusal:
        require_plausible(test, stiffness=STIFFNESS, linear=True)
    assert ("state `specimen` as measured" in str(refusal.value)) is is_learnable
    if is_learnable:
        require_plausible(test, stiffness=STIFFNESS)


@pytest.mark.parametrize("reversed_", [1.0, -1.0])
@pytest.mark.parametrize("unit", [4.4482216, 1.0 / 4.4482216, 9.80665, 1e3])
def test_the_ground_acceleration_tells_the_unit_of_any_force(displacement, unit, reversed_):
    """By the equation of the computer's part, here with a specimen that yields and half of the stiffness."""
    test = record_test(displacement, "yielding")
    structure = Structure(frequency=0.9, damping_ratio=0.03, experimental_fraction=0.5)
    x, step, w0 = test.command, test.time_step, structure.circular_frequency
    v = np.gradient(x, step)
    computed_values = np.gradient(v, step) + 0.06 * w0 * v + 0.5 * w0**2 * x
    test = replace(test, ground=-reversed_ * (computed_values + test.force / 1000.0))
    options = {"mass": 1000.0, "feedback_lag": 0.0}
    require_unit_of_force(test, structure, **options)
    assert mass_from_ground(test, structure, feedback_lag=0.0) == pytest.approx(1000.0, rel=0.01)
    with pytest.raises(InputError, match="State the unit of the force"):
        require_unit_of_force(replace(test, force=test.force / unit), structure, **options)


@pytest.mark.parametrize("unit", [4.4482216, 9.80665])
def test_a_measured_specimen_whose_force_is_straight_is_asked_for_its_unit(displacement, unit):
    """Its stiffness may be another one than stated, but hardly by the factor of a unit."""
    test = record_test(displacement, "spring")
    require_plausible(replace(test, force=0.4 * test.force), stiffness=STIFFNESS)
    with pytest.raises(InputError, match="State the unit of the force"):
        require_plausible(replace(test, force=test.force / unit), stiffness=STIFFNESS)


@pytest.mark.parametrize("ratio", [0.7, 1.0, 1.5])
def test_a_force_that_differs_a_little_from_what_is_stated_is_remarked(displacement, ratio):
    test = record_test(displacement, "spring", late=0.001)
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    test = replace(test, force=ratio * test.force)
    result = assess(test, structure, stated={"mass": StatedValue(1000.0)})
    messages = any("of what mass, frequency and share make" in warning for warning in result.warnings)
    assert messages is (ratio != 1.0)


@pytest.mark.parametrize("stated", [True, False])
def test_a_damper_far_stiffer_than_the_spring_beside_it_needs_a_stated_unit(displacement, stated):
    _, x, v, *_ = displacement
    force = STIFFNESS * (0.05 * x + 0.5 * yielding(x, 0.02 * np.abs(x).max()) + 0.01 * v)
    examine = {"stiffness": 0.05 * STIFFNESS, "is_unit_stated": stated}
    if stated:
        assert require_restoring_force(x, force, 1.0 / RATE, **examine).unexplained < 0.1
        with pytest.raises(InputError, match="does not fit the stated specimen"):
            require_restoring_force(x, 1e3 * force, 1.0 / RATE, **examine)
    else:
        with pytest.raises(InputError, match="State the unit of the force in the column's name"):
            require_restoring_force(x, force, 1.0 / RATE, **examine)


def test_yielding_specimen_is_no_wrong_unit(displacement):
    """Its stiffness over the test is a fourth of the stated one, like that of a force in pounds."""
    test = record_test(displacement, "yielding")
    require_plausible(test, stiffness=STIFFNESS, linear=True)


@pytest.mark.parametrize("lag", [0.01, 0.02, 0.04])
def test_a_force_that_lags_in_motion_of_one_frequency_is_not_reversed(lag):
    """A mass and a dashpot follow its reverse more closely than a spring follows the force."""

    def moved_at(time):
        return np.sin(6.0 * time) * np.sin(0.15 * time)

    time = np.arange(0.0, 20.0, 0.005)
    require_restoring_force(moved_at(time), 40.0 * moved_at(time - lag), 0.005, stiffness=40.0)


@pytest.mark.parametrize("share", [0.05, 0.3, 1.0, 2.0])
def test_wrongly_stated_share_is_no_wrong_unit(displacement, share):
    test = record_test(displacement, "spring")
    require_plausible(replace(test, force=share * test.force), stiffness=STIFFNESS)


@pytest.mark.parametrize("specimen", ["spring", "hardening", "preloaded spring"])
@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_exchanged_columns_show_in_the_force(displacement, specimen, noise):
    test = record_test(displacement, specimen, noise=noise)
    with pytest.raises(InputError, match=r"follows the command instead.*exchanged"):
        require_plausible(replace(test, command=test.measured, measured=test.command))


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (lambda test: np.full_like(test.force, 3.0), "does not change during the test"),
        (lambda test: np.random.default_rng(2).normal(size=test.force.size), "does not follow the measured"),
        (lambda test: np.sin(17.0 * np.arange(test.force.size) / RATE), "does not follow the measured"),
    ],
)
def test_a_force_of_nothing_is_refused(displacement, force, words):
    test = record_test(displacement, "spring")
    with pytest.raises(InputError, match=words):
        require_plausible(replace(test, force=force(test)))


def test_a_displacement_sensor_that_drifts_is_no_exchange_of_columns(displacement):
    """The force follows the motion of the piston, of which the command knows more than such a sensor."""
    test = record_test(displacement, "spring", late=0.003)
    time = np.arange(test.force.size) / RATE
    drifting = test.measured + 0.1 * np.abs(test.measured).max() * time / time[-1]
    require_plausible(replace(test, measured=drifting))
    with pytest.raises(InputError, match="exchanged"):
        require_plausible(replace(test, command=test.measured, measured=test.command))


@pytest.mark.parametrize("specimen", ["spring", "hardening"])
@pytest.mark.parametrize("lead", [0.0, 0.004, 0.02])
def test_leading_actuator_has_its_columns_in_order(displacement, specimen, lead):
    """The sensor is read half a sample early, and the force then follows the command more closely."""
    test = record_test(displacement, specimen, late=-lead, noise=0.0)
    places = np.arange(test.command.size)
    require_plausible(replace(test, measured=0.78 * np.interp(places + 0.5, places, test.measured)))


@pytest.mark.parametrize("rate", [25.0, 200.0])
def test_force_of_a_free_vibration_is_remarked_and_not_refused(rate):
    """The force of a pendulum is -m a exactly: a spring explains it nearly, a reversed mass fully."""

    def acceleration(displacement, speed):
        return -16.0 * np.sin(displacement) - 0.1 * speed

    time = np.arange(0.0, 30.0, 1.0 / rate)
    swing = scipy.integrate.solve_ivp(
        lambda _, y: [y[1], acceleration(*y)], (0.0, 30.0), [1.0, 0.0], t_eval=time, rtol=1e-9
    )
    displacement, force = swing.y[0], -3.0 * acceleration(*swing.y)
    assert np.corrcoef(displacement, force)[0, 1] > 0.95
    examined = require_restoring_force(displacement, force, 1.0 / rate)
    assert any("Check its sign" in doubt for doubt in doubts_of_sign(examined))


@pytest.mark.parametrize("specimen", SPECIMENS)
def test_resisting_forces_raise_no_doubt(displacement, specimen):
    assert list(doubts_of_force(record_test(displacement, specimen))) == []


@pytest.mark.parametrize("drift", [0.05, 0.3])
def test_drifting_limited_leading_sensor_is_remarked_and_not_refused(displacement, drift):
    """The force follows the command, yet no lead explains what the displacement misses."""
    test = record_test(displacement, "spring", late=-0.003)
    places = np.arange(test.force.size)
    drifting = test.measured + drift * np.abs(test.measured).max() * places / places[-1]
    limited = np.minimum(drifting, 0.9 * drifting.max())
    recording = replace(test, measured=limited, force=STIFFNESS * test.command)
    require_plausible(recording)
    assert any("more closely than the measured" in doubt for doubt in doubts_of_force(recording))


def test_leading_noisy_reading_is_not_exchanged_with_its_clean_command(displacement):
    """Clocks that differ look like exchanged columns, but only a reading is noisy."""
    test = record_test(displacement, "spring", late=-0.008)
    require_plausible(replace(test, force=STIFFNESS * test.command))


def test_a_brace_that_buckles_takes_work_and_is_not_reversed():
    """Springs explain its force better with the sign turned, but the motion does work on it."""
    simulated_tests = pytest.importorskip("reliab_studies.measured_specimen.simulated_tests")
    time = np.arange(0.0, 30.0, 1.0 / 256.0)
    noise = np.random.default_rng(4).standard_normal(time.size)
    load = np.convolve(noise, np.hanning(25), mode="same") * (time / 4.0) * np.exp(1.0 - time / 4.0)
    brace = simulated_tests.simulate("buckling brace", load, 1.0 / 256.0, np.random.default_rng(29))
    require_restoring_force(brace.measured, brace.force, 1.0 / 256.0)
