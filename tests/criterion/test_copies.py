"""One record that is given twice, or scaled, counts once."""

import numpy as np
import pytest
import xarray as xr

from reliab.criterion import derive_criterion, events_of_originals, read_ellipses, without_copies
from reliab.criterion.ellipse_table import tabled


def copied(ellipses, times):
    """Every motion several times, under other names and as of other earthquakes."""
    parts = [
        ellipses.assign_coords(
            motion=[f"{name} ({copy})" for name in ellipses["motion"].values],
            event=("motion", [f"{name} ({copy})" for name in ellipses["event"].values]),
        )
        for copy in range(times)
    ]
    return xr.concat(parts, dim="motion")


@pytest.mark.parametrize("checksums", [True, False], ids=["records", "table"])
def test_copies_promise_no_more_than_their_records(ellipses, checksums):
    """Eight times ten records are no eighty earthquakes."""
    few = ellipses.isel(motion=slice(0, 30, 3))
    few = few if checksums else few.drop_vars("checksum")
    own, many = (
        derive_criterion(given, f=1.0, xi=0.02, confidence=0.95, method="dirichlet")
        for given in (few, copied(few, 8))
    )
    assert many.limits(1.0, 0.02) == own.limits(1.0, 0.02)
    assert (many.provenance.n_motions, many.provenance.n_events) == (10, 10)
    assert "70 of 80 motions are the records of others" in " ".join(many.provenance.warnings)


def test_copies_have_the_earthquake_of_their_record(ellipses):
    few = ellipses.isel(motion=slice(0, 30, 3))
    events = events_of_originals(copied(few, 2))
    assert events[:10].tolist() == events[10:].tolist()
    assert np.unique(events).size == np.unique(few["event"].values).size


@pytest.mark.parametrize("form", [tabled, lambda given: given], ids=["table", "dataset"])
def test_different_motions_stay(ellipses, form):
    """Motions without an ellipse have nothing in common; in the shipped suite nothing is left out."""
    gaps = ellipses.assign({name: ellipses[name].where(ellipses["event"] > "E3") for name in ("a", "b")})
    table = ellipses.drop_vars("checksum")
    for given in (
        form(read_ellipses("real_suite")),
        form(gaps),
        form(gaps.drop_vars("checksum")),
        form(table),
    ):
        assert without_copies(given) is given


def test_unstated_earthquakes_are_told_of(ellipses):
    own = ellipses.assign_coords(event=("motion", ellipses["motion"].values))
    sentence = "No earthquake is stated for 60 of 60 motions"
    said = [
        " ".join(derive_criterion(given, f=1.0, xi=0.02).provenance.warnings) for given in (own, ellipses)
    ]
    assert sentence in said[0]
    assert "No earthquake is stated" not in said[1]
