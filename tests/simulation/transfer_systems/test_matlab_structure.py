"""What SciPy reads of MATLAB files is sound, whatever it holds; what would end the process is not."""

from pathlib import Path

import numpy as np
import pytest
import scipy

from reliab.simulation.transfer_systems.matlab_structure import require_sound_structure

CONTENT = {
    "complex": np.arange(9.0) + 1j,
    "structure": {"a": [1, 2], "b": "text", "inner": {"c": np.eye(3)}},
    "cells": np.array([np.eye(2), "b"], dtype=object),
    "sparse": scipy.sparse.csc_matrix(np.eye(4)),
    "empty": [],
    "words": np.array(["ab", "cd"]),
    "logical": np.array([True]),
}
FILES = sorted((Path(scipy.io.__file__).parent / "matlab/tests/data").glob("*.mat"))


@pytest.fixture
def path(tmp_path):
    return tmp_path / "held.mat"


@pytest.mark.parametrize("content", [False, True])
def test_all_kinds_of_variables_are_sound(path, content):
    scipy.io.savemat(path, CONTENT, do_compression=content)
    require_sound_structure(path)


def read_by_scipy(file):
    try:
        scipy.io.loadmat(file)
    except Exception:  # noqa: BLE001 - some of them are damaged on purpose
        return False
    return True


@pytest.mark.skipif(not FILES, reason="this SciPy came without its tests")
@pytest.mark.filterwarnings("ignore")
def test_scipy_files_are_sound():
    readable = [file for file in FILES if read_by_scipy(file)]
    assert len(readable) > 90
    for file in readable:
        require_sound_structure(file)


@pytest.mark.parametrize("compact", [False, True])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_truncated_file_is_refused(path, compact, share):
    scipy.io.savemat(path, {"x": np.random.default_rng(1).normal(size=99)}, do_compression=compact)
    content = path.read_bytes()
    path.write_bytes(content[: 128 + int(share * (len(content) - 128))])
    with pytest.raises(ValueError, match="ends within a variable"):
        require_sound_structure(path)


def test_variables_within_variables_without_end_are_refused(path):
    content = np.eye(1)
    for _ in range(70):
        cell = np.empty(1, dtype=object)
        cell[0] = content
        content = cell
    scipy.io.savemat(path, {"deep": content})
    with pytest.raises(ValueError, match="unknown kind"):
        require_sound_structure(path)


@pytest.mark.parametrize("kind", [0, 8, 14, 99, 60_000])
def test_numbers_of_no_kind_are_refused(path, kind):
    scipy.io.savemat(path, {"num": np.arange(9.0)})
    content = bytearray(path.read_bytes())
    place = content.index(b"num") + 4
    assert int.from_bytes(content[place : place + 4], "little") == 9
    content[place : place + 4] = kind.to_bytes(4, "little")
    path.write_bytes(content)
    with pytest.raises(ValueError, match="unknown kind"):
        require_sound_structure(path)
