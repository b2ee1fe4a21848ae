"""The march of a digital laboratory against its order of events, written out with matrices."""

import numpy as np
import pytest
from reliab_studies.laboratory.march import Events, NumericalStep, PlantStep, march

from reliab.effects.kernel import Kernel
from reliab.simulation.hybrid_test.open_loop import STATES, Plan

H = 0.01
SAMPLES = 60
RANDOM = np.random.default_rng(12)
GROUND, MIDPOINTS = RANDOM.normal(size=(2, SAMPLES))
NOISE = 1e-2 * RANDOM.normal(size=(2, SAMPLES))
NUMERICAL = NumericalStep(
    transition=0.3 * RANDOM.normal(size=(4, 4)),
    early=RANDOM.normal(size=4),
    middle=RANDOM.normal(size=4),
    late=RANDOM.normal(size=4),
    force=0.1 * RANDOM.normal(size=4),
    interface=RANDOM.normal(size=2),
    accelerated=RANDOM.normal(size=6),
)
PLANT = PlantStep(
    transition=0.4 * RANDOM.normal(size=(3, 3)),
    command=0.3 * RANDOM.normal(size=3),
    nonlinear=0.1 * RANDOM.normal(size=3),
    displacement=RANDOM.normal(size=3),
    velocity=RANDOM.normal(size=3),
    force=np.array([0.2, -0.4, 1.0]),
    displacement_of_command=0.3,
    force_of_command=-0.2,
    contains_nonlinear=False,
    dynamics=RANDOM.normal(size=(3, 3)),
    command_rate=RANDOM.normal(size=3),
    differenced=0.1 * RANDOM.normal(size=3),
    linear=np.array([1.3, 2e-3, 1e-5]),
)
FREE = Events(
    whole=0,
    fraction=0.0,
    stroke=np.inf,
    rate=np.inf,
    force=np.inf,
    command_step=0.0,
    displacement_step=0.0,
    force_step=0.0,
    beyond=np.inf,
)


def _force(motion, time, step, coefficients, state):
    state[0] += step * motion[0]
    return coefficients[0] * motion[1] * abs(motion[0]) + coefficients[1] * time + state[0] + motion[2]


def _controller(motion, reading, step, coefficients, state):
    state[0] += step * reading
    motion[0] = coefficients[0] * motion[0] + 0.1 * motion[1] + 0.05 * motion[2] - 0.2 * reading + state[0]
    return 0.0


def plan_of(function, *coefficients):
    return Plan(
        np.array([Kernel(function=function, states=1).address], dtype=np.int64), np.array([coefficients])
    )


NO_PLAN = Plan(np.zeros(0, dtype=np.int64), np.zeros((0, 1)))
FORCE = plan_of(_force, 0.3, 0.2)
CONTROLLER = plan_of(_controller, 0.7)


def round_to(value, step):
    return step * np.rint(value / step) if step > 0.0 else value


def runge_kutta(plant, w, constant_input, x, difference):
    """A step of the plant whose velocity is a difference: the last one first, then those of the stages."""

    def rate(state, speed):
        return plant.dynamics @ state + plant.command_rate * constant_input + plant.differenced * speed

    stages = [rate(w, difference)]
    for reach in (0.5 * H, 0.5 * H, H):
        stage = w + reach * stages[-1]
        stages.append(rate(stage, (plant.displacement @ stage - x) / reach))
    return w + H / 6.0 * (stages[0] + 2.0 * stages[1] + 2.0 * stages[2] + stages[3])


def reference_march(events, plant, *, is_forced, is_controlled, emulate):
    """Floors and signals, one instant after the other."""
    z, w = np.zeros(4), np.zeros(3)
    command_received = command_before = command_arrived = 0.0
    x_before = difference_before = sent_before = nonlinear = 0.0
    integral = integral_of_measured = 0.0
    floors, signals, commands = [], [], []
    for k in range(SAMPLES):
        floors.append(z[:2].copy())
        target = NUMERICAL.interface @ z[:2]
        x = plant.displacement @ w + plant.displacement_of_command * command_arrived
        v = plant.velocity @ w
        measured = round_to(x + NOISE[0, k], events.displacement_step)
        if is_controlled:
            speed = NUMERICAL.interface @ z[2:]
            pace = NUMERICAL.accelerated @ [*z, GROUND[k], command_received]
            integral_of_measured += H * measured
            target = 0.7 * target + 0.1 * speed + 0.05 * pace - 0.2 * measured + integral_of_measured
        sent = np.clip(
            np.clip(target, -events.stroke, events.stroke),
            *(sent_before + H * events.rate * np.array([-1, 1])),
        )
        sent_before = sent
        commands.append(round_to(sent, events.command_step))
        commands_sent = np.array([0.0] * (events.whole + 1) + commands)
        near, far = commands_sent[-1 - events.whole], commands_sent[-2 - events.whole]
        constant_input = (1.0 - events.fraction) * near + events.fraction * far
        difference = (x - x_before) / H
        nonlinear_before = nonlinear
        if is_forced:
            integral += H * x
            nonlinear = 0.3 * v * abs(x) + 0.2 * k * H + integral
        if emulate:
            force = plant.linear @ [x, difference, (difference - difference_before) / H] + nonlinear
        else:
            force = plant.force @ w + plant.force_of_command * command_arrived
            force += 0.0 if plant.contains_nonlinear else nonlinear
        command_arrived = constant_input
        reading = round_to(force + NOISE[1, k], events.force_step)
        signals.append([commands[-1], x, measured, reading])
        command_received, command_before = command_before, reading
        if k + 1 == SAMPLES:
            break
        z = NUMERICAL.transition @ z + NUMERICAL.early * GROUND[k] + NUMERICAL.late * GROUND[k + 1]
        z += NUMERICAL.middle * MIDPOINTS[k] + NUMERICAL.force * command_received
        if emulate:
            w = runge_kutta(plant, w, constant_input, x, difference)
        else:
            w = plant.transition @ w + plant.command * constant_input
            w = w + plant.nonlinear * (1.5 * nonlinear - 0.5 * nonlinear_before)
        w = np.where(plant.force == 1.0, np.clip(w, -events.force, events.force), w)
        x_before, difference_before = x, difference
    return np.array(floors).T, np.array(signals).T


@pytest.mark.parametrize("emulate", [False, True], ids=["exact", "differences"])
@pytest.mark.parametrize("is_controlled", [False, True], ids=["direct", "controlled"])
@pytest.mark.parametrize("contains", [False, True])
@pytest.mark.parametrize(
    "limits",
    [
        {},
        {"whole": 2, "fraction": 0.3},
        {"stroke": 1.2, "rate": 60.0, "force": 0.3},
        {"whole": 1, "command_step": 0.1, "displacement_step": 0.2, "force_step": 0.3},
    ],
    ids=["free", "late", "limited", "stepped"],
)
def test_every_instant_follows_from_the_one_before(limits, contains, is_controlled, emulate):
    events, plant = FREE._replace(**limits), PLANT._replace(contains_nonlinear=contains)
    is_forced = not emulate
    histories = march(
        *(GROUND, MIDPOINTS, H, NUMERICAL, plant, events, CONTROLLER if is_controlled else NO_PLAN, STATES),
        *(FORCE if is_forced else NO_PLAN, NOISE, emulate),
    )
    floors, signals = reference_march(
        events, plant, is_forced=is_forced, is_controlled=is_controlled, emulate=emulate
    )
    np.testing.assert_allclose(histories[0], floors, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(histories[1], signals, rtol=1e-9, atol=1e-9)
    assert histories[2] == SAMPLES


def test_a_lost_test_ends_at_once():
    events = FREE._replace(beyond=1.0)
    *_, run_to = march(
        GROUND,
        MIDPOINTS,
        H,
        NUMERICAL,
        PLANT,
        events,
        NO_PLAN,
        STATES,
        NO_PLAN,
        NOISE,
        False,  # noqa: FBT003 - compiled
    )
    floors, signals = reference_march(FREE, PLANT, is_forced=False, is_controlled=False, emulate=False)
    large = np.maximum(np.abs(signals[1]), np.abs(NUMERICAL.interface @ floors)) >= 1.0
    assert run_to == np.flatnonzero(large)[0] > 0
