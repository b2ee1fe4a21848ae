"""Write blind campaigns: `python tests/blind_campaigns/generate.py --seed 1 --count 20 --out FOLDER`."""

import argparse
import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from blind_campaigns.campaign import Options, generate
from blind_campaigns.case import Observation
from blind_campaigns.kinds import Kind
from blind_campaigns.labels import write_label
from blind_campaigns.motions import RecordFolder
from blind_campaigns.noise import KINDS

_SPACING = 1_000_003
"""Seeds of neighbouring batches do not meet: campaign i of seed s has the seed s·_SPACING + i."""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="generate.py", description=__doc__)
    parser.add_argument("--seed", type=int, required=True, help="seed of the batch")
    parser.add_argument("--count", type=int, default=1, help="number of campaigns")
    parser.add_argument(
        "--first", type=int, default=0, help="number of the first one, to resume or to split a batch"
    )
    parser.add_argument("--out", type=Path, required=True, help="campaigns go to OUT/campaigns/")
    parser.add_argument("--labels", type=Path, help="folder of the labels, OUT/labels/ unless given")
    parser.add_argument("--kind", choices=[str(kind) for kind in Kind], help="one kind only")
    parser.add_argument(
        "--effect", help="one effect only (with --kind single, faint, outside or one_channel)"
    )
    parser.add_argument(
        "--observation", choices=[str(one) for one in Observation], help="one way of observing only"
    )
    parser.add_argument("--noise", choices=KINDS, help="one kind of noise only")
    parser.add_argument("--snr", type=float, help="one signal-to-noise ratio only [dB]")
    parser.add_argument(
        "--records", type=Path, help="folder of real records (.AT2 or two-column .csv) to draw from"
    )
    parser.add_argument(
        "--without-rivals", action="store_true", help="leave the labels without rivals (faster)"
    )
    parser.add_argument("--fed-back-noise", action="store_true", help="the load cell's noise enters the loop")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    return parser


def _one(seed: int, number: int, out: Path, labels: Path, options: Options) -> str:
    """Write one campaign and say what it hides, or that its seed cannot be drawn."""
    name = f"campaign_{number:04d}"
    try:
        label = generate(seed * _SPACING + number, out / "campaigns" / name, options=options)
    except RuntimeError as error:
        return f"{name}  skipped: {error}"
    write_label(label, labels)
    effects = ", ".join(
        f"{effect['name']} {effect['effect_to_noise_db']:+.1f} dB" for effect in label.effects
    )
    noise = f"{label.noise['kind']:9s} {label.noise['snr_db']:4.0f} dB"
    return f"{name}  {label.kind:13s} {label.observation:22s} {noise}  {effects}"


def main(arguments: list[str] | None = None) -> None:
    """Run the command line."""
    given = _parser().parse_args(arguments)
    labels = given.labels or given.out / "labels"
    labels.mkdir(parents=True, exist_ok=True)
    options = Options(
        kind=Kind(given.kind) if given.kind else None,
        effect=given.effect,
        observation=Observation(given.observation) if given.observation else None,
        noise_kind=given.noise,
        snr_db=given.snr,
        records=RecordFolder(given.records) if given.records else None,
        with_rivals=not given.without_rivals,
        fed_back_noise=given.fed_back_noise,
    )
    numbers = range(given.first, given.first + given.count)
    if given.workers == 1:
        for number in numbers:
            sys.stdout.write(_one(given.seed, number, given.out, labels, options) + "\n")
            sys.stdout.flush()
        return
    with ProcessPoolExecutor(given.workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        jobs = [pool.submit(_one, given.seed, number, given.out, labels, options) for number in numbers]
        for job in as_completed(jobs):
            sys.stdout.write(job.result() + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
