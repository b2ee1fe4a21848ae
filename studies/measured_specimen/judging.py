"""Judge simulated tests from command, displacement and force alone, beside what is true of them."""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
import pandas as pd

from reliab.assessment.assess import assess
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress
from reliab.core.stated_value import StatedValue
from reliab.motions.motion import Motion
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

from .simulated_tests import SimulatedTest, simulate
from .specimens import FAMILIES

LINEAR: Final = "linear"
"""The family whose tests are judged as those of a stated linear specimen, too."""

_STEP = 1.0 / 1024.0
_SECONDS = 40.0
_ERRORS = (0.003, 0.3)  # of the exact response's peak, between which a test is kept
_DECIBELS = (40.0, 30.0)  # one after the other


def judge_tests(
    motions: Sequence[Motion],
    families: Sequence[str],
    tests: int,
    *,
    seed: int,
    threshold: float,
    progress: Progress,
) -> pd.DataFrame:
    """Simulate and judge tests of families of specimens.

    `threshold`: error of the whole test up to which it is good [-]. Result: one row a test: family, decibels,
    f [Hz], xi, alpha, true error, computed value with its interval (low, high) [-], held_out [-], word of the
    verdict, left (error of the corrected over that of the measured response) and inside (share of samples in
    the band) [-]; of linear specimens also stated_value, stated_low, stated_high and stated_word, with the
    specimen as it is stated.
    """
    drawn = [(family, number) for family in families for number in range(tests)]
    rows = []
    for done, (family, number) in enumerate(drawn, start=1):
        draw = np.random.default_rng([seed, list(FAMILIES).index(family), number])
        rows.append(_row(family, motions, draw, _DECIBELS[number % len(_DECIBELS)], threshold))
        progress(done, len(drawn))
    return pd.DataFrame(rows)


def draw_test(
    family: str, motions: Sequence[Motion], draw: np.random.Generator, decibels: float
) -> SimulatedTest:
    """Simulate a test whose error is neither tiny nor of a loop that diverges."""
    times = np.arange(0.0, _SECONDS, _STEP)
    while True:
        motion = motions[int(draw.integers(len(motions)))]
        try:
            test = simulate(family, -_sample_ground(motion, times), _STEP, draw, decibels=decibels)
        except ArithmeticError:  # the loop diverges
            continue
        if _ERRORS[0] < test.error < _ERRORS[1]:
            return test


def _sample_ground(motion: Motion, times: Array) -> Array:
    """Ground acceleration at times [s], at rest after the record's end."""
    ground = np.interp(times, motion.time_step * np.arange(motion.acceleration.size), motion.acceleration)
    ground[times > motion.time_step * motion.acceleration.size] = 0.0
    return ground


def _row(
    family: str, motions: Sequence[Motion], draw: np.random.Generator, decibels: float, threshold: float
) -> dict[str, object]:
    test = draw_test(family, motions, draw, decibels)
    loop = test.loop
    structure = Structure(
        frequency=loop.frequency, damping_ratio=loop.damping_ratio, experimental_fraction=loop.share
    )
    recording = Recording(
        command=test.command, measured=test.measured, force=test.force, time_step=test.step, name=family
    )
    row: dict[str, object] = {
        "family": family,
        "decibels": decibels,
        "f": loop.frequency,
        "xi": loop.damping_ratio,
        "alpha": loop.share,
        "true": test.error,
    }
    stated = {"mass": StatedValue(1.0)}
    try:
        found = assess(recording, structure, stated=stated, threshold=threshold, measured_specimen=True)
    except InputError as error:
        return row | {"word": "refused", "refusal": str(error)}
    (rebuilt,), original = found.error.displacements, test.moved - test.exact
    inside = (rebuilt.low <= original) & (original <= rebuilt.high)
    row |= {
        "value": rebuilt.rms.value,
        "low": rebuilt.rms.low,
        "high": rebuilt.rms.high,
        "held_out": found.error.specimen.held_out if found.error.specimen else np.nan,
        "word": str(found.verdict),
        "left": np.sqrt(np.mean((rebuilt.reference - test.exact) ** 2) / np.mean(original**2)),
        "inside": np.mean(inside),
    }
    return row | dict(_as_stated(recording, structure, threshold) if family == LINEAR else ())


def _as_stated(
    recording: Recording, structure: Structure, threshold: float
) -> Iterator[tuple[str, float | str]]:
    """Judge the test of a linear specimen as it is stated."""
    found = assess(recording, structure, threshold=threshold, linear_specimen=True)
    size = found.error.rms
    yield from (("stated_value", size.value), ("stated_low", size.low), ("stated_high", size.high))
    yield "stated_word", str(found.verdict)


ALL: Final = "all"
"""Name of the row over all families."""

_NEAR, _WIDE = 0.10, 0.25


def summarise(tests: pd.DataFrame, threshold: float) -> pd.DataFrame:
    """Rates of judged tests, one row a family and one over all.

    `tests` as `judge_tests` gives them; `threshold` of a good test [-]. Columns: tests, near and wide (share
    whose value lies within 10 and 25 % of the true error), held (share of intervals that hold it), bad
    (number of bad tests), false_safe (accepted bad tests over all tests), accepted (of the good ones),
    refused_good (of the good ones), undecided, left (median) and inside (mean) [-]; tests that were refused
    count as undecided and as missed.
    """
    groups = [(name, rows) for name, rows in tests.groupby("family", sort=False)]
    return pd.DataFrame([_rates(str(name), rows, threshold) for name, rows in [*groups, (ALL, tests)]])


def _rates(name: str, tests: pd.DataFrame, threshold: float) -> dict[str, object]:
    away = (tests["value"] / tests["true"] - 1.0).abs()
    good = tests["true"] <= threshold
    said_good, said_bad = tests["word"] == "reliable", tests["word"] == "not_reliable"
    return {
        "family": name,
        "tests": len(tests),
        "near": (away < _NEAR).mean(),
        "wide": (away < _WIDE).mean(),
        "held": ((tests["low"] <= tests["true"]) & (tests["true"] <= tests["high"])).mean(),
        "bad": int((~good).sum()),
        "false_safe": (said_good & ~good).mean(),
        "accepted": _share(said_good[good]),
        "refused_good": _share(said_bad[good]),
        "undecided": (~said_good & ~said_bad).mean(),
        "left": tests["left"].median(),
        "inside": tests["inside"].mean(),
    }


def _share(words: pd.Series) -> float:
    return float(words.mean()) if len(words) else np.nan


def compare_with_stated(tests: pd.DataFrame) -> dict[str, float]:
    """Say what tests of linear specimens lose when nobody states that they are.

    Returns the number of tests, `agree` (share of equal verdicts), `opposed` (share of opposite ones), and
    `width` and `widest`, the median and the 95th percentile of the ratio of the intervals' widths; empty
    where no test of a linear specimen was judged as it is stated.
    """
    if "stated_word" not in tests:
        return {}
    linear = tests.dropna(subset=["stated_word"])
    width = (linear["high"] - linear["low"]) / (linear["stated_high"] - linear["stated_low"])
    words = set(zip(linear["word"], linear["stated_word"], strict=True))
    opposite = {("reliable", "not_reliable"), ("not_reliable", "reliable")}
    pairs = pd.Series(list(zip(linear["word"], linear["stated_word"], strict=True)), dtype=object)
    return {
        "tests": float(len(linear)),
        "agree": float((linear["word"] == linear["stated_word"]).mean()),
        "opposed": float(pairs.isin(opposite & words).mean()),
        "width": float(width.median()),
        "widest": float(width.quantile(0.95)),
    }
