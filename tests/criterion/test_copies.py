"""One record that is given twice, or scaled, counts once."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from reliab.app.api.criteria import derive_criteria
from reliab.app.api.validation import validate_criteria
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.ellipse_table import as_table, drop_copies
from reliab.motions.loading import load_motions
from reliab.motions.motion import arias_times


def write_record(folder, motion, name):
    """Two columns, time [s] and acceleration [m/s²]."""
    folder.mkdir(exist_ok=True)
    times = motion.time_step * np.arange(motion.acceleration.size)
    lines = ["# time [s], acceleration [m/s2]"]
    lines += [f"{t:.5f},{value:.9e}" for t, value in zip(times, motion.acceleration, strict=True)]
    (folder / f"{name}.csv").write_text("\n".join(lines), encoding="utf-8")


def copy_motions(ellipses, times):
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
    small_sample = ellipses.isel(motion=slice(0, 30, 3))
    small_sample = small_sample if checksums else small_sample.drop_vars("checksum")
    original, many = (
        derive_criterion(sample, f=1.0, xi=0.02, confidence=0.95, method="dirichlet")
        for sample in (small_sample, copy_motions(small_sample, 8))
    )
    assert many.limits(1.0, 0.02) == original.limits(1.0, 0.02)
    assert (many.provenance.n_motions, many.provenance.n_events) == (10, 10)
    assert "70 of 80 motions are the records of others" in " ".join(many.provenance.warnings)


def test_a_scaled_copy_is_known_by_its_boundary(ellipses):
    """Its checksum is another; its a and b are the same but for rounding."""
    small_sample = ellipses.isel(motion=slice(0, 30, 3))
    scaled_copy = copy_motions(small_sample, 2)
    rounding = np.random.default_rng(3).normal(1.0, 2e-5, scaled_copy["a"].shape)
    scaled_copy = scaled_copy.assign({name: scaled_copy[name] * rounding for name in ("a", "b")})
    scaled_copy = scaled_copy.assign_coords(checksum=("motion", [f"{place:064}" for place in range(20)]))
    count = drop_copies(scaled_copy)
    assert count["motion"].values.tolist() == scaled_copy["motion"].values[:10].tolist()
    assert "10 of 20 motions are the records of others" in count.attrs["copies"]


@pytest.mark.slow
def test_trimmed_copies_of_records_raise_no_limit(tmp_path):
    """Under other names, other earthquakes and with other boundaries."""
    motions = load_motions("synthetic")[:8]
    for motion in motions:
        write_record(tmp_path / "own", motion, motion.name.replace("/", "_"))
        write_record(tmp_path / "with", motion, motion.name.replace("/", "_"))
        begin, end = arias_times(motion.acceleration, motion.time_step, [0.01, 0.99]) / motion.time_step
        short_motion = replace(motion, acceleration=1.7 * motion.acceleration[round(begin) : round(end)])
        write_record(tmp_path / "with", short_motion, f"COPY_{motion.name.replace('/', '_')}")
    limits = []
    for folder in ("own", "with"):
        result = derive_criteria(motions=tmp_path / folder, f=1.0, xi=0.05).to_dict()["criteria"][0]
        limits.append((result["a"], result["b"], result["n_motions"]))
    assert limits[1][2] == limits[0][2] == 8
    # Which of two is the original is not known; the trimmed ones have a and b of shorter records.
    assert limits[1][0] <= 1.02 * limits[0][0]


@pytest.mark.slow
def test_a_copy_is_not_judged_as_a_further_earthquake(tmp_path):
    for number, motion in enumerate(load_motions("synthetic")[:4]):
        write_record(tmp_path, motion, f"M{number}")
        write_record(
            tmp_path, replace(motion, acceleration=-0.6 * motion.acceleration), f"REVERSED_M{number}"
        )
    options = {"f": 1.0, "xi": 0.05, "confidence": 0.5, "law": "table", "trials": 8}
    result = validate_criteria(motions=tmp_path, **options).to_dict()
    assert result["n_motions"] == 4
    assert "each record counts once" in result["sentences"][0]


@pytest.mark.slow
@pytest.mark.parametrize("form", [as_table, lambda given: given], ids=["table", "dataset"])
def test_different_motions_stay(ellipses, form):
    """Motions without an ellipse have nothing in common; in the shipped suite nothing is left out."""
    gaps = ellipses.assign({name: ellipses[name].where(ellipses["event"] > "E3") for name in ("a", "b")})
    table = ellipses.drop_vars("checksum")
    for sample in (
        form(read_ellipses("real_suite")),
        form(gaps),
        form(gaps.drop_vars("checksum")),
        form(table),
    ):
        assert drop_copies(sample) is sample


def test_unstated_earthquakes_are_told_of(ellipses):
    original = ellipses.assign_coords(event=("motion", ellipses["motion"].values))
    sentence = "No earthquake is stated for 60 of 60 motions"
    messages = [
        " ".join(derive_criterion(sample, f=1.0, xi=0.02).provenance.warnings)
        for sample in (original, ellipses)
    ]
    assert sentence in messages[0]
    assert "No earthquake is stated" not in messages[1]
