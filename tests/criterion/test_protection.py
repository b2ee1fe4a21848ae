"""A criterion protects every length of its population, where lengths tell something of limits."""

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
import xarray as xr

from reliab.core.shipped import shipped
from reliab.criterion.carrying import carry_to_length, protect_over_lengths
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.ellipse_table import EllipseTable, as_table
from reliab.motions.loading import load_motions
from reliab.motions.motion import arias_times
from reliab.sweep.cut_records import add_known_cut_records
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.sweep.results import open_results, real_results
from reliab.validation.truth import Cell, Region, SimulatedTruth

SELECTION = {"f": [0.5, 1.0, 2.0], "xi": [0.02, 0.05], "threshold": [0.05], "side": ["lag"]}


@pytest.fixture(scope="module")
def population():
    return read_ellipses("real_suite").sel(**SELECTION)


@pytest.mark.slow
def test_at_each_structure_one_of_three_lengths_counts_and_it_is_the_least_favourable(population):
    safe_table = protect_over_lengths(population).sel(curve="inscribed", metric="rms").squeeze()
    lengths = np.quantile(population["duration"], [0.1, 0.5, 0.9])
    carried = [
        carry_to_length(population, float(length)).sel(curve="inscribed", metric="rms").squeeze()
        for length in lengths
    ]
    for name in ("a", "b"):
        low = [np.nanquantile(part[name].transpose("motion", ...), 0.05, axis=0) for part in carried]
        count = np.nanquantile(safe_table[name].transpose("motion", ...), 0.05, axis=0)
        assert count == pytest.approx(np.min(low, axis=0), rel=0.05)
        equal = [np.isclose(safe_table[name], part[name], equal_nan=True) for part in carried]
        assert np.any(equal, axis=0).all()


def test_other_errors_stay_as_they_are(population):
    safe_table = protect_over_lengths(population)
    for name in ("a", "b"):
        np.testing.assert_array_equal(safe_table[name].sel(metric="mte"), population[name].sel(metric="mte"))


@pytest.mark.parametrize(("form", "kind"), [(as_table, EllipseTable), (lambda given: given, xr.Dataset)])
def test_an_actuator_at_rest_is_still_known(population, form, kind):
    """By its errors a threshold without a meaning is refused."""
    safe_table = protect_over_lengths(form(population))
    assert isinstance(safe_table, kind)
    np.testing.assert_array_equal(as_table(safe_table).error_at_rest, as_table(population).error_at_rest)


def test_an_error_at_rest_is_known_of_whole_records_only(population):
    short = carry_to_length(population, 30.0)
    complete = population["duration"].values <= 30.0
    np.testing.assert_array_equal(np.isfinite(as_table(short).error_at_rest[:, 0, 0, 0]), complete)


def test_motions_of_left_out_earthquakes_keep_the_share_at_every_length(population):
    """Whole and cut: by the ellipses that are inscribed in their boundaries, those of cut records carried."""
    events = population["event"].values
    places = np.meshgrid(SELECTION["f"], SELECTION["xi"], indexing="ij")
    limits = {
        event: derive_criterion(population.isel(motion=events != event)).limits(*places)
        for event in np.unique(events)
    }
    for length in (12.0, 20.0, 30.0, np.inf):
        original = population if length == np.inf else carry_to_length(population, length)
        original = original[["a", "b"]].sel(curve="inscribed", metric="rms", threshold=0.05, side="lag")
        a, b = (original[name].transpose("motion", "f", "xi").values for name in ("a", "b"))
        coverage = [
            (a[row] >= limits[event][0]) & (b[row] >= limits[event][1]) for row, event in enumerate(events)
        ]
        assert np.mean(coverage) >= 0.93, length


@pytest.mark.slow
def test_records_of_left_out_earthquakes_keep_the_share_by_their_true_error(population, real_motions_folder):
    """Along the whole edge, by the loop, with the record cut where the length is stated, too."""
    motions = load_motions(real_motions_folder, sets=["far_field", "near_field"])[::4]
    coverage = {"default": [], "stated": []}
    for motion in motions:
        acceleration, step = motion.acceleration, motion.time_step
        onset = float(arias_times(acceleration, step, [0.01])[0])
        begin = round(max(min(onset - 1.0, motion.duration - 20.0), 0.0) / step)
        cut = replace(motion, acceleration=acceleration[begin : begin + round(20.0 / step) + 1])
        rivals = population.isel(motion=population["event"].values != motion.event)
        criteria = {
            "default": derive_criterion(rivals),
            "stated": derive_criterion(carry_to_length(rivals, max(cut.duration, 10.0))),
        }
        truth = SimulatedTruth(motions=[cut])
        for f, xi in product(SELECTION["f"], SELECTION["xi"]):
            cell = Cell(frequency=f, damping_ratio=xi, threshold=0.05, metric="rms")
            for name, criterion in criteria.items():
                a, b = (float(limit) for limit in criterion.limits(f, xi))
                edge = Region(a=a, b=b).edge()
                coverage[name].append((truth.errors(cell, 0, edge.gain, edge.delay) <= 1.0).all())
    assert np.mean(coverage["default"]) >= 0.93
    assert np.mean(coverage["stated"]) >= 0.93


@pytest.mark.parametrize(
    ("change", "options"),
    [
        (lambda ellipses: ellipses, {"metric": "mte"}),
        (lambda ellipses: ellipses, {"curve": "ellipse"}),
        (lambda ellipses: ellipses.isel(motion=slice(29)), {}),
        (lambda ellipses: ellipses.drop_dims("length"), {}),
        (lambda ellipses: carry_to_length(ellipses, 30.0), {}),
    ],
)
def test_population_without_lengths_stays_unchanged(population, change, options):
    ellipses = change(population)
    assert protect_over_lengths(ellipses, **options) is ellipses


@pytest.mark.slow
def test_windows_have_no_records_to_cut():
    path = shipped("datasets", "real_suite/ellipses.nc")
    assert "a_cut" in open_ellipses(path)
    assert "a_cut" not in open_ellipses(path, window="20")


def test_a_criterion_says_whether_lengths_are_protected(population):
    message = "limits grow with the length"
    safe_table, record_criterion = (
        derive_criterion(sample).provenance for sample in (population, population.drop_dims("length"))
    )
    assert "with the strictest limit of records of" in safe_table.population
    assert not any(message in sentence for sentence in safe_table.warnings)
    assert "least" not in record_criterion.population
    assert any(message in sentence for sentence in record_criterion.warnings)
    assert "least" not in derive_criterion(population, method="quantile").provenance.population


def test_shipped_results_are_protected_as_their_ellipses(population):
    """Their records are known by their checksums."""
    results = real_results([1.0], [0.02])
    boundary = open_results(results).sel(f=[1.0], xi=[0.02]).reliab.ellipses((0.05,))
    assert "a_cut" in boundary
    results_table, ellipse_table = (
        derive_criterion(sample, f=1.0, xi=0.02) for sample in (boundary, population)
    )
    for single, second in zip(results_table.limits(1.0, 0.02), ellipse_table.limits(1.0, 0.02), strict=True):
        assert float(single) == pytest.approx(float(second), rel=0.01)
    unknown = boundary.drop_dims("length").assign_coords(checksum=("motion", np.arange(100).astype(str)))
    assert add_known_cut_records(unknown) is unknown


def test_limits_do_not_grow_with_the_share(population):
    places = np.meshgrid(SELECTION["f"], SELECTION["xi"], indexing="ij")
    criteria = [derive_criterion(population, confidence=share) for share in (0.5, 0.8, 0.9, 0.95)]
    for lower, upper in pairwise(criteria):
        for larger, smaller in zip(lower.limits(*places), upper.limits(*places), strict=True):
            assert (smaller <= larger).all()
