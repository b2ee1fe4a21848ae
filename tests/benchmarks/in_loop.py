"""The monitor in C: time of a step, and its alarms beside simulated tests that are sound or diverge.

python tests/benchmarks/in_loop.py latency [steps]
python tests/benchmarks/in_loop.py alarms [stable tests of each kind] [seed]

Needs a C compiler, and Linux for the times: each step is timed once as it comes, interruptions included, and
twice more from the same state; the least of the three is the work of the step. The loops are those of
`monitor.py`, cut off at three times the exact peak. An alarm is in time when it is raised at least 0.3 s
before the displacement passes twice the exact peak.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from monitor import DIVERGING, RATE, STABLE, Case, cases

from reliab.api import export_monitor
from reliab.assessment.rebuilt_error import WholeStructure
from reliab.effects import find_effect
from reliab.in_loop import LoopMonitor, monitor_sources
from reliab.motions.synthetic import synthetic_suite
from reliab.shipped import shipped
from reliab.simulation.frames import read_structure
from reliab.simulation.hybrid_test import HybridTest
from reliab.structures import Structure

FLAGS = ("-std=c99", "-O2")
IN_TIME = 0.3
LARGE = 2.0
REPEATED = 3
TIMED = """
#define _GNU_SOURCE
#include "reliab_monitor.h"
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#define MOST 10000000
static unsigned once[MOST + 1], least[MOST + 1];  /* steps by nanoseconds */
static long timed(reliab_monitor *monitor, const double *x, const double *y)
{
    struct timespec a, b;
    clock_gettime(CLOCK_MONOTONIC, &a);
    (void)reliab_monitor_step(monitor, x, y);
    clock_gettime(CLOCK_MONOTONIC, &b);
    return (b.tv_sec - a.tv_sec) * 1000000000L + b.tv_nsec - a.tv_nsec;
}
static void say(const unsigned *counts, long steps)
{
    long sum = 0, k, half = -1, most = -1, worst = 0, beyond = 0;
    for (k = 0; k <= MOST; k++) {
        sum += counts[k];
        if (half < 0 && 2 * sum >= steps) { half = k; }
        if (most < 0 && 10000.0 * (double)sum >= 9999.0 * (double)steps) { most = k; }
        if (counts[k] > 0) { worst = k; }
        if (half >= 0 && k > 10 * half) { beyond += counts[k]; }
    }
    printf("%ld %ld %ld %ld ", half, most, worst, beyond);
}
int main(int n, char **words)
{
    static reliab_monitor monitor, repeated;
    const long steps = n > 1 ? atol(words[1]) : 1000000L;
    const int locked = mlockall(MCL_CURRENT) == 0;
    struct rusage use;
    cpu_set_t one;
    long i, switches, taken = 0;
    int alone;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    alone = sched_setaffinity(0, sizeof one, &one) == 0;
    memset(once, 0, sizeof once);
    memset(least, 0, sizeof least);
    reliab_monitor_init(&monitor);
    for (i = 0; i < steps; i++) {
        double x[RELIAB_ACTUATORS], y[RELIAB_ACTUATORS];
        long spent, smallest = MOST, r;
        unsigned k;
        for (k = 0u; k < RELIAB_ACTUATORS; k++) {
            x[k] = 0.01 * sin((6.0 + k) * RELIAB_STEP * (double)i);
            y[k] = 0.99 * x[k] + 1e-6 * sin(0.7 * (double)i);
        }
        for (r = 1; r < @REPEATED@; r++) {  /* the same step from the same state */
            memcpy(&repeated, &monitor, sizeof monitor);
            spent = timed(&repeated, x, y);
            smallest = spent < smallest ? spent : smallest;
        }
        getrusage(RUSAGE_THREAD, &use);
        switches = use.ru_nivcsw;
        spent = timed(&monitor, x, y);
        once[spent < MOST ? spent : MOST]++;
        smallest = spent < smallest ? spent : smallest;
        least[smallest]++;
        getrusage(RUSAGE_THREAD, &use);
        taken += use.ru_nivcsw > switches;
    }
    say(once, steps);
    say(least, steps);
    printf("%ld %d %d\\n", taken, alone, locked);
    return (int)(monitor.status & RELIAB_FAULT);
}
"""
READ = """
#include "reliab_monitor.h"
#include <stdio.h>
int main(void)
{
    static reliab_monitor monitor;
    double pair[2];
    unsigned long first[3] = {0, 0, 0}, i = 0;
    unsigned k;
    reliab_monitor_init(&monitor);
    for (; fread(pair, sizeof(double), 2, stdin) == 2; i++) {
        const unsigned status = reliab_monitor_step(&monitor, &pair[0], &pair[1]);
        for (k = 0u; k < 3u; k++) {
            if ((status & (1u << k)) != 0u && first[k] == 0) { first[k] = i + 1; }
        }
    }
    printf("%lu %lu %lu\\n", first[0], first[1], first[2]);
    return 0;
}
"""


def chain(floors: int) -> WholeStructure:
    """A shear frame of equal storeys of about 1 Hz with 2 % damping, its first storey in the laboratory."""
    stiffness = 2.0 * np.eye(floors) - np.eye(floors, k=1) - np.eye(floors, k=-1)
    stiffness[-1, -1] = 1.0
    stiffness *= (2.0 * np.pi / (2.0 * np.sin(np.pi / (4.0 * floors + 2.0)))) ** 2
    return WholeStructure(
        mass=np.eye(floors),
        damping=0.04 / (2.0 * np.pi) * stiffness,
        stiffness=stiffness,
        interface=np.eye(floors)[0],
        specimen_stiffness=float(stiffness[0, 0]) / 2.0,
    )


def compiled(folder: Path, main: str, flags: tuple[str, ...] = FLAGS) -> Path:
    (folder / "main.c").write_text(main)
    program = folder / "program"
    sources = ["reliab_monitor.c", "main.c", "-lm", "-o", str(program)]
    subprocess.run(["cc", *flags, *sources], cwd=folder, check=True)  # noqa: S603, S607 - a compiler
    return program


def timed_monitors() -> dict[str, LoopMonitor]:
    """Monitors whose steps are timed, by what they are of."""
    step = 1.0 / 4096.0
    frame = read_structure(shipped("datasets", "frames/two_actuators.toml"))
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    yields = {"force_n": 0.1, "displacement_m": 0.003, "lost_share": 1.0}
    model = HybridTest(structure=structure, effects=(find_effect("hysteresis")(**yields),))
    return {
        **{f"{floors} dof": LoopMonitor(structure=chain(floors), time_step=step) for floors in (1, 2, 20)},
        "2 actuators": LoopMonitor(
            structure=frame.partition, to_interface=frame.to_interface, time_step=step
        ),
        "hysteresis": LoopMonitor(structure=model, time_step=step),
    }


def latency(steps: int) -> None:
    for what, monitor in timed_monitors().items():
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file, text in monitor_sources(monitor).items():
                (folder / file).write_text(text)
            program = compiled(folder, TIMED.replace("@REPEATED@", str(REPEATED)))
            words = [program, str(steps)]
            said = subprocess.run(words, capture_output=True, text=True, check=True).stdout  # noqa: S603
            half, most, worst, beyond, *least, taken, alone, locked = (int(word) for word in said.split())
            print(
                f"{what:12} median {half} ns, 99.99 % {most} ns, worst {worst} ns, {beyond} steps beyond ten "
                f"medians; least of {REPEATED} of the same step: {least[0]}, {least[1]}, {least[2]} ns, "
                f"{least[3]} beyond; {taken} steps interrupted by others, {steps:,} steps"
                f"{', on one processor' * alone}{', in locked memory' * locked}",
                flush=True,
            )


def alarms_of(case: Case) -> list[float | None]:
    """Times of the alarm of the energy, of the error, and of a fault [s]."""
    structure = case.structure
    with tempfile.TemporaryDirectory() as name:
        export_monitor(
            ("c", name),
            f=structure.frequency,
            xi=structure.damping_ratio,
            alpha=structure.experimental_fraction,
            rate=RATE,
        )
        program = compiled(Path(name), READ, ("-std=c99", "-O0"))  # compiled once for each test
        rows = np.stack([case.command, case.measured], axis=1).tobytes()
        said = subprocess.run([program], input=rows, capture_output=True, check=True).stdout  # noqa: S603
    return [(int(word) - 1) / RATE if int(word) else None for word in said.split()]


def alarms(count: int, seed: int) -> None:
    rows = []
    diverging = count * len(STABLE) // len(DIVERGING)  # as many as are stable
    for case in cases(synthetic_suite(count=40, seed=seed), count, seed, diverging):
        energy, error, fault = alarms_of(case)
        large = np.abs(case.command) > LARGE * case.facts["peak"]
        offset = np.mean(case.measured[:20] - case.command[:20]) if case.facts["offset"] else 0.0
        strayed = case.measured - offset - case.ideal
        rows.append(
            {
                "kind": case.kind,
                "diverges": case.diverges,
                "energy": energy,
                "error": error,
                "fault": fault,
                "first": min((at for at in (energy, error) if at is not None), default=None),
                "doubled": float(np.argmax(large)) / RATE if large.any() else None,
                "rms": float(np.sqrt(np.mean(strayed**2)) / case.facts["peak"]),
            }
        )
    say(pd.DataFrame(rows))


def say(table: pd.DataFrame) -> None:
    for diverges, part in table.groupby("diverges"):
        for kind, of_kind in part.groupby("kind"):
            raised = of_kind.energy.notna().sum()
            margin = of_kind.doubled - of_kind["first"].astype(float)
            in_time = (margin >= IN_TIME).sum()
            what = f"{in_time} in time" if diverges else f"{of_kind.fault.notna().sum()} faults"
            print(f"{kind:20} {len(of_kind):4} tests, {raised:4} alarms of the energy, {what}")
    sound = table[~table.diverges]
    good, bad = sound[sound.rms < 0.05], sound[sound.rms > 0.1]
    print(f"stable: {len(sound)}, false alarms of the energy {sound.energy.notna().sum()}")
    print(f"error below 5 %: {len(good)}, false alarms of the error {good.error.notna().sum()}")
    print(f"stable, error above 10 %: {len(bad)}, silent {bad.error.isna().sum()}")
    ran = table[table.diverges & table.doubled.notna()]
    margin = ran.doubled - ran["first"].astype(float)
    in_time = (margin >= IN_TIME).sum()
    print(f"passed twice the peak: {len(ran)}, {in_time} in time, {ran['first'].isna().sum()} silent")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["latency", "alarms"])
    parser.add_argument("count", nargs="?", type=int)
    parser.add_argument("seed", nargs="?", type=int, default=1)
    given = parser.parse_args()
    if given.what == "latency":
        latency(given.count or 10**7)
    else:
        print(
            f"{len(STABLE)} stable and {len(DIVERGING)} diverging kinds, seed {given.seed}", file=sys.stderr
        )
        alarms(given.count or 72, given.seed)


if __name__ == "__main__":
    main()
