"""Tests of a rig made without histories, for what needs only their indices."""

import hashlib

import numpy as np
import xarray as xr

from reliab.rig.rig_folder import RigFolder, RigTable, RigTest, sort_table

RECORD = xr.Dataset({"measured": (("actuator", "time"), np.zeros((1, 4)))})


def rig_test(number, **changes):
    """One test; what is not stated is the same for all."""
    numbers = """f 1 xi 0.02 alpha 1 threshold 0.05 probability 0.99 A 0.99 d_ms 2 f_eq_hz 1
    remainder 0.01 rms 0.03 rms_low 0.02 rms_high 0.04 mte 0.08 peak_mm 50 velocity_mm_s 300
    own_a 0.06 own_b_ms2 1400 duration_s 40"""
    words = numbers.split()
    values = {
        **{name: float(value) for name, value in zip(words[::2], words[1::2], strict=True)},
        "sha256": hashlib.sha256(str(number).encode()).hexdigest(),
        "name": f"test_{number}.csv",
        "file": f"test_{number}.csv",
        "added": f"2026-01-01T00:00:00.{number:06d}",
        "verdict": "reliable",
        "reliable": True,
        **changes,
    }
    return RigTest(**values)


def keep(folder, *tests):
    """Put tests into a rig's folder."""
    for test in tests:
        RigFolder(folder).add(test, RECORD, {"reasons": []}, {"f": "1"})


def rig_table(tests) -> RigTable:
    """Table of tests that lie in no folder."""
    flat = []
    for test in tests:
        row = test.to_dict()
        flat.append({**row, **row.pop("covariates")})
    return sort_table(flat)
