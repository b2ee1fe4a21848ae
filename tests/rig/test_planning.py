"""What a plan promises, and what a comparison says."""

import json

import numpy as np
import pytest
from rig_rows import keep, rig_table, rig_test

from reliab.app.cli import run
from reliab.rig.comparison import compare_tables
from reliab.rig.memory import NextTest
from reliab.rig.planning import plan_tests
from reliab.structures.structure import Structure


def late(count, delay, seed=1):
    """Tests of a rig that is late by so many milliseconds."""
    rng = np.random.default_rng(seed)
    tests = []
    for number in range(count):
        actual = delay + 0.2 * rng.normal()
        error = np.hypot(0.01 / np.sqrt(0.06), actual / np.sqrt(1400.0)) * np.exp(0.05 * rng.normal())
        values = {"d_ms": actual, "rms": error, "remainder": 0.002 * np.exp(0.1 * rng.normal())}
        tests.append(rig_test(number + 1000 * seed, event=f"EQ{number // 2}", A=0.99, **values))
    return tests


@pytest.fixture(scope="module")
def plan():
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    return plan_tests(rig_table(late(12, 6.0)), structure, NextTest(), threshold=0.1)


def test_a_late_rig_is_to_be_compensated(plan):
    remedies = {remedy.change: remedy for remedy in plan.remedies}
    assert plan.share_now < 0.5
    assert remedies["compensation"].suffices
    assert remedies["compensation"].value == pytest.approx(6.0, abs=3.0)
    assert 0.0 < remedies["share in the laboratory"].value < 1.0
    assert remedies["damping ratio"].value > 0.02
    assert all(remedy.share_of_good_tests >= 0.95 for remedy in plan.remedies if remedy.suffices)
    assert json.dumps(plan.to_dict(), allow_nan=False)


def test_the_error_depends_on_motion_and_delay(plan):
    assert plan.sobol["motion"]["total"] > 0.5
    assert plan.sobol["delay"]["total"] > plan.sobol["remainder"]["total"]


def test_a_rig_that_became_quicker_is_better():
    comparison = compare_tables(rig_table(late(12, 6.0)), rig_table(late(12, 2.0, seed=2)))
    assert comparison.probability_better > 0.99
    assert comparison.contrasts["delay_ms"].before == pytest.approx(6.0, abs=0.3)
    same = compare_tables(rig_table(late(12, 6.0)), rig_table(late(12, 6.0)))
    assert same.contrasts["rms"].next_test_better == pytest.approx(0.5)


def test_the_commands_plan_and_compare(tmp_path, capsys):
    keep(tmp_path / "one", *late(6, 6.0))
    keep(tmp_path / "two", *late(6, 2.0, seed=2))
    assert run(["rig", "compare", str(tmp_path / "one"), str(tmp_path / "two")]) == 0
    assert "P(better)" in capsys.readouterr().out
    assert run(["rig", "compare", str(tmp_path / "one")]) == 2
    assert run(["rig", "compare", str(tmp_path / "one"), "--since", "2030-01-01"]) == 2
    assert run(["rig", "plan", str(tmp_path / "one"), "--f", "1"]) == 0
    assert "Sobol" in capsys.readouterr().out
