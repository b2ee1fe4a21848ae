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
import paths  # noqa: F401 - makes rows of rigs importable
import scipy
from rig_rows import rig_table, rig_test

from reliab.rig.learned import last_ten, pool, score_left_out_events
from reliab.rig.memory import Memory, NextTest
from reliab.rig.prediction import DRAWS, PredictedDraws, learn_tests, predict_next
from reliab.structures.structure import Structure

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.02)
KINDS = ("quiet", "amplitude", "warm-up", "specimens", "drift", "odd tests", "skewed")
SCATTER_ONLY = ("quiet", "amplitude", "skewed")
EARTHQUAKES, TESTS_OF_EARTHQUAKE = 24, 3
OTHER_RIGS = 60


def simulate_rig(kind, seed):
    """Tests of a rig of a kind."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    event_effects = {name: rng.normal(size=3) for name in range(EARTHQUAKES)}
    order = rng.permutation(np.repeat(np.arange(EARTHQUAKES), TESTS_OF_EARTHQUAKE))
    tests = []
    for number, event in enumerate(order.tolist()):
        day, place = divmod(number, 6)
        common, peak = event_effects[event], 50.0 * np.exp(0.6 * rng.normal())
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
        own_a, own_b = 0.06 * np.exp(0.5 * common[2]), 1400.0 * np.exp(0.5 * common[2])
        error = np.sqrt(((amplitude - 1.0) ** 2 + 0.2 * remainder**2) / own_a + delay**2 / own_b)
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
                own_a=own_a,
                own_b_ms2=own_b,
            )
        )
    return rig_table(tests)


def evaluate_left_out(table, threshold):
    """What the model says of each test without its earthquake, with the variances learned from all.

    Shares of tests within intervals and the like, by quantity; `really_left_out` checks them on a few.
    """
    memory = Memory.from_table(table)
    evaluations = {}
    for name, values in quantities(memory).items():
        learned_quantity = memory.learn(values, NextTest())
        residuals = learned_quantity.left_out.residuals
        limits = (np.log(threshold) - values) / (
            learned_quantity.spread * learned_quantity.left_out.spreads
        ) + residuals
        rows = {"inside": np.zeros(values.size), "good": values <= np.log(threshold)}
        rows |= {"score": learned_quantity.score_left_out_events, "stated": np.zeros(values.size)}
        for members, scatter in learned_quantity.scatters_without_earthquakes():
            low, high = scatter.quantile(0.05), scatter.quantile(0.95)
            rows["inside"][members] = (residuals[members] >= low) & (residuals[members] <= high)
            if name == "rms":
                rows["stated"][members] = scatter.cumulative(limits[members])
        rows["all tests pooled"] = score_left_out_events(
            values, learned_quantity.events, pool, only_earlier=False
        )
        rows["the last ten"] = score_left_out_events(
            values, learned_quantity.events, last_ten, only_earlier=True
        )
        evaluations[name] = rows
    return evaluations


def evaluate_known_motion(table):
    """The same where the motion of the test is known: log scores, and whether the error's interval holds it.

    Tests are drawn as `reliab rig predict --motion` draws them, with the ellipse of the test's own motion.
    """
    memory = Memory.from_table(table)
    quantities_learned = learn_tests(memory, NextTest(peak=1.0))
    own_a, own_b = table.numbers("own_a"), table.numbers("own_b_ms2")
    centres = {
        name: quantity.values - quantity.spread * quantity.left_out.spreads * quantity.left_out.residuals
        for name, quantity in quantities_learned.items()
    }
    count = len(table)
    scores, is_inside = np.zeros(count), np.zeros(count, dtype=bool)
    rng = np.random.default_rng(0)
    for event in np.unique(memory.events):
        member = memory.events == event
        other_tests = np.flatnonzero(~member)
        for name in ("A", "d_ms"):
            scores[member] += quantities_learned[name].score_left_out_events[member]
        for place in np.flatnonzero(member):
            rows = rng.choice(other_tests, size=DRAWS)
            longer = np.sqrt((other_tests.size - 1.0) / rng.chisquare(other_tests.size - 1.0, DRAWS))
            samples = {
                name: centres[name][place]
                + quantity.spread
                * quantity.left_out.spreads[place]
                * longer
                * quantity.left_out.residuals[rows]
                for name, quantity in quantities_learned.items()
            }
            draws = PredictedDraws(
                amplitude=samples["A"],
                delay_ms=samples["d_ms"],
                remainder=np.exp(samples["remainder"]),
                ratio=np.exp(samples["ratio"]),
            )
            errors = np.log(draws.errors(own_a[place], own_b[place]))
            low, high = np.quantile(errors, (0.05, 0.95))
            is_inside[place] = low <= memory.log_error[place] <= high
            scores[place] += scipy.stats.gaussian_kde(errors).logpdf(memory.log_error[place])[0]
    return scores, is_inside


def estimate_law(kind):
    """Logarithm of the density of each quantity over other rigs of a kind."""
    rigs = [Memory.from_table(simulate_rig(kind, 1_000_000 + seed)) for seed in range(OTHER_RIGS)]
    values_of_rigs = [quantities(memory) for memory in rigs]
    return {
        name: scipy.stats.gaussian_kde(np.concatenate([values[name] for values in values_of_rigs])).logpdf
        for name in values_of_rigs[0]
    }


def quantities(memory):
    """Values of each quantity that is judged."""
    return {"A": memory.amplitude, "d_ms": memory.delay, "rms": memory.log_error}


def predict_left_out(table, events):
    """Whether intervals hold the tests of some earthquakes, each time predicted by `predict_next`."""
    covers = {name: [] for name in ("A", "d_ms", "rms")}
    for event in events:
        names = table.texts("event")
        other_tests = table.only([place for place, name in enumerate(names) if name != event])
        for row in (row for row in table.rows if row["event"] == event):
            coming = NextTest(date=str(row["date"]), specimen=str(row["specimen"]))
            prediction = predict_next(other_tests, STRUCTURE, coming, threshold=0.06)
            for name, shares in covers.items():
                interval = prediction.intervals[name]
                shares.append(interval["low"] <= row[name] <= interval["high"])
    return covers


def main(first=100, rigs=20, events_to_check=0):
    probabilities, good = [], []
    for kind in KINDS:
        shares, scores, equal = {name: [] for name in ("A", "d_ms", "rms")}, [], []
        known_motion_shares, law = [], estimate_law(kind) if kind in SCATTER_ONLY else None
        for seed in range(first, first + rigs):
            table = simulate_rig(kind, seed)
            rng = np.random.default_rng([seed, KINDS.index(kind)])
            evaluation = evaluate_left_out(table, float(np.exp(rng.uniform(np.log(0.03), np.log(0.15)))))
            for name, shares_of_rigs in shares.items():
                shares_of_rigs.append(evaluation[name]["inside"].mean())
            probabilities += evaluation["rms"]["stated"].tolist()
            good += evaluation["rms"]["good"].tolist()
            sums = {
                name: sum(rows[name] for rows in evaluation.values())
                for name in ("score", "all tests pooled", "the last ten")
            }
            sums["known motion"], is_inside = evaluate_known_motion(table)
            known_motion_shares.append(is_inside.mean())
            if law is not None:
                values = quantities(Memory.from_table(table))
                sums["known law"] = sum(law[name](values[name]) for name in law)
            finite = np.isfinite(sums["the last ten"])
            scores.append({name: sums[name][finite].mean() for name in sums})
            if events_to_check:
                events = rng.choice(np.unique(table.texts("event")), size=events_to_check, replace=False)
                places = np.concatenate([np.flatnonzero(np.array(table.texts("event")) == e) for e in events])
                for name, hits in predict_left_out(table, events).items():
                    equal += (np.array(hits) == evaluation[name]["inside"][places]).tolist()
        shares["rms of a known motion"] = known_motion_shares
        print(f"{kind}: covered {means_of(shares)}; {describe_scores(scores)}", flush=True)
        if events_to_check:
            print(f"    the same with the earthquake really left out: {np.mean(equal):.3f} of {len(equal)}")
    state_calibration(np.array(probabilities), np.array(good))


def means_of(shares):
    """Mean of each share over the rigs, with its standard error."""
    return ", ".join(
        f"{name} {np.mean(shares_of_rigs):.3f} ± {np.std(shares_of_rigs) / np.sqrt(len(shares_of_rigs)):.3f}"
        for name, shares_of_rigs in shares.items()
    )


def describe_scores(scores):
    """Mean log scores, and in how many rigs each predictor is above both baselines."""
    baselines = ("all tests pooled", "the last ten")
    texts = [f"{name} {np.mean([scores_of_rig[name] for scores_of_rig in scores]):.2f}" for name in baselines]
    for name in scores[0].keys() - {*baselines}:
        gains = [
            scores_of_rig[name] - max(scores_of_rig[baseline] for baseline in baselines)
            for scores_of_rig in scores
        ]
        texts.append(
            f"{name} {np.mean([scores_of_rig[name] for scores_of_rig in scores]):.2f} "
            f"(best in {np.sum(np.array(gains) > 0.0)} of {len(gains)}, at worst {min(gains):+.2f})"
        )
    return "log scores: " + ", ".join(texts)


def state_calibration(probabilities, good):
    """Print the reliability diagram."""
    print(f"{probabilities.size} probabilities; Brier score {np.mean((probabilities - good) ** 2):.4f}")
    for low in np.arange(0.0, 1.0, 0.1):
        is_in_band = (probabilities >= low) & (probabilities < low + 0.1)
        if is_in_band.any():
            share = f"stated {probabilities[is_in_band].mean():.3f}, good {good[is_in_band].mean():.3f}"
            print(f"probability from {low:.1f}: {share}, of {is_in_band.sum()}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
