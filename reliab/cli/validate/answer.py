"""What `reliab validate` answers: JSON, and tables on the terminal."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, table

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

    from reliab.validation.cross_validation import CrossValidation

_HEADINGS = {
    "criterion": "left",
    "stated": "right",
    "contained (95 % interval)": "right",
    "by ellipses": "right",
    "false-safe": "right",
    "good tests accepted": "right",
}
_CONFUSION = ("good_accepted", "good_rejected", "bad_accepted", "bad_rejected")
ELLIPSE_NOTE = (
    "Note: without --motions or --results no simulated errors are known; the motions' own ellipses "
    "decide what is contained and which tests are good."
)
"""What is said where no simulated errors are known."""


def answer(validation: "CrossValidation", ellipses: "xr.Dataset", recognised: int) -> dict[str, Any]:
    """Put a cross-validation into plain values."""
    from reliab.sweep import share_of

    counts = validation.counts
    return {
        "scheme": validation.scheme,
        "threshold": validation.threshold,
        "metric": validation.metric,
        "window": str(ellipses.attrs.get("window", "unknown")),
        "alpha": share_of(ellipses),
        "n_motions": int(counts.sizes["motion"]),
        "n_events": len(set(counts["event"].values.tolist())),
        "n_of_learned_earthquakes": recognised,
        "truth": validation.truth,
        "unresolved": int(counts["unresolved"].sum()),
        "not_carried": _not_carried(validation),
        "rows": _rows(validation, ("f", "xi")),
        "by_frequency": _rows(validation, ("xi",)),
        "by_damping_ratio": _rows(validation, ("f",)),
        "rows_lead": _rows(validation, ("f", "xi"), "lead"),
    }


def _rows(validation: "CrossValidation", over: tuple[str, ...], side: str = "lag") -> list[dict[str, Any]]:
    """Rates with intervals and the confusion matrix, one row for each candidate and confidence."""
    from reliab.validation.cross_validation import RATES, tabulate
    from reliab.vocabulary import Side

    rows = []
    for line in tabulate(validation, over, side=Side(side)).to_dict(orient="records"):
        row: dict[str, Any] = {
            str(name): line[name] for name in ("candidate", "confidence", "f", "xi") if name in line
        }
        for name in RATES:
            ends = {"rate": name, "low": f"{name}_low", "high": f"{name}_high"}
            row[name] = {end: _number(line[key]) for end, key in ends.items()}
        row["confusion"] = {name: int(line[name]) for name in _CONFUSION}
        rows.append(row)
    return rows


def _not_carried(validation: "CrossValidation") -> list[dict[str, Any]]:
    """Criteria and confidences for which every fold has too few motions."""
    from reliab.criterion.laws import OF_MANY_MOTIONS

    counts = validation.counts
    touched = (counts["judged"] + counts["unresolved"]).sum(["side", "f", "xi", "motion"])
    return [
        {"candidate": candidate, "confidence": confidence}
        for candidate in counts["candidate"].values.tolist()
        for confidence in counts["confidence"].values.tolist()
        if candidate not in OF_MANY_MOTIONS
        and not int(touched.sel(candidate=candidate, confidence=confidence))
    ]


def _number(value: float) -> float | None:
    return float(value) if value == value else None  # noqa: PLR0124 - NaN where nothing was accepted


def show(content: dict[str, Any]) -> None:
    """Print the rates of criteria."""
    terminal = console()
    title = (
        f"{content['scheme'].replace('_', ' ')}: {content['n_motions']} motions of {content['n_events']} "
        f"earthquakes, {content['metric'].upper()} {content['threshold']:g} over "
        f"{_window(content['window'])}"
    )
    terminal.print(_table(title, content["rows"]))
    if content["rows_lead"]:
        terminal.print(_table("The same for actuators that are early (leads)", content["rows_lead"]))
    for sentence in (*kept_shares(content["rows"]), *kept_shares(content["rows_lead"], " for leads")):
        terminal.print(sentence, highlight=False)
    if content["n_of_learned_earthquakes"]:
        terminal.print(
            f"{content['n_of_learned_earthquakes']} of the motions are of earthquakes that the suite holds; "
            "each was judged by what was learned from the other earthquakes.",
            highlight=False,
        )
    for missing in content["not_carried"]:
        terminal.print(
            f"{missing['candidate']} at {missing['confidence']:.0%} is not judged: there are too few "
            f"motions or earthquakes for it.",
            highlight=False,
        )
    if content["unresolved"]:
        terminal.print(
            f"Not judged, because a criterion reaches beyond the stored results: {content['unresolved']} "
            "times.",
            highlight=False,
        )
    if content["truth"] == "ellipse":
        terminal.print(ELLIPSE_NOTE)


def kept_shares(rows: list[dict[str, Any]], of_side: str = "") -> Iterator[str]:
    """Say of each method and law whether the share of motions that it states is kept.

    >>> rate = {"rate": 0.52, "low": 0.41, "high": 0.63}
    >>> print(*kept_shares([{"candidate": "guo_2017_18", "confidence": 0.95, "containment": rate}]))
    guo_2017_18 does not keep the share that it states: it protects 52.0% of the motions where it states 95%.
    """
    for candidate in dict.fromkeys(row["candidate"] for row in rows):
        judged = [
            (row["containment"], row["confidence"])
            for row in rows
            if row["candidate"] == candidate and row["containment"]["rate"] is not None
        ]
        if not judged:
            continue
        below = [(rate, stated) for rate, stated in judged if rate["rate"] < stated]
        broken = [f"{stated:.0%}" for rate, stated in below if (rate["high"] or rate["rate"]) < stated]
        keeps = "keeps the share that it states"
        if broken:
            at = f" at {', '.join(broken)}" if len(judged) > 1 else ""
            keeps = f"does not keep the share that it states{at}"
        elif below:
            keeps = "may keep the share that it states, as far as so few motions can tell"
        shares = ", ".join(f"{rate['rate']:.1%} where it states {stated:.0%}" for rate, stated in judged)
        first, *others = shares.split(" where", 1)
        yield f"{candidate} {keeps}{of_side}: it protects {first} of the motions where{others[0]}."


def _table(title: str, rows: list[dict[str, Any]]) -> "Table":
    shown = table(title, _HEADINGS)
    for row in rows:
        shown.add_row(
            row["candidate"],
            f"{row['confidence']:.0%}",
            *(interval(row["containment"]), _share(row["containment_by_ellipse"]["rate"])),
            *(interval(row[name]) for name in ("false_safe", "accepted_share")),
        )
    return shown


def _window(label: str) -> str:
    lengths = {
        "record": "whole records",
        "arias": "5-95 % of the Arias intensity",
        "unknown": "an unknown window",
    }
    return lengths.get(label, f"the first {label} s")


def _share(value: float | None) -> str:
    return "none" if value is None else f"{value:.1%}"


def interval(rate: dict[str, float | None]) -> str:
    """Write a rate with its interval.

    `rate` [-].
    """
    if rate["rate"] is None:
        return "none"
    if rate["low"] is None or rate["high"] is None:
        return f"{rate['rate']:.1%}"
    return f"{rate['rate']:.1%} ({rate['low']:.1%} … {rate['high']:.1%})"
