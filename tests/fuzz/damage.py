"""Damage to the files of a case, and what is put in place of a file."""

import json
import os
import re
import stat
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random

from hypothesis import strategies as st

from fuzz.corpus import Case

NUMBERS = (
    *(b"0", b"-0.0", b"-1", b"1e308", b"-1e308", b"1e-320", b"1e999", b"nan", b"inf", b"-inf", b"1e9"),
    *(b"999999999999999999999", b"0x1F", b"1_000", b"1,5", b"", b"true", b"null", b'"x"', b"[]", b"{}"),
)
WORDS = (
    *(b"/etc/passwd", b"../../../../etc/passwd", b"/dev/zero", b"..", b".", b"a\x00b", b"con", b"~"),
    *(b"[bold]", b"[/red]", b"\x1b[31m", b"<b>", b"#panic()", "\u202eabc".encode(), b"x" * 3000),
    *(b"held_out = true", b"[[tests]]", b"[structure]", b"time_s", b"force_n", b"motion", b"a", b"\n", b","),
    *(b";", b"\t", b'"', b"'", b"=", b"{", b"[", b"\xff\xfe", b"\xef\xbb\xbf", b"\r", b"#", b"\x1a"),
)
_NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
_WORD = re.compile(rb"[A-Za-z_]\w*")


@dataclass(frozen=True)
class Instead:
    """What stands in the folder in place of an ordinary file: pipe, loop, zero, folder, nowhere or secret."""

    kind: str


SECRET = b"root:x:0:0:root:/root:/bin/sh\n"

INSTEAD = ("pipe", "loop", "zero", "folder", "nowhere", "secret")

EDITS = ("number", "number", "word", "bits", "cut", "put", "line twice", "no line", "end", "instead", "lost")
DamagedCase = Mapping[str, "bytes | Instead"]


@dataclass(frozen=True)
class Edit:
    """A change of one of the files: which one and where in it, both from 0 to 1, how much, what is put."""

    file: float
    kind: str
    place: float
    size: int
    insertion: bytes


_INSERTIONS = st.one_of(st.sampled_from(NUMBERS + WORDS), st.binary(max_size=8))
_SHARES = st.floats(0.0, 1.0)
_EDITS = st.builds(Edit, _SHARES, st.sampled_from(EDITS), _SHARES, st.integers(0, 64), _INSERTIONS)


def damaged_cases(seeds: list[Case]) -> st.SearchStrategy[DamagedCase]:
    """One of the seeds with one to four edits."""
    return st.builds(apply_edits, st.sampled_from(seeds), st.lists(_EDITS, min_size=1, max_size=4))


def draw_case(random: Random, seeds: list[Case]) -> tuple[Case, list[Edit]]:
    """One of the seeds and one to four edits, drawn without the bookkeeping of hypothesis."""
    return random.choice(seeds), [_draw_edit(random) for _ in range(random.randint(1, 4))]


def _draw_edit(random: Random) -> Edit:
    from_list = random.random() < 0.75
    insertion = random.choice(NUMBERS + WORDS) if from_list else random.randbytes(random.randint(0, 8))
    place = random.choice((0.0, 1.0, *[random.random()] * 8))
    return Edit(random.random(), random.choice(EDITS), place, random.randint(0, 64), insertion)


def apply_edits(case: Case, edits: Sequence[Edit]) -> DamagedCase:
    """Apply edits to a case."""
    content: dict[str, bytes | Instead] = dict(case)
    for edit in edits:
        names = sorted(content)
        name = names[min(int(edit.file * len(names)), len(names) - 1)]
        present = content[name]
        if isinstance(present, Instead):
            continue
        if edit.kind == "instead":
            content[name] = Instead(INSTEAD[edit.size % len(INSTEAD)])
        elif edit.kind == "lost" and len(content) > 1:
            del content[name]
        else:
            content[name] = edit_content(present, edit.kind, edit.place, edit.size, edit.insertion)
    return content


def edit_content(  # noqa: PLR0911 - a line for each kind of edit
    content: bytes, kind: str, place: float, size: int, insertion: bytes
) -> bytes:
    """Content with one edit near a place between its begin, 0, and its end, 1."""
    offset = int(place * len(content))
    lines = content.split(b"\n")
    row = int(place * (len(lines) - 1))
    match kind:
        case "number" | "word":
            pattern = _NUMBER if kind == "number" else _WORD
            match = pattern.search(content, offset) or pattern.search(content)
            if match is None:
                return content
            return content[: match.start()] + insertion + content[match.end() :]
        case "bits":
            bits = bytes(byte ^ (1 << size % 8) for byte in content[offset : offset + 1 + size // 8])
            return content[:offset] + bits + content[offset + 1 + size // 8 :]
        case "cut":
            return content[:offset] + content[offset + size :]
        case "put":
            return content[:offset] + insertion + content[offset:]
        case "line twice":
            return b"\n".join([*lines[: row + 1], *lines[row:]])
        case "no line":
            return b"\n".join([*lines[:row], *lines[row + 1 :]])
    return content[:offset]


def secret_of(folder: Path) -> Path:
    """File beside a case's folder that nothing in the folder may change."""
    return folder.with_name(f"{folder.name}-secret")


def write(case: DamagedCase, folder: Path) -> None:
    """Write a case to a folder."""
    for name, content in case.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, bytes):
            path.write_bytes(content)
            continue
        match content.kind:
            case "pipe":
                os.mkfifo(path)
            case "loop":
                path.symlink_to(path)
            case "zero":
                path.symlink_to("/dev/zero")
            case "folder":
                path.mkdir()
            case "nowhere":
                path.symlink_to(folder / "nowhere" / "at all")
            case "secret":
                secret = secret_of(folder)
                secret.write_bytes(SECRET)
                path.symlink_to(secret)


def keep(case: DamagedCase, folder: Path) -> None:
    """Keep a case that was found, with a list of what stands in place of ordinary files."""
    special = {name: content.kind for name, content in case.items() if isinstance(content, Instead)}
    write({name: content for name, content in case.items() if isinstance(content, bytes)}, folder)
    (folder / "instead.json").write_text(json.dumps(special))


def read_kept(folder: Path) -> DamagedCase:
    """Read a case that `keep` wrote."""
    special = json.loads((folder / "instead.json").read_text())
    files = [path for path in folder.rglob("*") if stat.S_ISREG(path.lstat().st_mode)]
    content = {str(path.relative_to(folder)): path.read_bytes() for path in files}
    del content["instead.json"]
    return {**content, **{name: Instead(kind) for name, kind in special.items()}}
