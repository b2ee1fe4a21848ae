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

REPETITIONS = 60


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


def compile_program(folder: Path) -> Path:
    program = folder / "program"
    sources = ["reliab_monitor.c", str(Path(__file__).with_name("step_times.c")), "-lm", "-o", str(program)]
    flags = ["-std=c99", "-O2", f"-DREPEATED={REPETITIONS}", "-I."]
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
            program = compile_program(folder)
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
