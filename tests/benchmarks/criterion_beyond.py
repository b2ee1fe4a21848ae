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

import argparse
from functools import cache, partial
from itertools import product

import numpy as np
import scipy
from criterion_scope import CONFIDENCES, THRESHOLD, XI, F, limits_of
from simulated_populations import POPULATIONS, SEED, simulated

from reliab.core.vocabulary import Side
from reliab.criterion.carrying import carry_to_length, carry_to_response, protect_over_lengths
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.response_measures import ResponseMeasures
from reliab.criterion.shipped_tables import read_shipped_ellipses, read_shipped_measures
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.first_order import first_order_ellipse
from reliab.tracking.indices.window import Window
from reliab.validation.cross_validation.truth import Cell, Region, SimulatedTruth

STRUCTURES = list(product(F, XI))
GREATEST = 0.9  # amplitude error at which an edge is cut
LONGEST = 0.2  # the same of a lead, as a share of the period
STEP = 0.01  # s


def shipped():
    """Inscribed ellipses at the threshold, of the structures."""
    table = read_shipped_ellipses("inscribed", "record", "rms")
    near = {"f": F, "xi": XI, "threshold": (THRESHOLD,)}
    places = {
        name: [int(np.abs(table.coordinates[name] - value).argmin()) for value in wanted]
        for name, wanted in near.items()
    }
    return table.take(**places)


@cache
def learned(without, side):
    """Ellipses without an earthquake, and limits as recorded and protected (confidence, structure, 2)."""
    ellipses = shipped()
    others = ellipses.take(motion=ellipses.events != without)
    return others, limits_of(others, side), limits_of(protect_over_lengths(others), side)


@cache
def limits_of_length(without, seconds, side):
    """The same carried to a length [s]."""
    return limits_of(carry_to_length(learned(without, side)[0], seconds), side)


def by_response(ellipses, excitation, f, xi, side):
    """Limits at each confidence (confidence, 2) by the response of a structure, and where that lies."""
    structure = Structure(frequency=f, damping_ratio=xi)
    own = ResponseMeasures.from_response(first_order_ellipse(excitation, structure), structure, "this motion")
    carried = carry_to_response(ellipses, read_shipped_measures(), own)
    criteria = [derive_criterion(carried, threshold=THRESHOLD, confidence=share) for share in CONFIDENCES]
    return np.array([criterion.limits(f, xi, side) for criterion in criteria]), carried.attrs["position"]


def judged(motion, window, without, side):
    """Whether outside, kept (criteria, confidences) and excess, for each structure."""
    ellipses, recorded, protected = learned(without, side)
    excitation = excitation_of(motion, window)
    of_length = limits_of_length(without, float(max(1, round(excitation.window_duration))), side)
    truth, found = SimulatedTruth(motions=[motion], window=window), []
    for place, (f, xi) in enumerate(STRUCTURES):
        response, position = by_response(ellipses, excitation, f, xi, side)
        limits = np.array([recorded[:, place], protected[:, place], of_length[:, place], response])
        longest = np.inf if side == Side.LAG else (1000.0 * LONGEST / f) ** 2
        pairs = np.minimum(limits.reshape(-1, 2), [GREATEST, longest]).tolist()
        edges = [Region(a=a, b=b, side=Side(side)).edge() for a, b in pairs]
        gain, delay = (np.concatenate([getattr(edge, name) for edge in edges]) for name in ("gain", "delay"))
        cell = Cell(frequency=f, damping_ratio=xi, threshold=THRESHOLD, metric="rms")
        errors = truth.errors(cell, 0, gain, delay).reshape(4, len(CONFIDENCES), -1).max(axis=-1)
        found.append((position == "outside", errors <= 1.0, errors[3, CONFIDENCES.index(0.95)]))
    return found


def show(name, rows):
    """Print one line for what is in scope, and one for what is not."""
    outside = np.array([row[0] for row in rows])
    for words, chosen in (("in scope", ~outside), ("outside", outside)):
        if not chosen.any():
            continue
        kept, excess = (np.array([row[place] for row in rows])[chosen] for place in (1, 2))
        shares = "  ".join(" ".join(f"{100 * part:3.0f}" for part in row) for row in kept.mean(axis=0))
        print(f"{name:26s} {words:9s} {chosen.sum():4d}  {shares}  {excess.max():.2f}", flush=True)


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
    return drawn("a soil of one frequency", number, history)


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
    return drawn("bare pulses", number, pulse / np.abs(pulse).max() + share * noise / np.abs(noise).max())


def drawn(name, number, history):
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
    """Print two lines for each length and population."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records")
    parser.add_argument("--cut", type=float, nargs="*", default=())
    parser.add_argument("--simulated", type=int, default=0)
    parser.add_argument("--seed", type=int, default=SEED)
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
            [row for motion in suite[::2] for row in judged(motion, window, motion.event, options.side)],
        )
    pairs, numbers = range(1, options.simulated // 2 + 1), range(options.simulated)
    populations = {
        **{name: partial(_of_earthquakes, name, pairs) for name in POPULATIONS},
        **{draw.__name__.replace("_", " "): partial(_of_draws, draw, numbers) for draw in DRAWS},
    }
    for name, motions in populations.items():
        if options.simulated and any(name.startswith(start) for start in options.population):
            show(
                name,
                [
                    row
                    for motion in motions(options.seed)
                    for row in judged(motion, Window(), "", options.side)
                ],
            )


def _of_earthquakes(name, pairs, seed):
    return [motion for pair in pairs for motion in simulated(name, pair, seed)]


def _of_draws(draw, numbers, seed):
    return [draw(number, seed) for number in numbers]


if __name__ == "__main__":
    main()
