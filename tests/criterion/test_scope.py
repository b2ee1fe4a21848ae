"""Where a test lies among the motions behind a criterion."""

import pytest

from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.scope import Position, compare_with_scope, population_of, scope_of

LENGTHS = {"length": [10.0, 20.0, 90.0, 100.0]}


@pytest.mark.parametrize(
    ("length", "position"),
    [
        (9.9, Position.OUTSIDE),
        (10.0, Position.EDGE),
        (20.0, Position.INSIDE),
        (90.0, Position.INSIDE),
        (95.0, Position.EDGE),
        (101.0, Position.OUTSIDE),
    ],
)
def test_a_length_lies_inside_between_the_outer_twentieths(length, position):
    assert compare_with_scope(LENGTHS, {"length": length}).position is position


def test_the_least_favourable_quantity_decides_and_each_has_a_sentence():
    scope = {**LENGTHS, "cycles": [5.0, 10.0, 100.0, 200.0]}
    compared = compare_with_scope(scope, {"length": 15.0, "cycles": 300.0})
    assert compared.position is Position.OUTSIDE
    assert [sentence.split(",")[0] for sentence in compared.sentences] == [
        "The length of the record",
        "The number of cycles",
    ]


def test_what_the_population_does_not_know_is_not_compared():
    assert compare_with_scope(LENGTHS, {"effective_duration": 1.0}).position is Position.INSIDE


def test_the_shipped_population_states_magnitudes_and_lengths():
    ellipses = read_ellipses("real_suite")
    assert population_of(ellipses) == (
        "100 ground motions of 19 earthquakes of magnitude 6.5 to 7.9, records of 10 to 100 s"
    )
    assert scope_of(ellipses)["magnitude"][0] == 6.5


def test_magnitudes_are_stated_only_where_all_are_known():
    ellipses = read_ellipses("real_suite").isel(motion=slice(4))
    unknown = ellipses.assign_coords(event=("motion", ["NORTHR", "NORTHR", "KOBE", "SOMEWHERE"]))
    assert "magnitude" not in scope_of(unknown)
