"""The monitor in C: time of a step at 1, 2 and 20 degrees of freedom, of two actuators, and of a hysteresis.

python tests/benchmarks/in_loop.py [steps]

Needs a C compiler and Linux. Each step is timed once as it comes, interruptions included. One that took above
two medians is repeated from the same state, twice and then until it takes below five, up to sixty times; the
least of these times is the work of the step: what the code needs comes back, an interruption does not.
"""

import argparse
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from reliab.core.shipped import shipped
from reliab.effects.registry import find_effect
from reliab.in_loop.sources import LoopMonitor, monitor_sources
from reliab.simulation.frames.frame_file import read_structure
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

FLAGS = ("-std=c99", "-O2")
REPETITIONS = 60
TIMING_PROGRAM = """
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
static long median(const unsigned *counts, long steps)
{
    long sum = 0, k;
    for (k = 0; k < MOST && 2 * (sum += counts[k]) < steps; k++) { }
    return k;
}
static long timed(reliab_monitor *monitor, const double *x, const double *y)
{
    struct timespec a, b;
    clock_gettime(CLOCK_MONOTONIC, &a);
    (void)reliab_monitor_step(monitor, x, y);
    clock_gettime(CLOCK_MONOTONIC, &b);
    {
        const long spent = (b.tv_sec - a.tv_sec) * 1000000000L + b.tv_nsec - a.tv_nsec;
        return spent < MOST ? spent : MOST;
    }
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
    static reliab_monitor monitor, before, repeated;
    const long steps = n > 1 ? atol(words[1]) : 1000000L;
    const int locked = mlockall(MCL_CURRENT) == 0;
    struct rusage use;
    cpu_set_t one;
    long i, switches, taken = 0, typical = 0, again = 0;
    int alone;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    alone = sched_setaffinity(0, sizeof one, &one) == 0;
    memset(once, 0, sizeof once);
    memset(least, 0, sizeof least);
    reliab_monitor_init(&monitor);
    for (i = 0; i < steps; i++) {
        double x[RELIAB_ACTUATORS], y[RELIAB_ACTUATORS];
        long spent, smallest, r;
        unsigned k;
        for (k = 0u; k < RELIAB_ACTUATORS; k++) {
            x[k] = 0.01 * sin((6.0 + k) * RELIAB_STEP * (double)i);
            y[k] = 0.99 * x[k] + 1e-6 * sin(0.7 * (double)i);
        }
        if (i == 10000) { typical = median(least, i); }
        memcpy(&before, &monitor, sizeof monitor);
        getrusage(RUSAGE_THREAD, &use);
        switches = use.ru_nivcsw;
        smallest = timed(&monitor, x, y);
        once[smallest]++;
        /* the same step from the same state, where it took long */
        for (r = 1; smallest > 2 * typical && (r < 3 || smallest > 5 * typical) && r < @REPEATED@; r++) {
            memcpy(&repeated, &before, sizeof monitor);
            spent = timed(&repeated, x, y);
            smallest = spent < smallest ? spent : smallest;
        }
        again += r > 1;
        least[smallest]++;
        getrusage(RUSAGE_THREAD, &use);
        taken += use.ru_nivcsw > switches;
    }
    say(once, steps);
    say(least, steps);
    printf("%ld %ld %d %d\\n", again, taken, alone, locked);
    return (int)(monitor.status & RELIAB_FAULT);
}
"""


def chain(floors: int) -> Partition:
    """A shear frame of equal storeys of about 1 Hz with 2 % damping, its first storey in the laboratory."""
    stiffness = 2.0 * np.eye(floors) - np.eye(floors, k=1) - np.eye(floors, k=-1)
    stiffness[-1, -1] = 1.0
    stiffness *= (2.0 * np.pi / (2.0 * np.sin(np.pi / (4.0 * floors + 2.0)))) ** 2
    return Partition(
        mass=np.eye(floors),
        damping=0.04 / (2.0 * np.pi) * stiffness,
        stiffness=stiffness,
        interface=np.eye(floors)[0],
        specimen_stiffness=float(stiffness[0, 0]) / 2.0,
    )


def compile_program(folder: Path, main: str, flags: tuple[str, ...] = FLAGS) -> Path:
    (folder / "main.c").write_text(main)
    program = folder / "program"
    sources = ["reliab_monitor.c", "main.c", "-lm", "-o", str(program)]
    subprocess.run(["cc", *flags, *sources], cwd=folder, check=True)  # noqa: S603, S607 - a compiler
    return program


def list_monitors() -> dict[str, LoopMonitor]:
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
    for label, monitor in list_monitors().items():
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file, text in monitor_sources(monitor).items():
                (folder / file).write_text(text)
            program = compile_program(folder, TIMING_PROGRAM.replace("@REPEATED@", str(REPETITIONS)))
            words = [program, str(steps)]
            output = subprocess.run(words, capture_output=True, text=True, check=True).stdout  # noqa: S603
            half, most_steps, worst, slow_steps, *least, repeats, stops, is_alone, is_locked = map(
                int, output.split()
            )
            print(
                f"{label:12} median {half} ns, 99.99 % {most_steps} ns, worst {worst} ns, {slow_steps} steps "
                f"beyond ten medians; work of a step: {least[0]}, {least[1]}, {least[2]} ns, "
                f"{least[3]} beyond, {repeats} repeated; {stops} steps interrupted by others, {steps:,} steps"
                f"{', on one processor' * is_alone}{', in locked memory' * is_locked}",
                flush=True,
            )


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("steps", nargs="?", type=int, default=10**7)
    latency(parser.parse_args().steps)


if __name__ == "__main__":
    main()
