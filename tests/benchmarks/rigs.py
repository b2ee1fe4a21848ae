"""Simulated rigs, not of the form of the model: what intervals cover, and who predicts best.

    python tests/benchmarks/rigs.py [first seed] [rigs of each kind]

Rigs are simulated at the level of their tests' indices: a gain that falls with the displacement, a delay that
warms up within a day, two specimens, a wandering or drifting delay, a tenth of odd tests, skewed scatter; the
error of each test follows from an ellipse of its earthquake and its own. For each earthquake the rig is
learned without it, and its tests are predicted under their circumstances (date, specimen).
"""

import sys
from collections.abc import Mapping

import numpy as np
from rig_rows import rig_table, rig_test

from reliab.rig import NextTest, predict_next
from reliab.structures import Structure

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.02)
KINDS = ("quiet", "amplitude", "warm-up", "specimens", "drift", "odd tests", "skewed")
EARTHQUAKES, PER_EARTHQUAKE = 24, 3


def simulated_rig(kind, seed):
    """Tests of a rig of a kind."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    of_event = {name: rng.normal(size=3) for name in range(EARTHQUAKES)}
    order = rng.permutation(np.repeat(np.arange(EARTHQUAKES), PER_EARTHQUAKE))
    tests = []
    for number, event in enumerate(order.tolist()):
        day, place = divmod(number, 6)
        common, peak = of_event[event], 50.0 * np.exp(0.6 * rng.normal())
        amplitude = 0.99 + 0.002 * common[0] + 0.003 * rng.normal()
        delay = 2.0 + 0.2 * common[1] + 0.4 * rng.normal()
        if kind == "amplitude":
            amplitude -= 0.01 * np.tanh(peak / 60.0)
        if kind == "warm-up":
            delay += 1.5 / (1.0 + place)
        if kind == "specimens":
            delay += 1.2 * (number // 12 % 2)
        if kind == "drift":
            delay += 0.02 * number
        if kind == "odd tests" and rng.random() < 0.1:
            delay, amplitude = delay + 4.0 * rng.standard_t(2), amplitude + 0.02 * rng.standard_t(2)
        if kind == "skewed":
            delay += 0.5 * (rng.gamma(1.5) - 1.5)
        remainder = 0.01 * np.exp(0.3 * rng.normal())
        of_a, of_b = 0.06 * np.exp(0.5 * common[2]), 1400.0 * np.exp(0.5 * common[2])
        error = np.sqrt(((amplitude - 1.0) ** 2 + 0.2 * remainder**2) / of_a + delay**2 / of_b)
        tests.append(
            rig_test(
                number,
                event=f"EQ{event}",
                date=f"2026-{1 + day // 28:02d}-{1 + day % 28:02d}T{9 + place:02d}:00:00",
                specimen=("first", "second")[number // 12 % 2] if kind == "specimens" else "",
                A=amplitude,
                d_ms=delay,
                remainder=remainder,
                rms=float(error * np.exp(0.1 * rng.normal())),
                peak_mm=peak,
                own_a=of_a,
                own_b_ms2=of_b,
            )
        )
    return rig_table(tests)


def judged(table, event) -> list[Mapping[str, float]]:
    """Predict the tests of an earthquake without it."""
    outside = [place for place, row in enumerate(table.rows) if row["event"] != event]
    rows = []
    for row in (row for row in table.rows if row["event"] == event):
        coming = NextTest(date=str(row["date"]), specimen=str(row["specimen"]))
        prediction = predict_next(table.only(outside), STRUCTURE, coming, threshold=0.06)
        inside = {
            name: interval["low"] <= row[name] <= interval["high"]
            for name, interval in prediction.intervals.items()
        }
        scores = {name: score or -np.inf for name, score in prediction.log_scores.items()}
        rows.append({**inside, "probability": prediction.probability, "good": row["rms"] <= 0.06, **scores})
    return rows


def main(first=100, rigs=3, earthquakes=6):
    """Print coverage, log scores and the calibration of the probability."""
    every = []
    for kind in KINDS:
        rows = []
        for seed in range(first, first + rigs):
            table = simulated_rig(kind, seed)
            events = np.unique(table.texts("event"))
            for event in np.random.default_rng(seed).choice(events, size=earthquakes, replace=False):
                rows += judged(table, event)
        every += rows
        shares = [f"{name} {np.mean([row[name] for row in rows]):.3f}" for name in ("A", "d_ms", "rms")]
        scores = [
            f"{name} {np.mean([row[name] for row in rows]):.2f}"
            for name in ("hierarchical model", "all tests pooled", "the last ten")
        ]
        print(f"{kind:10} {len(rows)} tests: covered {', '.join(shares)}", flush=True)
        print(f"{'':10} log score {', '.join(scores)}", flush=True)
    stated, good = (np.array([row[name] for row in every], dtype=float) for name in ("probability", "good"))
    for low, high in ((0.0, 0.2), (0.2, 0.4), (0.4, 0.6), (0.6, 0.8), (0.8, 1.0)):
        within = (stated >= low) & (stated <= high)
        if within.any():
            share = f"stated {stated[within].mean():.2f}, good {good[within].mean():.2f}"
            print(f"probability {low} to {high}: {share}, of {within.sum()}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
