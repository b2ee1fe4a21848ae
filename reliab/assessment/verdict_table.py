"""Verdicts on several tests as a table: one row for each test, also for one that could not be judged."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import pandas as pd

_PLAIN: Final = (
    *("file", "test", "verdict", "probability", "metric", "threshold"),
    *("A", "d_ms", "index", "stability_margin"),
)
_ENDS: Final = ("value", "low", "high")


def verdict_table(summaries: Iterable[Mapping[str, Any]]) -> "pd.DataFrame":
    """Put the answers about several tests into a table.

    Returns `file`, `test`, `verdict`, `probability` [-], `metric`, `threshold` [-], `A` [-], `d_ms` [ms],
    `index` [-], `stability_margin` [-], `rms`, `rms_low`, `rms_high`, `mte`, `mte_low`, `mte_high` [-],
    `reasons`, `warnings` and `fault`; empty where a value is unknown.

    >>> verdict_table([{"file": "a.csv", "fault": "It must not be empty."}]).loc[0, "fault"]
    'It must not be empty.'
    """
    import pandas as pd

    return pd.DataFrame([_row(summary) for summary in summaries])


def _row(summary: Mapping[str, Any]) -> dict[str, Any]:
    error = summary.get("error", {})
    sizes = {
        name if end == "value" else f"{name}_{end}": error.get(name, {}).get(end)
        for name in ("rms", "mte")
        for end in _ENDS
    }
    sentences = {name: " ".join(summary.get(name, ())) or None for name in ("reasons", "warnings")}
    return {
        **{name: summary.get(name) for name in _PLAIN},
        **sizes,
        **sentences,
        "fault": summary.get("fault"),
    }
