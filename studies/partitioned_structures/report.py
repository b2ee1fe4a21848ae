"""Report of what predicts the error of partitioned tests."""

from collections.abc import Mapping

import pandas as pd
from reliab_studies.validation.report import error_beyond_the_model

from reliab.core.vocabulary import PERCENT
from reliab.report.document import Column, Document, Figure, Section, Table, provenance_of
from reliab.report.numbers import Fixed
from reliab.report.prose import Prose, prose

from .running import PREDICTIONS, ratios

_NAMES = {
    "law_18": "equation (18)",
    "law_with_share": "mean law with the share α",
    "resolved": "A(f) and d(f), with the force's lag",
    "rebuilt": "rebuilt from the test",
}
_SHORT = {"law_18": "(18)", "law_with_share": "with α", "resolved": "A(f), d(f)", "rebuilt": "rebuilt"}


def report_partitioned_structures(
    *,
    title: str,
    tests: pd.DataFrame,
    shares: pd.DataFrame,
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report predictions against simulated errors."""
    completed = tests[~tests["lost"]]
    table = ratios(completed).assign(name=lambda frame: [_NAMES[name] for name in frame["prediction"]])
    return Document(
        kind="Partitioned structures",
        title=title,
        verdict=_verdict(table.set_index("prediction")),
        facts={
            "Question": "Which prediction of the error of such a test can be relied on?",
            "Tests": prose(
                "{all} of {structures} structures under {motions} motions; {lost} were lost to instability",
                all=len(tests),
                structures=tests["structure"].nunique(),
                motions=tests["motion"].nunique(),
                lost=int(tests["lost"].sum()),
            ),
            "Purpose": purpose,
        },
        blocks=(_predictions(table, completed), _compare_structures(completed), _shares(shares)),
        provenance=provenance_of(provenance),
    )


def _verdict(table: pd.DataFrame) -> Prose:
    """Name the prediction that scatters least, with its ratios, and the one that is furthest off."""
    best, worst = str(table["scatter"].idxmin()), str((table["median"] - 1.0).abs().idxmax())
    low, high, median = table["low"][best], table["high"][best], table["median"][worst]
    return prose(
        "Rely on the error {best}: it lies between {low} and {high} times the simulated error in 90 % "
        "of these tests. {worst} states {median} times the simulated error in the median of these tests.",
        best=_NAMES[best],
        low=f"{low:.2f}",
        high=f"{high:.2f}",
        worst=_NAMES[worst].replace("equation", "Equation"),
        median=f"{median:.1f}",
    )


def _predictions(table: pd.DataFrame, tests: pd.DataFrame) -> Section:
    columns = (
        Column(key="name", heading="Prediction", wide=True),
        Column(key="tests", heading="Tests", number=Fixed(decimals=0)),
        *(
            Column(key=key, heading=heading, number=Fixed(decimals=3), group="Predicted over simulated")
            for key, heading in (
                ("median", "Median"),
                ("scatter", "Scatter"),
                ("low", "5 %"),
                ("high", "95 %"),
            )
        ),
    )
    caption = (
        "Predicted over simulated RMS error. Scatter is the standard deviation of the ratio's logarithm. "
        "Equation (18) counts from 0.25 to 2 Hz, the range in which it is valid; the law with the share α "
        "if the specimen is a spring and α at least ten times the damping ratio."
    )
    long = pd.concat(
        [
            pd.DataFrame({"rig": _NAMES[name], "error": tests["error"], "predicted": tests[name]})
            for name in PREDICTIONS[1:]
        ]
    ).dropna()
    blocks = (
        Table(frame=table, columns=columns, caption=caption, label="tab:predictions"),
        Figure(
            drawing=error_beyond_the_model(long, prediction="Predicted error"),
            caption="Simulated error of every test over three predictions of it; on the line they agree.",
            label="fig:predictions",
            leads=True,
        ),
    )
    return Section(title="Predicted against simulated error", blocks=blocks)


def _compare_structures(tests: pd.DataFrame) -> Section:
    relative = tests[["structure"]].copy()
    for name in PREDICTIONS:
        relative[name] = tests[name] / tests["error"]
    frame = relative.groupby("structure", sort=False).median().reset_index()
    columns = (
        Column(key="structure", heading="Structure", wide=True),
        *(
            Column(key=name, heading=_SHORT[name], number=Fixed(decimals=2), group="Median of the ratio")
            for name in PREDICTIONS
        ),
    )
    caption = (
        "Predicted over simulated error by structure, for the predictions of the table above in its order."
    )
    table = Table(frame=frame, columns=columns, caption=caption, label="tab:structures")
    return Section(title="By structure", blocks=(table,))


def _shares(shares: pd.DataFrame) -> Section:
    share = Fixed(decimals=2, factor=PERCENT)
    columns = (
        Column(key="structure", heading="Structure", wide=True),
        Column(key="mode", heading="Mode", number=Fixed(decimals=0)),
        Column(key="f", heading="f", unit="Hz", number=Fixed(decimals=2)),
        Column(key="xi", heading="ξ", unit="%", number=share),
        *(
            Column(key=key, heading=heading, unit="%", number=share, group="The specimen's share")
            for key, heading in (("alpha", "Stiffness"), ("damping", "Damping"), ("mass", "Mass"))
        ),
        Column(key="critical_delay_ms", heading="Critical delay", unit="ms", number=Fixed(decimals=2)),
    )
    caption = "Modes of the structures and the specimen's share in each; the critical delay is exact."
    return Section(
        title="Structures",
        blocks=(Table(frame=shares, columns=columns, caption=caption, label="tab:shares"),),
        appendix=True,
    )
