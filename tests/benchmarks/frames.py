"""Time of the paper's 861 actuators before partitioned frames, under many ground motions.

python tests/benchmarks/frames.py [SOURCE ...]
"""

import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from reliab.core.shipped import shipped
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import FrameUnderTest, read_frame
from reliab.simulation.frames.frame_loop import FrameLoop
from reliab.sweep.request import ExplicitGrid

FRAMES = ("three_storeys", "benchmark_case_1")


def solve(frame: FrameUnderTest, motion: Motion) -> None:
    """Solve all actuators under one ground motion, poles and stability included."""
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    loop = FrameLoop(excitation=excitation, partition=frame.partition, output=frame.output)
    grid = ExplicitGrid()
    gain, delay = np.meshgrid(grid.gain, grid.delay, indexing="ij")
    loop.deviation(loop.cells(gain=gain, delay=delay))


def main() -> None:
    suite = list(load_motions(*(sys.argv[1:] or ["synthetic"])))
    for name in FRAMES:
        frame = read_frame(shipped("datasets", f"frames/{name}.toml"))
        solve(frame, suite[0])  # compiles
        start, processor = time.perf_counter(), time.process_time()
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda motion, frame=frame: solve(frame, motion), suite))
        wall_time, processor_time = time.perf_counter() - start, time.process_time() - processor
        print(f"{name}: {len(suite)} motions in {wall_time:.1f} s, {processor_time:.1f} s of processor time")


if __name__ == "__main__":
    main()
