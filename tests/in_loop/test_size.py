"""What the monitor in a loop adds to the wheel stays small."""

import zlib
from importlib.resources import files

LARGEST_SIZE = 50_000  # bytes


def test_sources_and_toolbox_are_small_in_a_wheel():
    folders = [
        files("reliab.in_loop").joinpath("template"),
        files("reliab.in_loop").joinpath("matlab", "+reliab"),
    ]
    texts = [path.read_bytes() for folder in folders for path in folder.iterdir()]
    assert len(texts) > 10
    assert sum(len(zlib.compress(text)) for text in texts) < LARGEST_SIZE
