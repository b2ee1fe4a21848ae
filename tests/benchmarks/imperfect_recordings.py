"""Measure what verdicts are worth where recording and structure are not as stated, restartable.

`python tests/benchmarks/imperfect_recordings.py FOLDER --seed S --count N [--rows NAME …] [--exact]
[--error]` simulates the tests of the seeds from S on by `tests/assessment/rebuilt_error/laboratory.py`, which
shares no code with `reliab`, under the real records of `../shared/motions` (`--records`), spoils each
recording or statement in one way after the other, and judges it with nothing stated but f, ξ and α. Answers
are kept in FOLDER, a file for each seed; what is there already is not done again. Printed for each row:
ratios of stated to true RMS^R, how often the 90 % interval holds the truth (with its Wilson interval), bad
tests accepted, good ones refused, undecided ones; then, for the rows `sound` and `ordinary`, the share of
good tests called reliable by size of the true error. With `--error` the function behind the error is asked
and not all of `assess`: many more tests in the same time, without what faults of a recording do to a verdict.
With `--linear` the specimen is stated as linear; with `--calibrated` the channels were calibrated as well, by
`calibrate_channels` on a sweep with the same faults and noise; with `--known` f is stated to 0.5 % and ξ to
5 %, with `--vibration` ξ to 0.002 as free vibrations show it, right but for that. `--rate` thins recordings
of 1024 Hz; in the row `clock` their channels are up to a sample of the converter apart (`--clock`, by default
as fast as the recording), and `--skew` is what is stated of it.

True errors lie between 1 and 12 %, the threshold is 5 %, white noise lies 45 dB below the motion. Rows of
`HELD_OUT` were looked at once, when everything was finished.
"""

import json
import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Protocol

import numpy as np
import pandas as pd
import paths
from blind_campaigns.scoring import wilson_interval
from laboratory_tests import (
    DECIBELS,
    LARGEST,
    SMALLEST,
    STEP,
    THRESHOLD,
    add_noise,
    argument_parser,
    draw_test,
    read_records,
)
from rebuilt_error import laboratory as lab

from reliab.assessment.assess import assess
from reliab.assessment.budget.corrections import correct_recording
from reliab.assessment.budget.sizes import Equipment, exact_equipment, ordinary_equipment
from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.assessment.turning import examine_turning
from reliab.assessment.verdict import Word, word_of_probability
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.criterion.derivation import published_criterion
from reliab.recordings.calibration import calibrate_channels, calibration_in_toml
from reliab.recordings.channels_file import read_channels_file
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

FREE_VIBRATION = 0.002  # of a damping ratio
CLOCK = "clock"
ENDS_WITH_YIELDING = ("low_if_yielding", "high_if_yielding")
ACTUATORS = (lab.DELAY, lab.DELAY, lab.LAG, lab.SECOND_ORDER, lab.RATE_LIMIT, lab.LEAD, lab.BACKLASH)


@dataclass(frozen=True)
class StatedTest:
    """A recording with what its laboratory states, and the true error."""

    command: np.ndarray
    measured: np.ndarray
    f: float
    xi: float
    alpha: float
    true: float
    ideal: np.ndarray


Fault = Callable[[StatedTest, np.random.Generator], StatedTest]


class Settings(Protocol):
    """Options of the command."""

    exact: bool
    error: bool
    linear: bool
    calibrated: bool
    known: bool
    vibration: bool
    rate: float
    clock: float | None
    skew: str | None


def add_skew(samples: float) -> Fault:
    """Measured displacement recorded late by so many samples."""
    return lambda test, _: replace(test, measured=later(test.measured, samples * STEP))


def add_clock_offset(rate: float) -> Fault:
    """Measured displacement off by up to a sample of a converter [Hz] either way."""
    return lambda test, rng: replace(
        test, measured=later(test.measured, (rng.uniform() - rng.uniform()) / rate)
    )


def later(values: np.ndarray, seconds: float) -> np.ndarray:
    """A history later by a time, exactly for what lies below the Nyquist frequency."""
    return apply_filter(values, lambda frequency: np.exp(-2j * np.pi * frequency * seconds))


def apply_filter(values: np.ndarray, gain: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """A history seen through an analogue filter, at rest before and after it."""
    pad = 4096
    size = values.size + 2 * pad
    history = np.concatenate([np.full(pad, values[0]), values, np.full(pad, values[-1])])
    level = np.linspace(history[0], history[-1], size)
    response = gain(np.fft.rfftfreq(size, STEP))
    return (np.fft.irfft(np.fft.rfft(history - level) * response, size) + level)[pad : pad + values.size]


def butterworth(corner: float) -> Callable[[np.ndarray], np.ndarray]:
    """Gain of a low-pass filter of second order."""
    return lambda frequency: (
        1.0 / (1.0 + 1j * math.sqrt(2.0) * frequency / corner - (frequency / corner) ** 2)
    )


def add_filters(command: float, measured: float) -> Fault:
    """Anti-alias filters with these corners [Hz]."""
    return lambda test, _: replace(
        test,
        command=apply_filter(test.command, butterworth(command)),
        measured=apply_filter(test.measured, butterworth(measured)),
    )


def add_scale(size: float, *, either: bool = False) -> Fault:
    """Scale of the sensor off by a share, or as much the other way."""
    return lambda test, rng: replace(
        test, measured=test.measured * (1.0 + size * (rng.choice([-1.0, 1.0]) if either else 1.0))
    )


def add_hysteresis(share: float) -> Fault:
    """Sensor with hysteresis: a loop as wide as a share of the span."""

    def spoil(test: StatedTest, _: np.random.Generator) -> StatedTest:
        radius, reading_before = 0.5 * share * float(np.ptp(test.measured)), test.measured[0]
        reading = np.empty_like(test.measured)
        for k, place in enumerate(test.measured.tolist()):
            reading_before = min(max(reading_before, place - radius), place + radius)
            reading[k] = reading_before
        return replace(test, measured=reading)

    return spoil


def add_offset(offset: float, drift: float) -> Fault:
    """Offset and drift of the sensor, shares of the peak."""

    def spoil(test: StatedTest, _: np.random.Generator) -> StatedTest:
        peak = float(np.abs(test.measured).max())
        return replace(
            test,
            measured=test.measured + peak * (offset + drift * np.linspace(-0.5, 0.5, test.measured.size)),
        )

    return spoil


def digitize(bits: int) -> Fault:
    """Converter of so many bits over three times the peak either way."""

    def spoil(test: StatedTest, _: np.random.Generator) -> StatedTest:
        step = 6.0 * float(np.abs(test.measured).max()) / 2**bits
        return replace(test, measured=step * np.round(test.measured / step))

    return spoil


def lose_samples(share: float, *, is_held: bool) -> Fault:
    """Samples of the measured displacement that show the one before, or that were lost and interpolated."""

    def spoil(test: StatedTest, rng: np.random.Generator) -> StatedTest:
        gone = np.flatnonzero(rng.uniform(size=test.measured.size) < share)
        gone = gone[(gone > 0) & (gone < test.measured.size - 1)]
        reading = test.measured.copy()
        reading[gone] = reading[gone - 1] if is_held else 0.5 * (reading[gone - 1] + reading[gone + 1])
        return replace(test, measured=reading)

    return spoil


def misstate(**factors: tuple[float, ...]) -> Fault:
    """Structure that is not as stated: relative errors of f, xi or alpha, one of them at random."""
    return lambda test, rng: replace(
        test, **{name: getattr(test, name) * (1.0 + rng.choice(sizes)) for name, sizes in factors.items()}
    )


def add_ordinary_errors(test: StatedTest, rng: np.random.Generator) -> StatedTest:
    """Equipment of a careful laboratory: everything a little off."""
    test = later_and_scaled(test, 0.1 * STEP * rng.normal(), 0.001 * rng.normal())
    test = add_hysteresis(0.0003 * abs(rng.normal()))(test, rng)
    return replace(
        test, f=test.f * (1.0 + 0.004 * rng.normal()), xi=test.xi * max(1.0 + 0.07 * rng.normal(), 0.5)
    )


def later_and_scaled(test: StatedTest, seconds: float, scale: float) -> StatedTest:
    """Skew and scale at once."""
    return replace(test, measured=(1.0 + scale) * later(test.measured, seconds))


def add_every_error(test: StatedTest, rng: np.random.Generator) -> StatedTest:
    """Everything off by the sizes of ordinary laboratories."""
    test = later_and_scaled(test, 0.33 * STEP * rng.normal(), 0.003 * rng.normal())
    test = add_hysteresis(0.001 * abs(rng.normal()))(test, rng)
    return replace(
        test, f=test.f * (1.0 + 0.01 * rng.normal()), xi=test.xi * max(1.0 + 0.15 * rng.normal(), 0.4)
    )


def cut_start(test: StatedTest, rng: np.random.Generator) -> StatedTest:
    """Recorded from some time after the beginning on; the true error is that over what was recorded."""
    moving = slice(int(rng.uniform(0.1, 0.6) * test.command.size), None)
    ideal, measured = test.ideal[moving], test.measured[moving]
    true = float(np.sqrt(np.mean((measured - ideal) ** 2)) / np.abs(ideal).max())
    return replace(test, command=test.command[moving], measured=measured, ideal=ideal, true=true)


def add_jitter(test: StatedTest, rng: np.random.Generator) -> StatedTest:
    """Clock of the measured channel that wanders by a tenth of a millisecond."""
    time = np.arange(test.measured.size) * STEP
    wander = np.interp(time, np.linspace(0.0, time[-1], 12), 1e-4 * rng.normal(size=12))
    return replace(test, measured=np.interp(time - wander, time, test.measured))


def bend_sensor(test: StatedTest, _: np.random.Generator) -> StatedTest:
    """Sensor whose scale falls with the stroke: 0.5 % of the peak off the line."""
    peak = float(np.abs(test.measured).max())
    return replace(test, measured=test.measured * (1.0 - 0.005 * (test.measured / peak) ** 2))


PLAIN: dict[str, Fault] = {
    "sound": lambda test, _: test,
    "late 0.2 samples": add_skew(0.2),
    "late 0.5 samples": add_skew(0.5),
    "late 1 sample": add_skew(1.0),
    "filters 200, 100 Hz": add_filters(200.0, 100.0),
    "scale +0.3 %": add_scale(0.003),
    "scale ±1 %": add_scale(0.01, either=True),
    "hysteresis 0.5 %": add_hysteresis(0.005),
    "offset 1 %": add_offset(0.01, 0.0),
    "drift 3 %": add_offset(0.0, 0.03),
    "12 bits": digitize(12),
    "held 1 %": lose_samples(0.01, is_held=True),
    "lost 1 %": lose_samples(0.01, is_held=False),
    "f +1 %": misstate(f=(0.01,)),
    "f ±2 %": misstate(f=(-0.02, 0.02)),
    "f +5 %": misstate(f=(0.05,)),
    "ξ ±30 %": misstate(xi=(-0.3, 0.3)),
    "ordinary": add_ordinary_errors,
}
HELD_OUT: dict[str, Fault] = {
    "everything": add_every_error,
    "early 0.7 samples": add_skew(-0.7),
    "filter 80 Hz on measured": add_filters(1e6, 80.0),
    "jitter 0.1 ms": add_jitter,
    "bent 0.5 %": bend_sensor,
    "f −3 %, ξ +20 %": misstate(f=(-0.03,), xi=(0.2,)),
    "10 bits": digitize(10),
}
CUT: dict[str, Fault] = {"begins in motion": cut_start}
SPECIMENS = {"hardening 5–15 %": lab.CUBIC, "bilinear R 2–4": lab.HYSTERESIS}


def draw(
    seed: int, records: list[Path], specimen: int = lab.LINEAR
) -> tuple[StatedTest, np.random.Generator]:
    """Test whose true error lies between the limits, with its noise."""
    rng = np.random.default_rng([seed, specimen])
    rig, outcome = draw_test(records, rng, (SMALLEST, LARGEST), ACTUATORS, specimen)
    noisy = add_noise(outcome.measured, rng)
    return StatedTest(outcome.command, noisy, rig.f, rig.xi, rig.alpha, outcome.rms, outcome.ideal), rng


def calibration(test: StatedTest, fault: Fault, rng: np.random.Generator) -> Mapping[str, StatedValue]:
    """What the laboratory's file says after a calibration by a sweep as large as the test."""
    time = np.arange(0.0, 30.0, STEP)
    motion = float(np.abs(test.measured).max()) * np.sin(2.0 * np.pi * (0.1 * time + 0.08 * time**2))
    read = fault(replace(test, command=motion, measured=motion), rng)
    level = 10.0 ** (-DECIBELS / 20.0) * float(motion.std())
    recording = Recording(
        command=read.command, measured=read.measured + level * rng.normal(size=time.size), time_step=STEP
    )
    with TemporaryDirectory() as folder:
        file = Path(folder) / "channels.toml"
        file.write_text(calibration_in_toml(calibrate_channels(recording), "", "sweep"), encoding="utf-8")
        return read_channels_file(file).test_values


def judge(
    test: StatedTest,
    *,
    exact: bool,
    error_alone: bool,
    rate: float,
    linear: bool = False,
    statements: Mapping[str, StatedValue] | None = None,
) -> dict[str, object]:
    """What the product says of a test that was recorded at a rate [Hz]."""
    statements, thinning = statements or {}, slice(None, None, round(lab.RATE / rate))
    recording = Recording(
        command=test.command[thinning], measured=test.measured[thinning], time_step=1.0 / rate
    )
    recording = correct_recording(recording, statements, {})
    structure = Structure(frequency=test.f, damping_ratio=test.xi, experimental_fraction=test.alpha)
    row: dict[str, object] = {"f": test.f, "xi": test.xi, "alpha": test.alpha, "true": test.true}
    equipment = exact_equipment() if exact else ordinary_equipment()
    if error_alone:
        question_of_test = replace(question(structure, equipment), stated=statements, linear_specimen=linear)
        error = error_of_test(recording, question_of_test)
        turning, word = (
            examine_turning(error, recording, question_of_test),
            word_of_probability(error.probability),
        )
        if word is Word.RELIABLE and turning.smallest_ductility is not None:
            word = Word.UNDECIDED
        answer = {"probability": error.probability, "word": str(word), "parts": parts(error)}
        yielding = turning.error_if_yielding or (math.nan, math.nan)
        return row | size(error.rebuilt.rms) | answer | dict(zip(ENDS_WITH_YIELDING, yielding, strict=True))
    try:
        assessment = assess(
            recording,
            structure,
            equipment=equipment,
            stated=statements,
            linear_specimen=linear,
            criterion=published_criterion("guo_2017_15"),  # of the index, which is not looked at
        )
    except InputError as error:
        return row | {"word": "refused", "why": str(error)}
    word = str(assessment.verdict)
    answer = {"probability": assessment.probability, "word": word, "parts": parts(assessment.error)}
    return row | size(assessment.error.rebuilt.rms) | answer


def parts(error: ErrorOfTest) -> dict[str, float]:
    """Standard deviation of the error that each quantity of the budget causes."""
    return {widening.name: widening.contribution for widening in error.widenings}


def question(structure: Structure, equipment: Equipment) -> Question:
    """What is asked of a test of which nothing else is stated."""
    return Question(
        structure=structure,
        stated={},
        equipment=equipment,
        metric=Metric.RMS,
        threshold=THRESHOLD,
        model=None,
        seed=0,
    )


def size(rms: Estimate) -> dict[str, float | str]:
    """RMS^R with its interval."""
    return {"value": rms.value, "low": rms.low, "high": rms.high}


def list_statements(
    test: StatedTest, fault: Fault, chance: list[int], options: Settings
) -> dict[str, StatedValue]:
    """What the laboratory states of a test beside f, ξ and α: calibration, deviations of f and ξ."""
    statements = dict(calibration(test, fault, np.random.default_rng(chance))) if options.calibrated else {}
    if options.known:
        statements |= {"f": StatedValue(test.f, 0.005 * test.f), "xi": StatedValue(test.xi, 0.05 * test.xi)}
    if options.vibration:
        statements |= {"xi": StatedValue(test.xi, FREE_VIBRATION)}
    if options.skew is not None:
        statements |= {"skew": StatedValue.parse(options.skew)}
    return statements


def from_free_vibration(test: StatedTest, true: StatedTest, rng: np.random.Generator) -> StatedTest:
    """Test whose ξ is known to 0.002."""
    return replace(test, xi=true.xi + FREE_VIBRATION * float(np.clip(rng.normal(), -3.0, 3.0)))


def state_closely(test: StatedTest, true: StatedTest, rng: np.random.Generator) -> StatedTest:
    """Test whose f is known to 0.5 % and ξ to 5 %."""
    return replace(test, f=true.f * (1.0 + 0.005 * rng.normal()), xi=true.xi * (1.0 + 0.05 * rng.normal()))


def run_seed(seed: int, records: list[Path], rows: list[str], file: Path, options: Settings) -> None:
    """Judge one test in every row that its file does not hold yet."""
    answers = json.loads(file.read_text()) if file.is_file() else {}
    missing_rows = [row for row in rows if row not in answers]
    numbers = {row: place for place, row in enumerate([*PLAIN, *HELD_OUT, *SPECIMENS, CLOCK, *CUT])}
    faults = {**PLAIN, **HELD_OUT, **CUT, CLOCK: add_clock_offset(options.clock or options.rate)}
    sound = draw(seed, records) if any(row in faults for row in missing_rows) else None
    for row in missing_rows:
        chance, fault = [seed, numbers[row]], faults.get(row, PLAIN["sound"])
        true = draw(seed, records, SPECIMENS[row])[0] if row in SPECIMENS else sound[0]
        test = fault(true, np.random.default_rng(chance))
        if options.known:
            test = state_closely(test, true, np.random.default_rng([*chance, 1]))
        if options.vibration:
            test = from_free_vibration(test, true, np.random.default_rng([*chance, 2]))
        answers[row] = judge(
            test,
            exact=options.exact,
            error_alone=options.error,
            rate=options.rate,
            linear=options.linear,
            statements=list_statements(test, fault, chance, options),
        )
        file.write_text(json.dumps(answers), encoding="utf-8")


def state(rows: pd.DataFrame) -> None:
    """Print a line for each row of the table."""
    for name, group in rows.groupby("row", sort=False):
        verdicts = group[group["word"] != "refused"]
        ratio = np.quantile(verdicts["value"] / verdicts["true"], [0.05, 0.95])
        is_covered = (verdicts["low"] <= verdicts["true"]) & (verdicts["true"] <= verdicts["high"])
        ends = wilson_interval(int(is_covered.sum()), len(is_covered))
        bad, good = verdicts["true"] > THRESHOLD, verdicts["true"] < THRESHOLD
        bad_accepted = int((bad & (verdicts["word"] == "reliable")).sum())
        good_refused = int((good & (verdicts["word"] == "not_reliable")).sum())
        print(
            f"{name:26} {len(verdicts)} tests: ratio {ratio[0]:.2f}–{ratio[1]:.2f}, "
            f"held {is_covered.mean():.0%} ({ends[0]:.0%}–{ends[1]:.0%}), "
            f"bad accepted {bad_accepted} of {bad.sum()}, good refused {good_refused} of {good.sum()}, "
            f"undecided {(verdicts['word'] == 'undecided').mean():.0%}, "
            f"width over true {((verdicts['high'] - verdicts['low']) / verdicts['true']).median():.2f}"
        )
        if name in SPECIMENS and "low_if_yielding" in verdicts:
            low, high = (
                verdicts[["low", ENDS_WITH_YIELDING[0]]].min(axis=1),
                verdicts[["high", ENDS_WITH_YIELDING[1]]].max(axis=1),
            )
            both = float(((low <= verdicts["true"]) & (verdicts["true"] <= high)).mean())
            print(f"{name!s:26} interval together with the errors if it yielded: held {both:.0%}")
    for name in ("sound", "ordinary", CLOCK):
        group = rows[rows["row"] == name]
        if group.empty:
            continue
        for low, high in ((0.01, 0.02), (0.02, 0.03), (0.03, 0.04), (0.04, 0.05)):
            band = group[(group["true"] >= low) & (group["true"] < high)]
            reliable = (band["word"] == "reliable").mean() if len(band) else math.nan
            print(f"{name}, true error {low:.0%} to {high:.0%}: {reliable:.0%} of {len(band)} reliable")


def main() -> None:
    parser = argument_parser(__doc__, count=100)
    parser.add_argument("--rows", nargs="*", default=[*PLAIN, *SPECIMENS])
    parser.add_argument("--records", type=Path, default=paths.MOTIONS)
    parser.add_argument("--exact", action="store_true")
    for option in ("--error", "--linear", "--calibrated", "--known", "--vibration"):
        parser.add_argument(option, action="store_true")
    parser.add_argument("--rate", type=float, default=lab.RATE)
    parser.add_argument("--clock", type=float)
    parser.add_argument("--skew")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    records = read_records(options.records)
    files = {
        seed: options.folder / f"test_{seed}.json"
        for seed in range(options.seed, options.seed + options.count)
    }
    for seed, file in files.items():
        run_seed(seed, records, options.rows, file, options)
        print(seed, flush=True, file=sys.stderr)
    answers = [
        {"row": row, "seed": seed, **json.loads(file.read_text())[row]}
        for row in options.rows
        for seed, file in files.items()
    ]
    state(pd.DataFrame(answers))


if __name__ == "__main__":
    main()
