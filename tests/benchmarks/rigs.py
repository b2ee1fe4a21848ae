"""Simulated rigs, not of the form of the model: what intervals cover, and who predicts best.

    python tests/benchmarks/rigs.py [first seed] [rigs of each kind] [earthquakes of each rig really left out]

Rigs are simulated at the level of their tests' indices: a gain that falls with the displacement, a delay that
warms up within a day, two specimens, a wandering or drifting delay, a tenth of odd tests, skewed scatter; the
error of each test follows from an ellipse of its earthquake and its own. Each earthquake is left out, and its
tests are predicted under their covariates (date, specimen), with variances and changes learned from all
tests; on some earthquakes the same is done with a rig that never had them. Tests are predicted once under an
unknown motion and once under a known one, whose ellipse and peak are given; the baselines know neither. Where
nothing but scatter happens, a predictor that knows the law of the rig says how much there is to gain.
Probabilities are stated for a threshold that is drawn without a look at the rig, from 3 to 15 %: one between
quantiles of the rig's own errors moves against the test that is left out, and makes every predictor seem too
sure.
"""

import sys

import numpy as np
import scipy
from rig_rows import rig_table, rig_test

from reliab.rig.learning.learned import last_ten, pool, score_left_out_events
from reliab.rig.memory import Memory, NextTest
from reliab.rig.prediction import DRAWS, PredictedDraws, learn_tests, predict_next
from reliab.structures.structure import Structure

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.02)
KINDS = ("quiet", "amplitude", "warm-up", "specimens", "drift", "odd tests", "skewed")
SCATTER_ONLY = ("quiet", "amplitude", "skewed")
EARTHQUAKES, PER_EARTHQUAKE = 24, 3
OTHER_RIGS = 60


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


def left_out(table, threshold):
    """What the model says of each test without its earthquake, with the variances learned from all.

    Shares of tests within intervals and the like, by quantity; `really_left_out` checks them on a few.
    """
    memory = Memory.from_table(table)
    found = {}
    for name, values in quantities(memory).items():
        learned = memory.learn(values, NextTest())
        residuals = learned.left_out.residuals
        limits = (np.log(threshold) - values) / (learned.spread * learned.left_out.spreads) + residuals
        rows = {"inside": np.zeros(values.size), "good": values <= np.log(threshold)}
        rows |= {"score": learned.score_left_out_events, "stated": np.zeros(values.size)}
        for members, scatter in learned.scatters_without_earthquakes():
            low, high = scatter.quantile(0.05), scatter.quantile(0.95)
            rows["inside"][members] = (residuals[members] >= low) & (residuals[members] <= high)
            if name == "rms":
                rows["stated"][members] = scatter.cumulative(limits[members])
        rows["all tests pooled"] = score_left_out_events(values, learned.events, pool, only_earlier=False)
        rows["the last ten"] = score_left_out_events(values, learned.events, last_ten, only_earlier=True)
        found[name] = rows
    return found


def left_out_of_known_motion(table):
    """The same where the motion of the test is known: log scores, and whether the error's interval holds it.

    Tests are drawn as `reliab rig predict --motion` draws them, with the ellipse of the test's own motion.
    """
    memory = Memory.from_table(table)
    learned = learn_tests(memory, NextTest(peak=1.0))
    of_a, of_b = table.numbers("own_a"), table.numbers("own_b_ms2")
    centres = {
        name: each.values - each.spread * each.left_out.spreads * each.left_out.residuals
        for name, each in learned.items()
    }
    count = len(table)
    scores, inside = np.zeros(count), np.zeros(count, dtype=bool)
    rng = np.random.default_rng(0)
    for event in np.unique(memory.events):
        member = memory.events == event
        others = np.flatnonzero(~member)
        for name in ("A", "d_ms"):
            scores[member] += learned[name].score_left_out_events[member]
        for place in np.flatnonzero(member):
            rows = rng.choice(others, size=DRAWS)
            longer = np.sqrt((others.size - 1.0) / rng.chisquare(others.size - 1.0, DRAWS))
            drawn = {
                name: centres[name][place]
                + each.spread * each.left_out.spreads[place] * longer * each.left_out.residuals[rows]
                for name, each in learned.items()
            }
            draws = PredictedDraws(
                amplitude=drawn["A"],
                delay_ms=drawn["d_ms"],
                remainder=np.exp(drawn["remainder"]),
                ratio=np.exp(drawn["ratio"]),
            )
            errors = np.log(draws.errors(of_a[place], of_b[place]))
            low, high = np.quantile(errors, (0.05, 0.95))
            inside[place] = low <= memory.log_error[place] <= high
            scores[place] += scipy.stats.gaussian_kde(errors).logpdf(memory.log_error[place])[0]
    return scores, inside


def known_law(kind):
    """Logarithm of the density of each quantity over other rigs of a kind."""
    rigs = [Memory.from_table(simulated_rig(kind, 1_000_000 + seed)) for seed in range(OTHER_RIGS)]
    every = [quantities(memory) for memory in rigs]
    return {
        name: scipy.stats.gaussian_kde(np.concatenate([values[name] for values in every])).logpdf
        for name in every[0]
    }


def quantities(memory):
    """Values of each quantity that is judged."""
    return {"A": memory.amplitude, "d_ms": memory.delay, "rms": memory.log_error}


def really_left_out(table, events):
    """Whether intervals hold the tests of some earthquakes, each time predicted by `predict_next`."""
    held = {name: [] for name in ("A", "d_ms", "rms")}
    for event in events:
        names = table.texts("event")
        rest = table.only([place for place, name in enumerate(names) if name != event])
        for row in (row for row in table.rows if row["event"] == event):
            coming = NextTest(date=str(row["date"]), specimen=str(row["specimen"]))
            prediction = predict_next(rest, STRUCTURE, coming, threshold=0.06)
            for name, shares in held.items():
                interval = prediction.intervals[name]
                shares.append(interval["low"] <= row[name] <= interval["high"])
    return held


def main(first=100, rigs=20, checked=0):
    """Print coverage, log scores and the calibration of the probability; `checked` earthquakes a rig."""
    stated, good = [], []
    for kind in KINDS:
        shares, scores, agreed = {name: [] for name in ("A", "d_ms", "rms")}, [], []
        held, law = [], known_law(kind) if kind in SCATTER_ONLY else None
        for seed in range(first, first + rigs):
            table = simulated_rig(kind, seed)
            rng = np.random.default_rng([seed, KINDS.index(kind)])
            found = left_out(table, float(np.exp(rng.uniform(np.log(0.03), np.log(0.15)))))
            for name, of_rig in shares.items():
                of_rig.append(found[name]["inside"].mean())
            stated += found["rms"]["stated"].tolist()
            good += found["rms"]["good"].tolist()
            sums = {
                name: sum(rows[name] for rows in found.values())
                for name in ("score", "all tests pooled", "the last ten")
            }
            sums["known motion"], inside = left_out_of_known_motion(table)
            held.append(inside.mean())
            if law is not None:
                values = quantities(Memory.from_table(table))
                sums["known law"] = sum(law[name](values[name]) for name in law)
            known = np.isfinite(sums["the last ten"])
            scores.append({name: sums[name][known].mean() for name in sums})
            if checked:
                events = rng.choice(np.unique(table.texts("event")), size=checked, replace=False)
                places = np.concatenate([np.flatnonzero(np.array(table.texts("event")) == e) for e in events])
                for name, hits in really_left_out(table, events).items():
                    agreed += (np.array(hits) == found[name]["inside"][places]).tolist()
        shares["rms of a known motion"] = held
        print(f"{kind}: covered {means_of(shares)}; {compared(scores)}", flush=True)
        if checked:
            print(f"    the same with the earthquake really left out: {np.mean(agreed):.3f} of {len(agreed)}")
    state_calibration(np.array(stated), np.array(good))


def means_of(shares):
    """Mean of each share over the rigs, with its standard error."""
    return ", ".join(
        f"{name} {np.mean(of_rig):.3f} ± {np.std(of_rig) / np.sqrt(len(of_rig)):.3f}"
        for name, of_rig in shares.items()
    )


def compared(scores):
    """Mean log scores, and in how many rigs each predictor is above both baselines."""
    baselines = ("all tests pooled", "the last ten")
    texts = [f"{name} {np.mean([each[name] for each in scores]):.2f}" for name in baselines]
    for name in scores[0].keys() - {*baselines}:
        above = [each[name] - max(each[baseline] for baseline in baselines) for each in scores]
        texts.append(
            f"{name} {np.mean([each[name] for each in scores]):.2f} "
            f"(best in {np.sum(np.array(above) > 0.0)} of {len(above)}, at worst {min(above):+.2f})"
        )
    return "log scores: " + ", ".join(texts)


def state_calibration(stated, good):
    """Print the reliability diagram."""
    print(f"{stated.size} probabilities; Brier score {np.mean((stated - good) ** 2):.4f}")
    for low in np.arange(0.0, 1.0, 0.1):
        within = (stated >= low) & (stated < low + 0.1)
        if within.any():
            share = f"stated {stated[within].mean():.3f}, good {good[within].mean():.3f}"
            print(f"probability from {low:.1f}: {share}, of {within.sum()}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
