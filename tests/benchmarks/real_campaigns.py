"""Diagnose every campaign of a folder, and compare with what is known of it and with the last run.

`python tests/benchmarks/real_campaigns.py FOLDER [--table FILE.json]` diagnoses each folder of FOLDER that
holds a campaign.toml, one after the other, and prints for each: verdict, names, which of them are expected,
missing or false, and the error on every held-out test (RMS over that of the signal) beside that of a
reference, a linear filter of 0.5 s that is fitted to the same training tests by least squares and knows no
physics. FILE.json holds the last run, where one is named; what has changed since is printed, and then the run
takes its place.

TRUTH.json in the folder of a campaign, where there is one, says what an expert calls the machine::

    {"effects": ["hysteresis"], "accepted": ["force_bias"], "verdicts": ["named"], "errors": {"a.csv": 0.11}}

`effects` must be named, `accepted` may stand beside them, any other name is false; `verdicts` are right ones;
`errors` are those of the best model that anybody has found, and stand in the place of the linear filter's.
"""

import json
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from benchmark_script import argument_parser

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


def examine(folder: Path) -> Row:
    """Diagnose a campaign and compare with what is known of it."""
    start_of_process = time.process_time()
    try:
        diagnosis = diagnose(read_campaign(folder))
    except InputError as refusal:
        return Row(verdict=f"refused: {refusal}")
    spent = time.process_time() - start_of_process
    truth = folder / "TRUTH.json"
    expectation: dict[str, Any] | None = (
        json.loads(truth.read_text(encoding="utf-8")) if truth.exists() else None
    )
    names = {effect.name for effect in (*diagnosis.effects, *diagnosis.doubtful)}
    expected_names = names if expectation is None else set(expectation.get("effects", []))
    acceptable = names if expectation is None else expected_names | set(expectation.get("accepted", []))
    verdict = str(diagnosis.verdict)
    if expectation is not None and verdict not in expectation.get("verdicts", [verdict]):
        verdict += " (wrong)"
    return Row(
        verdict=verdict,
        names=tuple(sorted(names)),
        missing=tuple(sorted(expected_names - names)),
        false=tuple(sorted(names - acceptable)),
        errors=errors_of(diagnosis, {} if expectation is None else expectation.get("errors", {})),
        processor_seconds=spent,
    )


def errors_of(diagnosis: Diagnosis, best_known: Mapping[str, float]) -> dict[str, tuple[float, float, float]]:
    """Errors of every held-out test, by block and file, the least explained first."""
    errors = {}
    for block in diagnosis.blocks:
        filter_errors = errors_of_filter(block)
        for gap in block.gap.by_test:
            (file,) = gap.files
            reference = float(best_known.get(file, filter_errors.get(file, float("nan"))))
            errors[f"{block.block.block} {file}"] = (gap.before, gap.after, reference)
    return errors


def errors_of_filter(diagnosis: BlockDiagnosis) -> dict[str, float]:
    """Errors of a linear filter of the input that was fitted to the training tests, by held-out file."""
    block = diagnosis.block
    thinning = max(1, round(FILTER_LENGTH * block.rate / COEFFICIENTS))
    training = {segment.test for segment in diagnosis.problem.segments}
    held_out = {segment.test for segment in diagnosis.proof.segments}
    columns = {test: _lag_columns(_inputs(diagnosis, test), thinning) for test in training | held_out}
    channel = {test: block.measured(test)[::thinning] for test in training | held_out}
    rows = np.concatenate([columns[test] for test in sorted(training)])
    target = np.concatenate([channel[test] for test in sorted(training)])
    weights = np.linalg.lstsq(rows, target, rcond=1e-9)[0]
    return {
        block.tests[test].file: float(
            np.linalg.norm(channel[test] - columns[test] @ weights) / np.linalg.norm(channel[test])
        )
        for test in held_out
    }


def _inputs(diagnosis: BlockDiagnosis, test: int) -> Array:
    channels = diagnosis.block.tests[test].channels
    return np.stack([channels[name] for name in diagnosis.block.inputs])


def _lag_columns(inputs: Array, thinning: int) -> Array:
    """Each input now and at earlier times, and a constant, shape (samples, columns)."""
    coarse = inputs[:, ::thinning]
    size = coarse.shape[1]
    history = np.concatenate([np.repeat(coarse[:, :1], COEFFICIENTS, axis=1), coarse], axis=1)
    lags = range(COEFFICIENTS + 1)
    columns = [row[COEFFICIENTS - lag : COEFFICIENTS - lag + size] for row in history for lag in lags]
    return np.stack([*columns, np.ones(size)], axis=1)


def changes(last_run: Row, now: Row) -> list[str]:
    """Sentences on what differs between two runs on one campaign."""
    sentences = []
    if last_run.verdict != now.verdict:
        sentences.append(f"verdict {last_run.verdict} → {now.verdict}")
    if last_run.names != now.names:
        sentences.append(f"names {', '.join(last_run.names) or 'none'} → {', '.join(now.names) or 'none'}")
    for test, (_, error_after, _) in now.errors.items():
        error_before = last_run.errors.get(test, (0.0, error_after, 0.0))[1]
        if abs(error_after - error_before) > NOTICEABLE * error_before:
            change = "worse" if error_after > error_before else "better"
            sentences.append(f"{test} {error_before:.4f} → {error_after:.4f} {change}")
    return sentences


def show(name: str, row: Row) -> None:
    """Print what a run says of a campaign."""
    print(f"{name}: {row.verdict}, {', '.join(row.names) or 'no effect'} ({row.processor_seconds:.0f} s)")
    if row.missing or row.false:
        print(f"  missing: {', '.join(row.missing) or 'none'}; false: {', '.join(row.false) or 'none'}")
    for test, (error_before, error_after, reference) in row.errors.items():
        errors = f"{error_before:.4f} calibrated, {error_after:.4f} with effects, {reference:.4f} reference"
        print(f"  {test}: {errors}")


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
    parser = argument_parser(__doc__, "folder")
    parser.add_argument("--table", type=Path, help="the last run's results, which this run's replace")
    options = parser.parse_args()
    last = {} if options.table is None else read_table(options.table)
    rows = dict(last)
    for file in sorted(options.folder.glob("*/campaign.toml")):
        name = file.parent.name
        rows[name] = examine(file.parent)
        show(name, rows[name])
        for sentence in changes(last[name], rows[name]) if name in last else []:
            print(f"  since the last run: {sentence}")
        sys.stdout.flush()
        if options.table is not None:
            table = json.dumps({n: asdict(row) for n, row in rows.items()}, indent=1)
            options.table.write_text(table, encoding="utf-8")


if __name__ == "__main__":
    main()
