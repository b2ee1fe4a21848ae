"""Diagnose every campaign of a folder, and compare with what is known of it and with the last run.

`python tests/benchmarks/real_campaigns.py FOLDER [--table FILE.json]` diagnoses each folder of FOLDER that
holds a campaign.toml, one after the other, and prints for each: verdict, names, which of them are expected,
missing or false, and the error on every held-out test (RMS over that of the signal) beside that of a
reference, a linear filter of 0.5 s that is fitted to the same training tests by least squares and knows no
physics. FILE.json (FOLDER/table.json unless given, never part of the project) holds the last run; what has
changed since is printed, and then the run takes its place.

TRUTH.json in the folder of a campaign, where there is one, says what an expert calls the machine::

    {"effects": ["hysteresis"], "accepted": ["force_bias"], "verdicts": ["named"], "errors": {"a.csv": 0.11}}

`effects` must be named, `accepted` may stand beside them, any other name is false; `verdicts` are right ones;
`errors` are those of the best model that anybody has found, and stand in the place of the linear filter's.
"""

import argparse
import json
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis

FILTER_LENGTH = 0.5
"""Time that the linear filter of the reference remembers [s]."""

COEFFICIENTS = 60
NOTICEABLE = 0.02
"""Relative change of an error that is a change."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a run says of one campaign."""

    verdict: str
    names: tuple[str, ...] = ()  # Of effects, sorted
    missing: tuple[str, ...] = ()  # missing, false: Names, where it is known what the machine is
    false: tuple[str, ...] = ()
    # By block and file: error of the calibrated model, of the best one, and of the reference
    errors: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    processor_seconds: float = 0.0


def examined(folder: Path) -> Row:
    """Diagnose a campaign and compare with what is known of it."""
    worked = time.process_time()
    try:
        diagnosis = diagnose(read_campaign(folder))
    except InputError as refusal:
        return Row(verdict=f"refused: {refusal}")
    spent = time.process_time() - worked
    truth = folder / "TRUTH.json"
    known: dict[str, Any] | None = json.loads(truth.read_text(encoding="utf-8")) if truth.exists() else None
    names = {effect.name for effect in (*diagnosis.effects, *diagnosis.doubtful)}
    wanted = names if known is None else set(known.get("effects", []))
    allowed = names if known is None else wanted | set(known.get("accepted", []))
    verdict = str(diagnosis.verdict)
    if known is not None and verdict not in known.get("verdicts", [verdict]):
        verdict += " (wrong)"
    return Row(
        verdict=verdict,
        names=tuple(sorted(names)),
        missing=tuple(sorted(wanted - names)),
        false=tuple(sorted(names - allowed)),
        errors=errors_of(diagnosis, {} if known is None else known.get("errors", {})),
        processor_seconds=spent,
    )


def errors_of(diagnosis: Diagnosis, best_known: Mapping[str, float]) -> dict[str, tuple[float, float, float]]:
    """Errors of every held-out test, by block and file, the least explained first."""
    errors = {}
    for block in diagnosis.blocks:
        reference = errors_of_filter(block)
        for gap in block.gap.by_test:
            (file,) = gap.files
            beside = float(best_known.get(file, reference.get(file, float("nan"))))
            errors[f"{block.block.block} {file}"] = (gap.before, gap.after, beside)
    return errors


def errors_of_filter(found: BlockDiagnosis) -> dict[str, float]:
    """Errors of a linear filter of the input that was fitted to the training tests, by held-out file."""
    block = found.block
    every = max(1, round(FILTER_LENGTH * block.rate / COEFFICIENTS))
    training = {segment.test for segment in found.problem.segments}
    held_out = {segment.test for segment in found.proof.segments}
    columns = {test: _lagged(_inputs(found, test), every) for test in training | held_out}
    channel = {test: block.measured(test)[::every] for test in training | held_out}
    rows = np.concatenate([columns[test] for test in sorted(training)])
    target = np.concatenate([channel[test] for test in sorted(training)])
    weights = np.linalg.lstsq(rows, target, rcond=1e-9)[0]
    return {
        block.tests[test].file: float(
            np.linalg.norm(channel[test] - columns[test] @ weights) / np.linalg.norm(channel[test])
        )
        for test in held_out
    }


def _inputs(found: BlockDiagnosis, test: int) -> Array:
    channels = found.block.tests[test].channels
    return np.stack([channels[name] for name in found.block.inputs])


def _lagged(inputs: Array, every: int) -> Array:
    """Each input now and at earlier times, and a constant, shape (samples, columns)."""
    thinned = inputs[:, ::every]
    size = thinned.shape[1]
    padded = np.concatenate([np.repeat(thinned[:, :1], COEFFICIENTS, axis=1), thinned], axis=1)
    lags = range(COEFFICIENTS + 1)
    delayed = [row[COEFFICIENTS - lag : COEFFICIENTS - lag + size] for row in padded for lag in lags]
    return np.stack([*delayed, np.ones(size)], axis=1)


def changes(former: Row, now: Row) -> list[str]:
    """Sentences on what differs between two runs on one campaign."""
    said = []
    if former.verdict != now.verdict:
        said.append(f"verdict {former.verdict} → {now.verdict}")
    if former.names != now.names:
        said.append(f"names {', '.join(former.names) or 'none'} → {', '.join(now.names) or 'none'}")
    for test, (_, after, _) in now.errors.items():
        before = former.errors.get(test, (0.0, after, 0.0))[1]
        if abs(after - before) > NOTICEABLE * before:
            said.append(f"{test} {before:.4f} → {after:.4f} {'worse' if after > before else 'better'}")
    return said


def show(name: str, row: Row) -> None:
    """Print what a run says of a campaign."""
    print(f"{name}: {row.verdict}, {', '.join(row.names) or 'no effect'} ({row.processor_seconds:.0f} s)")
    if row.missing or row.false:
        print(f"  missing: {', '.join(row.missing) or 'none'}; false: {', '.join(row.false) or 'none'}")
    for test, (before, after, beside) in row.errors.items():
        print(f"  {test}: {before:.4f} calibrated, {after:.4f} with effects, {beside:.4f} reference")


def read_table(path: Path) -> dict[str, Row]:
    """Read the rows of a former run, none where there was none."""
    if not path.exists():
        return {}
    table = json.loads(path.read_text(encoding="utf-8"))
    return {
        name: Row(
            **{
                **row,
                **{key: tuple(row[key]) for key in ("names", "missing", "false")},
                "errors": {test: tuple(errors) for test, errors in row["errors"].items()},
            }
        )
        for name, row in table.items()
    }


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--table", type=Path, help="the last run's results, which this run's replace")
    given = parser.parse_args()
    path = given.table or given.folder / "table.json"
    former = read_table(path)
    rows = dict(former)
    for file in sorted(given.folder.glob("*/campaign.toml")):
        name = file.parent.name
        rows[name] = examined(file.parent)
        show(name, rows[name])
        for sentence in changes(former[name], rows[name]) if name in former else []:
            print(f"  since the last run: {sentence}")
        sys.stdout.flush()
        path.write_text(json.dumps({n: asdict(row) for n, row in rows.items()}, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
