"""Weighted motions meet their target, are worth what Kish says, and give the criterion of such motions."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.scope import magnitudes_of
from reliab.criterion.weights import Weights

HEADER = "quantity,low,high,share"


@pytest.fixture(scope="module")
def population():
    return read_ellipses("real_suite").sel(
        f=[1.0], xi=[0.05], threshold=[0.05], metric=["rms"], side=["lag"], curve=["inscribed"]
    )


@pytest.fixture
def written(tmp_path):
    def write(*lines, header=HEADER):
        path = tmp_path / "target.csv"
        path.write_text("\n".join([header, *lines]))
        return path

    return write


def test_two_quantities_are_met_at_once(population, written):
    path = written("magnitude,6,6.7,0.6", "magnitude,6.7,8,0.4", "length,0,30,0.5", "length,30,100,0.5")
    weights = Weights.from_table(population, path)
    magnitudes = np.array(magnitudes_of(population["event"].values.tolist()))
    lengths = population["duration"].values
    assert weights.values[magnitudes <= 6.7].sum() == pytest.approx(0.6, abs=1e-4)
    assert weights.values[lengths <= 30.0].sum() == pytest.approx(0.5, abs=1e-4)
    assert weights.motions == pytest.approx(1.0 / np.square(weights.values).sum())
    assert weights.quantities == ("magnitude", "length")


def test_sites_near_the_rupture_are_weighed_by_the_sets_of_the_records(population, written):
    weights = Weights.from_table(population, written("distance,0,10,0.8", "distance,10,1000,0.2"))
    near = population["motion"].values[weights.values > weights.values.mean()]
    assert near.size == 56  # near-field records in Table 2 of the paper
    assert weights.values[np.isin(population["motion"].values, near)].sum() == pytest.approx(0.8)


def test_equal_weights_leave_motions_and_limits(population, written):
    weights = Weights.from_table(population, written("length,0,200,1"))
    assert weights.motions == pytest.approx(100.0)
    drawn = weights.drawn(population)
    names = sorted(name.split("#")[0] for name in drawn["motion"].values)
    assert names == sorted(population["motion"].values.tolist())


def test_the_criterion_is_that_of_the_motions_with_weight(population, written):
    long = population["duration"].values > 40.0
    alone = population.isel(motion=long).drop_vars("duration")
    drawn = Weights.from_table(population, written("length,40,100,1")).drawn(population)
    found, expected = (
        np.array(derive_criterion(ellipses).limits(1.0, 0.05))
        for ellipses in (drawn.drop_vars("duration"), alone)
    )
    assert found == pytest.approx(expected, rel=1e-6)


def test_shares_of_the_drawn_motions_are_near_the_weights(population, written):
    drawn = Weights.from_table(population, written("magnitude,6,6.7,0.8", "magnitude,6.7,8,0.2")).drawn(
        population
    )
    magnitudes = np.array(magnitudes_of(drawn["event"].values.tolist()))
    assert np.mean(magnitudes <= 6.7) == pytest.approx(0.8, abs=0.05)  # one of 54 motions is 0.02
    assert "worth" in drawn.attrs["carried_to"]


@pytest.mark.parametrize(
    ("lines", "rule"),
    [
        (["magnitude,5,6,1"], "hold motions"),
        (["magnitude,6,7,0.7"], "add up to 1"),
        (["magnitude,6,7,0.7", "magnitude,6.5,8,0.3"], "overlap"),
        (["depth,0,10,1"], "A quantity is one of"),
        (["distance,0,5,0.2", "distance,5,1000,0.8"], "end or begin at 10 km"),
        (["magnitude,7,6,1"], "greater high end"),
        (["magnitude,six,7,1"], "greater high end"),
        ([], "greater high end"),
        (["magnitude,7.8,8,1"], "worth at least 20"),
    ],
)
def test_a_target_that_cannot_be_met_is_refused(population, written, lines, rule):
    with pytest.raises(InputError, match=rule):
        Weights.from_table(population, written(*lines))


def test_other_columns_and_unknown_magnitudes_are_refused(population, written):
    with pytest.raises(InputError, match="has the columns"):
        Weights.from_table(population, written("1,2", header="a,b"))
    unknown = population.assign_coords(event=("motion", [f"E{k}" for k in range(100)]))
    with pytest.raises(InputError, match="must be known"):
        Weights.from_table(unknown, written("magnitude,6,8,1"))


def test_a_target_that_is_not_there_is_refused_in_words(population, tmp_path):
    with pytest.raises(InputError, match="No such file"):
        Weights.from_table(population, tmp_path / "none.csv")
