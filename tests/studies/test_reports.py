"""Validations and comparisons of suites are set; their verdicts say what was found."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from reliab_studies.paper2017.cases import cases_dataset, run_paper_cases
from reliab_studies.synthetic_vs_real.report import suites_report
from reliab_studies.validation.report import validation_report

from reliab.motions.motion import Motion
from reliab.report.document import Table
from reliab.report.sections import rates_section


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("reduction", "tone"), [(0.0, "good"), (0.2, "bad")])
def test_a_validation_says_whether_the_promise_is_kept(rates, set_without_warnings, reduction, tone):
    lower_rates = rates.assign(
        **{name: np.maximum(rates[name] - reduction, 0.0) for name in ("rate", "low", "high")}
    )
    tests = pd.DataFrame(
        {"rig": ["a", "a", "b"], "error": [0.02, 0.04, 0.06], "predicted": [0.02, 0.05, 0.05]}
    ).assign(accepted=[True, True, False], good=[True, True, False])
    document = validation_report(
        title="V", rates={"one": lower_rates, "other": rates}, confidence=0.95, beyond=tests, provenance={}
    )
    assert document.tone == tone
    set_without_warnings(document)


def test_a_table_names_the_rates_it_shows(rates, text_of):
    containment = rates[rates["measure"] == "containment"]
    section = rates_section(containment, confidence=0.95)
    (table,) = [block for block in section.blocks if isinstance(block, Table)]
    assert "motions that contain the criterion" in table.caption
    assert "accepted" not in table.caption
    document = validation_report(title="V", rates={"one": rates}, confidence=0.95, provenance={})
    assert "tests that are accepted although their error is too large" in text_of(document)


def test_the_cases_stand_beside_the_printed_numbers(rates, text_of):
    noise = np.random.default_rng(1).normal(size=2000) * np.hanning(2000)
    motion = Motion(name="NOISE", acceleration=noise, time_step=0.02)
    cases = cases_dataset(run_paper_cases(motion), motion)
    document = validation_report(title="V", rates={"one": rates}, confidence=0.95, cases=cases, provenance={})
    text = text_of(document)
    assert "over the first 39.98 s" in text
    for number in ("0.956", "0.760", "0.977", "3.830", "2.55", "3.16", "2.00", "5.35"):
        assert number in text
    assert "index at most 1" in text
    assert "of its RMS" in text


def test_suites_are_compared_with_the_first(rates, set_without_warnings):
    rng = np.random.default_rng(1)
    columns = ("peak_acceleration", "arias_intensity", "significant_duration", "mean_period", "a", "b")
    measures = {
        name: pd.DataFrame(np.exp(rng.normal(size=(9, 6))), columns=list(columns)) for name in ("real", "new")
    }
    periods = np.geomspace(0.1, 4.0, 5)
    spectra = {
        name: xr.DataArray(
            np.exp(rng.normal(size=(9, 5))), dims=("motion", "period"), coords={"period": periods}
        )
        for name in measures
    }
    limits = pd.DataFrame(
        [
            {"suite": name, "f": f, "xi": 0.02, "a": factor * 1e-4, "b": factor / f**2}
            for name, factor in (("real", 1.0), ("new", 4.0))
            for f in (0.5, 1.0)
        ]
    )
    document = suites_report(
        title="S",
        measures=measures,
        spectra=spectra,
        limits=limits,
        coverage=rates.assign(high=rates["rate"]),
        confidence=0.95,
        provenance={},
    )
    verdict = "".join(map(str, document.verdict))
    assert "2.00 to 2.00 times the delay" in verdict
    assert "95 % of the motions of “real” contain it" in verdict
    assert document.tone == "plain"
    set_without_warnings(document)
