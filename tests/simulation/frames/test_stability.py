"""Critical delays and discrete poles against growth and decay in simulation."""

import numpy as np
import pytest
from reliab_studies.laboratory.laboratory import Rig, run_laboratory

from reliab.core.errors import InputError
from reliab.simulation.frames.reduced_loop import pole_loop
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.integrators import CentralDifference, ChenRicles
from reliab.simulation.transfer_systems.transfer_function import gain_and_delay
from reliab.structures.critical_delay import stability_limit
from reliab.structures.frames.frame import Frame
from reliab.structures.partition import Partition
from reliab.structures.specimen import Specimen, floor_interface
from reliab.structures.stability import critical_delay
from reliab.structures.structure import Structure


@pytest.mark.parametrize(("case", "milliseconds"), [(1, 14.64), (2, 12.23), (3, 9.92), (4, 8.73)])
def test_benchmark_critical_delays(case, milliseconds, benchmark_partition):
    limit = stability_limit(benchmark_partition(case))
    assert 1e3 * limit.delay == pytest.approx(milliseconds, abs=0.01)
    assert limit.frequency == pytest.approx([3.59, 3.43, 3.16, 3.60][case - 1], abs=0.005)


@pytest.mark.parametrize("alpha", [0.05, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("gain", [0.9, 1.0, 1.1])
def test_one_mode_is_the_closed_form(alpha, gain):
    structure = Structure(frequency=1.7, damping_ratio=0.03, experimental_fraction=alpha)
    limit = stability_limit(Partition.of_structure(structure, mass=12.0), gain)
    assert limit.delay == pytest.approx(float(critical_delay(structure, gain)), rel=1e-9)


@pytest.mark.parametrize("seed", [0, 1, 2, 4, 5])
def test_a_pole_crosses_at_the_critical_delay(random_partition, seed):
    partition = random_partition(seed)
    limit = stability_limit(partition, 1.02)
    around = limit.delay * np.array([0.999, 1.0, 1.001])
    loop = pole_loop(partition, np.full(3, 1.02), around)
    assert loop.stable.tolist()[::2] == [True, False]
    crossing = loop.poles[np.argmax(loop.poles[:, 1].real), 1]
    assert abs(crossing.real) < 1e-8 * abs(crossing)
    assert crossing.imag / (2 * np.pi) == pytest.approx(limit.frequency, rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_a_loop_of_poles_answers_a_real_motion_by_a_real_one(random_partition, seed):
    """At conjugate arguments its transfer function is conjugate: each pole brings its own mirror image."""
    partition = random_partition(seed)
    delay = stability_limit(partition, 1.02).delay
    loop = pole_loop(partition, np.full(2, 1.02), delay * np.array([0.2, 0.8]))
    s = 1j * np.geomspace(0.1, 300.0, 25)
    np.testing.assert_allclose(loop.transfer(s.conj()), loop.transfer(s).conj(), rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3])
def test_tests_grow_beyond_the_critical_delay_and_decay_below(random_partition, seed):
    partition = random_partition(seed, size=2, mass=False)
    rate = 4096.0
    at = stability_limit(partition)
    limit, frequency = at.delay - 1.5 / rate, at.frequency  # the laboratory's own lag of the force
    kick = np.concatenate([np.hanning(40), np.zeros(int(60 * 50 / frequency))])
    for share, grows in ((0.93, False), (1.07, True)):
        rig = Rig(transfer_system=gain_and_delay(delay=share * limit))
        run = run_laboratory(partition, rig, kick, 0.02, rate=rate)
        last = run.command[run.command.size // 2 :]
        early, late = (np.abs(part).max() for part in (last[: last.size // 5], last[-last.size // 5 :]))
        assert bool(late > early) is grows


def least_damped_pole(structure, step, delay, integrator):
    """Pole ln(z)/h of a test integrated in steps: largest eigenvalue z of its linear map from step to step.

    The state is displacement, velocity, acceleration, and the displacements that are still on their way.
    """
    w0, xi, h = structure.circular_frequency, structure.damping_ratio, step
    damping, specimen = 2.0 * xi * w0, structure.experimental_fraction * w0**2
    whole = int(delay / step)
    part = delay / step - whole
    (x, v, a), past = np.split(np.eye(whole + 6), [3])  # columns of the map are the images of unit vectors
    if integrator is ChenRicles:
        moved = 4.0 / (4.0 + 2.0 * h * damping + (h * w0) ** 2) * a
        x, v = x + h * v + h**2 * moved, v + h * moved
    else:
        x, v = x + h * v + 0.5 * h**2 * a, v + 0.5 * h * a
    sent = np.vstack([x, past])
    force = specimen * ((1.0 - part) * sent[whole] + part * sent[whole + 1])
    load = damping * v + (w0**2 - specimen) * x + force
    if integrator is ChenRicles:
        a = -load
    else:
        a = -load / (1.0 + 0.5 * h * damping)
        v = v + 0.5 * h * a
    poles = np.log(np.linalg.eigvals(np.vstack([x, v, a, sent[:-1]])).astype(complex) + 1e-300) / h
    return poles[np.argmax(poles.real)]


@pytest.mark.parametrize("integrator", [CentralDifference, ChenRicles])
def test_the_least_damped_discrete_pole_is_the_growth_of_the_integrated_test(integrator):
    structure = Structure(frequency=2.0, damping_ratio=0.02)
    step, delay = 1 / 256, 3.4 / 256
    pole = least_damped_pole(structure, step, delay, integrator)
    test = HybridTest(structure=structure, actuator=Actuator(delay=delay))
    scheme_of_test = integrator() if integrator is CentralDifference else integrator(structure=structure)
    ground = np.concatenate([np.hanning(30), np.zeros(1500)])
    moved = run_closed_loop(test, ground, step, integrator=scheme_of_test).command.values[0]
    first, second = (np.std(moved[part]) for part in (slice(500, 756), slice(1244, 1500)))  # two cycles each
    assert np.log(second / first) / (744 * step) == pytest.approx(pole.real, rel=0.02)


def test_a_specimen_with_half_of_the_mass_tolerates_no_delay():
    frame = Frame.from_structure(Structure(frequency=1.0, damping_ratio=0.02), mass=100.0)
    heavy = Partition.of_frame(
        frame=frame, interface=floor_interface(frame, 1), specimen=Specimen(stiffness=100.0, mass=60.0)
    )
    assert stability_limit(heavy).delay == 0.0


def test_partitions_that_are_unstable_without_delay_are_refused():
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    with pytest.raises(InputError, match="unstable partition"):
        stability_limit(Partition.of_structure(structure), gain=-1.0)
