"""Critical delays and discrete poles against growth and decay in simulation."""

import numpy as np
import pytest
from reliab_studies.laboratory.laboratory import Rig, run_laboratory

from reliab.core.errors import InputError
from reliab.simulation.frames.reduced_loop import pole_loop
from reliab.simulation.transfer_systems.transfer_function import gain_and_delay
from reliab.structures.critical_delay import stability_limit
from reliab.structures.frame import Frame, Specimen, floor_interface
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure, critical_delay


@pytest.mark.parametrize(("case", "milliseconds"), [(1, 14.64), (2, 12.23), (3, 9.92), (4, 8.73)])
def test_benchmark_critical_delays(case, milliseconds, benchmark_partition):
    limit = stability_limit(benchmark_partition(case))
    assert 1e3 * limit.delay == pytest.approx(milliseconds, abs=0.01)
    assert limit.frequency == pytest.approx([3.59, 3.43, 3.16, 3.60][case - 1], abs=0.005)


@pytest.mark.parametrize("alpha", [0.05, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("gain", [0.9, 1.0, 1.1])
def test_one_mode_is_the_closed_form(alpha, gain):
    structure = Structure(frequency=1.7, damping_ratio=0.03, experimental_fraction=alpha)
    limit = stability_limit(Partition.from_structure(structure, mass=12.0), gain)
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
    position = stability_limit(partition)
    limit, frequency = (
        position.delay - 1.5 / rate,
        position.frequency,
    )  # the laboratory's own lag of the force
    kick = np.concatenate([np.hanning(40), np.zeros(int(60 * 50 / frequency))])
    for share, grows in ((0.93, False), (1.07, True)):
        rig = Rig(transfer_system=gain_and_delay(delay=share * limit))
        run = run_laboratory(partition, rig, kick, 0.02, rate=rate)
        last = run.command[run.command.size // 2 :]
        early, late = (np.abs(part).max() for part in (last[: last.size // 5], last[-last.size // 5 :]))
        assert bool(late > early) is grows


def test_a_specimen_with_half_of_the_mass_tolerates_no_delay():
    frame = Frame.from_structure(Structure(frequency=1.0, damping_ratio=0.02), mass=100.0)
    heavy = Partition.from_frame(
        frame=frame, interface=floor_interface(frame, 1), specimen=Specimen(stiffness=100.0, mass=60.0)
    )
    assert stability_limit(heavy).delay == 0.0


def test_partitions_unstable_without_delay_are_refused():
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    with pytest.raises(InputError, match="unstable partition"):
        stability_limit(Partition.from_structure(structure), gain=-1.0)
