"""Structure of a MATLAB file of version 5 to 7, checked before SciPy reads it.

SciPy looks up what a file names as the type of its numbers in a table without asking whether it is in
there, so that a damaged file ends the process. Elements are followed here in the order in which SciPy reads
them, after "MAT-File Format", The MathWorks, 2019.
"""

import io
import math
import zlib
from pathlib import Path
from typing import BinaryIO, Final, Literal, Protocol

_HEADER = 128  # bytes, whose last four hold the version and the order of bytes
_CHUNK = 1 << 16
_DEEPEST = 64
_SHORT = 4  # bytes
_MATRIX, _COMPRESSED_TYPE = 14, 15
_NUMBERS: Final = frozenset({1, 2, 3, 4, 5, 6, 7, 9, 12, 13, 16, 17, 18})
_CELL, _STRUCTURE, _OBJECT, _CHARACTERS, _SPARSE, _FUNCTION, _OPAQUE = 1, 2, 3, 4, 5, 16, 17
_NUMERIC: Final = range(6, 16)
_COMPLEX = 1 << 11
_BYTES = 9  # class of unsigned numbers of eight bits
_MOST_OBJECTS = 400_000_000  # bytes


def require_sound_structure(path: Path) -> None:
    """Follow all elements of a MATLAB file, and of the one within it that keeps objects of classes."""
    size = path.stat().st_size
    with path.open("rb") as file:
        header = file.read(_HEADER)
        if len(header) < _HEADER or 0 in header[:4] or header[124 + (header[126:127] == b"I")] != 1:
            return
        _follow(file, size, _order(header[126:128]))
    if subsystem := subsystem_of(path):
        inner = _order(subsystem[2:4])
        _follow(io.BytesIO(subsystem), len(subsystem), inner, begin=8)


def subsystem_of(path: Path) -> bytes:
    """Bytes of the file within a MATLAB file that keeps its objects of classes; none where it has none."""
    size = path.stat().st_size
    with path.open("rb") as file:
        header = file.read(_HEADER)
        order = _order(header[126:128])
        place = int.from_bytes(header[116:124], order)
        if not any(header[116:124].strip(b" \x00")) or not _HEADER <= place < size:
            return b""
        file.seek(place)
        kind, length = _Elements(_Plain(file, size), order).full_tag()
        if kind == _COMPRESSED_TYPE:
            return _Elements(_CompressedStream(file, length), order).bytes_of_matrix()
        file.seek(place)
        return _Elements(_Plain(file, size), order).bytes_of_matrix()


def _order(mark: bytes) -> Literal["little", "big"]:
    return "little" if mark == b"IM" else "big"


def _follow(file: BinaryIO, size: int, order: Literal["little", "big"], *, begin: int = _HEADER) -> None:
    """Follow the variables of a file, one after the other."""
    while begin < size:
        file.seek(begin)
        plain = _Elements(_Plain(file, size), order)
        kind, length = plain.full_tag()
        if kind == _COMPRESSED_TYPE:
            _Elements(_CompressedStream(file, length), order).matrix()
        elif kind == _MATRIX:
            file.seek(begin)
            plain.matrix()
        else:
            raise ValueError(f"a variable of the unknown kind {kind}")
        begin += 8 + length


class _Source(Protocol):
    """Bytes in their order."""

    def take(self, count: int) -> bytes: ...

    def skip(self, count: int) -> None: ...


class _Plain:
    def __init__(self, file: BinaryIO, size: int) -> None:
        self._file, self._size = file, size

    def take(self, count: int) -> bytes:
        self._require(count)
        return self._file.read(count)

    def skip(self, count: int) -> None:
        self._require(count)
        self._file.seek(count, 1)

    def _require(self, count: int) -> None:
        if self._file.tell() + count > self._size:
            raise ValueError("the file ends within a variable")


class _CompressedStream:
    """Bytes that are compressed, a piece of them at a time."""

    def __init__(self, file: BinaryIO, length: int) -> None:
        self._file, self._left = file, length
        self._unpacking, self._ready = zlib.decompressobj(), b""

    def take(self, count: int) -> bytes:
        while len(self._ready) < count:
            self._ready += self._piece()
        values, self._ready = self._ready[:count], self._ready[count:]
        return values

    def skip(self, count: int) -> None:
        while len(self._ready) < count:
            count -= len(self._ready)
            self._ready = self._piece()
        self._ready = self._ready[count:]

    def _piece(self) -> bytes:
        compressed = self._unpacking.unconsumed_tail
        if not compressed:
            compressed = self._file.read(min(_CHUNK, self._left))
            self._left -= len(compressed)
        piece = self._unpacking.decompress(compressed, _CHUNK)
        if not piece and not compressed:
            raise ValueError("the file ends within a variable")
        return piece


class _Elements:
    """Elements one after the other: a tag with kind and length, then the content."""

    def __init__(self, source: _Source, order: Literal["little", "big"]) -> None:
        self._source, self._order = source, order

    def _number(self, content: bytes) -> int:
        return int.from_bytes(content, self._order)

    def full_tag(self) -> tuple[int, int]:
        return self._number(self._source.take(4)), self._number(self._source.take(4))

    def _tag(self) -> tuple[int, int, int]:
        """Kind, length, and length with what fills it up; short contents stand within eight bytes."""
        first = self._number(self._source.take(4))
        if first >> 16:
            if first >> 16 > _SHORT:
                raise ValueError("a short element of more than four bytes")
            return first & 0xFFFF, first >> 16, 4
        length = self._number(self._source.take(4))
        return first, length, -(-length // 8) * 8

    def _numbers(self) -> None:
        kind, _, padded_length = self._tag()
        if kind not in _NUMBERS:
            raise ValueError(f"numbers of the unknown kind {kind}")
        self._source.skip(padded_length)

    def _content(self, longest: int) -> bytes:
        kind, length, padded_length = self._tag()
        if kind not in _NUMBERS or length > longest:
            raise ValueError("a name or size that is none")
        return self._source.take(padded_length)[:length]

    def matrix(self, depth: int = 0) -> None:
        """Follow a variable, or one within another."""
        kind, length = self.full_tag()
        if kind != _MATRIX or depth > _DEEPEST:
            raise ValueError(f"a variable of the unknown kind {kind}")
        if length == 0:
            return
        flags = self._number(self._source.take(16)[8:12])
        array_class = flags & 0xFF
        if array_class == _OPAQUE:
            for _ in range(3):
                self._content(_CHUNK)
            self.matrix(depth + 1)
            return
        sizes = self._content(4 * 32)
        count = math.prod(self._number(sizes[k : k + 4]) for k in range(0, len(sizes), 4))
        self._content(_CHUNK)
        self._values(array_class, count, 2 if flags & _COMPLEX else 1, depth)

    def bytes_of_matrix(self) -> bytes:
        """Numbers of a matrix of single bytes, which a file keeps its objects in."""
        kind, _ = self.full_tag()
        array_class = self._number(self._source.take(16)[8:12]) & 0xFF
        if kind != _MATRIX or array_class != _BYTES:
            raise ValueError("objects without bytes")
        self._content(4 * 32)
        self._content(_CHUNK)
        return self._content(_MOST_OBJECTS)

    def _values(self, array_class: int, count: int, parts: int, depth: int) -> None:
        if array_class == _OBJECT:
            self._content(_CHUNK)
        if array_class in {_STRUCTURE, _OBJECT}:
            width = self._number(self._content(4))
            count *= len(self._content(_CHUNK * _CHUNK)) // max(width, 1)
        if array_class in {_CELL, _STRUCTURE, _OBJECT, _FUNCTION}:
            for _ in range(count):
                self.matrix(depth + 1)
        elif array_class in _NUMERIC or array_class in {_CHARACTERS, _SPARSE}:
            parts_of_class = {_CHARACTERS: 1, _SPARSE: 2 + parts}
            for _ in range(parts_of_class.get(array_class, parts)):
                self._numbers()
        else:
            raise ValueError(f"a variable of the unknown class {array_class}")
