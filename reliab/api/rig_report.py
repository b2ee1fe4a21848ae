"""`reliab.api.report_rig`: what a rig does, what to expect of it and what to change, as PDF."""

import hashlib
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.api.arguments import Quantity, stated_threshold, stated_values
from reliab.errors import InputError
from reliab.files import require_ending
from reliab.rig import NextTest, Plan, RigFolder, plan_tests, predict_next
from reliab.structures import Structure

if TYPE_CHECKING:
    from reliab.report import Setting


def report_rig(
    rig: str | Path,
    out: str | Path,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    threshold: float | None = None,
    setting: "Setting | None" = None,
) -> Path:
    """Write the report of a rig: two pages for the head of the laboratory, and an appendix.

    Parameters
    ----------
    rig : str or pathlib.Path
        The folder, with at least three tests.
    out : str or pathlib.Path
        The PDF.
    f, xi, alpha, threshold
        Of the next test, as for :func:`predict_rig`; those of the last test by default.
    setting : Setting, optional
        Paper, title, date (today by default), and name and logo of the laboratory.

    Returns
    -------
    pathlib.Path
        The PDF.

    Raises
    ------
    InputError
        If there are fewer than three tests, an argument cannot be used, or the file cannot be written.
    """
    require_ending(out, ".pdf")
    from reliab.report import write_pdf
    from reliab.report.kinds.rig import rig_report

    table = RigFolder.opened(rig).table()
    if not table.rows:
        raise InputError("A rig must have tests", value="none", remedy="Add tests with `reliab rig add`")
    last = table.rows[-1]
    limit = stated_threshold(float(last["threshold"]) if threshold is None else threshold)
    structure: Structure | None = None
    plan: Plan | None = None
    if f is None and last["structure"]:
        prediction = predict_next(table, None, NextTest(), threshold=limit, frame=last["structure"])
    else:
        structure = _structure_of_next(last, f, xi, alpha)
        prediction = predict_next(table, structure, NextTest(), threshold=limit)
        plan = plan_tests(table, structure, NextTest(), threshold=limit)
    digest = hashlib.sha256("\n".join(table.texts("sha256")).encode()).hexdigest()
    document = rig_report(
        Path(rig).resolve().name,
        table,
        prediction,
        plan,
        structure=structure,
        provenance={"tests": len(table), "checksums of the tests, SHA-256": digest},
    )
    write_pdf(document, Path(out), date=datetime.now(tz=UTC).date(), setting=setting)
    return Path(out)


def _structure_of_next(
    last: Mapping[str, Any], f: Quantity | None, xi: Quantity | None, alpha: Quantity | None
) -> Structure:
    """Return what is stated of the next structure, and the rest as in the last test."""
    stated = stated_values(f=f, xi=xi, alpha=alpha)
    usual = {"f": 1.0, "xi": 0.02, "alpha": 1.0}
    frequency, damping, share = (
        stated[name].value if name in stated else float(value if last[name] is None else last[name])
        for name, value in usual.items()
    )
    return Structure(frequency=frequency, damping_ratio=damping, experimental_fraction=share)
