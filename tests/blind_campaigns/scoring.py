"""Score a product against the labels: every figure asked for, with Wilson 95 % intervals.

`python tests/blind_campaigns/score.py LABELS RESULTS [--names FILE] [--json FILE]`
"""

import argparse
import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from blind_campaigns.kinds import Kind
from blind_campaigns.labels import read_labels
from blind_campaigns.outcomes import Names, Outcome, read_names, read_outcomes

_NAMED_KINDS = (Kind.SINGLE, Kind.DOUBLE, Kind.TRIPLE, Kind.ONE_CHANNEL)
_QUANTILES = (0.05, 0.25, 0.5, 0.75)
_SNR_BINS = ((20.0, 30.0), (30.0, 40.0), (40.0, 50.0))
Judge = Callable[[Outcome], bool]


def wilson_interval(successes: int, trials: int, z: float = 1.959964) -> tuple[float, float]:
    """Return the Wilson score interval of a share, (0, 1) without trials."""
    if trials == 0:
        return 0.0, 1.0
    share = successes / trials
    centre = share + z * z / (2.0 * trials)
    spread = z * math.sqrt(share * (1.0 - share) / trials + z * z / (4.0 * trials**2))
    width = 1.0 + z * z / trials
    return max((centre - spread) / width, 0.0), min((centre + spread) / width, 1.0)


def share(answers: Iterable[bool]) -> dict[str, Any]:
    """Return count, number, share and its interval."""
    answers = list(answers)
    yes = sum(answers)
    low, high = wilson_interval(yes, len(answers))
    return {
        "count": yes,
        "of": len(answers),
        "share": yes / len(answers) if answers else None,
        "low": low,
        "high": high,
    }


def of_kind(outcomes: list[Outcome], *kinds: Kind) -> list[Outcome]:
    """Return the outcomes of some kinds of campaign."""
    return [outcome for outcome in outcomes if outcome.label.kind in kinds]


def _figure(outcomes: list[Outcome], judge: Judge, target: float, *, at_most: bool = False) -> dict[str, Any]:
    figure = share(judge(outcome) for outcome in outcomes)
    reached = None
    if figure["of"]:
        reached = figure["share"] <= target if at_most else figure["share"] >= target
    return {**figure, "target": target, "at_most": at_most, "reached": reached}


def _alarm(outcome: Outcome) -> bool:
    return bool(outcome.named) or outcome.verdict == "unknown_effect"


def rates(outcomes: list[Outcome]) -> dict[str, dict[str, Any]]:
    """Return the shares of the "done when" list."""
    single, faint = of_kind(outcomes, Kind.SINGLE), of_kind(outcomes, Kind.FAINT)
    quiet = of_kind(outcomes, Kind.NONE, Kind.MISCALIBRATED)
    several = of_kind(outcomes, Kind.DOUBLE, Kind.TRIPLE)
    closed = [
        o.closed_fraction
        for o in of_kind(outcomes, *_NAMED_KINDS)
        if o.exact and o.closed_fraction is not None
    ]
    table = {
        "answered": _figure(outcomes, lambda o: o.result is not None, 1.0),
        "single named right, alone": _figure(single, lambda o: o.exact, 0.97),
        "single right or honestly degenerate": _figure(single, lambda o: o.honest, 0.97),
        "single with a wrong name": _figure(single, lambda o: o.wrong, 0.03, at_most=True),
        "faint with a wrong name": _figure(faint, lambda o: o.wrong, 0.02, at_most=True),
        "faint called unknown": _figure(faint, lambda o: o.verdict == "unknown_effect", 0.02, at_most=True),
        "faint named right": {
            **share(o.exact for o in faint),
            "target": None,
            "at_most": False,
            "reached": None,
        },
        "two or three exactly right": _figure(several, lambda o: o.exact, 0.90),
        "two exactly right": _figure(of_kind(outcomes, Kind.DOUBLE), lambda o: o.exact, 0.90),
        "three exactly right": _figure(of_kind(outcomes, Kind.TRIPLE), lambda o: o.exact, 0.90),
        "nothing hidden, false name": _figure(quiet, lambda o: bool(o.named), 0.01, at_most=True),
        "nothing hidden, any alarm": _figure(quiet, _alarm, 0.01, at_most=True),
        "outside flagged unknown": _figure(of_kind(outcomes, Kind.OUTSIDE), lambda o: o.flagged, 0.95),
        "outside given a name": _figure(
            of_kind(outcomes, Kind.OUTSIDE), lambda o: o.wrong, 0.05, at_most=True
        ),
        "one channel named right": _figure(of_kind(outcomes, Kind.ONE_CHANNEL), lambda o: o.exact, 0.85),
    }
    wrong = [o for o in quiet if o.wrongly_stated]
    if wrong:
        table["f, xi or mass stated wrongly, told"] = _figure(wrong, lambda o: o.told, 0.95)
    within = share(value >= 0.9 for value in closed)
    reached = within["share"] >= 0.95 if closed else None
    table["gap closed by 0.9 or more"] = {**within, "target": 0.95, "at_most": False, "reached": reached}
    return table


def closed_quantiles(outcomes: list[Outcome]) -> dict[str, Any]:
    """Return quantiles of the closed fraction over rightly named campaigns; the median shall reach 0.99."""
    named = [outcome for outcome in of_kind(outcomes, *_NAMED_KINDS) if outcome.exact]
    values = [outcome.closed_fraction for outcome in named if outcome.closed_fraction is not None]
    if not values:
        return {"n": 0, "missing": len(named)}
    quantiles = {f"q{100 * q:.0f}": float(np.quantile(values, q)) for q in _QUANTILES}
    reached = quantiles["q50"] >= 0.99
    return {
        "n": len(values),
        "missing": len(named) - len(values),
        **quantiles,
        "median_target": 0.99,
        "reached": reached,
    }


def coverage(outcomes: list[Outcome], names: Names) -> dict[str, Any]:
    """Return how often 90 % intervals cover the truth, over all parameters and by parameter."""
    hits = [hit for outcome in of_kind(outcomes, *_NAMED_KINDS) for hit in outcome.intervals(names)]
    whole = share(covered for _, covered in hits)
    reached = None if whole["share"] is None else 0.85 <= whole["share"] <= 0.95
    by_parameter = {
        name: share(c for other, c in hits if other == name) for name in sorted({name for name, _ in hits})
    }
    by_number = {}
    for number in sorted({len(outcome.label.effects) for outcome in outcomes} - {0}):
        of_number = [o for o in of_kind(outcomes, *_NAMED_KINDS) if len(o.label.effects) == number]
        by_number[str(number)] = share(covers for o in of_number for _, covers in o.intervals(names))
    return {
        **whole,
        "target": [0.85, 0.95],
        "reached": reached,
        "by_parameter": by_parameter,
        "by_number": by_number,
    }


def foretold(outcomes: list[Outcome]) -> dict[str, dict[str, Any]]:
    """Return how often 90 % intervals of the error on a further test cover, by the number of effects."""
    rows = [row for outcome in outcomes for row in (outcome.result or {}).get("foretold", [])]
    numbers = sorted({int(row["effects"]) for row in rows})
    return {str(n): share(row["covers"] for row in rows if row["effects"] == n) for n in numbers}


def reliability(outcomes: list[Outcome], bins: int = 10) -> dict[str, Any]:
    """Return the reliability diagram of stated probabilities and the expected calibration error."""
    stated = [pair for outcome in outcomes for pair in outcome.stated]
    rows, error = [], 0.0
    for number in range(bins):
        low, high = number / bins, (number + 1) / bins
        inside = [(p, true) for p, true in stated if low <= p < high or (number == bins - 1 and p == 1.0)]
        if inside:
            mean = float(np.mean([p for p, _ in inside]))
            row = share(true for _, true in inside)
            rows.append({"from": low, "to": high, "mean_stated": mean, **row})
            error += len(inside) / len(stated) * abs(mean - row["share"])
    return {"n": len(stated), "expected_calibration_error": error if stated else None, "bins": rows}


def confusion(outcomes: list[Outcome]) -> dict[str, dict[str, int]]:
    """Return, per truth (an effect, or what the campaign is), how often each answer was given.

    In campaigns with several effects each hidden effect is a row of its own: named, or the verdict; names
    that are not hidden stand in the row `extra`.
    """
    matrix: dict[str, Counter[str]] = {}
    for outcome in outcomes:
        label = outcome.label
        if len(label.effects) > 1:
            for name in label.names:
                answer = name if name in outcome.named else f"({outcome.verdict}: missed)"
                matrix.setdefault(f"{name} among several", Counter())[answer] += 1
            for name in outcome.named - label.names:
                matrix.setdefault("extra among several", Counter())[name] += 1
            continue
        prefix = {Kind.FAINT: "faint ", Kind.ONE_CHANNEL: "one channel "}.get(Kind(label.kind), "")
        truth = prefix + next(iter(label.names), label.kind)
        answer = " + ".join(sorted(outcome.named)) or f"({outcome.verdict})"
        matrix.setdefault(truth, Counter())[answer] += 1
    return {truth: dict(answers.most_common()) for truth, answers in sorted(matrix.items())}


def breakdowns(outcomes: list[Outcome]) -> dict[str, dict[str, dict[str, Any]]]:
    """Return the rates by kind of noise, by signal-to-noise ratio and by observation."""
    groups: dict[str, dict[str, list[Outcome]]] = {"noise": {}, "snr": {}, "observation": {}}
    for outcome in outcomes:
        label = outcome.label
        groups["noise"].setdefault(label.noise["kind"], []).append(outcome)
        groups["observation"].setdefault(label.observation, []).append(outcome)
        for low, high in _SNR_BINS:
            if low <= label.noise["snr_db"] < high or label.noise["snr_db"] == high == _SNR_BINS[-1][1]:
                groups["snr"].setdefault(f"{low:.0f}-{high:.0f} dB", []).append(outcome)
    return {
        by: {name: rates(members) for name, members in sorted(named.items())} for by, named in groups.items()
    }


def score(outcomes: list[Outcome], names: Names) -> dict[str, Any]:
    """Return every figure."""
    return {
        "campaigns": len(outcomes),
        "kinds": dict(Counter(outcome.label.kind for outcome in outcomes)),
        "rates": rates(outcomes),
        "closed_fraction": closed_quantiles(outcomes),
        "coverage": coverage(outcomes, names),
        "foretold": foretold(outcomes),
        "reliability": reliability(outcomes),
        "confusion": confusion(outcomes),
        "breakdowns": breakdowns(outcomes),
        "failures": failures(outcomes),
    }


def failures(outcomes: list[Outcome]) -> list[dict[str, Any]]:
    """Return the campaigns whose answer is not what it should be, with truth and answer."""
    rows = []
    for outcome in outcomes:
        label = outcome.label
        good = {
            Kind.FAINT: not outcome.wrong,
            Kind.NONE: not _alarm(outcome),
            Kind.MISCALIBRATED: not _alarm(outcome),
            Kind.OUTSIDE: outcome.flagged,
        }.get(Kind(label.kind), outcome.exact)
        if not good or outcome.result is None:
            truth = {effect["name"]: effect["effect_to_noise_db"] for effect in label.effects}
            row = {
                "campaign": label.campaign,
                "kind": label.kind,
                "observation": label.observation,
                "truth": truth,
            }
            row |= {"noise": label.noise["kind"], "snr_db": label.noise["snr_db"]}
            rows.append({**row, "verdict": outcome.verdict, "named": sorted(outcome.named)})
    return rows


def table(figures: dict[str, Any]) -> str:
    """Return the figures as text."""
    lines = [
        f"{figures['campaigns']} campaigns: "
        + ", ".join(f"{n} {kind}" for kind, n in figures["kinds"].items()),
        "",
    ]
    lines.append(f"{'':38s} {'share':>7s}  {'95 % interval':15s} {'n':>5s}  target")
    lines += [_row(name, figure) for name, figure in figures["rates"].items()]
    lines.append(
        _row("90 % intervals that cover", {**figures["coverage"], "target": None, "at_most": False})
        + "  0.85…0.95"
    )
    for number, figure in figures["coverage"]["by_number"].items():
        lines.append(_row(f"  of parameters, {number} hidden effects", {**figure, "target": None}))
    for number, figure in figures["foretold"].items():
        lines.append(_row(f"  of held-out errors, {number} effects", {**figure, "target": None}))
    lines += ["", "closed fraction: " + _inline(figures["closed_fraction"])]
    calibration = figures["reliability"]
    lines += [
        "",
        f"stated probabilities: {_inline({k: v for k, v in calibration.items() if k != 'bins'})}",
    ]
    lines += [
        f"  {row['mean_stated']:.3f} stated, {row['share']:.3f} true (n = {row['of']})"
        for row in calibration["bins"]
    ]
    lines += ["", "confusion (truth: answers)"]
    lines += [f"  {truth:42s} {_inline(answers)}" for truth, answers in figures["confusion"].items()]
    for by, groups in figures["breakdowns"].items():
        lines += ["", f"by {by}"]
        for group, members in groups.items():
            lines += [f"  {group}", *(f"  {_row(name, f)}" for name, f in members.items() if f["of"])]
    return "\n".join(lines) + "\n"


def _row(name: str, figure: dict[str, Any]) -> str:
    if not figure["of"]:
        return f"{name:38s} {'–':>7s}"
    text = f"{name:38s} {figure['share']:7.3f}  {figure['low']:.3f}…{figure['high']:.3f}   {figure['of']:5d}"
    if figure["target"] is None:
        return text
    relation = "≤" if figure["at_most"] else "≥"
    return f"{text}  {relation} {figure['target']:.2f} {'yes' if figure['reached'] else 'NO'}"


def _inline(entries: dict[str, Any]) -> str:
    return ", ".join(
        f"{key} {value:.4f}" if isinstance(value, float) else f"{key} {value}"
        for key, value in entries.items()
    )


def main(arguments: list[str] | None = None) -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="score.py", description=__doc__)
    parser.add_argument("labels", type=Path, help="folder of labels")
    parser.add_argument("results", type=Path, help="folder of results, <campaign>.json each")
    parser.add_argument("--names", type=Path, default=Path(__file__).with_name("parameter_names.toml"))
    parser.add_argument("--json", type=Path, help="where to write the figures")
    given = parser.parse_args(arguments)
    figures = score(read_outcomes(read_labels(given.labels), given.results), read_names(given.names))
    if given.json:
        given.json.write_text(json.dumps(figures, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    sys.stdout.write(table(figures))


if __name__ == "__main__":
    main()
