"""Share of cut records and simulated ground motions under which criteria hold, inside and outside of scope.

    python tests/benchmarks/criterion_beyond.py RECORDS [--cut 10 15 20 30] [--simulated 20] [--seed 3435]
        [--population NAME...] [--side lag|lead]

With `--cut` one component of each of the records is cut to its first seconds and judged by what was learned
without its earthquake; with `--simulated` that many components of each population of
`simulated_populations.py`, and of two drawn without a model of earthquakes (a soil of one frequency; bare
pulses), are judged by all hundred. The error of the loop is computed along the whole edge, at the stated 50,
80, 90, 95 and 99 %, of criteria as recorded, protected over lengths (the default from 90 % on), by length and
by response. Rows tell apart structures whose response lies inside of the criterion's scope, or at its edge,
and those outside; the last column is the largest error over the threshold on the edge that states 95 % by
response.
"""

from functools import cache, partial

import numpy as np
import scipy
from benchmark_script import argument_parser
from criterion_scope import (
    CONFIDENCES,
    STRUCTURES,
    THRESHOLD,
    errors_on_edges,
    limits_of,
    read_inscribed,
)
from simulated_populations import POPULATIONS, SEED, simulate_earthquake

from reliab.core.vocabulary import Side
from reliab.criterion.carrying import carry_to_length, carry_to_response, protect_over_lengths
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.response_measures import ResponseMeasures, read_shipped_measures
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.first_order import first_order_ellipse
from reliab.tracking.indices.window import Window
from reliab.validation.truth import SimulatedTruth

GREATEST = 0.9  # amplitude error at which an edge is cut
LONGEST = 0.2  # the same of a lead, as a share of the period
STEP = 0.01  # s


@cache
def learn_criteria(left_out_event, side):
    """Ellipses without an earthquake, and limits as recorded and protected (confidence, structure, 2)."""
    ellipses = read_inscribed((THRESHOLD,))
    others_ellipses = ellipses.take(motion=ellipses.events != left_out_event)
    return (
        others_ellipses,
        limits_of(others_ellipses, side),
        limits_of(protect_over_lengths(others_ellipses), side),
    )


@cache
def limits_of_length(left_out_event, seconds, side):
    """The same carried to a length [s]."""
    return limits_of(carry_to_length(learn_criteria(left_out_event, side)[0], seconds), side)


def limits_of_response(ellipses, excitation, f, xi, side):
    """Limits at each confidence (confidence, 2) by the response of a structure, and where that lies."""
    structure = Structure(frequency=f, damping_ratio=xi)
    measures = ResponseMeasures.from_response(
        first_order_ellipse(excitation, structure), structure, "this motion"
    )
    carried = carry_to_response(ellipses, read_shipped_measures(), measures)
    criteria = [derive_criterion(carried, threshold=THRESHOLD, confidence=share) for share in CONFIDENCES]
    return np.array([criterion.limits(f, xi, side) for criterion in criteria]), carried.attrs["position"]


def judge_motion(motion, window, left_out_event, side):
    """Whether outside, kept (criteria, confidences) and excess, for each structure."""
    ellipses, plain, protection = learn_criteria(left_out_event, side)
    excitation = excitation_of(motion, window)
    limits_for_length = limits_of_length(
        left_out_event, float(max(1, round(excitation.window_duration))), side
    )
    truth, rows = SimulatedTruth(motions=[motion], window=window), []
    for place, (f, xi) in enumerate(STRUCTURES):
        response, position = limits_of_response(ellipses, excitation, f, xi, side)
        limits = np.array([plain[:, place], protection[:, place], limits_for_length[:, place], response])
        longest = np.inf if side == Side.LAG else (1000.0 * LONGEST / f) ** 2
        regions = np.minimum(limits.reshape(-1, 2), [GREATEST, longest])
        errors = errors_on_edges(truth, 0, f, xi, regions, side=side).reshape(4, -1)
        rows.append((position == "outside", errors <= 1.0, errors[3, CONFIDENCES.index(0.95)]))
    return rows


def show(name, rows):
    """Print one line for what is in scope, and one for what is not."""
    is_outside = np.array([row[0] for row in rows])
    for words, mask in (("in scope", ~is_outside), ("outside", is_outside)):
        if not mask.any():
            continue
        shares_kept, excess = (np.array([row[place] for row in rows])[mask] for place in (1, 2))
        shares = "  ".join(" ".join(f"{100 * part:3.0f}" for part in row) for row in shares_kept.mean(axis=0))
        print(f"{name:26s} {words:9s} {mask.sum():4d}  {shares}  {excess.max():.2f}", flush=True)


def one_frequency(number, seed=SEED):
    """Noise through a lightly damped soil of one frequency."""
    rng = np.random.default_rng([seed, 7, number])
    t = np.arange(0.0, rng.uniform(40.0, 100.0), STEP)
    w, xi, rise = 2.0 * np.pi * rng.uniform(0.3, 1.2), rng.uniform(0.02, 0.08), 0.25 * t[-1]
    soil = scipy.signal.bilinear([2.0 * xi * w, w**2], [1.0, 2.0 * xi * w, w**2], 1.0 / STEP)
    envelope = np.where(t < rise, (t / rise) ** 2, np.exp((rise - t) / (0.2 * t[-1])))
    high_pass = scipy.signal.butter(2, 0.2 * STEP, "high")
    history = scipy.signal.lfilter(
        *high_pass, scipy.signal.lfilter(*soil, rng.normal(size=t.size) * envelope)
    )
    return make_motion("a soil of one frequency", number, history)


def bare_pulse(number, seed=SEED):
    """A velocity pulse of Mavroeidis and Papageorgiou (2003) with little noise."""
    rng = np.random.default_rng([seed, 8, number])
    t = np.arange(0.0, rng.uniform(20.0, 60.0), STEP)
    period, cycles = np.exp(rng.uniform(np.log(0.8), np.log(7.0))), rng.uniform(1.0, 2.5)
    phase, begin = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.2, 0.4) * t[-1] + period
    x = 2.0 * np.pi * (t - begin) / period
    velocity = np.where(np.abs(x) <= np.pi * cycles, (1.0 + np.cos(x / cycles)) * np.cos(x + phase), 0.0)
    pulse = np.gradient(velocity, STEP)
    band = scipy.signal.butter(2, np.array([0.6, 16.0]) * STEP, "band")
    noise = scipy.signal.lfilter(
        *band, rng.normal(size=t.size) * np.exp(-(((t - begin) / (0.12 * t[-1])) ** 2))
    )
    share = rng.uniform(0.0, 0.15)
    return make_motion(
        "bare pulses", number, pulse / np.abs(pulse).max() + share * noise / np.abs(noise).max()
    )


def make_motion(name, number, history):
    """A motion with a peak of 3 m/s²."""
    acceleration = 3.0 * history / np.abs(history).max()
    return Motion(
        name=f"{name}/{number}",
        acceleration=acceleration,
        time_step=STEP,
        event=f"{name} {number}",
        set_name="drawn",
    )


DRAWS = (one_frequency, bare_pulse)


def main():
    parser = argument_parser(__doc__, "records", simulated=0, seed=SEED)
    parser.add_argument("--cut", type=float, nargs="*", default=())
    parser.add_argument("--side", choices=list(Side), default="lag")
    parser.add_argument("--population", nargs="*", help="beginnings of names, all by default", default=("",))
    options = parser.parse_args()
    heads = "as recorded          protected            by length            by response          excess"
    print(f"{'':26s} structures      {heads}")
    suite = load_motions(options.records, sets=["far_field", "near_field"])
    for seconds in options.cut:
        window = Window.parse(f"{seconds:g}")
        show(
            f"first {seconds:g} s",
            [
                row
                for motion in suite[::2]
                for row in judge_motion(motion, window, motion.event, options.side)
            ],
        )
    pairs, numbers = range(1, options.simulated // 2 + 1), range(options.simulated)
    populations = {
        **{name: partial(_simulate_population, name, pairs) for name in POPULATIONS},
        **{draw.__name__.replace("_", " "): partial(_draw_population, draw, numbers) for draw in DRAWS},
    }
    for name, motions in populations.items():
        if options.simulated and any(name.startswith(start) for start in options.population):
            show(
                name,
                [
                    row
                    for motion in motions(options.seed)
                    for row in judge_motion(motion, Window(), "", options.side)
                ],
            )


def _simulate_population(name, pairs, seed):
    return [motion for pair in pairs for motion in simulate_earthquake(name, pair, seed)]


def _draw_population(draw, numbers, seed):
    return [draw(number, seed) for number in numbers]


if __name__ == "__main__":
    main()
