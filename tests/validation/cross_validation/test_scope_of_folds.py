"""Groups whose motions lie outside of those from which their criterion is learned are named."""

import numpy as np
import pytest

import reliab
from reliab.criterion.ellipse_reading import read_ellipses


@pytest.fixture(scope="module")
def validation_over_regions():
    result = reliab.validate_criteria(
        ellipses="real_suite", f=1.0, xi=0.05, confidence=0.9, scheme="region", method="quantile"
    )
    return result.to_dict()["outside"]


@pytest.mark.slow
def test_region_with_shorter_records_is_named(validation_over_regions):
    """Nahanni's, the only ones of Canada, by a plain comparison of lengths."""
    ellipses = read_ellipses("real_suite")
    nahanni = ellipses["event"].values == "NAHANNI"
    lengths = ellipses["duration"].values
    assert nahanni.any()
    count = int((lengths[nahanni] < lengths[~nahanni].min()).sum())
    assert count
    (sentence,) = [
        sentence for sentence in validation_over_regions if "Canada" in sentence and "length" in sentence
    ]
    assert sentence.startswith(f"No promise for {count} of the {nahanni.sum()} motions")


@pytest.mark.slow
def test_a_region_within_all_others_is_not_named(validation_over_regions):
    assert not any(
        "Japan" in sentence or "Italy" in sentence
        for sentence in validation_over_regions
        if "length" in sentence
    )


@pytest.mark.slow
def test_lengths_decide_in_each_direction(validation_over_regions):
    lengths = read_ellipses("real_suite")["duration"].values
    assert np.ptp(lengths) > 0.0
    assert len(validation_over_regions) < 9  # of nine regions
