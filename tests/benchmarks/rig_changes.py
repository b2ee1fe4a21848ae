"""Changes of simulated rigs: how soon they are noticed, how often falsely, and before which verdict is lost.

    python tests/benchmarks/rig_changes.py [first seed] [rigs]

Rigs of 200 tests whose delay scatters by 0.5 ms, normally, skewed, or with one test in ten far off; a step of
1 ms, or a drift of 0.02 ms a test, begins at test 100. A drift costs a verdict where a test's delay is beyond
a limit and would not have been without it; limits are so many scatters above the usual delay.
"""

import sys

import numpy as np
import paths  # noqa: F401 - makes rows of rigs importable
from rig_rows import rig_table, rig_test
from rigs import KINDS, simulate_rig

from reliab.rig.watching import drift_chart

TESTS, BEGIN, SCATTER, FIRST_TESTS = 200, 100, 0.5, 13


def normal(rng):
    """Scatter as the chart assumes."""
    return rng.normal(size=TESTS)


def skew_normal(rng):
    """Gamma distribution of skewness 1.6."""
    return (rng.gamma(1.5, size=TESTS) - 1.5) / np.sqrt(1.5)


def odd(rng):
    """One test in ten by Student's t distribution of two degrees of freedom, eight times as wide."""
    return rng.normal(size=TESTS) + (rng.random(TESTS) < 0.1) * 8.0 * rng.standard_t(2, size=TESTS)


def rig(rng, scatter, shift):
    """Tests in which all three quantities scatter so, and the delay is shifted."""
    gain, delay, noise = (scatter(rng) for _ in range(3))
    peaks = 50.0 * np.exp(0.5 * rng.normal(size=TESTS))
    return rig_table(
        rig_test(
            number,
            A=0.99 + 0.003 * float(gain[number]),
            d_ms=2.0 + SCATTER * float(delay[number]) + float(shift[number]),
            remainder=0.01 * float(np.exp(np.clip(0.2 * noise[number], -3.0, 3.0))),
            peak_mm=float(peaks[number]),
        )
        for number in range(TESTS)
    )


def false_alarms(tables):
    """Share of tests at which a change was noticed though there was none."""
    detections = [len({change.noticed for change in drift_chart(table.rows).changes}) for table in tables]
    return sum(detections) / sum(len(table) - FIRST_TESTS for table in tables)


def steps_noticed(first, rigs, scatter, size):
    """Share of steps that are noticed within five tests."""
    shift = size * (np.arange(TESTS) >= BEGIN)
    detections = 0
    for seed in range(first, first + rigs):
        changes = drift_chart(rig(np.random.default_rng([1, seed]), scatter, shift).rows).changes
        detections += any(
            BEGIN <= change.noticed < BEGIN + 5 and change.cause == "delay" for change in changes
        )
    return detections / rigs


def drifts(first, rigs, margins):
    """Tests until a drift is noticed, and the share noticed before a verdict is lost, by margin."""
    ramp = 0.02 * np.maximum(np.arange(TESTS) - BEGIN + 1, 0)
    waits, in_advance = [], {margin: [] for margin in margins}
    for seed in range(first, first + rigs):
        table = rig(np.random.default_rng([2, seed]), normal, ramp)
        detections = [
            change.noticed
            for change in drift_chart(table.rows).changes
            if change.cause == "delay" and change.noticed >= BEGIN and change.size > 0.0
        ]
        first_noticed = min(detections, default=TESTS)
        waits.append(first_noticed - BEGIN + 1)
        delays = table.numbers("d_ms")
        for margin in margins:
            limit = 2.0 + margin * SCATTER
            lost_tests = np.flatnonzero((delays > limit) & (delays - ramp <= limit))
            in_advance[margin].append(first_noticed <= (lost_tests[0] if lost_tests.size else TESTS))
    return float(np.median(waits)), {
        margin: float(np.mean(advance)) for margin, advance in in_advance.items()
    }


def main(first=9000, rigs=300):
    still = np.zeros(TESTS)
    for scatter in (normal, skew_normal, odd):
        tables = [
            rig(np.random.default_rng([0, seed]), scatter, still) for seed in range(first, first + rigs)
        ]
        later, sooner = (steps_noticed(first, rigs, scatter, size) for size in (1.0, -1.0))
        print(
            f"{scatter.__name__}: false alarms {false_alarms(tables):.4f} a test; "
            f"a step of 1 ms within 5 tests {later:.3f}, of -1 ms {sooner:.3f}",
            flush=True,
        )
    wait, in_advance = drifts(first, rigs, (2.0, 3.0, 4.0))
    print(
        f"drift: noticed at test {wait:g} in the median; before a verdict was lost {in_advance}", flush=True
    )
    for kind in KINDS:
        tables = [simulate_rig(kind, seed) for seed in range(first, first + rigs // 6)]
        print(f"{kind}: alarms {false_alarms(tables):.4f} a test", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
