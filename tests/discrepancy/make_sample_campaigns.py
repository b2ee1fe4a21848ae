"""Make datasets/campaigns: `python tests/discrepancy/make_sample_campaigns.py [FOLDER]`.

Three blind campaigns on synthetic motions, thinned to what a repository can hold: three tests of 20 s at
about 500 Hz, rounded. The labels are written apart, encoded, so that nobody reads them by accident.
"""

import base64
import json
import sys
import tempfile
import tomllib
from dataclasses import asdict
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from blind_campaigns.campaign import Options, generate  # noqa: E402
from blind_campaigns.case import Observation  # noqa: E402
from blind_campaigns.kinds import Kind  # noqa: E402

SECONDS, TESTS, RATE_HZ = 20.0, 3, 500.0
DIGITS = {"time_s": 7, "ground_acceleration_mps2": 6, "command_m": 10, "measured_m": 8, "force_n": 3}
RECIPES = {
    "rig_a": (
        31,
        Options(
            kind=Kind.SINGLE,
            effect="coulomb_friction",
            observation=Observation.FULL,
            noise_kind="coloured",
            snr_db=38.0,
        ),
    ),
    "rig_b": (
        41,
        Options(kind=Kind.MISCALIBRATED, observation=Observation.FULL, noise_kind="mixture", snr_db=35.0),
    ),
    "rig_c": (
        53,
        Options(
            kind=Kind.OUTSIDE,
            effect="one_sided_spring",
            observation=Observation.FULL,
            noise_kind="white",
            snr_db=40.0,
        ),
    ),
}


def main(folder: Path) -> None:
    """Write all campaigns and their labels."""
    labels = {}
    for name, (seed, options) in RECIPES.items():
        with tempfile.TemporaryDirectory() as scratch:
            source = Path(scratch) / name
            label = generate(seed, source, options=options)
            thin(source, folder / name)
        labels[name] = base64.b64encode(json.dumps(asdict(label)).encode()).decode()
    (folder / "labels.json").write_text(json.dumps(labels, indent=1) + "\n", encoding="utf-8")


def thin(source: Path, small: Path) -> None:
    """Write the first seconds of the first tests and of a held-out one, thinned to RATE_HZ."""
    small.mkdir(parents=True, exist_ok=True)
    text = (source / "campaign.toml").read_text(encoding="utf-8")
    description = tomllib.loads(text)
    rate = description["sampling"]["rate_hz"]
    thinning = max(1, round(rate / RATE_HZ))
    tests = description["tests"]
    held_out_tests = [test for test in tests if test["held_out"]] or tests[-1:]
    fitted_tests = [test for test in tests if test is not held_out_tests[0]]
    selected_tests = [*fitted_tests[: TESTS - 1], held_out_tests[0]]
    head = text.split("[[tests]]")[0].replace(f"rate_hz = {rate}", f"rate_hz = {rate / thinning:g}")
    entries = [
        f'[[tests]]\nfile = "{test["file"]}"\nmotion = "{test["motion"]}"\n'
        f"held_out = {str(test is held_out_tests[0]).lower()}\n"
        for test in selected_tests
    ]
    (small / "campaign.toml").write_text(head + "\n".join(entries), encoding="utf-8")
    for test in selected_tests:
        table = pd.read_csv(source / test["file"]).iloc[: int(SECONDS * rate) + 1 : thinning]
        table.round(DIGITS).to_csv(small / test["file"], index=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "datasets" / "campaigns")
