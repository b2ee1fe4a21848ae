"""Measures of a response, and the motions for which a criterion speaks."""

import numpy as np
import pytest

from reliab.core.shipped import shipped
from reliab.criterion.carrying import carry_to_response
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.response_measures import BoundaryScales, ResponseMeasures, read_shipped_measures
from reliab.criterion.scope import Position, compare_with_scope, population_of, scope_of
from reliab.sweep.netcdf import read_netcdf

CONFIDENCES = (0.5, 0.8, 0.9, 0.95)


def test_shipped_boundaries_lie_at_their_predictions():
    comparison = read_shipped_measures().scales
    logarithms = comparison.logarithms(0.05, "lag", None)
    assert logarithms.mean() == pytest.approx(-0.14, abs=0.04)
    assert logarithms.std(axis=0).max() < 0.12  # where ln a scatters by 0.5 to 0.8


def test_the_whole_boundary_is_no_further_than_any_direction():
    least = read_shipped_measures().scales.logarithms(0.05, "lag", None)
    for angle in (0.0, 1.0, 3.1):
        assert (least <= read_shipped_measures(angle).scales.logarithms(0.05, "lag", angle) + 0.02).all()


def test_errors_between_stored_ones_are_interpolated():
    comparison = BoundaryScales(
        least=np.exp([[[[[0.0], [-0.2]]]]]),
        towards=np.ones((1, 1, 1, 2, 1, 9)),
        thresholds=np.array([0.01, 0.04]),
        sides=["lag"],
    )
    assert comparison.logarithms(0.02, "lag", None) == pytest.approx(-0.1)
    assert comparison.logarithms(0.04, "lag", None) == pytest.approx(-0.2)


@pytest.mark.slow
def test_a_criterion_by_response_keeps_every_share_of_earthquakes_left_out():
    """Also at 50 and 80 %: by a and b separately 69 and 93 % were kept."""
    structure_place = {"f": [1.0], "xi": [0.05]}
    ellipses = read_ellipses("real_suite").sel(
        metric=["rms"], threshold=[0.05], side=["lag"], curve=["inscribed"], **structure_place
    )
    measures = read_netcdf(shipped("datasets", "real_suite/first_order.nc"), "Measures", "").sel(
        structure_place
    )
    events = ellipses["event"].values
    is_contained = np.zeros((events.size, len(CONFIDENCES)), dtype=bool)
    for place, event in enumerate(events):
        rivals = events != event
        original = measures.isel(motion=[place])
        carried = carry_to_response(ellipses.isel(motion=rivals), measures.isel(motion=rivals), original)
        prediction, *_ = ResponseMeasures.from_dataset(original).predict_ellipses(0.05, "lag")
        reach = float(prediction[0, 0, 0] * original["scale"].sel(threshold=0.05, side="lag").item())
        is_contained[place] = [
            derive_criterion(carried, confidence=share).limits(1.0, 0.05)[0] <= reach for share in CONFIDENCES
        ]
    assert is_contained.mean(axis=0) == pytest.approx(CONFIDENCES, abs=0.06)


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
    comparison = compare_with_scope(scope, {"length": 15.0, "cycles": 300.0})
    assert comparison.position is Position.OUTSIDE
    assert [sentence.split(",")[0] for sentence in comparison.sentences] == [
        "The length of the record",
        "The number of cycles",
    ]


def test_measures_unknown_to_population_are_not_compared():
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
