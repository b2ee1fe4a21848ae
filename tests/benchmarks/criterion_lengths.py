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

import argparse
from dataclasses import replace
from functools import cache
from itertools import pairwise, product

import numpy as np
from criterion_beyond import DRAWS
from criterion_scope import CONFIDENCES, XI, F
from simulated_populations import POPULATIONS, SEED, simulated

from reliab.criterion.carrying import carry_to_length
from reliab.criterion.derivation import Derivation
from reliab.criterion.methods.registry import method_of
from reliab.criterion.shipped_tables import read_shipped_ellipses
from reliab.motions.intensity import arias_times
from reliab.motions.loading import load_motions
from reliab.validation.cross_validation.truth import Cell, Region, SimulatedTruth

THRESHOLDS = (0.02, 0.05)
STRUCTURES = tuple(product(F, XI))
LENGTHS = (10.0, 15.0, 20.0, 25.0, 30.0, 40.0)
CLASSES = (0.0, 25.0, 40.0, 60.0, 1000.0)
SHORTEST = 10.0  # s, of the population


@cache
def limits_of(without, duration):
    """Limits without an earthquake, of all lengths or of one [s], (threshold, confidence, structure, 2)."""
    table = read_shipped_ellipses("inscribed", "record", "rms")
    near = {"f": F, "xi": XI, "threshold": THRESHOLDS}
    places = {
        name: [int(np.abs(table.coordinates[name] - value).argmin()) for value in of]
        for name, of in near.items()
    }
    ellipses = table.take(**places, side=table.coordinates["side"] == "lag", motion=table.events != without)
    ellipses = ellipses if duration is None else carry_to_length(ellipses, duration)
    found = []
    for threshold in THRESHOLDS:
        derivation = Derivation.from_ellipses(
            ellipses, method=method_of("dirichlet"), threshold=threshold, metric="rms"
        )
        criteria = [derivation.criterion(share, joint=True) for share in CONFIDENCES]
        found.append([[criterion.limits(f, xi) for f, xi in STRUCTURES] for criterion in criteria])
    return np.array(found, dtype=float)


def kept(motion, without):
    """Whether both criteria hold under a motion, (criterion, threshold, confidence, structure)."""
    duration = max(SHORTEST, round(motion.duration, 1))
    limits = np.stack([limits_of(without, None), limits_of(without, duration)])
    truth, held = SimulatedTruth(motions=[motion]), np.zeros(limits.shape[:-1], dtype=bool)
    for (row, threshold), (place, (f, xi)) in product(enumerate(THRESHOLDS), enumerate(STRUCTURES)):
        edges = [Region(a=a, b=b).edge() for a, b in limits[:, row, :, place].reshape(-1, 2).tolist()]
        gain, delay = (np.concatenate([getattr(edge, name) for edge in edges]) for name in ("gain", "delay"))
        cell = Cell(frequency=f, damping_ratio=xi, threshold=threshold, metric="rms")
        errors = truth.errors(cell, 0, gain, delay).reshape(2, len(CONFIDENCES), -1)
        held[:, row, :, place] = (errors <= 1.0).all(axis=-1)
    return held


def cut(motion, length=None):
    """A record from 1 s before its onset on, for a length [s], or to the end of its shaking."""
    onset, end = arias_times(motion.acceleration, motion.time_step, [0.01, 0.99])
    length = min(end - onset + 3.0 if length is None else length, motion.duration)
    begin = round(max(min(onset - 1.0, motion.duration - length), 0.0) / motion.time_step)
    return replace(
        motion, acceleration=motion.acceleration[begin : begin + round(length / motion.time_step) + 1]
    )


def show(name, motions, without=None):
    """Print a line for all motions, and one for each class of lengths."""
    held = np.array([kept(motion, motion.event if without is None else without) for motion in motions])
    lengths = np.array([motion.duration for motion in motions])
    for low, high in ((0.0, CLASSES[-1]), *pairwise(CLASSES)):
        chosen = (lengths > low) & (lengths <= high)
        if chosen.any():
            shares = 100.0 * held[chosen].mean(axis=(0, 2, 4))
            row = "   ".join(" ".join(f"{share:5.1f}" for share in part) for part in shares)
            print(f"{name:32s} {low:4g}-{high:4g} s {chosen.sum():4d}   {row}", flush=True)


def main():
    """Print the shares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records")
    parser.add_argument("--others")
    parser.add_argument("--simulated", type=int, default=0)
    parser.add_argument("--seed", type=int, default=SEED)
    options = parser.parse_args()
    suite = list(load_motions(options.records, sets=["far_field", "near_field"]))
    show("whole", suite)
    show("cut to the shaking", [cut(motion) for motion in suite])
    for length in LENGTHS:
        show(f"cut to {length:g} s", [cut(motion, length) for motion in suite])
    if options.others:
        show("others", list(load_motions(options.others)))
    numbers = range(1, options.simulated + 1)
    populations = {
        **{name: [m for n in numbers for m in simulated(name, n, options.seed)] for name in POPULATIONS},
        **{draw.__name__: [draw(n, options.seed) for n in range(2 * options.simulated)] for draw in DRAWS},
    }
    for name, motions in populations.items() if options.simulated else ():
        show(name, motions, "")
        show(f"{name}, shaking", [cut(motion) for motion in motions], "")
        show(f"{name}, 20 s", [cut(motion, 20.0) for motion in motions], "")


if __name__ == "__main__":
    main()
