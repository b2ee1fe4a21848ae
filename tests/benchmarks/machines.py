"""Measure `diagnose` on machines that are not made of the library's effects, restartable.

`python tests/benchmarks/machines.py FOLDER [--seed 1] [--count 2] [--machines NAME ...] [--pairs]` simulates
`--count` campaigns of each machine of `machine_models.py`, from `--seed` on, diagnoses each, keeps what was
found in FOLDER and prints the shares that matter: dominant effects named, or rightly called unknown; a false
name beside them; `named` only where at most 20 % of the worst kind of held-out test is unexplained; with
`--pairs` the held-out error beside that of the best pair of the library's effects, all of which are fitted.
What an expert calls each machine stands in `machine_models.py`, fixed before the first run.
"""

import itertools
import json
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from benchmark_script import argument_parser
from blind_evaluation import foretold
from machine_models import ALWAYS_ACCEPTED, MACHINES, STEP, Machine
from scipy import signal

from reliab.core.arrays import Array
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.fitting.fit import fit
from reliab.discrepancy.fitting.screening import screen_effects
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.proof import compute_nrmse
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis

THINNING = 5
"""Steps of the simulation in a sample: 400 Hz."""

DURATION = 10.0  # s
NOISE = 10.0 ** (-50.0 / 20.0)
LARGEST_REMAINDER = 0.2
CLOSE = 1.15
HELD_OUT = (4, 5)
PROBABILITIES = (0.0, 0.9, 0.99, 0.999, 1.0)


def motions_of(random: np.random.Generator) -> list[Array]:
    """Draw two irregular motions, a growing sine and a sweep to fit, an irregular one and a sine to judge."""
    time = np.arange(0.0, DURATION, STEP)
    peak, rise = random.uniform(0.02, 0.06), np.minimum(np.minimum(time, DURATION - time) / 1.0, 1.0)
    irregular = [_irregular(random, time) * rise for _ in range(3)]
    sines = [np.sin(2.0 * np.pi * random.uniform(0.6, 1.5) * time) for _ in range(2)]
    sweep = signal.chirp(time, 0.3, DURATION, 4.0, phi=-90.0) / np.linspace(1.0, 2.5, time.size)
    shapes = [
        irregular[0],
        0.5 * irregular[1],
        sines[0] * rise * np.linspace(0.1, 1.0, time.size),
        0.8 * sweep * rise,
        0.8 * irregular[2],
        random.uniform(0.4, 0.8) * sines[1] * rise,
    ]
    return [peak * shape for shape in shapes]


def _irregular(random: np.random.Generator, time: Array) -> Array:
    """Noise between 0.3 and 3 Hz with a peak of one."""
    band = signal.butter(3, (0.3, 3.0), btype="bandpass", fs=1.0 / STEP, output="sos")
    values = signal.sosfiltfilt(band, random.standard_normal(time.size))
    envelope = np.exp(-(((time - 4.0) / 3.0) ** 2))
    shape = np.asarray(values * envelope)
    return shape / np.abs(shape).max()


def simulate(machine: Machine, seed: int, folder: Path) -> None:
    """Write a campaign of a machine."""
    random = np.random.default_rng([seed, 36])
    motions = motions_of(random)
    answers, nominal = machine.answer(random, motions)
    names = ("command_m", "measured_m") if machine.actuator else ("measured_m", "force_n")
    text = 'name = "rig"\n'
    text += "[actuator]\ngain = 1.0\ndelay_s = 0.0\n" if machine.actuator else ""
    text += "".join(["[specimen]\n", *(f"{key} = {value!r}\n" for key, value in nominal.items())]) * (
        not machine.actuator
    )
    text += f"[sampling]\nrate_hz = {1.0 / STEP / THINNING!r}\n"
    for k, (motion, answer) in enumerate(zip(motions, answers, strict=True)):
        held_out = str(k in HELD_OUT).lower()
        text += f'[[tests]]\nfile = "test_{k}.csv"\nmotion = "{k}"\nheld_out = {held_out}\n'
        driven, read = motion[::THINNING].copy(), answer[::THINNING].copy()
        read += NOISE * read.std() * random.standard_normal(read.size)
        if not machine.actuator:
            driven += NOISE * driven.std() * random.standard_normal(driven.size)
        time_s = np.arange(driven.size) * STEP * THINNING
        np.savetxt(
            folder / f"test_{k}.csv",
            np.column_stack([time_s, driven, read]),
            delimiter=",",
            header=",".join(["time_s", *names]),
            comments="",
            fmt="%.9g",
        )
    (folder / "campaign.toml").write_text(text, encoding="utf-8")


def examine(name: str, seed: int, *, pairs: bool) -> dict[str, Any]:
    """Simulate and diagnose a campaign, and compare with what an expert says."""
    machine = MACHINES[name]
    with tempfile.TemporaryDirectory() as scratch:
        simulate(machine, seed, Path(scratch))
        begin = time.process_time()
        diagnosis = diagnose(read_campaign(Path(scratch)))
        spent = time.process_time() - begin
    (block,) = diagnosis.blocks
    row = {**judge_diagnosis(machine, diagnosis), "processor_seconds": spent}
    row["foretold"] = foretold(block)
    if pairs:
        begin = time.process_time()
        errors = errors_of_pairs(block)
        row["best_pair"] = min(errors.items(), key=lambda item: item[1])
        row["models"], row["pair_seconds"] = len(errors), time.process_time() - begin
    return row


def judge_diagnosis(machine: Machine, diagnosis: Diagnosis) -> dict[str, Any]:
    """Compare names and verdict with what an expert says of a machine."""
    (block,) = diagnosis.blocks
    names = [effect.name for effect in (*diagnosis.effects, *diagnosis.doubtful)]
    acceptable = frozenset().union(*machine.dominant) | machine.accepted | ALWAYS_ACCEPTED
    verdict = str(diagnosis.verdict)
    remainder = block.gap.worst_unexplained_share or 0.0
    right = all(group & set(names) for group in machine.dominant)
    return {
        "verdict": verdict,
        "names": names,
        "right": right or (machine.unknown and verdict == "unknown_effect"),
        "false": sorted(set(names) - acceptable),
        "unknown": None if diagnosis.unknown is None else diagnosis.unknown.to_dict(),
        "before": block.gap.before,
        "after": block.gap.after,
        "worst_unexplained": remainder,
        "overstated": verdict == "named" and remainder > LARGEST_REMAINDER,
        "probability": {effect.name: effect.probability for effect in diagnosis.effects},
    }


def errors_of_pairs(diagnosis: BlockDiagnosis) -> dict[str, float]:
    """Held-out error of each pair of effects of the library, and of each single one."""
    problem = diagnosis.problem
    null = diagnosis.calibrated
    singles = {}
    for effect in screen_effects(problem, null, diagnosis.block.candidates, null):
        if effect.start.size:
            space = ModelSpace(diagnosis.block, (effect.kind,))
            singles[effect.kind] = fit(problem, space, [effect.start, *effect.others], null.noise)
    errors = {}
    for kind, single in singles.items():
        errors[str(kind.name)] = compute_nrmse(diagnosis.proof, diagnosis.proof.residuals(single))
        for effect in screen_effects(problem, single, diagnosis.block.candidates, null):
            if effect.start.size and effect.kind not in single.space.effects:
                space = ModelSpace(diagnosis.block, (kind, effect.kind))
                pair = fit(problem, space, [effect.start, *effect.others], single.noise)
                error = compute_nrmse(diagnosis.proof, diagnosis.proof.residuals(pair))
                key = " + ".join(sorted((str(kind.name), str(effect.kind.name))))
                errors[key] = min(error, errors.get(key, np.inf))
    return errors


def show(rows: Mapping[str, Mapping[str, Any]]) -> None:
    """Print the shares over all campaigns."""
    results = list(rows.values())
    shares = {
        "dominant effect named, or rightly unknown": [row["right"] for row in results],
        "a false name beside it": [bool(row["false"]) for row in results],
        "named although more than 20 % of a kind of test is unexplained": [
            row["overstated"] for row in results
        ],
    }
    near_best = [row["after"] <= CLOSE * row["best_pair"][1] for row in results if "best_pair" in row]
    if near_best:
        shares["held-out error within 1.15 times that of the best pair"] = near_best
    for words, answers in shares.items():
        print(f"{words}: {sum(answers)} of {len(answers)}, {np.mean(answers):.0%}")
    for low, high in itertools.pairwise(PROBABILITIES):
        pairs = [
            (probability, name not in row["false"])
            for row in results
            for name, probability in row["probability"].items()
            if low <= probability < high or probability == high == PROBABILITIES[-1]
        ]
        if pairs:
            mean = np.mean([probability for probability, _ in pairs])
            right = sum(is_true for _, is_true in pairs)
            print(f"probability {low} to {high}, mean {mean:.3f}: {right} of {len(pairs)} are no false name")
    for number in range(4):
        covers = [test["covers"] for row in results for test in row["foretold"] if test["effects"] == number]
        if covers:
            print(
                f"error on a held-out test, {number} effects: {sum(covers)} of {len(covers)} intervals hold"
            )
    print_times("diagnosis", [row["processor_seconds"] for row in results])
    rows_with_pairs = [row for row in results if "pair_seconds" in row]
    if rows_with_pairs:
        models = np.median([row["models"] for row in rows_with_pairs])
        print_times(f"all pairs ({models:.0f} models)", [row["pair_seconds"] for row in rows_with_pairs])


def print_times(name: str, seconds: Sequence[float]) -> None:
    """Print processor time of something that was done in each campaign [s]."""
    print(f"processor time, {name}: {np.median(seconds):.0f} s in the median, {max(seconds):.0f} at most")


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argument_parser(__doc__, "folder", seed=1, count=2)
    parser.add_argument("--machines", nargs="*", default=list(MACHINES), choices=list(MACHINES))
    parser.add_argument("--pairs", action="store_true", help="fit all pairs of effects, which takes longer")
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    rows = {}
    for seed, name in itertools.product(range(options.seed, options.seed + options.count), options.machines):
        file = options.folder / f"{name}_{seed}.json"
        if not file.exists():
            file.write_text(json.dumps(examine(name, seed, pairs=options.pairs)), encoding="utf-8")
        rows[file.stem] = row = json.loads(file.read_text(encoding="utf-8"))
        mark = "right" if row["right"] and not row["false"] else "WRONG"
        comparison = (
            f", best pair {row['best_pair'][1]:.4f} ({row['best_pair'][0]})" if "best_pair" in row else ""
        )
        print(
            f"{file.stem}: {mark}: {row['verdict']} {', '.join(row['names'])}, {row['before']:.4f} → "
            f"{row['after']:.4f}{comparison} ({row['processor_seconds']:.0f} s)",
            flush=True,
        )
    show(rows)


if __name__ == "__main__":
    main()
