"""Make the folders of tests and the studies importable, as pytest does."""

import sys
from pathlib import Path

import reliab.study.description  # noqa: F401 - makes the studies importable

ROOT = Path(__file__).resolve().parents[2]
MOTIONS = ROOT.parent / "shared" / "motions"
sys.path[:0] = [str(ROOT / "tests" / folder) for folder in ("", "assessment", "desk", "rig")]
