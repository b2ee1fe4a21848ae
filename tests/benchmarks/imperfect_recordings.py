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

import argparse
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

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/assessment"), str(ROOT / "tests"), str(ROOT / "tests/benchmarks")]

from blind_campaigns.scoring import wilson_interval  # noqa: E402
from rebuilt_error import laboratory as lab  # noqa: E402

from reliab.assessment.assess import assess  # noqa: E402
from reliab.assessment.budget.corrections import correct_recording  # noqa: E402
from reliab.assessment.budget.sizes import Equipment, exact_equipment, ordinary_equipment  # noqa: E402
from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test  # noqa: E402
from reliab.assessment.rebuilt_error.spread import Estimate  # noqa: E402
from reliab.assessment.turning import examine_turning  # noqa: E402
from reliab.assessment.verdict import Word, word_of_probability  # noqa: E402
from reliab.core.errors import InputError  # noqa: E402
from reliab.core.stated_value import StatedValue  # noqa: E402
from reliab.core.vocabulary import Metric  # noqa: E402
from reliab.criterion.published import published_criterion  # noqa: E402
from reliab.recordings.calibration import calibrate_channels, calibration_in_toml  # noqa: E402
from reliab.recordings.channels_file import read_channels_file  # noqa: E402
from reliab.recordings.recording import Recording  # noqa: E402
from reliab.structures.structure import Structure  # noqa: E402

STEP, THRESHOLD, DECIBELS = 1.0 / lab.RATE, 0.05, 45.0
SMALLEST, LARGEST = 0.01, 0.12
FREE_VIBRATION = 0.002  # of a damping ratio
CLOCK = "clock"
IF_YIELDING = ("low_if_yielding", "high_if_yielding")
ACTUATORS = (lab.DELAY, lab.DELAY, lab.LAG, lab.SECOND_ORDER, lab.RATE_LIMIT, lab.LEAD, lab.BACKLASH)


@dataclass(frozen=True)
class Told:
    """A recording with what its laboratory states, and the true error."""

    command: np.ndarray
    measured: np.ndarray
    f: float
    xi: float
    alpha: float
    true: float
    ideal: np.ndarray


Fault = Callable[[Told, np.random.Generator], Told]


class Asked(Protocol):
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


def skewed(samples: float) -> Fault:
    """Measured displacement recorded late by so many samples."""
    return lambda told, _: replace(told, measured=later(told.measured, samples * STEP))


def on_a_clock(rate: float) -> Fault:
    """Measured displacement off by up to a sample of a converter [Hz] either way."""
    return lambda told, rng: replace(
        told, measured=later(told.measured, (rng.uniform() - rng.uniform()) / rate)
    )


def later(values: np.ndarray, seconds: float) -> np.ndarray:
    """A history later by a time, exactly for what lies below the Nyquist frequency."""
    return through(values, lambda frequency: np.exp(-2j * np.pi * frequency * seconds))


def through(values: np.ndarray, gain: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """A history seen through an analogue filter, at rest before and after it."""
    pad = 4096
    size = values.size + 2 * pad
    padded = np.concatenate([np.full(pad, values[0]), values, np.full(pad, values[-1])])
    level = np.linspace(padded[0], padded[-1], size)
    response = gain(np.fft.rfftfreq(size, STEP))
    return (np.fft.irfft(np.fft.rfft(padded - level) * response, size) + level)[pad : pad + values.size]


def butterworth(corner: float) -> Callable[[np.ndarray], np.ndarray]:
    """Gain of a low-pass filter of second order."""
    return lambda frequency: (
        1.0 / (1.0 + 1j * math.sqrt(2.0) * frequency / corner - (frequency / corner) ** 2)
    )


def filtered(command: float, measured: float) -> Fault:
    """Anti-alias filters with these corners [Hz]."""
    return lambda told, _: replace(
        told,
        command=through(told.command, butterworth(command)),
        measured=through(told.measured, butterworth(measured)),
    )


def scaled(size: float, *, either: bool = False) -> Fault:
    """Scale of the sensor off by a share, or as much the other way."""
    return lambda told, rng: replace(
        told, measured=told.measured * (1.0 + size * (rng.choice([-1.0, 1.0]) if either else 1.0))
    )


def lagging(share: float) -> Fault:
    """Sensor with hysteresis: a loop as wide as a share of the span."""

    def spoil(told: Told, _: np.random.Generator) -> Told:
        radius, held = 0.5 * share * float(np.ptp(told.measured)), told.measured[0]
        reading = np.empty_like(told.measured)
        for k, place in enumerate(told.measured.tolist()):
            held = min(max(held, place - radius), place + radius)
            reading[k] = held
        return replace(told, measured=reading)

    return spoil


def shifted(offset: float, drift: float) -> Fault:
    """Offset and drift of the sensor, shares of the peak."""

    def spoil(told: Told, _: np.random.Generator) -> Told:
        peak = float(np.abs(told.measured).max())
        return replace(
            told,
            measured=told.measured + peak * (offset + drift * np.linspace(-0.5, 0.5, told.measured.size)),
        )

    return spoil


def converted(bits: int) -> Fault:
    """Converter of so many bits over three times the peak either way."""

    def spoil(told: Told, _: np.random.Generator) -> Told:
        step = 6.0 * float(np.abs(told.measured).max()) / 2**bits
        return replace(told, measured=step * np.round(told.measured / step))

    return spoil


def missing(share: float, *, held: bool) -> Fault:
    """Samples of the measured displacement that show the one before, or that were lost and interpolated."""

    def spoil(told: Told, rng: np.random.Generator) -> Told:
        gone = np.flatnonzero(rng.uniform(size=told.measured.size) < share)
        gone = gone[(gone > 0) & (gone < told.measured.size - 1)]
        reading = told.measured.copy()
        reading[gone] = reading[gone - 1] if held else 0.5 * (reading[gone - 1] + reading[gone + 1])
        return replace(told, measured=reading)

    return spoil


def stated(**factors: tuple[float, ...]) -> Fault:
    """Structure that is not as stated: relative errors of f, xi or alpha, one of them at random."""
    return lambda told, rng: replace(
        told, **{name: getattr(told, name) * (1.0 + rng.choice(sizes)) for name, sizes in factors.items()}
    )


def ordinary(told: Told, rng: np.random.Generator) -> Told:
    """Equipment of a careful laboratory: everything a little off."""
    told = later_and_scaled(told, 0.1 * STEP * rng.normal(), 0.001 * rng.normal())
    told = lagging(0.0003 * abs(rng.normal()))(told, rng)
    return replace(
        told, f=told.f * (1.0 + 0.004 * rng.normal()), xi=told.xi * max(1.0 + 0.07 * rng.normal(), 0.5)
    )


def later_and_scaled(told: Told, seconds: float, scale: float) -> Told:
    """Skew and scale at once."""
    return replace(told, measured=(1.0 + scale) * later(told.measured, seconds))


def everything(told: Told, rng: np.random.Generator) -> Told:
    """Everything off by the sizes of ordinary laboratories."""
    told = later_and_scaled(told, 0.33 * STEP * rng.normal(), 0.003 * rng.normal())
    told = lagging(0.001 * abs(rng.normal()))(told, rng)
    return replace(
        told, f=told.f * (1.0 + 0.01 * rng.normal()), xi=told.xi * max(1.0 + 0.15 * rng.normal(), 0.4)
    )


def begun(told: Told, rng: np.random.Generator) -> Told:
    """Recorded from some time after the beginning on; the true error is that over what was recorded."""
    moving = slice(int(rng.uniform(0.1, 0.6) * told.command.size), None)
    ideal, measured = told.ideal[moving], told.measured[moving]
    true = float(np.sqrt(np.mean((measured - ideal) ** 2)) / np.abs(ideal).max())
    return replace(told, command=told.command[moving], measured=measured, ideal=ideal, true=true)


def jittering(told: Told, rng: np.random.Generator) -> Told:
    """Clock of the measured channel that wanders by a tenth of a millisecond."""
    time = np.arange(told.measured.size) * STEP
    wander = np.interp(time, np.linspace(0.0, time[-1], 12), 1e-4 * rng.normal(size=12))
    return replace(told, measured=np.interp(time - wander, time, told.measured))


def bent(told: Told, _: np.random.Generator) -> Told:
    """Sensor whose scale falls with the stroke: 0.5 % of the peak off the line."""
    peak = float(np.abs(told.measured).max())
    return replace(told, measured=told.measured * (1.0 - 0.005 * (told.measured / peak) ** 2))


PLAIN: dict[str, Fault] = {
    "sound": lambda told, _: told,
    "late 0.2 samples": skewed(0.2),
    "late 0.5 samples": skewed(0.5),
    "late 1 sample": skewed(1.0),
    "filters 200, 100 Hz": filtered(200.0, 100.0),
    "scale +0.3 %": scaled(0.003),
    "scale ±1 %": scaled(0.01, either=True),
    "hysteresis 0.5 %": lagging(0.005),
    "offset 1 %": shifted(0.01, 0.0),
    "drift 3 %": shifted(0.0, 0.03),
    "12 bits": converted(12),
    "held 1 %": missing(0.01, held=True),
    "lost 1 %": missing(0.01, held=False),
    "f +1 %": stated(f=(0.01,)),
    "f ±2 %": stated(f=(-0.02, 0.02)),
    "f +5 %": stated(f=(0.05,)),
    "ξ ±30 %": stated(xi=(-0.3, 0.3)),
    "ordinary": ordinary,
}
HELD_OUT: dict[str, Fault] = {
    "everything": everything,
    "early 0.7 samples": skewed(-0.7),
    "filter 80 Hz on measured": filtered(1e6, 80.0),
    "jitter 0.1 ms": jittering,
    "bent 0.5 %": bent,
    "f −3 %, ξ +20 %": stated(f=(-0.03,), xi=(0.2,)),
    "10 bits": converted(10),
}
CUT: dict[str, Fault] = {"begins in motion": begun}
SPECIMENS = {"hardening 5–15 %": lab.CUBIC, "bilinear R 2–4": lab.HYSTERESIS}


def read_records(folder: Path) -> list[Path]:
    """Files of a catalogue."""
    return [folder / name for name in pd.read_csv(folder / "catalog.csv")["file"]]


def draw(seed: int, records: list[Path], specimen: int = lab.LINEAR) -> tuple[Told, np.random.Generator]:
    """Test whose true error lies between the limits, with its noise."""
    rng = np.random.default_rng([seed, specimen])
    while True:
        ground = lab.read_at2(records[rng.integers(len(records))])[: int(rng.uniform(15.0, 40.0) * lab.RATE)]
        f, xi = math.exp(rng.uniform(math.log(0.4), math.log(2.5))), rng.uniform(0.02, 0.08)
        alpha = 1.0 if rng.uniform() < 0.5 else rng.uniform(0.3, 1.0)
        built = lab.Lab(f, xi, alpha)
        peak = float(np.abs(lab.run(built, ground, ideal=ground).command).max())
        if not peak > 0.0:
            continue
        built = replace(built, specimen=specimen, shape=shape(specimen, peak, rng))
        ideal = lab.run(built, ground, ideal=ground).command
        kind = int(rng.choice(ACTUATORS))
        outcome = lab.run(
            replace(built, kind=kind, numbers=numbers(kind, built, peak, rng)), ground, ideal=ideal
        )
        if np.isfinite(outcome.rms) and SMALLEST < outcome.rms < LARGEST:
            break
    level = 10.0 ** (-DECIBELS / 20.0) * float(np.sqrt(np.mean(outcome.measured**2)))
    noisy = outcome.measured + lab.noise("white", outcome.measured.size, level, rng)
    return Told(outcome.command, noisy, f, xi, alpha, outcome.rms, ideal), rng


def shape(specimen: int, peak: float, rng: np.random.Generator) -> tuple[float, float, float]:
    """Numbers of a specimen: hardening of 5 to 15 % at the peak, or yielding at a ductility of 2 to 4."""
    if specimen == lab.CUBIC:
        return rng.uniform(0.05, 0.15) / peak**2, 0.0, 0.0
    if specimen == lab.HYSTERESIS:
        return peak / rng.uniform(2.0, 4.0), 0.03, 8.0
    return 0.0, 0.0, 0.0


def numbers(
    kind: int, built: lab.Lab, peak: float, rng: np.random.Generator
) -> tuple[float, float, float, float]:
    """Numbers of an actuator that errs by some per cent."""
    w0 = 2.0 * math.pi * built.f
    tau = 2.0 * built.xi / w0 / built.alpha * math.exp(rng.uniform(math.log(0.02), math.log(0.4)))
    gain = 1.0 + 0.3 * built.xi * rng.normal()
    return {
        lab.DELAY: (gain, tau, 0.01 * tau * rng.uniform(-1.0, 1.0), 0.0),
        lab.LAG: (gain, tau, 0.0, 0.0),
        lab.RATE_LIMIT: (gain, tau, peak * w0 * rng.uniform(0.4, 1.0), 0.0),
        lab.BACKLASH: (peak * built.xi * rng.uniform(0.02, 0.3), 0.0, 0.0, 0.0),
        lab.LEAD: (gain, tau, 0.0, 0.0),
        lab.SECOND_ORDER: (gain, 1.4 / tau, 0.7, 0.0),
    }[kind]


def calibration(told: Told, fault: Fault, rng: np.random.Generator) -> Mapping[str, StatedValue]:
    """What the laboratory's file says after a calibration by a sweep as large as the test."""
    time = np.arange(0.0, 30.0, STEP)
    motion = float(np.abs(told.measured).max()) * np.sin(2.0 * np.pi * (0.1 * time + 0.08 * time**2))
    read = fault(replace(told, command=motion, measured=motion), rng)
    level = 10.0 ** (-DECIBELS / 20.0) * float(motion.std())
    recording = Recording(
        command=read.command, measured=read.measured + level * rng.normal(size=time.size), time_step=STEP
    )
    with TemporaryDirectory() as folder:
        file = Path(folder) / "channels.toml"
        file.write_text(calibration_in_toml(calibrate_channels(recording), "", "sweep"), encoding="utf-8")
        return read_channels_file(file).test_values


def judge(
    told: Told,
    *,
    exact: bool,
    error_alone: bool,
    rate: float,
    linear: bool = False,
    stated: Mapping[str, StatedValue] | None = None,
) -> dict[str, object]:
    """What the product says of a test that was recorded at a rate [Hz]."""
    stated, thinned = stated or {}, slice(None, None, round(lab.RATE / rate))
    recording = Recording(
        command=told.command[thinned], measured=told.measured[thinned], time_step=1.0 / rate
    )
    recording = correct_recording(recording, stated, {})
    structure = Structure(frequency=told.f, damping_ratio=told.xi, experimental_fraction=told.alpha)
    row: dict[str, object] = {"f": told.f, "xi": told.xi, "alpha": told.alpha, "true": told.true}
    equipment = exact_equipment() if exact else ordinary_equipment()
    if error_alone:
        asked = replace(question(structure, equipment), stated=stated, linear_specimen=linear)
        error = error_of_test(recording, asked)
        turning, word = examine_turning(error, recording, asked), word_of_probability(error.probability)
        if word is Word.RELIABLE and turning.smallest_ductility is not None:
            word = Word.UNDECIDED
        answer = {"probability": error.probability, "word": str(word), "parts": parts(error)}
        yielding = turning.error_if_yielding or (math.nan, math.nan)
        return row | size(error.rebuilt.rms) | answer | dict(zip(IF_YIELDING, yielding, strict=True))
    try:
        found = assess(
            recording,
            structure,
            equipment=equipment,
            stated=stated,
            linear_specimen=linear,
            criterion=published_criterion("guo_2017_15"),  # of the index, which is not looked at
        )
    except InputError as error:
        return row | {"word": "refused", "why": str(error)}
    word = str(found.verdict)
    answer = {"probability": found.probability, "word": word, "parts": parts(found.error)}
    return row | size(found.error.rebuilt.rms) | answer


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


def stated_values(told: Told, fault: Fault, chance: list[int], asked: Asked) -> dict[str, StatedValue]:
    """What the laboratory states of a test beside f, ξ and α: calibration, deviations of f and ξ."""
    stated = dict(calibration(told, fault, np.random.default_rng(chance))) if asked.calibrated else {}
    if asked.known:
        stated |= {"f": StatedValue(told.f, 0.005 * told.f), "xi": StatedValue(told.xi, 0.05 * told.xi)}
    if asked.vibration:
        stated |= {"xi": StatedValue(told.xi, FREE_VIBRATION)}
    if asked.skew is not None:
        stated |= {"skew": StatedValue.parse(asked.skew)}
    return stated


def from_free_vibration(told: Told, true: Told, rng: np.random.Generator) -> Told:
    """Test whose ξ is known to 0.002."""
    return replace(told, xi=true.xi + FREE_VIBRATION * float(np.clip(rng.normal(), -3.0, 3.0)))


def known_better(told: Told, true: Told, rng: np.random.Generator) -> Told:
    """Test whose f is known to 0.5 % and ξ to 5 %."""
    return replace(told, f=true.f * (1.0 + 0.005 * rng.normal()), xi=true.xi * (1.0 + 0.05 * rng.normal()))


def run_seed(seed: int, records: list[Path], rows: list[str], file: Path, asked: Asked) -> None:
    """Judge one test in every row that its file does not hold yet."""
    answers = json.loads(file.read_text()) if file.is_file() else {}
    wanted = [row for row in rows if row not in answers]
    numbers = {row: place for place, row in enumerate([*PLAIN, *HELD_OUT, *SPECIMENS, CLOCK, *CUT])}
    faults = {**PLAIN, **HELD_OUT, **CUT, CLOCK: on_a_clock(asked.clock or asked.rate)}
    sound = draw(seed, records) if any(row in faults for row in wanted) else None
    for row in wanted:
        chance, fault = [seed, numbers[row]], faults.get(row, PLAIN["sound"])
        true = draw(seed, records, SPECIMENS[row])[0] if row in SPECIMENS else sound[0]
        told = fault(true, np.random.default_rng(chance))
        if asked.known:
            told = known_better(told, true, np.random.default_rng([*chance, 1]))
        if asked.vibration:
            told = from_free_vibration(told, true, np.random.default_rng([*chance, 2]))
        answers[row] = judge(
            told,
            exact=asked.exact,
            error_alone=asked.error,
            rate=asked.rate,
            linear=asked.linear,
            stated=stated_values(told, fault, chance, asked),
        )
        file.write_text(json.dumps(answers), encoding="utf-8")


def state(rows: pd.DataFrame) -> None:
    """Print a line for each row of the table."""
    for name, group in rows.groupby("row", sort=False):
        judged = group[group["word"] != "refused"]
        ratio = np.quantile(judged["value"] / judged["true"], [0.05, 0.95])
        held = (judged["low"] <= judged["true"]) & (judged["true"] <= judged["high"])
        ends = wilson_interval(int(held.sum()), len(held))
        bad, good = judged["true"] > THRESHOLD, judged["true"] < THRESHOLD
        accepted = int((bad & (judged["word"] == "reliable")).sum())
        refused = int((good & (judged["word"] == "not_reliable")).sum())
        print(
            f"{name:26} {len(judged)} tests: ratio {ratio[0]:.2f}–{ratio[1]:.2f}, "
            f"held {held.mean():.0%} ({ends[0]:.0%}–{ends[1]:.0%}), bad accepted {accepted} of {bad.sum()}, "
            f"good refused {refused} of {good.sum()}, "
            f"undecided {(judged['word'] == 'undecided').mean():.0%}, "
            f"width over true {((judged['high'] - judged['low']) / judged['true']).median():.2f}"
        )
        if name in SPECIMENS and "low_if_yielding" in judged:
            low, high = (
                judged[["low", IF_YIELDING[0]]].min(axis=1),
                judged[["high", IF_YIELDING[1]]].max(axis=1),
            )
            both = float(((low <= judged["true"]) & (judged["true"] <= high)).mean())
            print(f"{name!s:26} interval together with the errors if it yielded: held {both:.0%}")
    for name in ("sound", "ordinary", CLOCK):
        group = rows[rows["row"] == name]
        if group.empty:
            continue
        for low, high in ((0.01, 0.02), (0.02, 0.03), (0.03, 0.04), (0.04, 0.05)):
            inside = group[(group["true"] >= low) & (group["true"] < high)]
            reliable = (inside["word"] == "reliable").mean() if len(inside) else math.nan
            print(f"{name}, true error {low:.0%} to {high:.0%}: {reliable:.0%} of {len(inside)} reliable")


def main() -> None:
    """Judge tests and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--rows", nargs="*", default=[*PLAIN, *SPECIMENS])
    parser.add_argument("--records", type=Path, default=ROOT.parent / "shared/motions")
    parser.add_argument("--exact", action="store_true")
    for option in ("--error", "--linear", "--calibrated", "--known", "--vibration"):
        parser.add_argument(option, action="store_true")
    parser.add_argument("--rate", type=float, default=lab.RATE)
    parser.add_argument("--clock", type=float)
    parser.add_argument("--skew")
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    records = read_records(asked.records)
    files = {seed: asked.folder / f"test_{seed}.json" for seed in range(asked.seed, asked.seed + asked.count)}
    for seed, file in files.items():
        run_seed(seed, records, asked.rows, file, asked)
        print(seed, flush=True, file=sys.stderr)
    answers = [
        {"row": row, "seed": seed, **json.loads(file.read_text())[row]}
        for row in asked.rows
        for seed, file in files.items()
    ]
    state(pd.DataFrame(answers))


if __name__ == "__main__":
    main()
