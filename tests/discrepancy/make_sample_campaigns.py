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
    sealed = {}
    for name, (seed, options) in RECIPES.items():
        with tempfile.TemporaryDirectory() as scratch:
            whole = Path(scratch) / name
            label = generate(seed, whole, options=options)
            thin(whole, folder / name)
        sealed[name] = base64.b64encode(json.dumps(asdict(label)).encode()).decode()
    (folder / "labels.json").write_text(json.dumps(sealed, indent=1) + "\n", encoding="utf-8")


def thin(whole: Path, small: Path) -> None:
    """Write the first seconds of the first tests and of a held-out one, thinned to RATE_HZ."""
    small.mkdir(parents=True, exist_ok=True)
    text = (whole / "campaign.toml").read_text(encoding="utf-8")
    described = tomllib.loads(text)
    rate = described["sampling"]["rate_hz"]
    every = max(1, round(rate / RATE_HZ))
    tests = described["tests"]
    marked = [test for test in tests if test["held_out"]] or tests[-1:]
    others = [test for test in tests if test is not marked[0]]
    kept = [*others[: TESTS - 1], marked[0]]
    head = text.split("[[tests]]")[0].replace(f"rate_hz = {rate}", f"rate_hz = {rate / every:g}")
    entries = [
        f'[[tests]]\nfile = "{test["file"]}"\nmotion = "{test["motion"]}"\n'
        f"held_out = {str(test is marked[0]).lower()}\n"
        for test in kept
    ]
    (small / "campaign.toml").write_text(head + "\n".join(entries), encoding="utf-8")
    for test in kept:
        table = pd.read_csv(whole / test["file"]).iloc[: int(SECONDS * rate) + 1 : every]
        table.round(DIGITS).to_csv(small / test["file"], index=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "datasets" / "campaigns")
