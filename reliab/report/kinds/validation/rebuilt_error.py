"""Section on the rebuilt error beside criteria, on the same simulated tests."""

import pandas as pd

from reliab.report.document import Column, Figure, Paragraph, Section, Table
from reliab.report.figures.rebuilt_error_study import accepted_tests, stated_errors
from reliab.report.numbers import Fixed, Whole
from reliab.report.prose import Prose, prose
from reliab.report.wording import PERCENT, percent
from reliab.validation.rebuilt_error_study import (
    LINEAR,
    OWN_BOUNDARY,
    PLAIN,
    REBUILT,
    RIGHT,
    WITH_MODEL,
    summarised,
)

_NAMES = {"guo_2017_15": "equation (15)", "guo_2017_18": "equation (18)"}


def rebuilt_error_section(tests: pd.DataFrame, threshold: float) -> Section:
    """Report what the rebuilt error is worth beside criteria.

    Parameters
    ----------
    tests : pandas.DataFrame
        As :func:`reliab.validation.rebuilt_error_study.try_tests` gives it.
    threshold : float
        Error up to which a test is good [-].

    Returns
    -------
    Section
        Two figures and four tables.
    """
    named = tests.assign(judge=tests["judge"].replace(_NAMES))
    tables = summarised(named)
    plain = named[
        (named["specimen"] == LINEAR) & (named["sensor"] == PLAIN.sensor) & (named["stated"] == RIGHT)
    ]
    conditions = tables["conditions"].assign(
        condition=[
            sensor if stated == RIGHT else f"{sensor}, {stated}"
            for sensor, stated in zip(
                tables["conditions"]["sensor"], tables["conditions"]["stated"], strict=True
            )
        ]
    )
    specimens, looks = tables["specimens"], tables["looks"].set_index("specimen")["looks_nonlinear"]
    false_flags = tables["looks"].set_index(["specimen", "sensor"])["looks_nonlinear"]
    return Section(
        title="The error of the test itself",
        blocks=(
            Paragraph(
                text=prose(
                    "The same simulated tests, judged by the error that is rebuilt from command and measured "
                    "displacement, and by $A$ and $d$ with criteria and with the own boundary of the motion. "
                    "A test is good up to {threshold} of true error, which is that of the true piston "
                    "against the same loop with a perfect actuator. A criterion that says nothing of leads "
                    "accepts none. A verdict is “reliable” as `reliab assess` gives it: the error stays "
                    "below the threshold with 95 % probability, and the specimen does not look nonlinear. "
                    "A motion is contained when none of its bad tests is accepted, and an error in the "
                    "interval when the stated 90 % interval holds it. "
                    "The rebuilt error takes the structure as linear and stated; the specimens that are not "
                    "linear look so in {nonlinear} of their tests, the linear ones in {linear} at 40 dB.",
                    threshold=percent(threshold),
                    nonlinear=percent(float(looks.drop(LINEAR).mean()))
                    if len(looks.drop(LINEAR))
                    else "none",
                    linear=percent(float(false_flags[LINEAR, PLAIN.sensor])),
                )
            ),
            Figure(
                drawing=stated_errors(plain, (REBUILT, OWN_BOUNDARY)),
                caption=(
                    "Error that is stated over the true one, sensor of 40 dB: the rebuilt error needs no "
                    "ground motion and no premise on the actuator; the own boundary takes the actuator for a "
                    "gain and a delay."
                ),
                label="fig:rebuilt-stated",
            ),
            Figure(
                drawing=accepted_tests(tables["judges"]),
                caption="Bad and good tests that each judge accepts, sensor of 40 dB.",
                label="fig:rebuilt-accepted",
            ),
            _table(
                tables["judges"], "judge", "Judge", "Judges on linear specimens, sensor of 40 dB.", "judges"
            ),
            _table(
                conditions[conditions["judge"] == REBUILT],
                "condition",
                "Sensor, and what is stated wrongly",
                "The rebuilt error by sensor and by what is stated wrongly, the tolerance being as large.",
                "conditions",
            ),
            _table(
                tables["rigs"][tables["rigs"]["judge"] == REBUILT],
                "rig",
                "Actuator",
                "The rebuilt error by actuator, sensor of 40 dB.",
                "rigs",
            ),
            _table(
                specimens[specimens["judge"].isin([REBUILT, WITH_MODEL])].assign(
                    named=lambda rows: (
                        rows["specimen"]
                        + rows["judge"].map({REBUILT: ", taken as linear", WITH_MODEL: ", with a model"})
                    )
                ),
                "named",
                "Specimen",
                "Nonlinear specimens without a model, and with one whose parameters are off by about 1 %.",
                "specimens",
            ),
        ),
        label="sec:rebuilt",
    )


def _table(frame: pd.DataFrame, key: str, heading: str, caption: Prose, label: str) -> Table:
    share, ratio = Fixed(decimals=1, factor=PERCENT), Fixed(decimals=3)
    bad, good, stated = "bad tests", "good tests", "stated over true error"
    return Table(
        frame=frame,
        columns=(
            Column(key=key, heading=heading),
            Column(key="bad", heading="tried", number=Whole(), group=bad),
            Column(key="bad_accepted", heading="accepted", unit="%", number=share, group=bad),
            Column(key="good", heading="tried", number=Whole(), group=good),
            Column(key="good_accepted", heading="accepted", unit="%", number=share, group=good),
            Column(key="contained", heading="Motions contained", unit="%", number=share),
            Column(key="ratio_05", heading="5 %", number=ratio, group=stated),
            Column(key="ratio_95", heading="95 %", number=ratio, group=stated),
            Column(key="covered", heading="In interval", unit="%", number=share),
        ),
        caption=caption,
        label=f"tab:rebuilt-{label}",
    )
