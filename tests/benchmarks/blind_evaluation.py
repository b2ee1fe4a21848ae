"""Measure `diagnose` on blind campaigns that nobody has seen, restartable.

`python tests/benchmarks/blind_evaluation.py FOLDER [--seed 2000000] [--count 400] [--without-rivals]
[--variant NAME] [--kind KIND] [--effect EFFECT] [--observation NAME]` draws the campaigns of the seeds from
`--seed` on (of one kind, with one effect or observed in one way only, if one is given), changes them as the
variant says, diagnoses each, keeps labels and results in FOLDER, and writes FOLDER/figures.json, the table of
`tests/blind_campaigns/score.py` and how long it took. What is there already is not done again; several runs
may share the work, each with its own range of seeds.
"""

import json
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from benchmark_script import argument_parser  # noqa: E402
from benchmarks.campaign_variants import MIXED_VARIANT, NOISY_DB, VARIANTS, changes_of  # noqa: E402
from blind_campaigns.campaign import Options, generate  # noqa: E402
from blind_campaigns.case import Observation  # noqa: E402
from blind_campaigns.kinds import Kind  # noqa: E402
from blind_campaigns.labels import write_label  # noqa: E402
from blind_campaigns.scoring import main as score  # noqa: E402

from reliab.core.errors import InputError  # noqa: E402
from reliab.discrepancy.adding import add  # noqa: E402
from reliab.discrepancy.campaign.reading import read_campaign  # noqa: E402
from reliab.discrepancy.diagnose import diagnose  # noqa: E402
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis  # noqa: E402
from reliab.discrepancy.segment import energy_of  # noqa: E402

LIMIT = 10.0
"""Seconds that a campaign of five tests should take at most."""


def evaluate(seed: int, folder: Path, options: Options, *, variant: str | None = None) -> None:
    """Draw, diagnose and record the campaign of one seed; the measured data are thrown away."""
    name = f"campaign_{seed}"
    with tempfile.TemporaryDirectory() as scratch:
        campaign = Path(scratch) / name
        try:
            label = generate(seed, campaign, options=options)
        except RuntimeError as error:
            print(f"{name} cannot be drawn: {error}")
            return
        changes = changes_of(variant, seed, hidden=label.names)
        for change in changes:
            VARIANTS[change](campaign)
        result = {**answer(campaign), "changed": changes}
        shutil.rmtree(campaign)
    (folder / "results" / f"{name}.json").write_text(json.dumps(result), encoding="utf-8")
    write_label(label, folder / "labels")
    names = [effect["name"] for effect in result["effects"]]
    print(f"{name} {label.kind} {sorted(label.names)}: {result['verdict']} {names}", flush=True)


def answer(folder: Path) -> dict[str, Any]:
    """Diagnose a campaign; a campaign that is refused has the verdict `refused`."""
    begin, start_of_process = time.perf_counter(), time.process_time()
    try:
        diagnosis = diagnose(read_campaign(folder))
    except InputError as refusal:
        return {"verdict": "refused", "effects": [], "refusal": str(refusal)}
    result = diagnosis.to_dict()
    result["misstated"] = [item.name for block in diagnosis.blocks for item in block.misstated]
    result["either_misstated"] = [item.name for block in diagnosis.blocks for item in block.either_misstated]
    result["foretold"] = [row for block in diagnosis.blocks for row in foretold(block)]
    result["seconds"] = time.perf_counter() - begin
    add(diagnosis)
    result["seconds_with_posterior"] = time.perf_counter() - begin
    result["processor_seconds"] = time.process_time() - start_of_process
    return result


def foretold(diagnosis: BlockDiagnosis) -> list[dict[str, Any]]:
    """Compare the interval of the error on a further test with that on each held-out test.

    Both are those of the believed model, at the frequencies at which models are judged.
    """
    if diagnosis.further is None:
        return []
    proof, block = diagnosis.proof, diagnosis.proof.block
    predictions = proof.predictions(diagnosis.best.space, diagnosis.best.coordinates)
    rows = []
    for test in sorted({segment.test for segment in proof.segments}):
        residual = signal = 0.0
        for segment in (s for s in proof.segments if s.test == test):
            measured = segment.spectrum(proof.measured(test))
            residual += energy_of(measured - segment.coarse_spectrum(predictions[test], block.every))
            signal += energy_of(measured)
        error = (residual / signal) ** 0.5
        covers = diagnosis.further.low <= error <= diagnosis.further.high
        rows.append(
            {
                "block": str(block.block),
                "file": block.tests[test].file,
                "effects": len(diagnosis.best.space.effects),
                "error": error,
                "covers": covers,
                **diagnosis.further.to_dict(),
            }
        )
    return rows


def show_times(folder: Path) -> None:
    """Print how long campaigns took: wall and processor, reading and posterior included."""
    results = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))]
    for key in ("seconds", "seconds_with_posterior", "processor_seconds"):
        times = sorted(float(result[key]) for result in results if key in result)
        if times:
            shares = {q: times[min(int(q * len(times)), len(times) - 1)] for q in (0.5, 0.9, 0.95)}
            text = ", ".join(f"{q:.0%} within {value:.1f} s" for q, value in shares.items())
            share_in_time = sum(value <= LIMIT for value in times) / len(times)
            print(f"{key}: {text}, largest {times[-1]:.1f} s, {share_in_time:.0%} within {LIMIT:.0f} s")


def main() -> None:
    parser = argument_parser(__doc__, "folder", seed=2_000_000, count=400)
    parser.add_argument(
        "--without-rivals",
        action="store_true",
        help="Do not find out which other effects could pass for the hidden one: the same campaigns, faster.",
    )
    parser.add_argument(
        "--variant",
        choices=sorted([*VARIANTS, MIXED_VARIANT]),
        help="Change every campaign in this way.",
    )
    parser.add_argument(
        "--kind", choices=[str(kind) for kind in Kind], help="Draw campaigns of one kind only."
    )
    parser.add_argument("--effect", help="Hide this effect in every campaign of a single one.")
    parser.add_argument("--observation", choices=[str(item) for item in Observation], help="Observe so only.")
    options_of_command = parser.parse_args()
    options = Options(
        kind=None if options_of_command.kind is None else Kind(options_of_command.kind),
        effect=options_of_command.effect,
        snr_db=NOISY_DB if options_of_command.variant == "noisy" else None,
        with_rivals=not options_of_command.without_rivals,
        observation=None
        if options_of_command.observation is None
        else Observation(options_of_command.observation),
    )
    for part in ("labels", "results"):
        (options_of_command.folder / part).mkdir(parents=True, exist_ok=True)
    for seed in range(options_of_command.seed, options_of_command.seed + options_of_command.count):
        if not (options_of_command.folder / "labels" / f"campaign_{seed}.json").exists():
            evaluate(seed, options_of_command.folder, options, variant=options_of_command.variant)
    score(
        [
            *(str(options_of_command.folder / part) for part in ("labels", "results")),
            "--json",
            str(options_of_command.folder / "figures.json"),
        ]
    )
    show_times(options_of_command.folder / "results")


if __name__ == "__main__":
    main()
