"""Verdicts on the paper's four cases."""

import pytest
from reliab_studies.paper2017.cases import case_verdicts

from reliab.criterion.derivation import published_criterion
from reliab.motions.loading import load_motions


def test_each_case_is_judged_by_each_criterion():
    motion = load_motions("synthetic")[0]
    criterion = published_criterion("guo_2017_18")
    verdicts = case_verdicts(motion, {"one": lambda *_: criterion, "two": lambda *_: criterion})
    assert list(verdicts["case"]) == [1, 1, 2, 2, 3, 3, 4, 4]
    first = verdicts.iloc[0]
    index = (first["A"] - 1.0) ** 2 / (0.021 * 0.02) + first["d_ms"] ** 2 / (121.6 * 2.718281828459045**-6.6)
    assert first["index"] == pytest.approx(index)
    assert first["accepted"] == (index <= 1.0)
    assert verdicts["probability"].isna().all()
