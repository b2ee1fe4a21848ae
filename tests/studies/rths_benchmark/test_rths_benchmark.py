"""The benchmark as a study runs it: rows, summaries, and what is refused."""

import json

import numpy as np
import pytest
from reliab_studies.partitioned_structures.running import (
    PREDICTIONS,
    draw_tests,
    partitioned_structures,
    ratios,
    run_tests,
    shares_of_structures,
)
from reliab_studies.rths_benchmark.outcomes import (
    BenchmarkRequest,
    compare_with_published,
    find_published_motion,
    read_published,
    run_benchmark,
    summary,
)

from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion


@pytest.fixture
def shaking():
    t = np.arange(0, 12, 0.01)
    acceleration = np.sin(2 * np.pi * 3.0 * t) * np.minimum(t / 2, 1) * np.exp(-t / 4) * (t > 1)
    return Motion(name="folder/elcentro", acceleration=acceleration, time_step=0.01)


def test_rows_hold_finite_numbers(shaking):
    request = BenchmarkRequest(cases=(4,), compensators=("none", "inverse"), perturbed=1)
    rows = run_benchmark([shaking], request)
    assert len(rows) == 4
    json.dumps(rows, allow_nan=False)
    unstable_row, stable_row = rows[0], rows[2]
    assert unstable_row["lost"]
    assert unstable_row["J2"] is None
    assert (stable_row["case"], stable_row["motion"], stable_row["plant"]) == (4, "elcentro", "nominal")
    assert rows[3]["plant"] == 1
    assert stable_row["A"] == pytest.approx(1.0, abs=0.02)
    assert stable_row["rebuilt"]["verdict"] == "reliable"
    assert "rebuilt" not in rows[3]
    table = summary(rows).set_index(["compensator", "plants"])
    assert table.loc[("none", "nominal"), "lost"] == 1
    assert table.loc[("inverse", "perturbed"), "lost"] == 0


def test_the_published_table_is_typed_and_compared(shaking):
    table = read_published(shipped("datasets", "rths_benchmark/table3.csv"))
    assert table.shape == (4, 10)
    assert table.loc[3, "J4"] == 72.6
    comparison = compare_with_published(find_published_motion([shaking]), table.head(1), seeds=1)
    assert len(comparison) == 18
    assert set(comparison["variant"]) == {"emulated", "exact"}


@pytest.mark.parametrize(
    "wrong", [{"cases": (5,)}, {"compensators": ("magic",)}, {"perturbed": -1}, {"threshold": 0.0}]
)
def test_bad_requests_are_refused(wrong):
    with pytest.raises(InputError):
        BenchmarkRequest(**wrong)


@pytest.mark.slow
def test_partitioned_tests_are_drawn_run_and_predicted():
    # A and d over frequency are told by a motion of many frequencies only.
    tests = draw_tests(list(load_motions("synthetic")[:1]), 4, seed=1)
    assert [test.structure for test in tests] == list(partitioned_structures())[:4]
    rows = run_tests(tests)
    assert not rows["lost"].any()
    table = ratios(rows).set_index("prediction")
    assert list(table.index) == list(PREDICTIONS)
    assert table.loc["rebuilt", "median"] == pytest.approx(1.0, abs=0.05)
    assert table.loc["resolved", "median"] == pytest.approx(1.0, abs=0.15)
    with pytest.raises(InputError, match="needs motions and tests"):
        draw_tests([], 4, seed=1)


def test_shares_of_the_studys_structures_are_sound():
    shares = shares_of_structures()
    assert (shares["critical_delay_ms"] > 1.0).all()
    assert shares["alpha"].between(0.0, 1.0).all()
