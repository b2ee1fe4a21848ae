"""Measure `diagnose` where no model is exact, restartable.

`python tests/benchmarks/imperfect_worlds.py FOLDER --seed S --count N` draws the worlds of the seeds from S
on (`tests/imperfect_worlds`), diagnoses each, predicts a further test with the model that it names, keeps an
answer for each seed in FOLDER, and prints: how often the dominant effect is named, how often a false name
stands beside it, how often stated probabilities are true, and how often the stated 90 % interval of the
error holds the error on the further test. Probabilities are those of named effects, of effects in doubt and
of their rivals; FOLDER/reliability.png draws them; `--table FILE.csv` writes a row for each world. What is
there already is not done again.
"""

import json
import tempfile
import time
from collections import Counter
from dataclasses import asdict, replace
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the worlds importable
from benchmark_script import argument_parser
from blind_campaigns.scoring import wilson_interval
from imperfect_worlds.world import FURTHER, RATE, write_world

from reliab.discrepancy.blocks.actuator import ActuatorBlock
from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.campaign.campaign import Campaign, MeasuredTest, Stretch
from reliab.discrepancy.campaign.reading import read_campaign, read_channels
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.segment import cut_segments, motions_of
from reliab.recordings.recording import StatedChannels
from reliab.study.description import PACKAGE

OFFSETS = {"sensor_bias", "force_bias"}
BINS = (0.0, 0.05, 0.2, 0.5, 0.8, 0.95, 1.001)


def evaluate(seed: int, folder: Path) -> None:
    """Draw, diagnose and record the world of one seed."""
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch)
        world = write_world(path, seed)
        begin, start_of_process = time.perf_counter(), time.process_time()
        campaign = read_campaign(path)
        diagnosis = diagnose(campaign)
        seconds, processor = time.perf_counter() - begin, time.process_time() - start_of_process
        further_test = MeasuredTest(
            file=FURTHER,
            motion="further",
            held_out=True,
            channels=read_channels(path / FURTHER, RATE, StatedChannels())[0],
        )
    block = diagnosis.blocks[0]
    result = {
        "world": asdict(world),
        "verdict": str(diagnosis.verdict),
        "effects": [{"name": e.name, "probability": e.probability} for e in diagnosis.effects],
        "doubtful": [e.name for e in diagnosis.doubtful],
        "stated": largest_probabilities(diagnosis),
        "unknown": None if diagnosis.unknown is None else diagnosis.unknown.expression,
        "gap": diagnosis.gap.to_dict(),
        "expected": None if block.further is None else block.further.to_dict(),
        "error": error_on(block, replace(campaign, tests=(*campaign.tests, further_test))),
        "structured_share": block.structured_share,
        "seconds": seconds,
        "processor_seconds": processor,
    }
    (folder / f"world_{seed}.json").write_text(json.dumps(result), encoding="utf-8")
    names = [effect.name for effect in diagnosis.effects]
    print(f"{seed} {world.name} {world.model_error:.2f}: {diagnosis.verdict} {names}", flush=True)


def error_on(diagnosis: BlockDiagnosis, campaign: Campaign) -> float:
    """Error of the best model on a campaign's last test, RMS over that of the signal, judged frequencies."""
    last = len(campaign.tests) - 1
    if isinstance(diagnosis.block, ActuatorBlock):
        block = ActuatorBlock(campaign, diagnosis.block.scales)
    else:
        block = SpecimenBlock(campaign, diagnosis.block.scales, motions_of(campaign), is_smoothed=True)
    stretch = Stretch(test=last, begin=0, end=campaign.tests[last].size)
    segment = cut_segments((stretch,) * 3, campaign.rate, lambda _: diagnosis.block.highest)[0]
    model = diagnosis.best.space.model(diagnosis.best.coordinates)
    measured = block.measured(last)
    residual = segment.spectrum(measured) - segment.spectrum(block.predict(model, last))
    return float(np.linalg.norm(residual) / np.linalg.norm(segment.spectrum(measured)))


def largest_probabilities(diagnosis: Diagnosis) -> dict[str, float]:
    """Largest stated probability by name, of effects and of their rivals; offsets are left out."""
    probabilities: dict[str, float] = {}
    for effect in (*diagnosis.effects, *diagnosis.doubtful):
        for item in (effect, *effect.rivals):
            if not {effect.name, item.name} & OFFSETS:  # type: ignore[attr-defined]
                probabilities[item.name] = max(probabilities.get(item.name, 0.0), item.probability)  # type: ignore[attr-defined]
    return probabilities


def pair_with_truth(probabilities: dict[str, float], names_accepted: set[str]) -> list[tuple[float, bool]]:
    """Stated probabilities, and whether they are true; of several accepted names the most probable counts."""
    first = max((p for name, p in probabilities.items() if name in names_accepted), default=None)
    wrong = [(p, False) for name, p in probabilities.items() if name not in names_accepted]
    return wrong if first is None else [*wrong, (first, True)]


def draw(pairs: list[tuple[float, bool]], path: Path) -> None:
    """Draw how often what was stated with a probability was true."""
    rows = []
    for low, high in pairwise(BINS):
        band = [(p, true) for p, true in pairs if low <= p < high]
        if band:
            count = sum(true for _, true in band)
            ends = wilson_interval(count, len(band))
            rows.append(
                {
                    "mean_stated": float(np.mean([p for p, _ in band])),
                    "share": count / len(band),
                    "low": ends[0],
                    "high": ends[1],
                    "of": len(band),
                }
            )
    if rows:
        pages = import_module(f"{PACKAGE}.blind_evaluation.report")
        pages.discrepancy_reliability(pd.DataFrame(rows)).savefig(path, dpi=200)


def share(answers: list[bool]) -> str:
    """Count, share and its 95 % interval as text."""
    low, high = wilson_interval(sum(answers), len(answers))
    return (
        f"{sum(answers)}/{len(answers)} = {np.mean(answers):.1%} ({low:.1%} to {high:.1%})"
        if answers
        else "none"
    )


def read_results(folder: Path) -> dict[int, dict[str, Any]]:
    """Answers of a folder by seed."""
    return {
        int(path.stem.removeprefix("world_")): json.loads(path.read_text(encoding="utf-8"))
        for path in sorted(folder.glob("world_*.json"))
    }


def table(folder: Path) -> pd.DataFrame:
    """One row for each world of a folder."""
    return pd.DataFrame(
        {
            "seed": seed,
            "world": result["world"]["name"],
            "model_error": result["world"]["model_error"],
            "accepted": " ".join(result["world"]["accepted"]),
            "verdict": result["verdict"],
            "named": " ".join(effect["name"] for effect in result["effects"]),
            "error": result["error"],
            **{f"error_{end}": (result["expected"] or {}).get(end) for end in ("low", "high")},
        }
        for seed, result in read_results(folder).items()
    )


def show(folder: Path) -> None:
    """Print all rates of what is in a folder."""
    results = list(read_results(folder).values())
    names = [[e["name"] for e in result["effects"]] for result in results]
    names_accepted = [set(result["world"]["accepted"]) for result in results]
    dominant = [bool(set(n) & a) for n, a in zip(names, names_accepted, strict=True)]
    false = [bool(set(n) - a - OFFSETS) for n, a in zip(names, names_accepted, strict=True)]
    offsets = [bool(set(n) & OFFSETS) for n in names]
    print(f"{len(results)} worlds, model error {min(r['world']['model_error'] for r in results):.2f} to"
          f" {max(r['world']['model_error'] for r in results):.2f} of the signal")  # fmt: skip
    print(f"dominant effect named: {share(dominant)}")
    print(f"a false name: {share(false)}; a false offset: {share(offsets)}")
    print("verdicts:", dict(Counter(result["verdict"] for result in results)))
    pairs = [
        pair
        for result, a in zip(results, names_accepted, strict=True)
        for pair in pair_with_truth(result["stated"], a)
    ]
    draw(pairs, folder / "reliability.png")
    for low, high in pairwise(BINS):
        band = [true for p, true in pairs if low <= p < high]
        if band:
            print(f"  stated {low:.2f} to {min(high, 1.0):.2f}: true {share(band)}")
    are_covered = [
        result["expected"]["low"] <= result["error"] <= result["expected"]["high"]
        for result in results
        if result["expected"]
    ]
    print(f"90 % intervals hold the error on a further test: {share(are_covered)}")
    closed_fractions = [result["gap"]["closed_fraction"] for result in results]
    print("closed fractions within [0, 1]:", all(c is None or 0.0 <= c <= 1.0 for c in closed_fractions))
    for key in ("seconds", "processor_seconds"):
        times = np.quantile([result[key] for result in results], (0.5, 0.9, 0.95, 1.0))
        print(
            f"{key}: median {times[0]:.1f}, 90 % {times[1]:.1f}, 95 % {times[2]:.1f}, largest {times[3]:.1f}"
        )
    rows = zip(results, dominant, false, names, strict=True)
    for result, right, wrong, names_of_world in rows:
        if not right or wrong:
            world, verdict = result["world"], result["verdict"]
            print(f"  {world['name']} {world['model_error']:.2f}: {verdict} {names_of_world}")


def main() -> None:
    parser = argument_parser(__doc__, "folder", seed=0, count=200)
    parser.add_argument("--table", type=Path, help="CSV with a row for each world of FOLDER")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for seed in range(options.seed, options.seed + options.count):
        if not (options.folder / f"world_{seed}.json").exists():
            evaluate(seed, options.folder)
    show(options.folder)
    if options.table is not None:
        table(options.folder).to_csv(options.table, index=False, float_format="%.4g")


if __name__ == "__main__":
    main()
