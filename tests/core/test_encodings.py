"""A text says the same in every encoding that programs on Windows write, through every reader."""

import numpy as np
import pytest

from reliab.core.encodings import as_cell, pieces_as_utf8, restore_cell
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.campaign.reading import read_channels
from reliab.motions.loading import load_motions
from reliab.recordings.following import rows_as_written
from reliab.recordings.reading import read_test
from reliab.recordings.recording import StatedChannels

ENCODINGS = (
    *("utf-8", "utf-8-sig", "utf-16", "utf-16-le with a mark", "utf-16-be with a mark"),
    *("utf-16-le", "utf-16-be"),
)
HEADER = "# units: m/s2\r\n# time_step: 0.01\r\n# event: Köln\r\n"
RECORD = HEADER + "".join(f"{0.1 * k:.2f}\r\n" for k in range(9))
TEST = "time_s,command_m,measured_m\r\n" + "".join(f"{k / 64},{k % 7},{k % 5}\r\n" for k in range(80))


def encode_text(text, encoding, place):
    name, _, mark = encoding.partition(" ")
    place.write_bytes((f"\ufeff{text}" if mark else text).encode(name))
    return place


@pytest.fixture(params=ENCODINGS)
def encoding(request):
    return request.param


def test_ground_motions(tmp_path, encoding):
    (motion,) = load_motions(encode_text(RECORD, encoding, tmp_path / "a.txt"))
    np.testing.assert_allclose(motion.acceleration, 0.1 * np.arange(9))
    assert motion.event == "Köln"


def test_catalogues(tmp_path, encoding):
    encode_text(RECORD, encoding, tmp_path / "a.txt")
    encode_text("motion,event,file\r\nä,Köln,a.txt\r\n", encoding, tmp_path / "catalog.csv")
    (motion,) = load_motions(tmp_path)
    assert (motion.name, motion.event) == ("ä", "Köln")


def test_recordings(tmp_path, encoding):
    columns = read_test(encode_text(TEST, encoding, tmp_path / "a.csv"))
    assert list(columns.values) == ["time_s", "command_m", "measured_m"]
    np.testing.assert_array_equal(columns.values["measured_m"], np.arange(80) % 5)


def test_tests_of_a_campaign(tmp_path, encoding):
    text = TEST.replace("command_m", "force_n")
    channels, _ = read_channels(encode_text(text, encoding, tmp_path / "a.csv"), 64.0, StatedChannels())
    np.testing.assert_array_equal(channels[Channel.MEASURED], np.arange(80) % 5)


def test_tables_of_ellipses(tmp_path, encoding):
    text = "motion,a,b\r\nä/1,1e-4,20\r\nö/2,2e-4,30\r\n"
    assert read_ellipses(encode_text(text, encoding, tmp_path / "a.csv"))["event"].values.tolist() == [
        "ä",
        "ö",
    ]


@pytest.mark.parametrize("size", [2, 3, 1000])
def test_a_running_test_in_pieces(tmp_path, encoding, size):
    content = encode_text(TEST, encoding, tmp_path / "a.csv").read_bytes()
    pieces = [content[k : k + size] for k in range(0, len(content), size)]
    rows = rows_as_written(iter([*pieces, b"", *pieces]), name="a.csv", declarations={})
    measured = np.concatenate([row.measured for row in rows])
    np.testing.assert_array_equal(measured, np.tile(np.arange(80) % 5, 2))


def test_a_new_file_may_have_another_encoding():
    pieces = ["aä".encode("utf-16"), b"", "bö".encode()]
    assert b"".join(pieces_as_utf8(pieces)).decode() == "aäbö"


CELLS = (
    *("=1+1", "+A1", "-A1", "@sum", "'=x", "''=x", "\t=1", " =1", "＝1"),
    *("'-5", "-5", "+.5e-3", "KOBE/1", "'", ""),
)


@pytest.mark.parametrize("text", CELLS)
def test_a_cell_is_read_as_it_was_written_and_is_no_formula(text):
    cell = as_cell(text)
    assert restore_cell(cell) == text
    try:
        float(cell)
    except ValueError:
        assert not cell.strip().startswith(("=", "+", "-", "@", "＝"))
