"""Reliability diagram of the probability by the index, under earthquakes that were left out.

    python tests/benchmarks/index_probability.py RECORDS [SECONDS...] [--population] [--groups]
        [--seed S] [--rigs N]

Rigs with a gain and a delay are drawn around the boundaries of each of the 100 records, whole or cut to
SECONDS. Their probability is stated as `reliab assess` does, by the motions of other earthquakes: as a
criterion for tests of that length (`population`), and carried to the test's own exact response (`response`).
Whether a rig is good is computed by the loop. Printed are, for each band of stated probability, the mean of
what is stated and the share of good tests; and the shares kept along the edge of the 95 % limits. By the
population no probability is stated where the response lies outside of its scope; what would have been stated
there stands in rows of its own (`unstated`). With `--population` the response's own, which takes most of the
time, is left out.
"""

from itertools import pairwise

import numpy as np
from benchmark_script import argument_parser
from criterion_scope import LENGTHS

from reliab.assessment.default_criterion import criterion_of_response, default_criterion
from reliab.core.vocabulary import Metric
from reliab.criterion.response_measures import ResponseMeasures
from reliab.criterion.scope import Position, compare_with_scope
from reliab.motions.loading import load_motions
from reliab.simulation.engine import Loop
from reliab.structures.structure import Structure
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.first_order import first_order_ellipse
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window
from reliab.validation.truth import Region

THRESHOLD, CONFIDENCE = 0.05, 0.95
STRUCTURES = (0.5, 0.02), (1.0, 0.05), (2.0, 0.02)
BANDS = (0.0, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98, 1.0)


def judge_rigs(motion, seconds, f, xi, rng, *, population, rigs):
    """Probabilities (3, rigs), whether good (rigs,), edges kept (2,) and areas (2,) under one record."""
    structure = Structure(frequency=f, damping_ratio=xi)
    excitation = excitation_of(motion, Window.parse("record" if seconds is None else f"{seconds:g}"))
    response = first_order_ellipse(excitation, structure)
    length = response.duration
    length_criterion = default_criterion(
        f, xi, THRESHOLD, CONFIDENCE, excluded_event=motion.event, duration=length
    )
    settings = {"threshold": THRESHOLD, "confidence": CONFIDENCE, "excluded_events": [motion.event]}
    response_criterion = criterion_of_response(response, structure, **settings)
    a, b = (float(limit) for limit in response_criterion.limits(f, xi))
    turn, size = np.pi * rng.random(rigs), np.exp(rng.uniform(-1.2, 1.2, rigs))
    gain = 1.0 + size * np.sqrt(a) * np.cos(turn)
    delay = size * np.sqrt(b) * np.sin(turn) / 1000.0
    loop = Loop(excitation=excitation, structure=structure)

    def errors(gain, delay):
        return relative_error(loop.deviation(loop.cells(gain=gain, delay=delay)), Metric.RMS)

    population_probability = length_criterion.probability(gain, delay, f, xi)
    measures = ResponseMeasures.from_response(response, structure, "this test").measure_values
    test = {"length": length, "cycles": length * f} | {name: value.item() for name, value in measures.items()}
    is_outside = compare_with_scope(length_criterion.provenance.scope, test).position is Position.OUTSIDE
    unknown = np.full(rigs, np.nan)
    probabilities = [
        unknown if is_outside else population_probability,
        unknown,
        population_probability if is_outside else unknown,
    ]
    if not population:
        probabilities[1] = [
            float(
                criterion_of_response(response, structure, tracking=rig, **settings).probability(*rig, f, xi)
            )
            for rig in zip(gain.tolist(), delay.tolist(), strict=True)
        ]
    edges_kept, areas = [], []
    for criterion in (length_criterion, response_criterion):
        limits = [float(limit) for limit in criterion.limits(f, xi)]
        edge = Region(a=limits[0], b=limits[1]).edge()
        edges_kept.append(bool((errors(edge.gain, edge.delay) <= THRESHOLD).all()))
        areas.append(np.sqrt(limits[0] * limits[1]))
    return np.array(probabilities), errors(gain, delay) <= THRESHOLD, edges_kept, areas


def show_bands(name, probability, good, events):
    """Print what is stated and what is good, for each band of what is stated.

    Beside the share that is good stands its standard deviation by earthquakes drawn with replacement.
    """
    finite = np.isfinite(probability)
    probability, good, events = probability[finite], good[finite], events[finite]
    band = np.clip(np.digitize(probability, BANDS) - 1, 0, len(BANDS) - 2)
    for place in range(len(BANDS) - 1):
        if (members := band == place).any():
            doubt = earthquake_deviation(good[members], events[members])
            print(
                f"  {name:10s} {BANDS[place]:.2f} to {BANDS[place + 1]:.2f}: stated "
                f"{probability[members].mean():.2f}, good {good[members].mean():.2f} ± {doubt:.2f} "
                f"of {members.sum()}"
            )
    if finite.any():
        print(f"  {name:10s} Brier score {np.mean((probability - good) ** 2):.3f}", flush=True)


def earthquake_deviation(good, events):
    """Standard deviation of a share when whole earthquakes are drawn with replacement."""
    _, group = np.unique(events, return_inverse=True)
    sums = np.array([np.bincount(group, weights=values) for values in (good, np.ones(good.size))])
    rows = np.random.default_rng(1).integers(0, sums.shape[1], (500, sums.shape[1]))
    shares = sums[0][rows].sum(axis=1) / sums[1][rows].sum(axis=1)
    return shares.std()


def main():
    parser = argument_parser(__doc__, "records", population=False, seed=34, rigs=24)
    parser.add_argument("seconds", type=float, nargs="*")
    parser.add_argument("--groups", action="store_true", help="also by the length of whole records")
    options = parser.parse_args()
    suite = load_motions(options.records, sets=["far_field", "near_field"])
    for seconds in [None, *options.seconds]:
        rng = np.random.default_rng(options.seed)
        results = [
            judge_rigs(motion, seconds, f, xi, rng, population=options.population, rigs=options.rigs)
            for motion in suite
            for f, xi in STRUCTURES
        ]
        probabilities = np.concatenate([part[0] for part in results], axis=1)
        good = np.concatenate([part[1] for part in results])
        events = np.repeat([motion.event for motion in suite], len(STRUCTURES) * options.rigs)
        if options.groups:
            lengths = np.repeat([motion.duration for motion in suite], len(STRUCTURES) * options.rigs)
            for low, high in pairwise(LENGTHS):
                members = (lengths > low) & (lengths <= high)
                show_bands(
                    f"{low:g} to {high:g} s", probabilities[0][members], good[members], events[members]
                )
        edges_kept, areas = (np.array([part[place] for part in results]) for place in (2, 3))
        print(f"{'whole records' if seconds is None else f'first {seconds:g} s'}: {good.size} tests")
        for name, probability in zip(("population", "response", "unstated"), probabilities, strict=True):
            show_bands(name, probability, good, events)
        print(
            f"  95 % kept by {', '.join(f'{share:.1%}' for share in edges_kept.mean(axis=0))}; "
            f"area of the second over the first {np.median(areas[:, 1] / areas[:, 0]):.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
