"""Verdicts of criteria on simulated tests."""

import numpy as np
import pandas as pd

from reliab.report import Column, Section, Table, Whole, law_in_words
from reliab.report.prose import prose
from reliab.significant import percent


def verdicts_section(verdicts: pd.DataFrame, confidence: float) -> Section:
    """Count good and bad tests that criteria accept and refuse.

    `verdicts`: columns `candidate`, `confidence`, `good_accepted`, `good_rejected`, `bad_accepted`,
    `bad_rejected`; `confidence`: share of the population's ground motions that the criteria state [-].
    """
    rows = verdicts[np.isclose(verdicts["confidence"], confidence)]
    rows = rows.assign(candidate=[law_in_words(str(name)) for name in rows["candidate"]])
    good, bad = prose("good tests"), prose("bad tests")
    return Section(
        title="Verdicts on simulated tests",
        blocks=(
            Table(
                frame=rows,
                columns=(
                    Column(key="candidate", heading="Criterion"),
                    Column(key="good_accepted", heading="accepted", number=Whole(), group=good),
                    Column(key="good_rejected", heading="refused", number=Whole(), group=good),
                    Column(key="bad_accepted", heading="accepted", number=Whole(), group=bad),
                    Column(key="bad_rejected", heading="refused", number=Whole(), group=bad),
                ),
                caption=prose(
                    "Verdicts of the criteria that state {share} on tests whose amplitude errors and delays "
                    "lie evenly around the boundaries, each under a motion of a held-out earthquake; a test "
                    "is good when its simulated error stays below the threshold.",
                    share=percent(confidence),
                ),
                label="tab:confusion",
            ),
        ),
    )
