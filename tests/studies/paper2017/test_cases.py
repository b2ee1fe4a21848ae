"""Table 6 from KOBE/KJM000."""

import csv

import pytest
from reliab_studies.paper2017.cases import case_table, cases_dataset, list_printed_cases, run_paper_cases

from reliab.motions.loading import load_motions


def test_masses_are_those_of_table_5():
    masses = [round(case.mass, 2) for case in list_printed_cases()]
    assert masses == [0.09, 0.25, 0.09, 0.09]


def test_table_6(real_motions_folder, shared_folder):
    motion = load_motions(real_motions_folder, sets=["held_out"]).select(names=["KOBE/KJM000"])[0]
    with (shared_folder / "paper" / "tables5_6.csv").open() as file:
        rows = list(csv.DictReader(file))
    for outcome, row in zip(run_paper_cases(motion), rows, strict=True):
        assert outcome.amplitude == pytest.approx(float(row["A"]), abs=0.0005)
        assert 1e3 * outcome.equivalent_delay == pytest.approx(float(row["d_ms"]), abs=0.05)
        assert 100 * outcome.rms == pytest.approx(float(row["rms_percent"]), rel=0.08)
        a, b = 0.021 * outcome.case.damping_ratio, 6080 * outcome.case.damping_ratio
        decay = 2.718281828459045 ** (-6.6 * outcome.case.frequency)
        index = (outcome.amplitude - 1) ** 2 / a + (1e3 * outcome.equivalent_delay) ** 2 / (b * decay)
        assert (index <= 1) is (row["fulfils_eq18"] == "Yes")
        assert (outcome.rms <= 0.05) is (float(row["rms_percent"]) <= 5.0)


def test_verdicts_stand_beside_the_printed_ones(real_motions_folder):
    motion = load_motions(real_motions_folder, sets=["held_out"]).select(names=["KOBE/KJM000"])[0]
    cases = cases_dataset(run_paper_cases(motion), motion)
    table = case_table(cases)
    assert table["accepted"].tolist() == table["accepted_printed"].tolist() == [True, True, True, False]
    assert table["good"].tolist() == [True, True, True, False]
    assert cases.attrs["window"] == 40.0
    ideal, response = (cases[name].sel(case=2).values for name in ("ideal", "measured"))
    error = ((response - ideal) ** 2).mean() ** 0.5 / (ideal**2).mean() ** 0.5
    assert table.loc[1, "of_rms"] == pytest.approx(error, rel=1e-4)
