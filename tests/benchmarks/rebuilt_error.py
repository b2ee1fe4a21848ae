"""Measure how good the rebuilt error is, on tests that share no code with the product.

`python tests/benchmarks/rebuilt_error.py PART [--count N] [--seed S] [--records FOLDER]` with a part of

history        noise-free history against the simulation, every actuator
noise          40 dB white noise, structure known: error within 2 %, accepted and refused at 5 %
coverage       90 % intervals and probabilities: random noise, wrong f (sd 1 %), ξ (10 %), scale (0.5 %)
levels         20 to 60 dB and quantised sensors, structure known
parameters     f, ξ and contradictions where ground acceleration (and force) are recorded at 40 dB
nonlinear      cubic, Coulomb, hysteresis: the model off by 1 % in each parameter, and none; false flags
monitor        time for a sample, distance from offline
time           offline, 40 s at 1024 Hz

Tests are simulated by `tests/rebuilt_error/laboratory.py` under the real records of FOLDER (a folder with a
catalog.csv, `../shared/motions` by default), each cut at random to 15 to 40 s.
"""

import argparse
import csv
import math
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from rebuilt_error import laboratory as lab  # noqa: E402

from reliab.loop.effects import find_effect  # noqa: E402
from reliab.loop.hybrid_test import HybridTest, Specimen  # noqa: E402
from reliab.loop.structure import Structure  # noqa: E402
from reliab.rebuilt_error import Tolerances, rebuild  # noqa: E402
from reliab.rebuilt_error.identification import identify  # noqa: E402
from reliab.rebuilt_error.monitor import Monitor  # noqa: E402
from reliab.rebuilt_error.nonlinear_reference import rebuild_with_specimen  # noqa: E402
from reliab.rebuilt_error.specimen_check import examine_specimen  # noqa: E402

STEP = 1.0 / lab.RATE
ACTUATORS = (lab.DELAY, lab.DELAY, lab.LAG, lab.RATE_LIMIT, lab.BACKLASH, lab.LEAD, lab.SECOND_ORDER)


class Records:
    """Ground motions, drawn at random."""

    def __init__(self, folder: Path, rng: np.random.Generator) -> None:
        with (folder / "catalog.csv").open(encoding="utf-8") as file:
            self.files = [folder / row["file"] for row in csv.DictReader(file)]
        self.rng = rng

    def draw(self) -> np.ndarray:
        """One record of 15 to 40 s."""
        ground = lab.read_at2(self.files[self.rng.integers(len(self.files))])
        return ground[: int(self.rng.uniform(15.0, 40.0) * lab.RATE)]


@dataclass(frozen=True)
class Sample:
    """A simulated test."""

    lab: lab.Lab
    outcome: lab.Outcome

    @property
    def structure(self) -> Structure:
        """The structure as it is."""
        return Structure(
            frequency=self.lab.f, damping_ratio=self.lab.xi, experimental_fraction=self.lab.alpha
        )


def samples(records: Records, rng: np.random.Generator, low: float, high: float) -> Iterator[Sample]:
    """Tests of random structures and actuators whose RMS^R lies in a range."""
    while True:
        ground = records.draw()
        f, xi = math.exp(rng.uniform(math.log(0.4), math.log(2.5))), rng.uniform(0.02, 0.08)
        alpha = 1.0 if rng.uniform() < 0.5 else rng.uniform(0.3, 1.0)
        plain = lab.Lab(f, xi, alpha)
        peak = float(np.abs(lab.run(plain, ground).ideal).max())
        if not peak > 0.0:
            continue
        built = replace(plain, kind=int(rng.choice(ACTUATORS)))
        outcome = lab.run(replace(built, numbers=numbers(built, peak, rng)), ground)
        if np.isfinite(outcome.rms) and low < outcome.rms < high:
            yield Sample(built, outcome)


def numbers(built: lab.Lab, peak: float, rng: np.random.Generator) -> tuple[float, float, float, float]:
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
    }[built.kind]


def read(outcome: lab.Outcome, kind: str, decibels: float, rng: np.random.Generator) -> np.ndarray:
    """Measured displacement with noise so many decibels below it."""
    level = 10.0 ** (-decibels / 20.0) * float(np.sqrt(np.mean(outcome.measured**2)))
    if kind == "quantised":
        return lab.quantised(outcome.measured, level, rng)
    return outcome.measured + lab.noise(kind, outcome.measured.size, level, rng)


def share(values: list[bool] | np.ndarray) -> str:
    """Share of truths with its count and standard error."""
    rate = float(np.mean(values))
    return f"{rate:.1%} of {len(values)} (± {math.sqrt(max(rate * (1 - rate), 1e-9) / len(values)):.1%})"


def history(records: Records, rng: np.random.Generator, count: int) -> None:
    """Noise-free histories."""
    off: dict[int, list[float]] = {}
    for _, test in zip(range(count), samples(records, rng, 0.002, 1.0), strict=False):
        o = test.outcome
        rebuilt = rebuild(o.command, o.measured, STEP, test.structure, draws=2)
        true = o.measured - o.ideal
        off.setdefault(test.lab.kind, []).append(
            float(np.sqrt(np.mean((rebuilt.error - true) ** 2) / np.mean(true**2)))
        )
    for kind, values in sorted(off.items()):
        print(f"actuator {kind}: relative RMS at most {max(values):.1e} over {len(values)} tests")


def noise(records: Records, rng: np.random.Generator, count: int) -> None:
    """40 dB, structure known."""
    ratios, mtes, wrongly, rightly = [], [], [], []
    for _, test in zip(range(count), samples(records, rng, 0.01, 0.2), strict=False):
        o = test.outcome
        rebuilt = rebuild(o.command, read(o, "white", 40.0, rng), STEP, test.structure, draws=64)
        ratios.append(rebuilt.rms.value / o.rms)
        mtes.append(rebuilt.mte.value / o.mte)
        accepted = rebuilt.rms.value < 0.05
        if o.rms > 0.05 * 1.03:
            wrongly.append(accepted)
        elif o.rms < 0.05 * 0.97:
            rightly.append(accepted)
    print(f"RMS^R within 2 %: {share(np.abs(np.array(ratios) - 1.0) < 0.02)}")
    print(f"MTE^R within 2 %: {share(np.abs(np.array(mtes) - 1.0) < 0.02)}")
    print(f"at 5 %: bad accepted {share(wrongly)}; good accepted {share(rightly)}")


def coverage(records: Records, rng: np.random.Generator, count: int) -> None:
    """90 % intervals and probabilities under everything at once."""
    kinds = ("white", "slow", "quantised", "mains")
    inside: dict[str, list[tuple[bool, bool]]] = {kind: [] for kind in kinds}
    stated, true = [], []
    tolerances = Tolerances(frequency=0.01, damping_ratio=0.1, sensor_scale=0.005)
    for _, test in zip(range(count), samples(records, rng, 0.01, 0.2), strict=False):
        o, kind = test.outcome, kinds[rng.integers(4)]
        measured = read(o, kind, rng.uniform(30.0, 60.0), rng) * (1.0 + 0.005 * rng.normal())
        wrong = Structure(
            frequency=test.lab.f * (1.0 + 0.01 * rng.normal()),
            damping_ratio=test.lab.xi * (1.0 + 0.1 * rng.normal()),
            experimental_fraction=test.lab.alpha,
        )
        rebuilt = rebuild(o.command, measured, STEP, wrong, tolerances=tolerances)
        inside[kind].append(
            (rebuilt.rms.low <= o.rms <= rebuilt.rms.high, rebuilt.mte.low <= o.mte <= rebuilt.mte.high)
        )
        stated.append(rebuilt.probability(0.05))
        true.append(o.rms < 0.05)
    inside["all"] = [pair for pairs in inside.values() for pair in pairs]
    for kind, pairs in inside.items():
        if pairs:
            rms, mte = zip(*pairs, strict=True)
            print(f"{kind:10} RMS^R {share(list(rms))}, MTE^R {share(list(mte))}")
    edges = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)
    for low, high in pairwise(edges):
        chosen = [k for k, p in enumerate(stated) if low <= p < high]
        if chosen:
            mean, rate = np.mean([stated[k] for k in chosen]), np.mean([true[k] for k in chosen])
            print(f"stated {mean:.3f}, true {rate:.3f} ({len(chosen)} tests)")


def levels(records: Records, rng: np.random.Generator, count: int) -> None:
    """Noise of 20 to 60 dB."""
    for kind in ("white", "quantised"):
        for decibels in (20.0, 30.0, 40.0, 50.0, 60.0):
            ratios, inside = [], []
            for _, test in zip(range(count), samples(records, rng, 0.01, 0.2), strict=False):
                o = test.outcome
                rebuilt = rebuild(o.command, read(o, kind, decibels, rng), STEP, test.structure, draws=64)
                ratios.append(rebuilt.rms.value / o.rms)
                inside.append(rebuilt.rms.low <= o.rms <= rebuilt.rms.high)
            ends = np.quantile(ratios, [0.05, 0.5, 0.95])
            print(
                f"{kind} {decibels:.0f} dB: ratio {ends.round(3).tolist()} (5, 50, 95 %), "
                f"inside {share(inside)}"
            )


def parameters(records: Records, rng: np.random.Generator, count: int) -> None:
    """f, ξ and contradictions."""
    for with_force in (True, False):
        off, reported, contradicted = [], [], []
        for _, test in zip(range(count), samples(records, rng, 0.002, 0.3), strict=False):
            o = test.outcome
            channels = [
                values + lab.noise("white", values.size, 0.01 * float(np.std(values)), rng)
                for values in (o.measured, o.ground, o.force)
            ]
            measured, ground, force = channels
            for factor in (1.0, float(rng.choice([0.98, 1.02]))):
                stated = replace(test.structure, frequency=factor * test.lab.f)
                found = identify(
                    *(o.command, measured, ground, STEP, stated), force=force if with_force else None
                )
                says = "frequency" in found.disagreements()
                (contradicted if factor == 1.0 else reported).append(says)
            off.append(
                (found.frequency.value / test.lab.f - 1.0, found.damping_ratio.value / test.lab.xi - 1.0)
            )
        f, xi = np.abs(np.array(off)).T
        print(
            f"force {'recorded' if with_force else 'absent'}: f within 0.2 % {share(f < 0.002)}, "
            f"ξ within 5 % {share(xi < 0.05)}; f wrong by 2 % reported {share(reported)}, "
            f"right f contradicted {share(contradicted)}"
        )


def nonlinear(records: Records, rng: np.random.Generator, count: int) -> None:
    """Nonlinear specimens with and without a model."""
    for kind in (lab.LINEAR, lab.CUBIC, lab.COULOMB, lab.HYSTERESIS):
        flagged, ratios, linear, inside = [], [], [], []
        while len(flagged) < count:
            ground = records.draw()
            f, xi = math.exp(rng.uniform(math.log(0.5), math.log(2.0))), rng.uniform(0.02, 0.05)
            w0, k = 2.0 * math.pi * f, (2.0 * math.pi * f) ** 2
            peak = float(np.abs(lab.run(lab.Lab(f, xi), ground).ideal).max())
            shape, test, deviations = specimen(kind, k, w0, peak, f, xi, rng)
            tau = 2.0 * xi / w0 * rng.uniform(0.05, 0.3)
            o = lab.run(lab.Lab(f, xi, 1.0, lab.DELAY, (1.0 - 0.1 * xi, tau, 0.0, 0.0), kind, shape), ground)
            if not (np.isfinite(o.rms) and 0.01 < o.rms < 0.2):
                continue
            measured = read(o, "white", 40.0, rng)
            force = o.force + lab.noise("white", o.force.size, 0.01 * float(np.std(o.force)), rng)
            plain = rebuild(o.command, measured, STEP, Structure(frequency=f, damping_ratio=xi), draws=2)
            flagged.append(examine_specimen(plain.histories.measured, force, STEP, f).nonlinear)
            linear.append(plain.rms.value / o.rms)
            if test is not None:
                found = rebuild_with_specimen(o.command, measured, STEP, test, deviations=deviations)
                ratios.append(found.rms.value / o.rms)
                inside.append(found.rms.low <= o.rms <= found.rms.high)
        print(f"specimen {kind}: flagged {share(flagged)}, linear ratio {np.median(linear):.2f} (median)")
        if ratios:
            print(
                f"  with a model: within 10 % {share(np.abs(np.array(ratios) - 1.0) < 0.1)}, "
                f"inside {share(inside)}"
            )


def specimen(
    kind: int, k: float, w0: float, peak: float, f: float, xi: float, rng: np.random.Generator
) -> tuple[tuple[float, float, float], HybridTest | None, dict[str, float]]:
    """Numbers of a specimen, and a model of it that is off by 1 % in each parameter."""
    structure, off = Structure(frequency=f, damping_ratio=xi), 1.0 + 0.01 * rng.standard_normal(4)
    if kind == lab.CUBIC:
        shape = (rng.uniform(0.1, 0.5) / peak**2, 0.0, 0.0)
        effect = find_effect("cubic_stiffness")
        name = effect.parameters[0].name
        effects, stiffness = effect(**{name: k * shape[0] * off[1]}), k
        stated = {f"cubic_stiffness.{name}": 0.01 * k * shape[0]}
    elif kind == lab.COULOMB:
        shape = (rng.uniform(0.02, 0.1) * k * peak, 0.02 * w0 * peak, 0.0)
        effects = find_effect("coulomb_friction")(
            force_n=shape[0] * off[1], regularisation_velocity_m_per_s=shape[1] * off[2]
        )
        stiffness, stated = k, {"coulomb_friction.force_n": 0.01 * shape[0]}
        stated["coulomb_friction.regularisation_velocity_m_per_s"] = 0.01 * shape[1]
    elif kind == lab.HYSTERESIS:
        shape = (rng.uniform(0.2, 0.5) * peak, rng.uniform(0.1, 0.5), 2.0)
        stiffness, force = shape[1] * k, (1.0 - shape[1]) * k * shape[0]
        effects = find_effect("hysteresis")(
            force_n=force * off[1], displacement_m=shape[0] * off[2], gamma=0.5, exponent=2.0, lost_share=0.0
        )
        stated = {"hysteresis.force_n": 0.01 * force, "hysteresis.displacement_m": 0.01 * shape[0]}
    else:
        return (0.0, 0.0, 0.0), None, {}
    stated["stiffness_n_per_m"] = 0.01 * stiffness
    test = HybridTest(
        structure=structure, specimen=Specimen(stiffness=stiffness * off[0]), effects=(effects,)
    )
    return shape, test, stated


def monitor(records: Records, rng: np.random.Generator, count: int) -> None:
    """Time for a sample with all intervals that `reliab monitor` asks for, and distance from offline."""
    test = next(samples(records, rng, 0.01, 0.2))
    o = test.outcome
    measured = read(o, "white", 40.0, rng)
    tolerances = Tolerances(frequency=0.01, damping_ratio=0.1, sensor_scale=0.005)
    whole = rebuild(o.command, measured, STEP, test.structure, tolerances=tolerances)
    for _ in range(count):
        follow = Monitor(test.structure, STEP, tolerances=tolerances)
        chunk = 64
        follow.feed(o.command[:chunk], measured[:chunk])
        begin = time.process_time()
        for first in range(chunk, o.command.size, chunk):
            follow.feed(o.command[first : first + chunk], measured[first : first + chunk])
            if follow.due:
                follow.ask()
        spent = (time.process_time() - begin) / (o.command.size - chunk)
        last = follow.ask(draws=256)
        off = np.abs(follow.error - whole.error).max() / np.abs(whole.error).max()
        print(
            f"{1e6 * spent:.1f} µs of processor a sample, history off by {off:.1e}, "
            f"RMS^R by {abs(last.rms.value / whole.rms.value - 1.0):.1e}, its high end by "
            f"{abs(last.rms.high / whole.rms.high - 1.0):.1e}"
        )


def offline(records: Records, rng: np.random.Generator, count: int) -> None:
    """Processor time of one rebuilding with intervals, and of what widens them."""
    tolerances = Tolerances(frequency=0.01, damping_ratio=0.1, sensor_scale=0.005)
    for _, test in zip(range(count), samples(records, rng, 0.01, 0.2), strict=False):
        o = test.outcome
        measured = read(o, "white", 40.0, rng)
        begin = time.process_time()
        rebuilt = rebuild(o.command, measured, STEP, test.structure, tolerances=tolerances)
        between = time.process_time()
        rebuilt.widenings()
        widened = time.process_time() - between
        print(f"{o.command.size} samples: {between - begin:.3f} s, widenings {widened:.3f} s")


PARTS = {
    "history": (history, 60),
    "noise": (noise, 200),
    "coverage": (coverage, 300),
    "levels": (levels, 20),
    "parameters": (parameters, 60),
    "nonlinear": (nonlinear, 20),
    "monitor": (monitor, 2),
    "time": (offline, 3),
}


def main() -> None:
    """Run one part."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--count", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--records", type=Path, default=ROOT.parent / "shared" / "motions")
    chosen = parser.parse_args()
    measure, count = PARTS[chosen.part]
    rng = np.random.default_rng(chosen.seed)
    measure(Records(chosen.records, rng), rng, chosen.count or count)


if __name__ == "__main__":
    main()
