"""Earthquakes are known by record, date and name."""

import pytest
import xarray as xr

from reliab.core.shipped import shipped
from reliab.motions.loading import load_motions
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.validation.folds import earthquakes_among


@pytest.fixture(scope="module")
def real():
    return open_ellipses(shipped("datasets", "real_suite/ellipses.nc"))


@pytest.mark.parametrize(
    ("event", "name"),
    [
        ("KOBE", "KOBE"),
        ("KOBE JAPAN 1995-01-16", "KOBE"),
        ("KOBE/KJM000", "KOBE"),
        ("Hyogo-ken Nanbu 1995-01-17", "KOBE"),
        ("Kobe, 1995", "KOBE"),
        ("IMPERIAL VALLEY-06 1979-10-15", "IMPVALL"),
        ("IMPERIAL VALLEY-02 1940-05-19", None),
        ("Loma Prieta", "LOMAP"),
        ("CHI-CHI TAIWAN 1999-09-21", "CHICHI"),
        ("Irpinia 1980/11/23", "ITALY"),
        ("Tohoku 2011-03-11", None),
        ("SYN001", None),
        ("KO", None),
        ("1995-13-99", None),
    ],
)
def test_an_earthquake_is_known_by_name_and_date(event, name, real):
    assert earthquakes_among([event], [""], real) == [name]


def test_a_record_is_known_whatever_it_is_called(real):
    place = real["event"].values.tolist().index("KOBE")
    checksum = str(real["checksum"].values[place])
    assert earthquakes_among(["mine", "mine"], [checksum, "0" * 64], real) == ["KOBE", None]


def test_a_copy_of_a_record_is_of_its_earthquake(real):
    """Scaled or trimmed, it has another checksum, and the same outline."""
    place = real["event"].values.tolist().index("KOBE")
    outline = str(real["outline"].values[place])
    second = "".join("0123456789abcdef"[15 - int(digit, 16)] for digit in outline)
    assert earthquakes_among(["mine"] * 2, ["0" * 64] * 2, real, [outline, second]) == ["KOBE", None]


def test_other_earthquakes_keep_their_names():
    suite = xr.Dataset(coords={"event": ("motion", ["TOHOKU 2011-03-11", "Maule"])})
    assert earthquakes_among(["Tohoku", "MAULE 2010-02-27", "Illapel"], ["", "", ""], suite) == [
        "TOHOKU 2011-03-11",
        "Maule",
        None,
    ]


@pytest.mark.slow
def test_headers_of_all_real_records_are_recognised(real_motions_folder, real):
    for folder in ("far_field", "near_field"):
        catalogue_events = {
            motion.checksum: motion.event for motion in load_motions(real_motions_folder, sets=[folder])
        }
        motions = list(load_motions(real_motions_folder / folder))
        labels = earthquakes_among([motion.event for motion in motions], [""] * len(motions), real)
        assert labels == [catalogue_events[motion.checksum] for motion in motions]
