"""Report of the virtual multi-axial benchmark."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure as MatplotlibFigure
from reliab_studies.laboratory.wording import count_good_tests

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Column, Document, Figure, Section, Table, provenance_of
from reliab.report.numbers import Fixed
from reliab.report.prose import Prose, prose
from reliab.report.style import apply_style, label_logarithmic, legend_below, line, name_axes, panels, plain

from .controllers import PERFECT
from .outcomes import DEGREES
from .plant import NOMINAL

_NAMES = {
    PERFECT: "perfect actuators",
    "none": "no controller",
    "decoupling": "decoupling inverse",
    "feedforward": "feedforward for each actuator",
    "lqg": "feedforward and LQG",
    "rodeac": "RoDeAC",
}
_SHOWN = (("J1", "ms"), ("J2", "%"), ("J5", "%"), ("J7", "%"))
_SIGNS = ("x", "θ")
_ENDS, _ORDINARY = ("low", "high"), ("ordinary_low", "ordinary_high")


def marths_report(
    *,
    title: str,
    tests: Sequence[Mapping[str, Any]],
    threshold: float,
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report the benchmark from its tests."""
    rows = [dict(test) for test in tests]
    judged = _list_errors(rows)
    return Document(
        kind="Virtual multi-axial benchmark",
        title=title,
        verdict=_verdict(judged, threshold),
        facts={
            "Question": "Which controller keeps the error of a test with two coupled actuators small, and "
            "does the error that is rebuilt from the test alone agree with the true one?",
            "Tests": _count_tests(rows),
            "Not compared": "With published values: no paper with numbers of this benchmark was available.",
            "Purpose": purpose,
        },
        blocks=(_criteria(rows), _uncertain(rows), _errors(judged, threshold)),
        provenance=provenance_of(provenance),
    )


def _count_tests(rows: Sequence[Mapping[str, Any]]) -> Prose:
    lost = sum(bool(row["lost"]) for row in rows)
    plants = len({row["plant"] for row in rows}) - 1
    return prose(
        "{tests} under {motions}; the nominal plant under each, {plants} uncertain plants under one each; "
        "{lost} lost to motions ten times as large as they should be",
        tests=len(rows),
        motions=", ".join(dict.fromkeys(str(row["motion"]) for row in rows)),
        plants=plants,
        lost=lost,
    )


def _list_errors(rows: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Errors of the tests, one row for each displacement, without perfect actuators."""
    return pd.DataFrame(
        [
            {
                "name": _NAMES[row["controller"]],
                "motion": row["motion"],
                "plant": row["plant"],
                "degree": sign,
                **row["error"][degree],
            }
            for row in rows
            if row["controller"] != PERFECT and not row["lost"]
            for degree, sign in zip(DEGREES, _SIGNS, strict=True)
        ],
        columns=["name", "motion", "plant", "degree", "true", "value", *_ENDS, *_ORDINARY],
    )


def _verdict(judged: pd.DataFrame, threshold: float) -> Prose:
    if judged.empty:
        return "No test was kept."
    largest = judged.groupby(["name", "motion", "plant"], sort=False)["true"].max()
    good = (largest <= threshold).droplevel(["motion", "plant"])
    ratio = judged["value"] / judged["true"]
    near = float(((ratio > 0.98) & (ratio < 1.02)).mean())  # noqa: PLR2004 - 2 %
    return prose(
        "The errors of both displacements stay below {threshold} {kept}. The error rebuilt from a test alone "
        "lies within 2 % of the true one in {near} of cases.",
        threshold=percent(threshold),
        kept=count_good_tests(good),
        near=percent(near, decimals=0),
    )


def _criteria(rows: Sequence[Mapping[str, Any]]) -> Section:
    """Criteria of the nominal plant, beside their values with perfect actuators."""
    nominal = [row for row in rows if row["plant"] == NOMINAL and not row["lost"]]
    frame = pd.DataFrame([{**_spread(row), "motion": row["motion"]} for row in nominal])
    columns = (
        Column(key="name", heading="Controller", wide=True),
        Column(key="motion", heading="Motion"),
        *_columns(_SHOWN),
    )
    text = (
        "J7 to J10 compare with the undivided structure. The bay that was taken away from it is "
        "idealised and differs from the frame that is tested, so that even perfect actuators do not bring "
        "these criteria to zero. What a controller adds is the difference from the value of perfect "
        "actuators; J1 to J6 and the error below distinguish controllers."
    )
    caption = (
        "Nominal plant. J1, J2: delay and RMS of tracking, first and second actuator; J5, J7: x and θ "
        "against the computed node and the undivided structure. J4 is J1 in the benchmark's code."
    )
    return Section(
        title="Criteria and their floor",
        blocks=(text, Table(frame=frame, columns=columns, caption=caption, label="tab:criteria")),
    )


def _columns(criteria: Sequence[tuple[str, str]]) -> tuple[Column, ...]:
    return tuple(
        Column(
            key=f"{name} {place}",
            heading=str(place + 1) if name in {"J1", "J2"} else _SIGNS[place],
            unit=unit,
            number=Fixed(decimals=1),
            group=name,
        )
        for name, unit in criteria
        for place in range(2)
    )


def _spread(row: Mapping[str, Any]) -> dict[str, Any]:
    values = {f"{name} {place}": row[name][place] for name, _ in _SHOWN for place in range(2)}
    return {"name": _NAMES[row["controller"]], **values}


def _uncertain(rows: Sequence[Mapping[str, Any]]) -> Section:
    """Means over the uncertain plants, and how many tests were lost."""
    uncertain = [row for row in rows if row["plant"] != NOMINAL]
    content = []
    for name in dict.fromkeys(row["controller"] for row in uncertain):
        of_name = [row for row in uncertain if row["controller"] == name]
        completed = pd.DataFrame([_spread(row) for row in of_name if not row["lost"]])
        means = completed.drop(columns="name").mean().to_dict() if len(completed) else {}
        content.append(
            {"name": _NAMES[name], "tests": len(of_name), "lost": len(of_name) - len(completed), **means}
        )
    names = [f"{name} {place}" for name, _ in _SHOWN for place in range(2)]
    frame = pd.DataFrame(content, columns=["name", "tests", "lost", *names])
    columns = (
        Column(key="name", heading="Controller", wide=True),
        Column(key="tests", heading="Tests", number=Fixed(decimals=0)),
        Column(key="lost", heading="Lost", number=Fixed(decimals=0)),
        *_columns(_SHOWN),
    )
    caption = "Means over the tests of uncertain plants that were not lost."
    return Section(
        title="Uncertain plants",
        blocks=(Table(frame=frame, columns=columns, caption=caption, label="tab:uncertain"),),
    )


def _errors(judged: pd.DataFrame, threshold: float) -> Section:
    number = Fixed(decimals=2, factor=PERCENT)
    nominal = judged[judged["plant"] == NOMINAL]
    columns = (
        Column(key="name", heading="Controller", wide=True),
        Column(key="motion", heading="Motion"),
        Column(key="degree", heading=""),
        Column(key="true", heading="True", unit="%", number=number),
        *(
            Column(key=key, heading=heading, unit="%", number=number, group="Rebuilt from the test")
            for key, heading in (("value", "Value"), ("low", "From"), ("high", "To"))
        ),
        *(
            Column(key=key, heading=heading, unit="%", number=number, group="Ordinary equipment")
            for key, heading in zip(_ORDINARY, ("From", "To"), strict=True)
        ),
    )
    held = np.asarray((judged["low"] <= judged["true"]) & (judged["true"] <= judged["high"]), dtype=bool)
    safe = np.asarray((judged["high"] < threshold) & (judged["true"] > threshold), dtype=bool)
    text = prose(
        "RMS error of x and θ over the peak of the same test with perfect actuators. Over all {cases} errors "
        "the 90 % interval, with everything exact but the noise, holds the true one in {held}; {safe} of "
        "the intervals below {threshold} belong to a true error above it.",
        cases=len(judged),
        held=percent(float(held.mean()) if held.size else 0.0, decimals=0),
        safe=int(safe.sum()),
        threshold=percent(threshold),
    )
    caption = (
        "True and rebuilt errors of the nominal plant: with everything exact but the noise, as it is in the "
        "simulation, and with what ordinary equipment leaves unknown."
    )
    spread = Figure(
        drawing=_draw_errors(judged),
        caption="True error of both displacements, a mark for each test. Look for controllers that stay low "
        "whatever the plant.",
        label="fig:errors",
        leads=True,
    )
    return Section(
        title="The error of each test",
        blocks=(
            spread,
            text,
            Table(frame=nominal, columns=columns, caption=caption, label="tab:errors"),
        ),
    )


_HEIGHT = 80.0
_WIDTH = 150.0
_SPREAD = 0.2


@apply_style
def _draw_errors(judged: pd.DataFrame) -> MatplotlibFigure:
    """Draw the true error of every test over its controller, one mark for each displacement."""
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    names = list(dict.fromkeys(judged["name"]))
    for rank, (sign, errors) in enumerate(judged.groupby("degree", sort=False)):
        where = errors["name"].map(names.index) + _SPREAD * (rank - 0.5)
        look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none"}
        place.plot(where, PERCENT * errors["true"], label=plain(str(sign)), **look)
    values = PERCENT * judged["true"]
    place.set(yscale="log", ylim=(0.8 * values.min(), 1.25 * values.max()))
    labels = [plain(name).replace(" for ", "\nfor ").replace(" and ", "\nand ") for name in names]
    place.set_xticks(range(len(names)), labels)
    label_logarithmic(place.yaxis)
    name_axes(place, "", "RMS error [%]")
    legend_below(figure, place, columns=2)
    return figure
