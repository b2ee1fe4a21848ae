"""Everything that the paper prints with a number is in the comparison."""

import numpy as np
import pytest
import xarray as xr

from reliab.motions import Motion
from reliab.paper.cases import run_paper_cases
from reliab.paper.example import EXAMPLE, run_paper_example
from reliab.report.kinds.paper import containment, paper_report
from reliab.report.kinds.paper_cases import cases_dataset
from reliab.report.kinds.paper_compared_tables import table_2
from reliab.report.kinds.paper_comparisons import comparisons
from reliab.report.kinds.paper_fits import PaperFits
from reliab.report.printed import printed_tables

DEFINED = ("1", "2", "3a", "3b", "4", "5", "6", "7a", "7b", "7c", "8", "9", "10", "13")
FITTED = ("11", "12", "14", "15", "16a", "16b", "17", "18")


@pytest.fixture(scope="module")
def parts(ellipses_of):
    noise = np.random.default_rng(1).normal(size=3000) * np.hanning(3000)
    motion = Motion(name=EXAMPLE, acceleration=noise, time_step=0.015)
    frequencies = printed_tables().frequencies["f_hz"]
    damping_ratios = printed_tables().damping_ratios["xi"]
    names = printed_tables().motions["record"].to_numpy()
    ellipses = ellipses_of(tuple(frequencies), tuple(damping_ratios), motions=100, events=19, names=names)
    return run_paper_example(motion), ellipses, cases_dataset(run_paper_cases(motion))


def test_nothing_is_missing(parts):
    example, ellipses, cases = parts
    found = comparisons(PaperFits(example=example, ellipses=ellipses), cases, printed_tables())
    expected = [f"Table {number}" for number in range(1, 7)]
    expected += [f"Figure {number}" for number in range(1, 18)]
    expected += [f"Equation ({number})" for number in (*DEFINED, *FITTED)]
    assert set(found["item"]) == set(expected)


def test_what_has_a_printed_number_has_a_reproduced_one(parts):
    example, ellipses, cases = parts
    found = comparisons(PaperFits(example=example, ellipses=ellipses), cases, printed_tables())
    numbers = found.dropna(subset=["printed"])
    assert numbers["reproduced"].notna().all()
    assert set(found[found["printed"].isna() & found["remark"].eq("")]["item"]) == set()


def test_every_row_of_table_2_is_compared(parts):
    example, ellipses, _ = parts
    rows = table_2(PaperFits(example=example, ellipses=ellipses.isel(motion=slice(90))), printed_tables())
    assert len(rows) == 100
    assert rows["a"].isna().sum() == 10


def test_containment_counts_motions(parts):
    example, ellipses, _ = parts
    found = containment(PaperFits(example=example, ellipses=ellipses))
    sample = ellipses.sel(f=1.0, xi=0.02, threshold=0.05, metric="rms", curve="ellipse")
    share = float(((sample["a"] >= 5.6e-5) & (sample["b"] >= 1.15)).mean())
    assert found.set_index("f").loc[1.0, "guo_2017_15_corrected"] == pytest.approx(share)


def test_the_report_is_set(parts, set_without_warnings):
    example, ellipses, cases = parts
    document = paper_report(
        title="T", example=example, ellipses=ellipses, cases=cases, provenance={"seed": 1}
    )
    set_without_warnings(document)


def test_the_printed_tables_give_the_printed_quantiles(parts):
    example, ellipses, cases = parts
    printed = printed_tables()
    order = xr.DataArray(printed.motions["record"].to_numpy(), dims="motion")
    as_printed = ellipses.sel(motion=order).copy(deep=True)
    at = {"f": 1.0, "xi": 0.02, "threshold": 0.05, "metric": "rms", "curve": "ellipse"}
    as_printed["a"].loc[at], as_printed["b"].loc[at] = (
        printed.motions["a"].to_numpy(),
        printed.motions["b"].to_numpy(),
    )
    found = comparisons(PaperFits(example=example, ellipses=as_printed), cases, printed).set_index(
        ["item", "quantity"]
    )
    assert abs(found.loc[("Figure 11", "correlation of a and b"), "difference"]) < 1e-3
    assert abs(found.loc[("Equation (12)", "a"), "difference"]) < 0.01
    assert abs(found.loc[("Equation (12)", "b"), "difference"]) < 0.01
