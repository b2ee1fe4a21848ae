"""Reading tables of ellipses, sound and faulty."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.population import sample_of


def write_ellipses(tmp_path, text):
    path = tmp_path / "ellipses.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_printed_table_has_100_motions_of_19_earthquakes(printed_table2):
    sample = sample_of(printed_table2, frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms")
    assert (sample.n_motions, sample.n_events) == (100, 19)
    assert sample.motions[12] == "KOBE/NIS000"
    assert sample.a[12] == pytest.approx(1.38e-4)
    assert sample.b[12] == pytest.approx(2.35)


def test_columns_are_found_in_any_order_and_case(tmp_path):
    path = write_ellipses(tmp_path, "B, Event ,A,Motion\n2,K,1e-4,x\n3,K,2e-4,y\n4,L,3e-4,z\n")
    table = read_ellipses(path, f=2.0, xi=0.05, threshold=0.1, metric="mte")
    sample = sample_of(table, frequency=2.0, damping_ratio=0.05, threshold=0.1, metric="mte")
    np.testing.assert_array_equal(sample.a, [1e-4, 2e-4, 3e-4])
    np.testing.assert_array_equal(sample.events, ["K", "K", "L"])


def test_without_names_every_row_is_an_event(tmp_path):
    table = read_ellipses(write_ellipses(tmp_path, "a,b\n1e-4,2\n1e-4,3\n2e-4,4\n"))
    assert len(set(table["event"].values)) == 3


def test_structures_and_thresholds_may_stand_in_the_table(tmp_path):
    rows = [
        f"{m},{f},{xi},{threshold},{f * (k + 1) * 1e-4},{k + 1}"
        for k, m in enumerate("xyz")
        for f in (1, 2)
        for xi in (0.02, 0.05)
        for threshold in (0.05, 0.1)
    ]
    table = read_ellipses(write_ellipses(tmp_path, "motion,f,xi,threshold,a,b\n" + "\n".join(rows)))
    assert dict(table.sizes) == {
        "motion": 3, "f": 2, "xi": 2, "threshold": 2, "metric": 1, "curve": 1, "side": 1,
    }  # fmt: skip
    sample = sample_of(table, frequency=2.0, damping_ratio=0.05, threshold=0.1, metric="rms")
    np.testing.assert_allclose(sample.a, [2e-4, 4e-4, 6e-4])


def test_motion_missing_in_a_cell_is_skipped_there(tmp_path):
    text = (
        "motion,f,a,b\nx,1,1e-4,1\ny,1,2e-4,2\nz,1,3e-4,3\nw,1,3e-4,3\nx,2,1e-4,1\ny,2,2e-4,2\nz,2,3e-4,3\n"
    )
    table = read_ellipses(write_ellipses(tmp_path, text))
    for frequency, count in ((1.0, 4), (2.0, 3)):
        sample = sample_of(table, frequency=frequency, damping_ratio=0.02, threshold=0.05, metric="rms")
        assert sample.n_motions == count


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "readable CSV"),
        ("a,c\n1,2\n", "No column b"),
        ("a,b\n1e-4,2\n-1e-4,2\n", "line 3: Not a number between .* in the column a"),
        ("a,b\n1e-4,two\n", "line 2: Not a number between .* in the column b; found 'two'"),
        ("a,b\n1e-4,inf\n", "line 2"),
        ("a,b\n1e-4,\n", "line 2"),
        ("motion,a,b\nx,1e-4,2\nx,1e-4,3\n", "line 3: A motion occurs twice"),
        ("a,b,xi\n1e-4,1,zero\n", "column xi"),
    ],
)
def test_faults_are_named_with_their_line(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        read_ellipses(write_ellipses(tmp_path, text))


def test_a_missing_file_is_bad_input(tmp_path):
    with pytest.raises(InputError, match=r"none\.csv: No such file"):
        read_ellipses(tmp_path / "none.csv")


def test_a_binary_file_is_bad_input(tmp_path):
    path = tmp_path / "binary.csv"
    path.write_bytes(bytes(range(256)) * 20)
    with pytest.raises(InputError):
        read_ellipses(path)


@pytest.mark.parametrize(
    "wrong", [{"frequency": 3.0}, {"damping_ratio": 0.1}, {"threshold": 0.2}, {"metric": "mte"}]
)
def test_untraced_value_is_refused_with_a_choice(printed_table2, wrong):
    cell = {"frequency": 1.0, "damping_ratio": 0.02, "threshold": 0.05, "metric": "rms", **wrong}
    with pytest.raises(InputError, match="Choose among"):
        sample_of(printed_table2, **cell)
