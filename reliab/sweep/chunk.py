"""The chunk that holds the results of one motion, written as Zarr would write it but without its event loop.

Zarr passes every chunk through an event loop and a pool of threads, which costs as much processor time as
simulating it, under the interpreter's lock. The bytes are the same: little-endian values, Blosc, CRC-32C,
under the name that the array prescribes.
"""

from pathlib import Path
from typing import Any, Final

import numpy as np
from numcodecs.blosc import BITSHUFFLE, SHUFFLE, Blosc
from numcodecs.checksum32 import CRC32C
from numpy.typing import NDArray
from zarr.codecs import BloscCodec, Crc32cCodec

from reliab.files import written_whole

_COMPRESSOR: Final = "zstd"
_LEVEL: Final = 1


def codecs() -> list[Any]:
    """Zarr's codecs of arrays of numbers, with which chunks are read."""
    return [BloscCodec(cname=_COMPRESSOR, clevel=_LEVEL), Crc32cCodec()]


def encoded(values: NDArray[np.generic]) -> bytes:
    """Encode the values of a chunk."""
    plain = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    shuffle = BITSHUFFLE if plain.itemsize == 1 else SHUFFLE
    compressed = Blosc(cname=_COMPRESSOR, clevel=_LEVEL, shuffle=shuffle).encode(plain)
    return bytes(CRC32C(location="end").encode(compressed))


def write_chunk(folder: Path, array: Any, index: int, values: NDArray[np.generic]) -> None:  # noqa: ANN401
    """Write the values of one motion to an array whose chunks hold one motion each."""
    key = array.metadata.encode_chunk_key((index, *(0 for _ in values.shape)))
    place = folder / key
    place.parent.mkdir(parents=True, exist_ok=True)
    with written_whole(place, synced=False) as unfinished:
        unfinished.write_bytes(encoded(values))
