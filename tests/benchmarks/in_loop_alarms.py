"""Alarms of the monitor in C beside simulated tests: sound ones, diverging ones, channels that drop out.

python tests/benchmarks/in_loop_alarms.py [--count N] [--seed S] [--out TABLE.csv] [--compiler tcc]

N tests of each stable kind, as many diverging ones altogether, and a quarter as many in which a channel
drops out. Kinds are those of `monitor.py` (one degree of freedom), frames of three to five storeys with one
actuator and with two or three, and specimens with one of the effects that ship (the monitor has the model);
noise of the sensor is 1e-4 to 3e-3 of the exact peak. A loop that diverges is cut off at three times the
exact peak of any interface displacement. An alarm is in time when it is raised at least 0.3 s before one of
them passes twice its exact peak. `--beside-python` compares the alarm of the energy with that of Python's
monitor, for the kinds that it follows (all but several actuators). Needs a C compiler; most of the time is
its own, of which tcc takes little.
"""

import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
import scipy.linalg
from benchmark_script import argument_parser
from monitor import (
    DIVERGING,
    LARGE,
    RATE,
    STABLE,
    SWITCH_OFF,
    THRESHOLD,
    cases as cases_of_one_degree,
    effect,
)

from reliab.assessment.monitor import Monitor
from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.effects.effect import Effect, Role
from reliab.effects.registry import library
from reliab.in_loop.sources import LoopMonitor, monitor_sources
from reliab.motions.motion import Motion, resample
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.critical_delay import stability_limit
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

LEAST_MARGIN = 0.3  # s
CHUNK = 0.25  # s, after which Python's monitor is asked
FINE = 1024.0  # Hz, at which frames and nonlinear specimens are simulated; frames are followed at RATE
LARGER_KINDS = ("frame", "several actuators", "model")
KINDS = (*((kind, False) for kind in LARGER_KINDS), *((kind, True) for kind in LARGER_KINDS))
LATER = ("hysteresis_with_play",)  # effects that came after the counts, which they would draw anew
BREAKS = ("not a number", "held", "zero", "held for 0.05 s")
READ = """
#include "reliab_monitor.h"
#include <stdio.h>
int main(void)
{
    static reliab_monitor monitor;
    double row[2 * RELIAB_ACTUATORS];
    unsigned long first[3] = {0, 0, 0}, i = 0;
    unsigned k;
    reliab_monitor_init(&monitor);
    for (; fread(row, sizeof row, 1, stdin) == 1; i++) {
        const unsigned status = reliab_monitor_step(&monitor, row, row + RELIAB_ACTUATORS);
        for (k = 0u; k < 3u; k++) {
            if ((status & (1u << k)) != 0u && first[k] == 0) { first[k] = i + 1; }
        }
    }
    printf("%lu %lu %lu\\n", first[0], first[1], first[2]);
    return 0;
}
"""


@dataclass(frozen=True, kw_only=True)
class LoopCase:
    """A simulated test; histories by actuator, which are the interface displacements, in rows."""

    kind: str
    diverges: bool
    monitor: LoopMonitor | Monitor
    command: Array
    measured: Array
    ideal: Array
    exact_peaks: Array | None = None  # where the exact response was cut off
    offset: float = 0.0

    @property
    def peaks(self) -> Array:
        """Peaks of the exact response over the whole motion, by displacement [m]."""
        return np.abs(self.ideal).max(axis=1) if self.exact_peaks is None else self.exact_peaks

    @property
    def rms(self) -> float:
        """Largest true RMS error of any displacement over its exact peak."""
        error = self.measured - self.offset - self.ideal
        return float((np.sqrt(np.mean(error**2, axis=1)) / self.peaks).max())

    @property
    def time_of_doubling(self) -> float | None:
        """First time at which a command is beyond twice its exact peak [s]."""
        large = (np.abs(self.command) > LARGE * self.peaks[:, np.newaxis]).any(axis=0)
        return float(np.argmax(large)) * self.monitor.time_step if large.any() else None


def compile_monitor(monitor: LoopMonitor, folder: Path, compiler: str) -> Path:
    for name, text in {**monitor_sources(monitor), "main.c": READ}.items():
        (folder / name).write_text(text)
    words = [compiler, "-std=c99", "-O0", "reliab_monitor.c", "main.c", "-lm", "-o", "program"]
    subprocess.run(words, cwd=folder, check=True)  # noqa: S603 - a compiler
    return folder / "program"


def alarms_of(case: LoopCase, compiler: str) -> list[float | None]:
    """Times of the alarm of the energy, of the error, and of a fault [s]."""
    with tempfile.TemporaryDirectory() as name:
        program = compile_monitor(case.monitor, Path(name), compiler)
        rows = np.ascontiguousarray(np.concatenate([case.command, case.measured]).T).tobytes()
        output = subprocess.run([program], input=rows, capture_output=True, check=True).stdout  # noqa: S603
    step = case.monitor.time_step
    return [(int(word) - 1) * step if int(word) else None for word in output.split()]


def as_one_actuator_drives(partition: Partition) -> Partition:
    """Frame with one actuator, at the first interface displacement of a partition."""
    return Partition(
        mass=partition.mass,
        damping=partition.damping,
        stiffness=partition.stiffness,
        interface=partition.interface[:, 0],
        specimen_stiffness=float(partition.specimen_stiffness[0, 0]),
        specimen_damping=float(partition.specimen_damping[0, 0]),
        specimen_mass=float(partition.specimen_mass[0, 0]),
    )


def alarm_of_python(case: LoopCase) -> float | None:
    """Time of the alarm of the energy of Python's monitor, which follows one actuator [s]."""
    structure, step = case.monitor.structure, case.monitor.time_step
    if isinstance(structure, Partition):
        structure = as_one_actuator_drives(structure)
    elif isinstance(structure, HybridTest):
        structure = UpdatedModel(name="", test=structure)
    monitor, size = Monitor(structure, step), round(CHUNK / step)
    for first in range(0, case.command.shape[1], size):
        stretch = slice(first, first + size)
        monitor.feed(case.command[0, stretch], case.measured[0, stretch])
        if monitor.gains_energy_since is not None:
            return monitor.gains_energy_since
    return None


def compare_with_python(tests: Iterator[LoopCase], compiler: str) -> None:
    """Print how many tests have the alarm of the energy at the same sample in C and in Python."""
    pairs = [(alarms_of(case, compiler)[0], alarm_of_python(case)) for case in tests]
    alarms = sum(c_alarm is not None for c_alarm, _ in pairs)
    equal = sum(c_alarm == python_alarm for c_alarm, python_alarm in pairs)
    print(f"{len(pairs)} tests, {alarms} with an alarm of the energy in C, {equal} alike in Python")


@compiled
def _march(
    mass: Array,
    damping: Array,
    stiffness: Array,
    load: Array,
    interface: Array,
    force: Array,
    drag: Array,
    gain: Array,
    late: int,
    ground: Array,
    rate: float,
) -> tuple[Array, Array]:
    """Commands and measured displacements of a loop whose actuators are `late` by whole samples."""
    size, degrees, count = mass.shape[0], gain.shape[0], ground.size
    x, v = np.zeros(size), np.zeros(size)
    command, measured = np.zeros((count, degrees)), np.zeros((count, degrees))
    for k in range(count):
        command[k] = interface.T @ x
        if k >= late:
            measured[k] = gain @ command[k - late]
        travel = measured[k] - measured[k - 1] if k > 0 else measured[k]
        resists = interface @ (force @ measured[k] + drag @ (travel * rate))
        v = v + mass @ (-load * ground[k] - damping @ v - stiffness @ x - resists) / rate
        x = x + v / rate
    return command, measured


def loop_of_frame(partition: Partition, gain: Array, delay: float, ground: Array) -> tuple[Array, Array]:
    """Commands and measured displacements at RATE, simulated at FINE."""
    frame, thinning = partition, round(FINE / RATE)
    arrays = (
        np.linalg.inv(frame.mass),
        frame.numerical_damping,
        frame.numerical_stiffness,
        frame.mass @ frame.influence,
        frame.interface,
        frame.specimen_stiffness,
        frame.specimen_damping,
        gain,
    )
    arrays = tuple(np.ascontiguousarray(array, dtype=float) for array in arrays)
    both = _march(*arrays, round(delay * FINE), np.ascontiguousarray(ground), FINE)
    command, measured = (np.ascontiguousarray(history[::thinning].T) for history in both)
    return command, measured


def draw_frame(rng: np.random.Generator, degrees: int) -> Partition:
    """A shear frame, the lower `degrees` floors in the laboratory."""
    floors = int(rng.integers(3, 6))
    stiffness = 2.0 * np.eye(floors) - np.eye(floors, k=1) - np.eye(floors, k=-1)
    stiffness[-1, -1] = 1.0
    mass = np.diag(rng.uniform(0.7, 1.5, floors))
    first = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)[0]
    w1 = 2.0 * np.pi * np.exp(rng.uniform(np.log(0.4), np.log(3.0)))
    stiffness *= w1**2 / first
    inner, coupling = stiffness[:degrees, :degrees], stiffness[:degrees, degrees:]
    condensation = inner - coupling @ np.linalg.solve(stiffness[degrees:, degrees:], coupling.T)
    share = condensation * rng.uniform(0.2, 0.9)
    return Partition(
        mass=mass,
        damping=2.0 * rng.uniform(0.01, 0.06) / w1 * stiffness,
        stiffness=stiffness,
        interface=np.eye(floors)[:, :degrees],
        specimen_stiffness=share,
        specimen_damping=0.2 * rng.uniform() * 2.0 * 0.02 / w1 * share,
    )


def draw_delay_share(rng: np.random.Generator, diverges: bool, largest: float = 0.9) -> float:  # noqa: FBT001
    """Delay over the critical one."""
    return float(rng.uniform(1.1, 3.0) if diverges else np.exp(rng.uniform(np.log(0.005), np.log(largest))))


def frame_case(kind: str, diverges: bool, motion: Motion, rng: np.random.Generator) -> LoopCase | None:  # noqa: FBT001
    """A frame with one actuator, or with two or three; gains are off, and actuators move each other."""
    degrees = 1 if kind == "frame" else int(rng.integers(2, 4))
    partition = draw_frame(rng, degrees)
    gain = np.eye(degrees) + 0.01 * rng.standard_normal((degrees, degrees))
    limit = stability_limit(partition, gain).delay
    if not (4.0 / FINE < limit < 1.0):
        return None  # shorter than whole samples can show
    ground = resample(motion, FINE).acceleration
    exact, _ = loop_of_frame(partition, np.eye(degrees), 0.0, ground)
    delay = draw_delay_share(rng, diverges) * limit
    if (round(delay * FINE) > limit * FINE) != diverges:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        command, measured = loop_of_frame(partition, gain, delay, ground)
    structure = as_one_actuator_drives(partition) if degrees == 1 else partition
    case = LoopCase(
        kind=kind,
        diverges=diverges,
        monitor=LoopMonitor(structure=structure, time_step=1.0 / RATE),
        command=command,
        measured=measured,
        ideal=exact,
    )
    return add_noise(end_at_switch_off(case), rng)


def draw_effect(name: str, peak: float, k: float, w0: float, rng: np.random.Generator) -> Effect:
    """An effect that shows in a motion of a peak [m]; `k` [N/m], `w0` [rad/s]."""
    force, speed = k * peak, peak * w0
    friction = {
        "force_n": rng.uniform(0.02, 0.15) * force,
        "regularisation_velocity_m_per_s": 0.01 * speed,
    }
    yields = {
        "force_n": rng.uniform(0.2, 0.6) * force,
        "displacement_m": rng.uniform(0.2, 0.6) * peak,
        "lost_share": 1.0,
    }
    parameters = {
        "series_play": {"width_m": rng.uniform(0.005, 0.05) * peak},
        "cubic_stiffness": {"cubic_n_per_m3": rng.uniform(0.1, 0.5) * k / peak**2},
        "quadratic_stiffness": {"quadratic_n_per_m2": rng.uniform(0.05, 0.2) * k / peak},
        "coulomb_friction": friction,
        "directional_friction": {**friction, "asymmetry": 0.2},
        "viscous_damping": {"damping_n_s_per_m": rng.uniform(0.01, 0.05) * k / w0},
        "quadratic_damping": {"coefficient_n_s2_per_m2": rng.uniform(0.05, 0.2) * force / speed**2},
        "power_law_damping": {"coefficient": rng.uniform(0.02, 0.1) * force / speed**0.4, "exponent": 0.4},
        "hysteresis": yields,
        "degrading_hysteresis": {**yields, "stiffness_loss": 0.02, "strength_loss": 0.02, "slip": 0.5},
        "added_mass": {"mass_kg": rng.uniform(0.02, 0.1) * k / w0**2},
        "gap": {"gap_m": rng.uniform(0.05, 0.2) * peak},
    }
    return effect(name, **{key: float(value) for key, value in parameters[name].items()})


def model_case(kind: str, diverges: bool, motion: Motion, rng: np.random.Generator) -> LoopCase | None:  # noqa: FBT001
    """A nonlinear specimen with its model; stable ones up to half the delay that is critical at first."""
    structure = Structure(
        frequency=float(np.exp(rng.uniform(np.log(0.4), np.log(3.0)))),
        damping_ratio=float(rng.uniform(0.01, 0.06)),
        experimental_fraction=float(rng.uniform(0.3, 1.0)),
    )
    ground, w0 = resample(motion, FINE).acceleration, structure.circular_frequency
    plain = HybridTest(structure=structure, mass=float(np.exp(rng.uniform(0.0, 8.0))))
    peak = float(np.abs(run_closed_loop(plain, ground, 1.0 / FINE).command.values[0]).max())
    names = [
        name
        for name, effect_type in library().items()
        if effect_type.role is Role.FORCE and name not in LATER
    ]
    assert plain.specimen is not None
    acting = draw_effect(names[int(rng.integers(len(names)))], peak, plain.specimen.stiffness, w0, rng)
    test = replace(plain, effects=(acting,))
    limit = 2.0 * structure.damping_ratio / (w0 * structure.experimental_fraction)
    late = Actuator(
        gain=1.0 + structure.damping_ratio * rng.uniform(-0.3, 0.3),
        delay=draw_delay_share(rng, diverges, 0.5) * limit,
    )
    exact = run_closed_loop(test, ground, 1.0 / FINE).command.values[:1]
    if not np.abs(exact).max() < 10.0 * peak:
        return None  # a specimen that runs away of its own
    with np.errstate(over="ignore", invalid="ignore"):
        run = run_closed_loop(replace(test, actuator=late), ground, 1.0 / FINE)
    if not diverges and not np.abs(run.command.values[0]).max() < LARGE * np.abs(exact).max():
        return None
    case = LoopCase(
        kind=kind,
        diverges=diverges,
        monitor=LoopMonitor(structure=test, time_step=1.0 / FINE),
        command=run.command.values[:1],
        measured=run.measured[np.newaxis],
        ideal=exact,
    )
    return add_noise(end_at_switch_off(case), rng)


def end_at_switch_off(case: LoopCase) -> LoopCase | None:
    """End a test where its rig switches off; None if it does not do what was drawn."""
    excessive = ~(np.abs(case.command) < SWITCH_OFF * case.peaks[:, np.newaxis]).all(axis=0)
    if excessive.any() != case.diverges:
        return None
    end = int(np.argmax(excessive)) if case.diverges else case.command.shape[1]
    return replace(
        case,
        command=case.command[:, :end],
        measured=case.measured[:, :end],
        ideal=case.ideal[:, :end],
        exact_peaks=case.peaks,
    )


def add_noise(case: LoopCase | None, rng: np.random.Generator) -> LoopCase | None:
    """Add the noise of the sensors."""
    if case is None:
        return None
    level = case.peaks * np.exp(rng.uniform(np.log(1e-4), np.log(3e-3)))
    noise = level[:, np.newaxis] * rng.standard_normal(case.measured.shape)
    return replace(case, measured=case.measured + noise)


def cases(count: int, seed: int, kinds: Sequence[str]) -> Iterator[LoopCase]:
    suite = list(synthetic_suite(count=40, seed=seed))
    diverging = count * (len(STABLE) + len(LARGER_KINDS)) // (len(DIVERGING) + len(LARGER_KINDS))
    for case in (
        cases_of_one_degree(suite, count, seed, diverging) if {*STABLE, *DIVERGING} & {*kinds} else ()
    ):
        if case.kind not in kinds:
            continue
        monitor = LoopMonitor(structure=Partition.from_structure(case.structure), time_step=1.0 / RATE)
        offset = float(np.mean(case.measured[:20] - case.command[:20])) if case.facts["offset"] else 0.0
        rows = (np.atleast_2d(values) for values in (case.command, case.measured, case.ideal))
        command, measured, ideal = rows
        yield LoopCase(
            kind=case.kind,
            diverges=case.diverges,
            monitor=monitor,
            command=command,
            measured=measured,
            ideal=ideal,
            exact_peaks=np.array([case.facts["peak"]]),
            offset=offset,
        )
    for place, (kind, diverges) in enumerate(KINDS):
        missing, number = (diverging if diverges else count) * (kind in kinds), 0
        while missing:
            rng = np.random.default_rng((seed, 100 + place, number))
            motion = suite[int(rng.integers(len(suite)))]
            case = (model_case if kind == "model" else frame_case)(kind, diverges, motion, rng)
            number += 1
            if case is not None:
                missing -= 1
                yield case


def judge_case(case: LoopCase, compiler: str) -> dict[str, object]:
    """Alarms of a test, and what is true of it."""
    energy, error, fault = alarms_of(case, compiler)
    return {
        "kind": case.kind,
        "diverges": case.diverges,
        "energy": energy,
        "error": error,
        "fault": fault,
        "first": min((instant for instant in (energy, error, fault) if instant is not None), default=None),
        "doubled": case.time_of_doubling,
        "rms": case.rms,
        "calm": seconds_calm(case),
        "seconds": case.command.shape[1] * case.monitor.time_step,
    }


def seconds_calm(case: LoopCase) -> float:
    """Time from the last doubling of the exact peak to the end, the longest of any displacement [s]."""
    longest = 0.0
    for row in case.ideal:
        level, place = 0.0, 0
        for k, value in enumerate(np.maximum.accumulate(np.abs(row))):
            if value > 2.0 * level:
                level, place = value, k
        longest = max(longest, (row.size - 1 - place) * case.monitor.time_step)
    return longest


def break_channel(
    case: LoopCase, fault_kind: str, rng: np.random.Generator, compiler: str
) -> dict[str, object]:
    """A sound test of which one channel drops out while it moves."""
    channel, measured = int(rng.integers(len(case.measured))), case.measured.copy()
    size = np.abs(case.command[channel])
    moves = np.flatnonzero(size > 0.2 * size.max())
    place = int(rng.choice(moves))
    end = place + round(0.05 / case.monitor.time_step) if fault_kind == BREAKS[-1] else None
    last = measured[channel, place - 1]
    measured[channel, place:end] = {"not a number": np.nan, "zero": 0.0}.get(fault_kind, last)
    energy, error, fault = alarms_of(replace(case, measured=measured), compiler)
    motion = case.command[channel, place : place + round(1.0 / case.monitor.time_step)]
    return {
        "how": fault_kind,
        "at": place * case.monitor.time_step,
        "fault": fault,
        "energy": energy,
        "error": error,
        "travel": float(np.ptp(motion)),
        "peak": float(case.peaks[channel]),
    }


def say_of_kinds(table: pd.DataFrame) -> None:
    for (diverges, kind), part in table.groupby(["diverges", "kind"]):
        margin = part.doubled - part["first"].astype(float)
        text = (
            f"{(margin >= LEAST_MARGIN).sum()} in time" if diverges else f"{part.fault.notna().sum()} faults"
        )
        print(f"{kind:20} {len(part):4} tests, {part.energy.notna().sum():4} alarms of the energy, {text}")


def say(table: pd.DataFrame) -> None:
    say_of_kinds(table)
    sound, ran = table[~table.diverges], table[table.diverges & table.doubled.notna()]
    good, bad = sound[sound.rms < THRESHOLD], sound[sound.rms > 2.0 * THRESHOLD]
    print(f"stable: {len(sound)}, false alarms of the energy {sound.energy.notna().sum()}")
    print(f"stable: {len(sound)}, false faults {sound.fault.notna().sum()}")
    print(f"error below the threshold: {len(good)}, false alarms of the error {good.error.notna().sum()}")
    false = sound.energy.notna() | sound.fault.notna() | (sound.error.notna() & (sound.rms < THRESHOLD))
    print(f"stable: {len(sound)}, with any false alarm {false.sum()}")
    silent = bad[bad.error.isna()]
    short = (silent.calm < 12.0).sum()
    print(f"stable, error above twice the threshold: {len(bad)}, silent {len(silent)}, too short {short}")
    print(silent.to_string())
    margin = ran.doubled - ran["first"].astype(float)
    early, silent = (margin >= LEAST_MARGIN).sum(), ran["first"].isna().sum()
    print(f"passed twice the peak: {len(ran)}, {early} in time, {silent} silent")
    print(ran[~(margin >= LEAST_MARGIN)].to_string())


def say_of_dropouts(table: pd.DataFrame) -> None:
    for fault_kind, part in table.groupby("how"):
        wait = (part.fault - part["at"]).astype(float)
        print(
            f"{fault_kind:16} {len(part):4} dropouts, {part.fault.notna().sum()} faults, half within "
            f"{wait.median():.3f} s, all of them within {wait.max():.3f} s"
        )


def main() -> None:
    parser = argument_parser(__doc__, count=50, seed=1, compiler="cc", out=Path, beside_python=False)
    parser.add_argument("--kinds", nargs="+", default=[*STABLE, *DIVERGING, *LARGER_KINDS])
    options = parser.parse_args()
    if options.beside_python:
        compare_with_python(cases(options.count, options.seed, options.kinds), options.compiler)
        return
    rows, dropouts = [], []
    for place, case in enumerate(cases(options.count, options.seed, options.kinds)):
        rows.append(judge_case(case, options.compiler))
        if not case.diverges and place % 4 == 0:
            rng = np.random.default_rng((options.seed, 200, place))
            dropouts.append(break_channel(case, BREAKS[place // 4 % len(BREAKS)], rng, options.compiler))
    if options.out:
        pd.DataFrame(rows).to_csv(options.out, index=False)
        pd.DataFrame(dropouts).to_csv(options.out.with_suffix(".dropouts.csv"), index=False)
    say(pd.DataFrame(rows))
    say_of_dropouts(pd.DataFrame(dropouts))


if __name__ == "__main__":
    main()
