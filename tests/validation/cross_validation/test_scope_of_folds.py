"""Groups whose motions lie outside of those from which their criterion is learned are named."""

import numpy as np
import pytest

import reliab
from reliab.criterion.ellipse_reading import read_ellipses


@pytest.fixture(scope="module")
def by_region():
    found = reliab.validate_criteria(
        ellipses="real_suite", f=1.0, xi=0.05, confidence=0.9, scheme="region", method="quantile"
    )
    return found.to_dict()["outside"]


@pytest.mark.slow
def test_a_region_whose_records_are_shorter_than_all_others_is_named(by_region):
    """Nahanni's, the only ones of Canada, by a plain comparison of lengths."""
    ellipses = read_ellipses("real_suite")
    nahanni = ellipses["event"].values == "NAHANNI"
    lengths = ellipses["duration"].values
    assert nahanni.any()
    count = int((lengths[nahanni] < lengths[~nahanni].min()).sum())
    assert count
    (sentence,) = [sentence for sentence in by_region if "Canada" in sentence and "length" in sentence]
    assert sentence.startswith(f"No promise for {count} of the {nahanni.sum()} motions")


@pytest.mark.slow
def test_a_region_within_all_others_is_not_named(by_region):
    assert not any(
        "Japan" in sentence or "Italy" in sentence for sentence in by_region if "length" in sentence
    )


@pytest.mark.slow
def test_lengths_decide_in_each_direction(by_region):
    lengths = read_ellipses("real_suite")["duration"].values
    assert np.ptp(lengths) > 0.0
    assert len(by_region) < 9  # of nine regions
