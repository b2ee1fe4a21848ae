"""The report of blind campaigns says how many targets were reached and names every failure."""

import json

import pandas as pd
from reliab_studies.blind_evaluation.report import (
    blind_evaluation_report,
    discrepancy_confusion,
    discrepancy_reliability,
)

from reliab.report.content import CONTENT_FILE, files_of

RATE = {"count": 3, "of": 4, "share": 0.75, "low": 0.3, "high": 0.95, "at_most": False}
FAILURE = {
    "campaign": "campaign_7", "kind": "single", "observation": "full", "truth": {"gap": 3.2},
    "noise": "white", "snr_db": 30.0, "verdict": "named", "named": ["backlash"],
}  # fmt: skip
RUN = {
    "code": "abc", "seeds": "1 to 4", "campaigns": 4, "kinds": {"single": 4},
    "rates": {
        "single named right, alone": {**RATE, "target": 0.97, "reached": False},
        "three exactly right": {**RATE, "of": 0, "target": 0.9, "reached": None},
        "answered": {**RATE, "count": 4, "share": 1.0, "target": 1.0, "reached": True},
    },
    "closed_fraction": {"n": 3, "q5": 0.98, "q50": 1.0},
    "coverage": {**RATE, "target": [0.85, 0.95], "reached": False},
    "reliability": {"bins": [{"mean_stated": 0.99, "share": 0.75, "low": 0.3, "high": 0.95, "of": 4}]},
    "confusion": {"gap": {"gap": 3, "backlash": 1}, "faint gap": {"gap": 1}, "none": {"(named)": 1}},
    "failures": [FAILURE],
}  # fmt: skip


def text_of(*runs):
    document = blind_evaluation_report(title="Blind", runs=runs, provenance={})
    return json.dumps(json.loads(files_of(document)[CONTENT_FILE]), ensure_ascii=False)


def test_the_verdict_counts_the_campaigns():
    text = text_of(RUN)
    assert "1 of 2 targets" in text
    assert "All runs" not in text


def test_failures_are_named():
    assert "backlash" in text_of(RUN)
    assert "There was none." in text_of({**RUN, "failures": []})


def test_earlier_runs_stand_beside_the_last():
    assert "Code old" in text_of({**RUN, "code": "old"}, RUN)


def test_evaluations_are_drawn():
    bins = pd.DataFrame(
        {
            "mean_stated": [0.5, 0.99],
            "share": [0.4, 1.0],
            "low": [0.2, 0.9],
            "high": [0.7, 1.0],
            "of": [10, 90],
        }
    )
    assert discrepancy_reliability(bins).axes[0].get_lines()
    counts = {"gap": {"gap": 9, "(not_identifiable)": 1}, "none": {"(no_missing_effect)": 12}}
    texts = {text.get_text() for text in discrepancy_confusion(counts).axes[0].texts}
    assert texts == {"9", "1", "12"}
