"""Tables and figures of the evidence pages, from the results of `tests/benchmarks`.

A file of results has one row for each figure: `table`, `case`, `quantity`, `value`, the ends `low` and `high`
of its interval or range, the number `of` tests behind it, and the `source`, whose command, date and commit
stand in `sources.csv`.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import matplotlib.pyplot as plt
import pandas as pd
from pandas.io.formats.style import Styler

ROOT: Final = Path(__file__).parents[2]
RESULTS: Final = ROOT / "tests" / "benchmarks" / "results"
BLUE, GREY = "#3b6ea5", "#888888"
NO_COUNT: Final = re.compile(r"\[|over|median|mean|share|score|area|stated|keep")
"""Words of quantities that are no number of tests."""
LARGE: Final = 1e3  # from here on, numbers are written without decimals


def read_results(subject: str, table: str | None = None) -> pd.DataFrame:
    """Read the results on a subject, or one table of them."""
    rows = pd.read_csv(RESULTS / f"{subject}.csv", dtype={"table": str, "case": str, "quantity": str})
    if table is None:
        return rows
    chosen = rows[rows["table"] == table]
    if chosen.empty:
        raise KeyError(table)
    return chosen


def write_result(row: pd.Series) -> str:
    """Write a figure with its interval, or with the number it is out of."""
    counts = not NO_COUNT.search(row["quantity"]) and float(row["value"]).is_integer()
    if counts and pd.notna(row["of"]) and 0 <= row["value"] <= row["of"]:
        return join_words(f"{row['value']:,.0f} of {row['of']:,.0f}")
    value = write_number(row["value"]) if pd.notna(row["value"]) else ""
    if pd.isna(row["low"]) or pd.isna(row["high"]):
        return value
    ends = join_words(f"{write_number(row['low'])} to {write_number(row['high'])}")
    return f"{value} ({ends})" if value else ends


def join_words(text: str) -> str:
    """Keep a text in one line of a narrow column."""
    return text.replace(" ", "\N{NO-BREAK SPACE}")


def write_number(number: float) -> str:
    """Write a number without a power of ten if it is large."""
    return f"{number:,.0f}" if abs(number) >= LARGE else f"{number:.4g}"


def show_table(subject: str, table: str, quantities: Sequence[str] = ()) -> Styler:
    """Show one table: cases in rows, quantities in columns."""
    rows = read_results(subject, table)
    if quantities:
        rows = rows[rows["quantity"].isin(quantities)]
    written = rows.assign(written=[write_result(row) for _, row in rows.iterrows()])
    cases, columns = rows["case"].unique(), quantities or rows["quantity"].unique()
    wide = written.pivot_table(index="case", columns="quantity", values="written", aggfunc="first")
    wide = wide.reindex(index=cases, columns=columns).fillna("")
    return style_table(wide.T if len(wide) == 1 else wide).set_caption(table[:1].upper() + table[1:])


def style_table(table: pd.DataFrame) -> Styler:
    """Set a table with its index as the first column, to the left."""
    to_the_left = {"selector": "th, td", "props": "text-align: left; padding-right: 1em"}
    whole = table.rename_axis(index="", columns=None).reset_index()
    caption_to_the_left = {"selector": "caption", "props": "text-align: left; font-style: italic"}
    return whole.style.hide(axis="index").set_table_styles([to_the_left, caption_to_the_left])


def show_shares(
    subject: str,
    tables: Sequence[str],
    quantity: str,
    *,
    stated: float | None = None,
    label: str = "",
) -> None:
    """Draw one share of each case, with its interval, beside the stated one.

    Parameters
    ----------
    subject : str
        Name of the file of results.
    tables : sequence of str
        Its tables, one below the other.
    quantity : str
        What is drawn, in per cent.
    stated : float, optional
        What should come out, in per cent.
    label : str, optional
        Text below the axis, the quantity by default.
    """
    rows = pd.concat([read_results(subject, table) for table in tables])
    rows = rows[rows["quantity"] == quantity][::-1]
    figure, axes = plt.subplots(figsize=(7, 0.6 + 0.28 * len(rows)))
    places = range(len(rows))
    axes.hlines(places, rows["low"], rows["high"], color=BLUE, linewidth=1)
    axes.plot(rows["value"], places, "o", color=BLUE, markersize=5)
    axes.set_yticks(places, rows["case"])
    axes.margins(y=0.06)
    if stated is not None:
        axes.axvline(stated, color=GREY, linewidth=0.8, linestyle="--")
    axes.set_xlabel(label or quantity)
    figure.tight_layout()


def show_promises(
    subject: str,
    tables: dict[str, str],
    candidates: Sequence[str],
    shares: Sequence[int] = (50, 80, 90, 95),
) -> None:
    """Draw shares that were found over those that were stated, a panel for each candidate.

    Parameters
    ----------
    subject : str
        Name of the file of results.
    tables : dict
        Tables with their label.
    candidates : sequence of str
        What the shares were stated by.
    shares : sequence of int
        The stated shares, in per cent.
    """
    rows_of_panels = -(-len(candidates) // 2)
    figure, panels = plt.subplots(
        rows_of_panels, 2, figsize=(7, 3.1 * rows_of_panels), sharex=True, sharey=True, squeeze=False
    )
    for axes, candidate in zip(panels.flat, candidates, strict=True):
        axes.plot([40, 100], [40, 100], color=GREY, linewidth=0.8, linestyle="--")
        for name, label in tables.items():
            rows = read_results(subject, name)
            for _, case in rows.groupby("case", sort=False):
                found = case.set_index("quantity")["value"]
                names = [f"{candidate}, stated {share} %" for share in shares]
                axes.plot(shares, found.reindex(names), marker=".", color=BLUE, alpha=0.35, linewidth=0.8)
            axes.plot([], [], color=BLUE, label=label)
        axes.set(title=candidate)
        axes.title.set_fontsize(10)
    figure.supxlabel("stated [%]", fontsize=10)
    figure.supylabel("found [%]", fontsize=10)
    figure.tight_layout()


def show_probabilities(subject: str, table: str, *, percent: bool = False) -> None:
    """Draw what was found over what was stated, a line for each case or quantity."""
    rows = read_results(subject, table)
    by = "case" if percent else "quantity"
    stated = rows["quantity" if percent else "case"].str.extract(r"stated ([\d.]+)")[0].astype(float)
    rows = rows.assign(stated=stated).dropna(subset=["stated"])
    figure, axes = plt.subplots(figsize=(4.6, 3.6))
    end = 100 if percent else 1
    axes.plot([0, end], [0, end], color=GREY, linewidth=0.8, linestyle="--")
    for name, group in rows.groupby(by, sort=False):
        axes.plot(group["stated"], group["value"], marker="o", markersize=4, linewidth=1, label=name)
    unit = " [%]" if percent else ""
    axes.set(xlabel=f"stated{unit}", ylabel=f"found{unit}")
    axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()


def show_coverage() -> None:
    """Draw how often intervals and probabilities of 1,000 simulated tests hold (`datasets/rebuilt_error`)."""
    tests = pd.read_csv(ROOT / "datasets" / "rebuilt_error" / "coverage.csv")
    good = tests["true_rms"] < 0.05  # noqa: PLR2004 - the threshold of the study
    classes = pd.cut(tests["probability"], [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0], include_lowest=True)
    stated = tests["probability"].groupby(classes, observed=True).mean()
    found = good.groupby(classes, observed=True).mean()
    figure, axes = plt.subplots(figsize=(4.6, 3.6))
    axes.plot([0, 1], [0, 1], color=GREY, linewidth=0.8, linestyle="--")
    axes.plot(stated, found, "o-", color=BLUE, markersize=4, linewidth=1)
    axes.set(xlabel="stated probability of an error below 5 %", ylabel="share found")
    figure.tight_layout()


def show_growth() -> None:
    """Draw how limits grow as less of the stiffness stands in the laboratory, over the law that is used."""
    growth = pd.read_csv(ROOT / "datasets" / "experimental_share" / "growth.csv")
    figure, axes = plt.subplots(figsize=(7, 3.4))
    for xi, rows in growth.groupby("xi"):
        axes.fill_between(rows["alpha"], rows["a_limit_least"], rows["a_limit_most"], alpha=0.2)
        axes.plot(rows["alpha"], rows["a_limit_least"], marker=".", label=f"ξ = {xi:g}")
    axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle="--")
    axes.set(xlabel="share of the stiffness in the laboratory", ylabel="simulated limit over the law")
    axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()


METHODS: Final = {
    "tracking_indicator": "tracking indicator",
    "pei": "PEI",
    "fei": "FEI",
    "face": "FACE",
    "rebuilt": "rebuilt error",
}
THRESHOLD: Final = 0.05


def read_other_methods() -> tuple[pd.DataFrame, dict[str, float]]:
    """Read what each measure says of the same tests, and the limit of each measure."""
    tests = pd.read_csv(ROOT / "reports" / "site" / "other_methods.csv")
    bad = tests["true"] > THRESHOLD
    limits = {"fei": 1.0, "face": THRESHOLD, "rebuilt": THRESHOLD}
    for measure in ("tracking_indicator", "pei"):  # the limit that separates these very tests best
        right = {limit: int(((tests[measure] > limit) == bad).sum()) for limit in tests[measure]}
        limits[measure] = max(right, key=right.__getitem__)
    return tests, limits


def compare_methods() -> Styler:
    """Count how each measure judges the tests."""
    tests, limits = read_other_methods()
    bad = tests["true"] > THRESHOLD
    rows = {}
    for measure, name in METHODS.items():
        refused = tests[measure] > limits[measure]
        correlation = tests[measure].corr(tests["true"], method="spearman")
        rows[name] = {
            "rank correlation with the true error": f"{correlation:.2f}",
            "right": join_words(f"{(refused == bad).sum()} of {len(tests)}"),
            "bad accepted": f"{(bad & ~refused).sum()} of {bad.sum()}",
            "good refused": f"{(~bad & refused).sum()} of {(~bad).sum()}",
        }
    return style_table(pd.DataFrame(rows).T)


def draw_methods() -> None:
    """Draw each measure over the true error, with its limit."""
    tests, limits = read_other_methods()
    figure, panels = plt.subplots(2, 3, figsize=(8, 5.2), sharex=True)
    panels.flat[-1].axis("off")
    for axes, (measure, name) in zip(panels.flat[:-1], METHODS.items(), strict=True):
        axes.loglog(100 * tests["true"], tests[measure], ".", color=BLUE, markersize=5)
        axes.axvline(100 * THRESHOLD, color=GREY, linewidth=0.8)
        axes.axhline(limits[measure], color=GREY, linewidth=0.8)
        axes.set(xlabel="true error [%]", title=name)
        axes.title.set_fontsize(10)
    figure.tight_layout()


def count_verdicts() -> Styler:
    """Count the verdicts of `reliab assess` on good and bad tests."""
    tests, _ = read_other_methods()
    truth = (tests["true"] > THRESHOLD).map({True: "bad", False: "good"})
    counts = pd.crosstab(tests["word"].str.replace("_", " "), truth)
    return style_table(counts)


def show_sources(*subjects: str) -> Styler:
    """List the commands behind the figures of a page, with date and commit where they are known."""
    used = pd.concat([read_results(subject) for subject in subjects])[["source", "table"]].drop_duplicates()
    tables = used.groupby("source", sort=False)["table"].agg(", ".join)
    sources = pd.read_csv(RESULTS / "sources.csv", dtype=str).fillna("").set_index("source")
    listed = sources.loc[tables.index].assign(figures=tables).reset_index(drop=True)
    columns = [name for name in ("command", "date", "commit", "note") if listed[name].any()]
    return style_table(listed.set_index("figures")[columns])
