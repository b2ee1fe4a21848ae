"""Report of how often diagnoses of campaigns with known, hidden effects were right."""

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reliab.core.significant_digits import percent, percent_and_interval
from reliab.core.vocabulary import PERCENT
from reliab.effects.registry import library
from reliab.report.document import Column, Document, Figure as RpFigure, Points, Section, Table, provenance_of
from reliab.report.numbers import Fixed
from reliab.report.prose import Prose, prose, spell_out
from reliab.report.style import BLUE, GREY, INK, apply_style, blank, name_axes, panels, plain

_GROUPS = (
    "One effect that exceeds the noise",
    "Two or three effects, each in a row of its own",
    "One effect below the noise",
    "One effect in a loop that is seen through one channel",
    "Nothing hidden, and effects outside the library",
)
_AMONG, _FAINT, _ONE_CHANNEL = " among several", "faint ", "one channel "
_NOTHING = ("none", "miscalibrated")
_FEWEST_BINS = 3
_OUTCOMES = {
    "answered": "answered at all",
    "single named right, alone": "one effect: named, and nothing else",
    "single right or honestly degenerate": "one effect: named, or given with others that fit as well",
    "single with a wrong name": "one effect: a wrong name",
    "faint with a wrong name": "faint effect: a wrong name",
    "faint called unknown": "faint effect: called unknown",
    "faint named right": "faint effect: named",
    "two or three exactly right": "two or three effects: all named",
    "two exactly right": "two effects: both named",
    "three exactly right": "three effects: all named",
    "nothing hidden, false name": "nothing hidden: a name",
    "nothing hidden, any alarm": "nothing hidden: a name, or called unknown",
    "outside flagged unknown": "effect outside the library: called unknown",
    "outside given a name": "effect outside the library: given a name",
    "one channel named right": "one channel: named",
    "gap closed by 0.9 or more": "90 % or more of the gap closed",
}
"""Outcomes of the evaluation, in words for readers."""
_SHARE = Fixed(decimals=1, factor=PERCENT)


def blind_evaluation_report(
    *,
    title: str,
    runs: Sequence[Mapping[str, Any]],
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
) -> Document:
    """Report what was measured on blind campaigns."""
    last = runs[-1]
    rates_with_target = [rate for rate in last["rates"].values() if rate["target"] is not None and rate["of"]]
    missed = [
        _name_outcome(name)
        for name, rate in last["rates"].items()
        if rate["target"] is not None and rate["of"] and not rate["reached"]
    ]
    gap = last["closed_fraction"]
    return Document(
        kind="Blind evaluation of diagnoses",
        title=title,
        verdict=prose(
            "{failed} of {campaigns} campaigns that nobody had seen before were answered wrongly. "
            "{reached} of {asked} targets are reached{missed}.",
            reached=sum(bool(rate["reached"]) for rate in rates_with_target),
            asked=len(rates_with_target),
            campaigns=last["campaigns"],
            failed=len(last["failures"]),
            missed=f"; missed: {'; '.join(missed)}" if missed else "",
        ),
        facts={
            "Campaigns": ", ".join(f"{count} {spell_out(kind)}" for kind, count in last["kinds"].items()),
            "Gap closed on held-out tests": prose(
                "{middle} in the median, {low} or more in 95 % of {n} campaigns",
                middle=percent(gap["q50"]),
                low=percent(gap["q5"]),
                n=gap["n"],
            ),
        },
        blocks=(
            _rates(last),
            _confusion(last),
            _probabilities(last),
            _failures(last),
            _limits(notes),
            *_earlier(runs),
        ),
        provenance=provenance_of(
            {**provenance, **{f"seeds, code {run['code']}": run["seeds"] for run in runs}}
        ),
    )


def _name_outcome(name: str) -> str:
    return _OUTCOMES.get(name, name)


def _rates(run: Mapping[str, Any]) -> Section:
    rates = {**run["rates"], "90 % intervals that hold the truth": run["coverage"]}
    rows = [
        {"what": _name_outcome(name), **rate, "wanted": _target(rate)}
        for name, rate in rates.items()
        if rate["of"]
    ]
    columns = (
        Column(key="what", heading="What", wide=True),
        Column(key="count", heading="Times", number=Fixed(decimals=0)),
        Column(key="of", heading="Of", number=Fixed(decimals=0)),
        *(
            Column(key=key, heading=heading, unit="%", number=_SHARE)
            for key, heading in (("share", "Share"), ("low", "From"), ("high", "To"))
        ),
        Column(key="wanted", heading="Target"),
    )
    caption = "What was measured on the last run, with Wilson's 95 % intervals."
    table = Table(frame=pd.DataFrame(rows), columns=columns, caption=caption, label="tab:rates")
    return Section(title="How often it is right", blocks=(table,))


def _target(rate: Mapping[str, Any]) -> str:
    target = rate["target"]
    if target is None:
        return "–"
    if isinstance(target, list):
        return f"{percent(target[0])} to {percent(target[1])}"
    return f"at {'most' if rate['at_most'] else 'least'} {percent(target)}"


def _earlier(runs: Sequence[Mapping[str, Any]]) -> tuple[Section, ...]:
    """Rates of all runs, each with the code of its time; nothing where there is one."""
    if len(runs) == 1:
        return ()
    frame = pd.DataFrame(
        {
            run["code"]: {
                _name_outcome(name): f"{rate['count']} of {rate['of']}"
                for name, rate in {
                    **run["rates"],
                    "90 % intervals that hold the truth": run["coverage"],
                }.items()
            }
            for run in runs
        }
    )
    filled = frame.fillna("–").reset_index(names="what")
    columns = (
        Column(key="what", heading="What", wide=True),
        *(Column(key=code, heading=f"Code {code}") for code in frame.columns),
    )
    caption = "All runs in their order; each was made on campaigns that nobody had seen before."
    table = Table(frame=filled, columns=columns, caption=caption, label="tab:runs")
    return (Section(title="Earlier runs", blocks=(table,), appendix=True),)


def _confusion(run: Mapping[str, Any]) -> Section:
    """Draw the first group, and tabulate all, each with what was answered otherwise."""
    groups: dict[str, dict[str, Mapping[str, int]]] = {}
    for truth, answers in run["confusion"].items():
        groups.setdefault(_group(truth), {})[truth] = answers
    group_names = [name for name in _GROUPS if name in groups]
    columns = (
        Column(key="group", heading="Hidden", wide=True),
        Column(key="kinds", heading="Kinds", number=Fixed(decimals=0)),
        Column(key="of", heading="Times", number=Fixed(decimals=0)),
        Column(key="right", heading="Answered so", number=Fixed(decimals=0)),
        Column(key="otherwise", heading="Otherwise", wide=True),
    )
    return Section(
        title="Which effects are confused",
        blocks=(
            Table(
                frame=pd.DataFrame([_count_answers(name, groups[name]) for name in group_names]),
                columns=columns,
                caption="What is hidden against what is answered; verdicts without a name in brackets.",
                label="tab:confusion",
            ),
            RpFigure(
                drawing=discrepancy_confusion(groups[group_names[0]]),
                caption=f"{group_names[0]}: what is hidden against what is answered; right on the diagonal.",
                label="fig:confusion",
                leads=True,
            ),
        ),
    )


def _count_answers(group: str, truths: Mapping[str, Mapping[str, int]]) -> dict[str, object]:
    """Count the answers of a group that are what was hidden, and name the others."""
    others = [
        f"{count} × {spell_out(truth)} as {spell_out(answer)}"
        for truth, answers in truths.items()
        for answer, count in answers.items()
        if answer != _answer_to(truth)
    ]
    return {
        "group": group,
        "kinds": len(truths),
        "of": sum(sum(answers.values()) for answers in truths.values()),
        "right": sum(answers.get(_answer_to(truth), 0) for truth, answers in truths.items()),
        "otherwise": ", ".join(others) or "–",
    }


def _answer_to(truth: str) -> str:
    """Answer that is right for what is hidden."""
    name = truth.removesuffix(_AMONG).removeprefix(_FAINT).removeprefix(_ONE_CHANNEL)
    if name in library():
        return name
    return "(no_missing_effect)" if name in _NOTHING else "(unknown_effect)"


def _group(truth: str) -> str:
    alone, among, faint, one_channel, outside = _GROUPS
    if truth.endswith(_AMONG):
        return among
    if truth.startswith(_FAINT):
        return faint
    if truth.startswith(_ONE_CHANNEL):
        return one_channel
    return alone if truth in library() else outside


def _probabilities(run: Mapping[str, Any]) -> Section:
    """Draw stated probabilities against shares, or say them where they are too few for a curve."""
    bins = pd.DataFrame(run["reliability"]["bins"])
    title = "Whether stated probabilities are kept"
    if len(bins) >= _FEWEST_BINS:
        caption = "How often effects were right that were named with a probability; the numbers count them."
        figure = RpFigure(drawing=discrepancy_reliability(bins), caption=caption, label="fig:reliability")
        return Section(title=title, blocks=(figure,))
    return Section(title=title, blocks=tuple(_right_of_named(row) for row in bins.to_dict("records")))


def _right_of_named(row: Mapping[Hashable, Any]) -> Prose:
    """Say how many effects that were named with a probability were right."""
    share, ends = percent_and_interval(row["share"], row["low"], row["high"])
    return prose(
        "Of {n} effects that were named with a probability of {stated} in the mean, {share} were right "
        "(95 % interval {ends}).",
        n=row["of"],
        stated=percent(row["mean_stated"], 4),
        share=share,
        ends=ends,
    )


def _failures(run: Mapping[str, Any]) -> Section:
    title = "Every campaign that was answered wrongly"
    if not run["failures"]:
        return Section(title=title, blocks=("There was none.",))
    rows = [
        {
            "campaign": str(failure["campaign"]).removeprefix("campaign_"),
            "seen": spell_out(failure["observation"]),
            "noise": f"{spell_out(failure['noise'])}, {failure['snr_db']:.0f} dB",
            "truth": ", ".join(f"{spell_out(name)} {db:+.0f} dB" for name, db in failure["truth"].items())
            or "nothing",
            "answer": ", ".join(map(spell_out, failure["named"])) or spell_out(str(failure["verdict"])),
        }
        for failure in run["failures"]
    ]
    columns = (
        Column(key="campaign", heading="Seed"),
        Column(key="seen", heading="Observed"),
        Column(key="noise", heading="Noise"),
        Column(key="truth", heading="Hidden, over the noise", wide=True),
        Column(key="answer", heading="Answer", wide=True),
    )
    caption = "Failures of the last run; the level is that of the effect over the noise of its channel."
    return Section(
        title=title,
        blocks=(Table(frame=pd.DataFrame(rows), columns=columns, caption=caption, label="tab:failures"),),
    )


def _limits(notes: Sequence[Prose]) -> Section:
    points = (
        "An effect must be named when it exceeds the noise in its own channel after calibration.",
        "Shares of few campaigns are uncertain: the intervals say how much.",
    )
    return Section(title="How to read this", blocks=(Points(items=(*points, *notes)),))


_HEIGHT = 76.0
_ROW, _EDGE = 4.6, 42.0
_DARK = 0.55


@apply_style
def discrepancy_reliability(bins: pd.DataFrame) -> Figure:
    """Draw how often effects that were named with a stated probability were right.

    `bins`: columns `mean_stated`, `share`, `low`, `high` (95 % interval of the share) [-] and `of`, the
    count. Result: share that was right over the stated probability; on the diagonal statements are
    calibrated.
    """
    figure, axes = panels(height=_HEIGHT, width=_HEIGHT + 14.0)
    place = axes[0, 0]
    place.plot([0.0, 1.0], [0.0, 1.0], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)))
    reach = np.maximum([bins["share"] - bins["low"], bins["high"] - bins["share"]], 0.0)
    place.errorbar(bins["mean_stated"], bins["share"], yerr=reach, fmt="o", color=BLUE, capsize=2.5)
    for row in bins.itertuples():
        place.annotate(
            f"{row.of}", (row.mean_stated, row.share), (4, -9), textcoords="offset points", fontsize=7.0
        )
    place.set(xlim=(-0.02, 1.04), ylim=(-0.02, 1.04), aspect="equal")
    name_axes(place, "Stated probability [-]", "Share that is right [-]")
    return figure


@apply_style
def discrepancy_confusion(counts: Mapping[str, Mapping[str, int]]) -> Figure:
    """Draw which effects were given which names.

    Truths in rows, answers in columns; shading by the share of the row.
    """
    table = pd.DataFrame(counts).T.fillna(0).astype(int)
    table = table[sorted(table.columns, key=lambda name: _place(str(name), list(counts)))]
    figure = blank(height=_ROW * len(table) + _EDGE)
    axes = figure.subplots()
    shares = table.to_numpy() / np.maximum(table.to_numpy().sum(axis=1, keepdims=True), 1)
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    axes.grid(visible=False)
    for (row, column), count in np.ndenumerate(table.to_numpy()):
        if count:
            colour = "white" if shares[row, column] > _DARK else INK
            axes.text(column, row, f"{count}", ha="center", va="center", color=colour, fontsize=6.5)
    axes.set_xticks(
        range(table.shape[1]), [_put_in_words(name) for name in table.columns], rotation=90.0, fontsize=6.5
    )
    axes.set_yticks(range(table.shape[0]), [_put_in_words(name) for name in table.index], fontsize=6.5)
    name_axes(axes, "Answer", "Truth")
    return figure


def _place(name: str, truths: list[str]) -> tuple[bool, int, str]:
    """Order of the answers: that of the truths, then other names, then verdicts."""
    return name.startswith("("), truths.index(name) if name in truths else len(truths), name


def _put_in_words(name: object) -> str:
    return plain(str(name).replace("_", " "))
