"""The digital laboratory: facts of the benchmark, other engines, compensators."""

import csv

import numpy as np
import pytest
from reliab_studies.laboratory.laboratory import Limits, Rig, Sensors, _runge_kutta_step, run_laboratory
from reliab_studies.rths_benchmark.benchmark import (
    CASES,
    COMPENSATORS,
    RATE,
    benchmark_compensator,
    benchmark_frame,
    benchmark_partition,
    benchmark_plants,
    benchmark_rig,
    inverse_factors,
    scale_record,
)
from reliab_studies.rths_benchmark.outcomes import NAMES, benchmark_criteria, tracking_delay

from reliab.core.errors import InputError
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.transfer_systems.transfer_function import (
    ServoHydraulic,
    TransferFunction,
    gain_and_delay,
)
from reliab.structures.frame import Frame, Specimen, floor_interface, reference_response
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure


@pytest.fixture
def elcentro(shared_folder):
    path = shared_folder / "benchmark/motions/elcentro.csv"
    if not path.is_file():
        pytest.skip(f"the benchmark's motions are not here ({path})")
    columns = np.loadtxt(path, delimiter=",", skiprows=3)
    return scale_record(columns[:, 1]), columns[1, 0] - columns[0, 0]


@pytest.fixture
def published_differences(shared_folder):
    with (shared_folder / "benchmark/published_table3.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = ["J1_ms", *(f"J{number}_pct" for number in range(2, 10))]
    return np.array([[float(row[name]) for name in names] for row in rows])


@pytest.mark.parametrize(
    ("case", "frequencies", "damping"),
    [
        (1, [3.6124, 15.9966, 38.0862], 14084.30),
        (2, [3.4443, 15.2521, 36.3137], 11817.39),
        (3, [3.1683, 14.0299, 33.4038], 9635.14),
        (4, [3.6124, 15.9966, 38.0862], 8450.58),
    ],
)
def test_benchmark_structures(case, frequencies, damping):
    frame = benchmark_frame(case)
    np.testing.assert_allclose(frame.modes.frequency, frequencies, atol=6e-5)
    assert frame.damping[0, 0] == pytest.approx(damping, abs=0.01)
    np.testing.assert_allclose(
        frame.modes.shapes[:, 0] / frame.modes.shapes[0, 0], [1, 1.6112, 1.9762], atol=6e-5
    )


def test_reference_has_the_published_rms_and_peak(elcentro):
    ground, step = elcentro
    for case, rms, peak in ((1, 0.626, 3.902), (2, 0.669, 4.044), (3, 1.014, 5.509), (4, 0.802, 4.384)):
        times = np.arange(int((ground.size - 1) * step * RATE) + 1) / RATE
        shaken = np.interp(times, step * np.arange(ground.size), ground)
        first = 1e3 * reference_response(benchmark_frame(case), shaken, 1 / RATE)[0]
        assert np.sqrt(np.mean(first**2)) == pytest.approx(rms, abs=6e-4)
        assert np.abs(first).max() == pytest.approx(peak, abs=6e-4)


def criteria_of(elcentro, seed, *, emulate):
    """The benchmark's indicators of its four cases, shape (cases, indicators)."""
    ground, step = elcentro
    rig = benchmark_rig("pi_phase_lead", benchmark_plants(0)[0])
    runs = (
        run_laboratory(benchmark_partition(case), rig, ground, step, seed=seed, emulate_differences=emulate)
        for case in CASES
    )
    return np.array([list(benchmark_criteria(run).values()) for run in runs])


def test_published_table_comes_back(elcentro, published_differences):
    values = criteria_of(elcentro, 0, emulate=False)
    assert np.abs(values / published_differences - 1.0).max() < 0.06


@pytest.mark.slow
def test_published_table_comes_back_to_its_digits_from_the_published_differences(
    elcentro, published_differences
):
    values = np.array([criteria_of(elcentro, seed, emulate=True) for seed in range(6)])
    assert np.abs(values.mean(axis=0) / published_differences - 1.0).max() < 0.04
    assert (np.round(values, 1) == published_differences).any(axis=0).sum() >= 30


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("name", ["inverse", "adaptive_time_series", "adaptive_model_based"])
def test_compensators_track_down_to_the_noise(elcentro, name):
    ground, step = elcentro
    for plant in benchmark_plants(1):
        partition = benchmark_partition(1, plant.stiffness)
        run = run_laboratory(partition, benchmark_rig(name, plant), ground, step, seed=1)
        values = benchmark_criteria(run)
        floor = 2.56  # 16 µm over the reference's RMS
        assert not run.lost
        assert values["J1"] <= 0.5
        assert 0.9 * floor < values["J2"] < 1.3 * floor


def test_every_compensator_of_the_benchmark_is_known():
    for name in COMPENSATORS:
        benchmark_compensator(name)
    with pytest.raises(InputError, match="must be one of"):
        benchmark_compensator("magic")


def test_without_a_compensator_the_benchmark_is_lost():
    t = np.arange(0, 20, 0.01)
    ground = np.sin(2 * np.pi * 3.6 * t) * np.exp(-t / 3)
    run = run_laboratory(
        benchmark_partition(4), benchmark_rig("none", benchmark_plants(0)[0]), ground, 0.01, seed=0
    )
    assert run.lost
    assert run.measured.size < t[-1] * RATE


def test_perturbed_plants_have_the_stated_deviations_and_the_same_reference():
    plants = benchmark_plants(400, seed=2)[1:]
    leakage = np.array([plant.servo.leakage for plant in plants])
    assert (leakage > 0.0).all()
    assert np.std([plant.servo.valve_stiffness for plant in plants]) == pytest.approx(3.3e3, rel=0.12)
    assert np.std([plant.stiffness for plant in plants]) == pytest.approx(5e4, rel=0.12)
    assert [plant.stiffness for plant in benchmark_plants(3)] == [p.stiffness for p in benchmark_plants(5)][
        :4
    ]
    partition = benchmark_partition(1, plants[0].stiffness)
    np.testing.assert_allclose(partition.frame.stiffness, benchmark_frame(1).stiffness)


def test_a_delayed_spring_is_the_closed_loop_of_one_mode():
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    t = np.arange(0, 12, 0.01)
    ground = np.sin(2 * np.pi * 1.1 * t) * np.exp(-t / 4)
    rate, delay = 4096.0, 0.006
    run = run_laboratory(
        Partition.from_structure(structure, mass=50.0),
        Rig(transfer_system=gain_and_delay(0.99, delay)),
        ground,
        0.01,
        rate=rate,
    )
    # The force that is held costs a step and a half of further delay in the loop.
    late = HybridTest(structure=structure, actuator=Actuator(gain=0.99, delay=delay + 1.5 / rate))
    shaken = np.interp(np.arange(run.command.size) / rate, t, ground)
    reference = run_closed_loop(late, shaken, 1 / rate).command.values[0]
    assert np.abs(run.command - reference).max() < 2e-4 * np.abs(reference).max()


@pytest.mark.slow
def test_a_nonlinear_specimen_before_a_servo_is_a_fine_integration():
    cubic, specimen = 5e8, Specimen(stiffness=2e5, damping=100.0, mass=20.0)
    frame = Frame(mass=[[1000.0]], damping=[[12000.0]], stiffness=[[8e5]])
    partition = Partition.from_frame(
        frame=frame,
        interface=floor_interface(frame, 1),
        specimen=specimen,
        effects=(find_effect("cubic_stiffness")(cubic_n_per_m3=cubic),),
    )
    plant = ServoHydraulic().plant(specimen)
    t = np.arange(0, 1.2, 0.005)
    ground = 4.0 * np.sin(2 * np.pi * 4.0 * t) * np.hanning(t.size)
    run = run_laboratory(partition, Rig(), ground, 0.005)

    def slope(w, u):
        return plant.dynamics @ w + plant.command * u - plant.nonlinear * cubic * w[3] ** 3

    w, positions, parts = np.zeros(5), [0.0], 4  # the actuator alone, under the command that was sent
    h = 1 / RATE / parts
    for u in run.sent[:-1]:
        for _ in range(parts):
            k1 = slope(w, u)
            k2 = slope(w + 0.5 * h * k1, u)
            k3 = slope(w + 0.5 * h * k2, u)
            w = w + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(w + h * k3, u))
        positions.append(w[3])
    peak = np.abs(run.piston).max()
    assert cubic * peak**2 > 0.1 * specimen.stiffness  # the cubic term matters
    assert np.abs(run.piston - positions).max() < 1e-3 * peak


def test_limits_hold():
    t = np.arange(0, 6, 0.01)
    ground = 30.0 * np.sin(2 * np.pi * 3.6 * t)
    partition, plant = benchmark_partition(1), benchmark_plants(0)[0]
    free = run_laboratory(partition, benchmark_rig("inverse", plant), ground, 0.01, seed=0)
    assert np.abs(free.force).max() > 8900.0
    for limits, history, limit in (
        (Limits(force=8900.0), lambda run: run.force, 8900.0 + 20.0),
        (Limits(stroke=0.007), lambda run: run.sent, 0.007 + 4e-6),
        (Limits(rate=0.1), lambda run: np.diff(run.sent) * RATE, 0.1 + 0.02),
    ):
        rig = Rig(
            transfer_system=plant.servo,
            compensator=benchmark_compensator("inverse"),
            sensors=Sensors(force_noise=2.0),
            limits=limits,
        )
        run = run_laboratory(partition, rig, ground, 0.01, seed=0)
        assert np.abs(history(run)).max() <= limit


def test_sensors_have_their_noise_and_resolution():
    rig = Rig(
        transfer_system=TransferFunction(numerator=(63165.0,), denominator=(1.0, 402.1, 63165.0)),
        sensors=Sensors(displacement_noise=1e-5, displacement_step=2e-6, force_step=3.0),
    )
    partition = Partition.from_structure(Structure(frequency=1.0, damping_ratio=0.05), mass=1000.0)
    ground = np.sin(2 * np.pi * np.arange(0, 8, 0.01))
    run = run_laboratory(partition, rig, ground, 0.01, rate=2048.0, seed=4)
    assert np.std(run.measured - run.piston) == pytest.approx(1e-5, rel=0.03)
    np.testing.assert_allclose(run.measured / 2e-6, np.rint(run.measured / 2e-6), atol=1e-6)
    np.testing.assert_allclose(run.force / 3.0, np.rint(run.force / 3.0), atol=1e-9)


def test_criteria_of_a_perfect_test_are_zero_and_of_a_late_one_its_delay():
    t = np.arange(0, 20, 0.01)
    ground = np.sin(2 * np.pi * 3.0 * t) * np.exp(-t / 5)
    partition = benchmark_partition(1)
    run = run_laboratory(
        partition, benchmark_rig("pi_phase_lead", benchmark_plants(0)[0]), ground, 0.01, seed=0
    )
    values = benchmark_criteria(run)
    assert list(values) == list(NAMES)
    assert values["J1"] == pytest.approx(4.6, abs=0.2)
    assert tracking_delay(run.floors[0], run.floors[0], run.step) == 0.0


def test_bad_laboratories_are_refused():
    partition, ground = benchmark_partition(1), np.zeros(100)
    plant = benchmark_plants(0)[0]
    with pytest.raises(InputError, match="need a seed"):
        run_laboratory(partition, benchmark_rig("inverse", plant), ground, 0.01)
    with pytest.raises(InputError, match="emulated for a servo"):
        run_laboratory(
            Partition.from_structure(Structure(frequency=1.0, damping_ratio=0.05)),
            Rig(transfer_system=gain_and_delay()),
            ground,
            0.01,
            emulate_differences=True,
        )
    with pytest.raises(InputError, match="A force is limited where"):
        run_laboratory(
            Partition.from_structure(Structure(frequency=1.0, damping_ratio=0.05)),
            Rig(transfer_system=gain_and_delay(), limits=Limits(force=1.0)),
            ground,
            0.01,
        )
    with pytest.raises(InputError, match="must be 1, 2, 3 or 4"):
        benchmark_frame(5)
    for build in (lambda: Limits(rate=0.0), lambda: Sensors(force_noise=-1.0)):
        with pytest.raises(InputError):
            build()


def test_a_step_is_the_classical_runge_kutta_method():
    """Slopes at the beginning, twice in the middle and at the end, under a load that changes meanwhile."""
    rng = np.random.default_rng(3)
    dynamics, loads, step = rng.normal(size=(3, 3)), rng.normal(size=(3, 2)), 0.1
    state, begin, middle, end = rng.normal(size=3), *rng.normal(size=(3, 2))
    k1 = dynamics @ state + loads @ begin
    k2 = dynamics @ (state + 0.5 * step * k1) + loads @ middle
    k3 = dynamics @ (state + 0.5 * step * k2) + loads @ middle
    k4 = dynamics @ (state + step * k3) + loads @ end
    reference = state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    transition, early, middle_matrix, late = _runge_kutta_step(dynamics, loads, step)
    assert transition @ state + early @ begin + middle_matrix @ middle + late @ end == pytest.approx(
        reference
    )


def test_benchmark_plant_has_the_published_inverse():
    factors = inverse_factors(ServoHydraulic(), benchmark_partition(1).specimen)
    np.testing.assert_allclose(factors, [0.992542, 0.0248894, 1.066232e-4, 3.856392e-7], rtol=2e-5)
