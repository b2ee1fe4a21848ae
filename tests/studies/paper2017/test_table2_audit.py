"""Hidden differences that were put into a table are found, and none where there is none."""

import numpy as np
import pandas as pd
import pytest
from reliab_studies.table2_audit.audit import NONE_FOUND, audit_table2
from reliab_studies.table2_audit.hidden_difference import logarithms, simulate_ellipse

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.02)
PLANTED_DIFFERENCES = {
    "SYN003/H1": "time step",
    "SYN003/H2": "time step",
    "SYN007/H1": "component",
    "SYN012/H1": "duration",
    "SYN012/H2": "duration",
}
UNEXPLAINED_ROWS = ("SYN020/H1", "SYN021/H2", "SYN022/H1", "SYN023/H2", "SYN024/H1", "SYN025/H1")


@pytest.fixture(scope="module")
def suite():
    """The built-in suite, every third earthquake sampled half as often."""
    motions = list(load_motions("synthetic"))
    return [_coarse(motion) if int(motion.event[3:]) % 3 == 1 else motion for motion in motions]


def _coarse(motion):
    return Motion(
        name=motion.name,
        event=motion.event,
        acceleration=motion.acceleration[::2],
        time_step=2.0 * motion.time_step,
    )


def pair_of(*arguments):
    return logarithms(simulate_ellipse(*arguments))


def pair_of_paper(motion, motions_by_name):
    kind = PLANTED_DIFFERENCES.get(motion.name)
    if kind == "time step":
        return pair_of(motion.acceleration, 2.0 * motion.time_step, STRUCTURE)
    if kind == "duration":
        quiet = np.concatenate([motion.acceleration, np.zeros(2 * motion.acceleration.size)])
        return pair_of(quiet, motion.time_step, STRUCTURE, 2.0 * motion.duration)
    if kind == "component":
        motion = motions_by_name[motion.name.replace("H1", "H2")]
    return pair_of(motion.acceleration, motion.time_step, STRUCTURE)


@pytest.fixture(scope="module")
def audit_table(suite):
    motions_by_name = {motion.name: motion for motion in suite}
    rng = np.random.default_rng(8)
    rows = []
    for motion in suite:
        pair = np.array(pair_of_paper(motion, motions_by_name)) + 0.02 * rng.standard_normal(2)
        if motion.name in UNEXPLAINED_ROWS:
            pair += rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 1.0) * np.array([1.0, rng.uniform(0.4, 1.6)])
        rows.append({"record": motion.name, "a": np.exp(pair[0]), "b": np.exp(pair[1]), "error": 1.0})
    return audit_table2(suite, pd.DataFrame(rows)).set_index("record")


@pytest.mark.slow
def test_planted_differences_are_named(audit_table):
    differences = audit_table.loc[list(PLANTED_DIFFERENCES), "difference"]
    assert differences.to_dict() == PLANTED_DIFFERENCES


@pytest.mark.slow
def test_named_rows_close_their_gap(audit_table):
    rows = audit_table.loc[list(PLANTED_DIFFERENCES)]
    assert (rows["gap_before"] > 0.1).all()
    assert (rows["gap_after"] < 0.08).all()
    assert (rows["chance"] <= 0.05).all()


@pytest.mark.slow
def test_rows_without_a_difference_are_seldom_given_one(audit_table):
    has_difference = audit_table.loc[list(UNEXPLAINED_ROWS), "difference"] != NONE_FOUND
    assert has_difference.sum() <= 1


@pytest.mark.slow
def test_agreeing_rows_have_no_difference(audit_table):
    agreeing = audit_table.drop([*PLANTED_DIFFERENCES, *UNEXPLAINED_ROWS])
    assert agreeing["agrees"].all()
    assert (agreeing["difference"] == "").all()
    np.testing.assert_array_equal(agreeing["a_after"], agreeing["a"])


def test_other_records_are_refused(suite):
    table = pd.DataFrame({"record": ["A/1"], "a": [1e-4], "b": [1.0], "error": [1.0]})
    with pytest.raises(InputError, match="records of the table"):
        audit_table2(suite, table)
