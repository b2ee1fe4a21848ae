"""Simulate tests and have each of them judged, motion by motion."""

from pathlib import Path
from typing import Final

import pandas as pd

from reliab.errors import InputError
from reliab.files import refuse_unwritable, written_whole
from reliab.progress import Progress, silent
from reliab.validation.rebuilt_error_study.bench import tests_of_round
from reliab.validation.rebuilt_error_study.design import Design

STUDY_COLUMNS: Final = (
    *("study", "round", "motion", "event", "test", "rig", "specimen", "f", "xi", "alpha", "sensor", "stated"),
    *("error", "good", "judge", "accepted", "estimate", "low", "high", "looks_nonlinear"),
)
"""Columns of a study: a row for each judge of each test under each condition."""


def try_tests(design: Design, *, kept: Path | None = None, progress: Progress = silent) -> pd.DataFrame:
    """Simulate tests and let every judge judge them.

    Returns [-].
    Returns columns :data:`STUDY_COLUMNS`: the true `error` [-] of the test and whether it is `good`; of the
    `judge` whether it `accepted` the test, and the error that it stated, `estimate` with its 90 % interval
    `low` to `high` [-], where it states one; and whether the specimen `looks_nonlinear`, where the recorded
    force was looked at (1 or 0). Tests that run away are not judged, since nobody takes them for good.
    """
    table = _kept(kept, design.digest)
    table = table[table["round"] < design.trials]
    done = set(table["round"].tolist())
    for number in range(design.trials):
        if number not in done:
            rows = pd.DataFrame(list(tests_of_round(design, number)), columns=list(STUDY_COLUMNS))
            table = rows if table.empty else pd.concat([table, rows], ignore_index=True)
            if kept is not None:
                _write(table, kept)
        progress(number + 1, design.trials)
    return table


def _kept(path: Path | None, digest: str) -> pd.DataFrame:
    if path is None or not path.exists():
        return pd.DataFrame(columns=list(STUDY_COLUMNS))
    try:
        table = pd.read_csv(path)
    except (OSError, ValueError) as error:
        raise InputError(
            "The file of a study must be a table that an earlier run wrote",
            value=str(error),
            remedy="Name another file",
            where=str(path),
        ) from error
    if list(table.columns) != list(STUDY_COLUMNS) or not (table["study"] == digest).all():
        raise InputError(
            "An interrupted study can only be resumed with its own file",
            value="other motions, structures, errors, or another version",
            remedy="Name another file",
            where=str(path),
        )
    return table


def _write(table: pd.DataFrame, path: Path) -> None:
    with refuse_unwritable("The study's file must be writable", where=path), written_whole(path) as file:
        table.to_csv(file, index=False)
