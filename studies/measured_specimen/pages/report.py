"""Report of how well a specimen is learned from its own force."""

from collections.abc import Mapping

import pandas as pd

from reliab.report import (
    Block,
    Column,
    Document,
    Figure,
    Fixed,
    Paragraph,
    Prose,
    Section,
    Table,
    Whole,
    provenance_of,
)
from reliab.report.prose import prose
from reliab.significant import counted, percent
from reliab.vocabulary import PERCENT

from ..pages.ratios import ratios_by_family
from ..summary import ALL, compare_with_stated

_SHARE = Fixed(decimals=0, factor=PERCENT)
_SMALL_SHARE = Fixed(decimals=1, factor=PERCENT)


def measured_specimen_report(
    *,
    title: str,
    tests: pd.DataFrame,
    rates: pd.DataFrame,
    threshold: float,
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report errors of tests whose specimen is known by its force only.

    `threshold`: error up to which a test is good [-].
    """
    overall = rates[rates["family"] == ALL].iloc[0]
    return Document(
        kind="Specimens known by their force",
        title=title,
        verdict=prose(
            "Of {tests} the computed error lies within 10 % of the true one in {near}, and within 25 % "
            "in {wide}; the 90 % interval holds it in {held}.",
            tests=counted(int(overall["tests"]), "test"),
            near=percent(float(overall["near"]), decimals=0),
            wide=percent(float(overall["wide"]), decimals=0),
            held=percent(float(overall["held"]), decimals=0),
        ),
        facts={
            "Families": str(len(rates) - 1),
            "Tests of each": " to ".join(
                str(int(n)) for n in sorted({rates["tests"].iloc[:-1].min(), rates["tests"].iloc[:-1].max()})
            ),
            "Good test": f"error of at most {percent(threshold)} RMS",
            "Purpose": purpose,
        },
        blocks=(_method(), _errors(tests, rates), _verdicts(rates), _corrected(rates), *_linear(tests)),
        provenance=provenance_of(provenance),
    )


def _method() -> Section:
    text = prose(
        "Structures of 0.5 to 2 Hz with 2 to 5 % damping, of whose stiffness the specimen bears 20 to 100 % "
        "before it yields; actuators with a gain, a lag, a delay and now and then play; white noise on "
        "displacement and force; 40 s at 1024 Hz. Everything that is stated is exact, and the peak of the "
        "linear response is 1.5 to 5 yield displacements. The specimens share no code with the elements "
        "that learn them. Where the interval is called a 90 % interval, it is meant for such tests: the "
        "scatter that stands for what a representation misses was settled on other tests of these families."
    )
    return Section(title="What is simulated", blocks=(Paragraph(text=text),))


def _errors(tests: pd.DataFrame, rates: pd.DataFrame) -> Section:
    judged = tests.dropna(subset=["value"])
    blocks: tuple[Block, ...] = (
        Figure(
            drawing=ratios_by_family(judged),
            caption="Computed over true error of each test, with its 90 % interval.",
            label="fig:ratios",
            leads=True,
        ),
        Table(
            frame=rates,
            columns=(
                Column(key="family", heading="Specimen", wide=True),
                Column(key="tests", heading="Tests", number=Whole()),
                Column(key="near", heading="10 %", unit="%", number=_SHARE, group="within"),
                Column(key="wide", heading="25 %", unit="%", number=_SHARE, group="within"),
                Column(key="held", heading="Interval holds", unit="%", number=_SHARE),
            ),
            caption="Tests whose computed error comes near the true one, and whose interval holds it.",
            label="tab:errors",
        ),
    )
    return Section(title="Computed and true errors", blocks=blocks)


def _verdicts(rates: pd.DataFrame) -> Section:
    columns = (
        Column(key="family", heading="Specimen", wide=True),
        Column(key="bad", heading="Bad tests", number=Whole()),
        Column(key="false_safe", heading="Bad and accepted", unit="%", number=_SMALL_SHARE),
        Column(key="accepted", heading="accepted", unit="%", number=_SHARE, group="good tests"),
        Column(key="refused_good", heading="refused", unit="%", number=_SHARE, group="good tests"),
        Column(key="undecided", heading="Undecided", unit="%", number=_SHARE),
    )
    caption = "Verdicts: accepted bad tests and undecided ones among all, the others among good tests."
    return Section(
        title="Verdicts",
        blocks=(Table(frame=rates, columns=columns, caption=caption, label="tab:verdicts"),),
    )


def _corrected(rates: pd.DataFrame) -> Section:
    columns = (
        Column(key="family", heading="Specimen", wide=True),
        Column(key="left", heading="Error that is left", unit="%", number=_SHARE),
        Column(key="inside", heading="Samples in the band", unit="%", number=_SHARE),
    )
    caption = (
        "RMS error of the corrected response over that of the measured one, median of the tests, and samples "
        "of the exact response within the 90 % band."
    )
    return Section(
        title="The corrected response",
        blocks=(Table(frame=rates, columns=columns, caption=caption, label="tab:corrected"),),
    )


def _linear(tests: pd.DataFrame) -> tuple[Section, ...]:
    """Say what tests of linear specimens lose; nothing where none was judged."""
    lost = compare_with_stated(tests)
    if not lost:
        return ()
    number = int(lost["tests"])
    text: Prose = prose(
        "{tests} judged as if the specimen were stated as linear, too: {agree} of the verdicts are the same, "
        "{opposed} opposite ones; the interval of the error is {width:.2f} times as wide in the median, and "
        "{widest:.2f} times or more in 5 %.",
        tests="One test of a linear specimen was"
        if number == 1
        else f"{number} tests of linear specimens were",
        agree=percent(lost["agree"], decimals=0),
        opposed=percent(lost["opposed"], decimals=0),
        width=lost["width"],
        widest=lost["widest"],
    )
    return (Section(title="What a linear specimen loses", blocks=(Paragraph(text=text),)),)
