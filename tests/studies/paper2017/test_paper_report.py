"""The report of the paper says what was found, and every page of it can be set."""

import numpy as np
import pytest
from reliab_studies.paper2017.audit import audit
from reliab_studies.paper2017.cases import cases_dataset, run_paper_cases
from reliab_studies.paper2017.example import run_paper_example
from reliab_studies.paper2017.pages.report import paper_report
from reliab_studies.paper2017.printed import EXAMPLE, PrintedTables
from reliab_studies.paper2017.records import Records, containment

from reliab.motions.motion import Motion


@pytest.fixture(scope="module")
def parts(ellipses_of):
    noise = np.random.default_rng(1).normal(size=3000) * np.hanning(3000)
    motion = Motion(name=EXAMPLE, acceleration=noise, time_step=0.015)
    tables = PrintedTables.read()
    ellipses = ellipses_of(
        tuple(tables.table3["f_hz"]),
        tuple(tables.table4["xi"]),
        motions=100,
        events=19,
        names=tables.table2["record"].to_numpy(),
    )
    return run_paper_example(motion), ellipses, cases_dataset(run_paper_cases(motion), motion)


@pytest.mark.slow
def test_printed_numbers_are_recomputed_or_named_as_impossible(parts):
    example, ellipses, cases = parts
    numbers = audit(ellipses=ellipses, example=example, cases=cases)
    rows = numbers[~numbers["quantity"].str.startswith("error of")]
    rows_with_number = rows.dropna(subset=["printed"])
    impossible_rows = rows_with_number[rows_with_number[["from_tables", "from_records"]].isna().all(axis=1)]
    assert impossible_rows["quantity"].tolist() == ["EA"]
    assert (rows["finding"] != "").all()


def test_containment_counts_motions(parts):
    _, ellipses, _ = parts
    shares = containment(Records(ellipses=ellipses))
    sample = ellipses.sel(f=1.0, xi=0.02, threshold=0.05, metric="rms", curve="ellipse", side="lag")
    share = float(((sample["a"] >= 5.6e-5) & (sample["b"] >= 1.15)).mean())
    assert shares.set_index("f").loc[1.0, "guo_2017_15_corrected"] == pytest.approx(share)


@pytest.mark.slow
def test_the_report_tells_the_audit(parts, text_of):
    example, ellipses, cases = parts
    text = text_of(
        paper_report(title="T", example=example, ellipses=ellipses, cases=cases, provenance={"seed": 1})
    )
    numbers = audit(ellipses=ellipses, example=example, cases=cases).set_index(["item", "quantity"])
    rows = int(numbers.loc[("Table 2", "rows within 10 % in a and b"), "from_records"])
    assert f"So are {rows} of the 100 rows of Table 2" in text
    assert "24 and 28 sets of two components are 104" in text
    assert "of the peak of the exact response, over the whole record" in text
    assert "Zhu et al." in text
    assert "seed 1" in text
