"""Divisions that leave out whole regions, magnitudes and lengths."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.validation.folds import folds_of, transfer


@pytest.mark.parametrize("scheme", ["region", "magnitude", "length"])
def test_whole_groups_are_left_out_and_no_earthquake_is_on_both_sides(scheme):
    events = np.array(["NORTHR", "NORTHR", "KOBE", "KOBE", "CHICHI", "DENALI", "DENALI", "GAZLI"])
    lengths = np.array([20.0, 30.0, 41.0, 22.0, 90.0, 90.0, 70.0, 15.0])
    folds = folds_of(scheme, events, lengths)
    assert np.sum([fold.judged for fold in folds], axis=0).tolist() == [1] * 8
    for fold in folds:
        assert not set(events[fold.learned]) & set(events[fold.judged])
    if scheme == "length":
        for fold in folds:
            classes = np.digitize(lengths, [25.0, 40.0, 60.0])
            assert not set(classes[fold.learned]) & set(classes[fold.judged])
    else:
        verdict = {frozenset(events[fold.judged].tolist()) for fold in folds}
        assert len(verdict) == len(folds)


def test_california_is_left_out_whole():
    events = np.array(["NORTHR", "LOMAP", "KOBE"])
    first = next(fold for fold in folds_of("region", events) if fold.judged[0])
    assert first.judged.tolist() == [True, True, False]


@pytest.mark.parametrize(("scheme", "events"), [("region", ["A", "B"]), ("length", ["KOBE", "LOMAP"])])
def test_unknown_groups_are_refused(scheme, events):
    with pytest.raises(InputError, match=scheme):
        folds_of(scheme, np.array(events))


@pytest.mark.parametrize(
    ("sets", "remedy"),
    [(["", ""], "State sets in the column set of a catalogue"), (["b", "c"], "Choose among b, c")],
)
def test_unknown_set_is_refused_with_the_choices(sets, remedy):
    with pytest.raises(InputError, match=f"found a. {remedy}"):
        list(transfer(np.array(sets), np.array(["x", "y"]), learned=["a"], judged=["b"]))
