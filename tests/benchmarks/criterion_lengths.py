"""Share of ground motions under which criteria hold, by the length of the record, whole and cut.

    python tests/benchmarks/criterion_lengths.py RECORDS [--others FOLDER] [--simulated 12] [--seed 90210]

Each of the hundred records is judged by what was learned without its earthquake: as it is, cut to its shaking
(from 1 s before 1 % to 2 s after 99 % of the Arias intensity) and to 10 to 40 s from there, at 2 and 5 %
RMS^R, 0.5, 1, 2 Hz and ξ = 2, 5 %; late actuators, the error of the loop along the whole edge. With
`--simulated` so many earthquakes of each population of `simulated_populations.py` and twice as many drawn
motions of `criterion_beyond.py` are judged by all hundred. `--others`: records of a folder, judged without
the earthquake that their catalogue names. Printed are shares at the stated 50, 80, 90, 95 and 99 %: of the
default criterion, and of that for the length of the record.
"""

from dataclasses import replace
from functools import cache
from itertools import pairwise, product
from pathlib import Path

import numpy as np
from benchmark_script import argument_parser
from criterion_beyond import DRAWS
from criterion_scope import STRUCTURES, errors_on_edges, limits_of as limits_at, read_inscribed
from simulated_populations import POPULATIONS, SEED, simulate_earthquake

from reliab.criterion.carrying import carry_to_length, protect_over_lengths
from reliab.motions.loading import load_motions
from reliab.motions.motion import arias_times
from reliab.validation.truth import SimulatedTruth

THRESHOLDS = (0.02, 0.05)
LENGTHS = (10.0, 15.0, 20.0, 25.0, 30.0, 40.0)
CLASSES = (0.0, 25.0, 40.0, 60.0, 1000.0)
SHORTEST = 10.0  # s, of the population


@cache
def limits_of(left_out_event, duration):
    """Limits without an earthquake, of all lengths or of one [s], (threshold, confidence, structure, 2)."""
    table = read_inscribed(THRESHOLDS)
    ellipses = table.take(side=table.coordinates["side"] == "lag", motion=table.events != left_out_event)
    ellipses = protect_over_lengths(ellipses) if duration is None else carry_to_length(ellipses, duration)
    return np.array([limits_at(ellipses, threshold=threshold) for threshold in THRESHOLDS])


def holds(motion, left_out_event):
    """Whether both criteria hold under a motion, (criterion, threshold, confidence, structure)."""
    duration = max(SHORTEST, round(motion.duration, 1))
    limits = np.stack([limits_of(left_out_event, None), limits_of(left_out_event, duration)])
    truth, result = SimulatedTruth(motions=[motion]), np.zeros(limits.shape[:-1], dtype=bool)
    for (row, threshold), (place, (f, xi)) in product(enumerate(THRESHOLDS), enumerate(STRUCTURES)):
        regions = limits[:, row, :, place].reshape(-1, 2)
        errors = errors_on_edges(truth, 0, f, xi, regions, threshold=threshold)
        result[:, row, :, place] = errors.reshape(2, -1) <= 1.0
    return result


def cut(motion, length=None):
    """A record from 1 s before its onset on, for a length [s], or to the end of its shaking."""
    onset, end = arias_times(motion.acceleration, motion.time_step, [0.01, 0.99])
    length = min(end - onset + 3.0 if length is None else length, motion.duration)
    begin = round(max(min(onset - 1.0, motion.duration - length), 0.0) / motion.time_step)
    return replace(
        motion, acceleration=motion.acceleration[begin : begin + round(length / motion.time_step) + 1]
    )


def show(name, motions, left_out_event=None):
    """Print a line for all motions, and one for each class of lengths."""
    holding = np.array(
        [holds(motion, motion.event if left_out_event is None else left_out_event) for motion in motions]
    )
    lengths = np.array([motion.duration for motion in motions])
    for low, high in ((0.0, CLASSES[-1]), *pairwise(CLASSES)):
        mask = (lengths > low) & (lengths <= high)
        if mask.any():
            shares = 100.0 * holding[mask].mean(axis=(0, 2, 4))
            row = "   ".join(" ".join(f"{share:5.1f}" for share in part) for part in shares)
            print(f"{name:32s} {low:4g}-{high:4g} s {mask.sum():4d}   {row}", flush=True)


def main():
    options = argument_parser(__doc__, "records", others=Path, simulated=0, seed=SEED).parse_args()
    suite = list(load_motions(options.records, sets=["far_field", "near_field"]))
    show("whole", suite)
    show("cut to the shaking", [cut(motion) for motion in suite])
    for length in LENGTHS:
        show(f"cut to {length:g} s", [cut(motion, length) for motion in suite])
    if options.others:
        show("others", list(load_motions(options.others)))
    numbers = range(1, options.simulated + 1)
    populations = {
        **{
            name: [m for n in numbers for m in simulate_earthquake(name, n, options.seed)]
            for name in POPULATIONS
        },
        **{draw.__name__: [draw(n, options.seed) for n in range(2 * options.simulated)] for draw in DRAWS},
    }
    for name, motions in populations.items() if options.simulated else ():
        show(name, motions, "")
        show(f"{name}, shaking", [cut(motion) for motion in motions], "")
        show(f"{name}, 20 s", [cut(motion, 20.0) for motion in motions], "")


if __name__ == "__main__":
    main()
