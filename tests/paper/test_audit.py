"""Every printed number beside what follows from the printed tables and from given ellipses."""

import numpy as np
import pytest
import xarray as xr

from reliab.errors import InputError
from reliab.paper import audit
from reliab.shipped import shipped

PRINTED = shipped("datasets", "paper")


@pytest.fixture(scope="module")
def table():
    return audit(PRINTED).set_index(["item", "quantity"])


@pytest.mark.parametrize(
    ("item", "quantity", "value", "digits"),
    [
        ("Equation (12)", "a", 5.29e-5, 2e-3),
        ("Equation (12)", "b", 1.048, 1e-3),
        ("Figure 11", "correlation of a and b", 0.9774, 1e-4),
        ("Equation (15)", "k1", 121.6, 1e-3),
        ("Equation (15)", "k2", 6.62, 1e-3),
        ("Equation (16)", "k3", 0.0463, 1e-3),
        ("Equation (16)", "k4", 104.0, 5e-3),
        ("Table 6", "index of equation (18) of case 1", 0.956, 1e-3),
        ("Table 6", "index of equation (18) of case 2", 0.760, 1e-3),
        ("Table 6", "index of equation (18) of case 3", 0.977, 1e-3),
        ("Table 6", "index of equation (18) of case 4", 3.830, 1e-3),
    ],
)
def test_numbers_follow_from_the_printed_tables(table, item, quantity, value, digits):
    assert table.loc[(item, quantity), "from_tables"] == pytest.approx(value, rel=digits)


def test_every_item_stands_once(table):
    assert table.index.is_unique
    assert {f"Table {number}" for number in range(1, 7)} <= set(table.index.get_level_values("item"))
    assert {f"Equation ({number})" for number in (11, 12, 14, 15, 16, 17, 18)} <= set(
        table.index.get_level_values("item")
    )
    assert len(table.loc["Table 2"]) == 200


def test_errata_are_named(table):
    assert "b f² is nearly constant" in table.loc[("Equation (15)", "b at 2 Hz"), "finding"]
    assert "7.5 times" in table.loc[("Equation (18)", "a at ξ = 0.02"), "finding"]
    assert table.loc[("Table 4", "b at ξ = 0.1"), "finding"] == "√b printed as b"


def ellipses_of(table2):
    """Ellipses as printed, but one record's doubled and the delay of another halved."""
    a, b = (table2[each].to_numpy(dtype=float, copy=True) for each in "ab")
    a[0], b[0] = 2.0 * a[0], 2.0 * b[0]
    b[1] = 0.5 * b[1]
    shape = ("motion", "f", "xi", "threshold", "metric", "curve")
    return xr.Dataset(
        {name: (shape, each[:, None, None, None, None, None]) for name, each in (("a", a), ("b", b))},
        coords={
            "motion": table2["record"].to_numpy(),
            "f": [1.0],
            "xi": [0.02],
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
        },
    )


def test_rows_are_compared_with_the_records(printed_rows):
    found = audit(PRINTED, ellipses_of(printed_rows)).set_index(["item", "quantity"])
    names = printed_rows["record"].tolist()
    assert "by about 2, as another duration" in found.loc[("Table 2", f"a of {names[0]}"), "finding"]
    assert "does not come back" in found.loc[("Table 2", f"b of {names[1]}"), "finding"]
    assert (found.loc["Table 2"]["finding"].iloc[4:] == "comes back").all()
    assert np.isnan(found.loc[("Table 3", "a at 2 Hz"), "from_records"])


def test_simulated_numbers_take_their_place(table):
    found = audit(PRINTED, simulated={("Table 6", "RMS^R of case 1"): 2.56}).set_index(["item", "quantity"])
    assert found.loc[("Table 6", "RMS^R of case 1"), "finding"] == "comes back"
    assert "cannot be recomputed" in table.loc[("Table 6", "RMS^R of case 1"), "finding"]


def test_what_the_paper_does_not_print_is_refused():
    with pytest.raises(InputError, match="belong to an item"):
        audit(PRINTED, simulated={("Table 7", "a"): 1.0})


def test_a_folder_without_the_tables_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"no table2\.csv"):
        audit(tmp_path)
