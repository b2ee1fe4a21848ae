"""Actuators that are no constant gain and delay: how well A and d describe their tests."""

import pandas as pd

from reliab.report import Column, Figure, Fixed, Paragraph, Section, Table, Whole
from reliab.report.prose import prose
from reliab.vocabulary import PERCENT

from ..pages.actuators_beyond_the_model import error_beyond_the_model


def actuators_section(tests: pd.DataFrame) -> Section:
    """Report tests whose actuators are no constant gain and delay."""
    return Section(
        title="Actuators that are no constant gain and delay",
        blocks=(
            Paragraph(
                text=prose(
                    "Each test was simulated with its actuator; $A$ and $d$ were evaluated from command and "
                    "measured displacement as a laboratory would, and the error was compared with that of a "
                    "constant gain $A$ and delay $d$ (@fig:beyond, @tab:beyond). The delays stand below and "
                    "above what the criterion allows and what the motion of each test tolerates, so that "
                    "good and bad tests are accepted or refused as the criterion decides."
                )
            ),
            Figure(
                drawing=error_beyond_the_model(tests),
                caption=(
                    "Error of each test over the error that a constant gain and delay would have made: "
                    "on the diagonal, A and d describe the actuator fully."
                ),
                label="fig:beyond",
                floats=True,
            ),
            _table(_by_actuator(tests)),
        ),
    )


def _by_actuator(tests: pd.DataFrame) -> pd.DataFrame:
    """Count verdicts and measure how far the prediction is off, for each actuator."""
    grouped = tests.assign(
        excess=(tests["error"] - tests["predicted"]).abs() / tests["predicted"],
        bad=~tests["good"],
        unsafe=tests["accepted"] & ~tests["good"],
        wasted=~tests["accepted"] & tests["good"],
    ).groupby("rig", sort=False)
    return grouped.agg(
        tests=("error", "size"),
        typical=("excess", "median"),
        worst=("excess", "max"),
        bad=("bad", "sum"),
        accepted=("accepted", "sum"),
        unsafe=("unsafe", "sum"),
        wasted=("wasted", "sum"),
    ).reset_index()


def _table(frame: pd.DataFrame) -> Table:
    share, off = Fixed(decimals=1, factor=PERCENT), "off the prediction"
    return Table(
        frame=frame,
        columns=(
            Column(key="rig", heading="Actuator", wide=True),
            Column(key="tests", heading="Tests", number=Whole()),
            Column(key="typical", heading="median", unit="%", number=share, group=off),
            Column(key="worst", heading="worst", unit="%", number=share, group=off),
            Column(key="bad", heading="Bad", number=Whole()),
            Column(key="accepted", heading="Accepted", number=Whole()),
            Column(key="unsafe", heading="Accepted, yet bad", number=Whole()),
            Column(key="wasted", heading="Good, yet refused", number=Whole()),
        ),
        caption=(
            "Verdicts on actuators beyond the model; a test is bad when its own simulated error "
            "exceeds the threshold."
        ),
        label="tab:beyond",
    )
