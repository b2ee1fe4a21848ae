"""Critical delays, discrete poles and the predictive indicator, against growth and decay in simulation."""

import math

import numpy as np
import pytest
from reliab_studies.rths_benchmark.benchmark import benchmark_partition

from reliab.errors import InputError
from reliab.simulation.actuator import Actuator
from reliab.simulation.frames.loop_poles import pole_loop
from reliab.simulation.hybrid_test import HybridTest, run_closed_loop
from reliab.simulation.integrators import CentralDifference, ChenRicles
from reliab.simulation.laboratory.laboratory import run_laboratory
from reliab.simulation.laboratory.rig import Rig
from reliab.simulation.transfer_systems import gain_and_delay
from reliab.structures.critical_delay import critical_delay, predictive_stability_indicator
from reliab.structures.frames import Frame
from reliab.structures.partition import Partition, floor_interface
from reliab.structures.root_locus import Scheme, discrete_critical_delay, discrete_poles, root_locus
from reliab.structures.specimen import Specimen
from reliab.structures.stability import critical_delay as critical_delay_of_one_mode
from reliab.structures.structure import Structure


@pytest.mark.parametrize(("case", "milliseconds"), [(1, 14.64), (2, 12.23), (3, 9.92), (4, 8.73)])
def test_benchmark_critical_delays(case, milliseconds):
    delay, frequency = critical_delay(benchmark_partition(case))
    assert 1e3 * delay == pytest.approx(milliseconds, abs=0.01)
    assert frequency == pytest.approx([3.59, 3.43, 3.16, 3.60][case - 1], abs=0.005)
    assert predictive_stability_indicator(benchmark_partition(case)) == pytest.approx(
        math.log10(milliseconds), abs=1e-3
    )


@pytest.mark.parametrize("alpha", [0.05, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("gain", [0.9, 1.0, 1.1])
def test_one_mode_is_the_closed_form(alpha, gain):
    structure = Structure(frequency=1.7, damping_ratio=0.03, experimental_fraction=alpha)
    found, _ = critical_delay(Partition.of(structure, mass=12.0), gain)
    assert found == pytest.approx(float(critical_delay_of_one_mode(structure, gain)), rel=1e-9)


@pytest.mark.parametrize("seed", [0, 1, 2, 4, 5])
def test_a_pole_crosses_at_the_critical_delay(random_partition, seed):
    partition = random_partition(seed)
    delay, frequency = critical_delay(partition, 1.02)
    around = delay * np.array([0.999, 1.0, 1.001])
    loop = pole_loop(partition, np.full(3, 1.02), around)
    assert loop.stable.tolist()[::2] == [True, False]
    crossing = loop.poles[np.argmax(loop.poles[:, 1].real), 1]
    assert abs(crossing.real) < 1e-8 * abs(crossing)
    assert crossing.imag / (2 * np.pi) == pytest.approx(frequency, rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_a_loop_of_poles_answers_a_real_motion_by_a_real_one(random_partition, seed):
    """At conjugate arguments its transfer function is conjugate: each pole brings its own mirror image."""
    partition = random_partition(seed)
    delay, _ = critical_delay(partition, 1.02)
    loop = pole_loop(partition, np.full(2, 1.02), delay * np.array([0.2, 0.8]))
    s = 1j * np.geomspace(0.1, 300.0, 25)
    np.testing.assert_allclose(loop.transfer(s.conj()), loop.transfer(s).conj(), rtol=1e-9)


@pytest.mark.parametrize("seed", [0, 3])
def test_tests_grow_beyond_the_critical_delay_and_decay_below(random_partition, seed):
    partition = random_partition(seed, size=2, mass=False)
    rate = 4096.0
    limit, frequency = critical_delay(partition)
    limit -= 1.5 / rate  # the laboratory's own lag of the force
    kick = np.concatenate([np.hanning(40), np.zeros(int(60 * 50 / frequency))])
    for share, grows in ((0.93, False), (1.07, True)):
        rig = Rig(transfer_system=gain_and_delay(delay=share * limit))
        run = run_laboratory(partition, rig, kick, 0.02, rate=rate)
        last = run.command[run.command.size // 2 :]
        early, late = (np.abs(part).max() for part in (last[: last.size // 5], last[-last.size // 5 :]))
        assert bool(late > early) is grows


@pytest.mark.parametrize(
    ("scheme", "integrator"),
    [(Scheme.CENTRAL_DIFFERENCE, CentralDifference), (Scheme.CHEN_RICLES, ChenRicles)],
)
def test_discrete_poles_are_the_growth_of_the_integrated_test(scheme, integrator):
    structure = Structure(frequency=2.0, damping_ratio=0.02)
    step, delay = 1 / 256, 3.4 / 256
    pole = discrete_poles(Partition.of(structure), step, delay=delay, scheme=scheme)[0]
    test = HybridTest(structure=structure, actuator=Actuator(delay=delay))
    scheme_of_test = integrator() if integrator is CentralDifference else integrator(structure=structure)
    ground = np.concatenate([np.hanning(30), np.zeros(1500)])
    moved = run_closed_loop(test, ground, step, integrator=scheme_of_test).command.values[0]
    first, second = (np.std(moved[part]) for part in (slice(500, 756), slice(1244, 1500)))  # two cycles each
    assert np.log(second / first) / (744 * step) == pytest.approx(pole.real, rel=0.02)


def test_a_force_that_is_held_costs_a_step_and_a_half():
    partition, step = benchmark_partition(1), 1 / 4096
    exact, _ = critical_delay(partition)
    found = discrete_critical_delay(partition, step, scheme=Scheme.HELD_FORCE)
    assert exact - found == pytest.approx(1.5 * step, rel=0.02)


def test_the_locus_starts_at_the_structure_and_crosses_at_the_limit():
    partition, step = benchmark_partition(4), 1 / 2048
    limit = discrete_critical_delay(partition, step)
    locus = root_locus(partition, step, np.array([0.0, 0.99 * limit, 1.01 * limit]))
    np.testing.assert_allclose(np.sort(np.abs(locus[0]))[0], abs(partition.frame.poles[0]), rtol=1e-3)
    assert locus[1, 0].real < 0.0 < locus[2, 0].real


def test_a_specimen_with_half_of_the_mass_tolerates_no_delay():
    frame = Frame.of(Structure(frequency=1.0, damping_ratio=0.02), mass=100.0)
    heavy = Partition(
        frame=frame, interface=floor_interface(frame, 1), specimen=Specimen(stiffness=100.0, mass=60.0)
    )
    assert critical_delay(heavy)[0] == 0.0
    with pytest.raises(InputError, match="tolerates some delay"):
        predictive_stability_indicator(heavy)


def test_partitions_that_are_unstable_without_delay_are_refused():
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    with pytest.raises(InputError, match="unstable partition"):
        critical_delay(Partition.of(structure), gain=-1.0)
