"""The real records of the paper, where they are at hand."""

import csv
from pathlib import Path

import numpy as np
import pytest

from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.catalogue import write_suite
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions
from reliab.motions.suite import MotionSuite

SET_NAMES = ["far_field", "near_field", "held_out"]


@pytest.fixture(scope="module")
def suite(real_motions_folder: Path) -> MotionSuite:
    return MotionSuite.from_motions(load_motions(real_motions_folder, sets=SET_NAMES))


@pytest.fixture(scope="module")
def rows(real_motions_folder: Path) -> list[dict[str, str]]:
    with (real_motions_folder / "catalog.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_suite_of_the_paper_has_a_hundred_motions_from_nineteen_events(real_motions_folder: Path) -> None:
    suite = load_motions(real_motions_folder)
    assert len(suite) == 100
    assert len(set(suite.events)) == 19
    assert "KOBE/KJM000" not in suite.names


def test_sizes_steps_and_peaks_are_those_of_the_catalogue(
    suite: MotionSuite, rows: list[dict[str, str]]
) -> None:
    assert list(suite.names) == [row["motion"] for row in rows]
    for motion, row in zip(suite, rows, strict=True):
        assert motion.acceleration.size == int(row["header_npts"])
        assert motion.time_step == float(row["header_dt_s"])
        assert motion.peak_acceleration / STANDARD_GRAVITY == pytest.approx(float(row["pga_g"]), abs=5.1e-5)


def test_samples_equal_numpy_reading(
    suite: MotionSuite, rows: list[dict[str, str]], real_motions_folder: Path
) -> None:
    for motion, row in zip(suite, rows, strict=True):
        lines = (real_motions_folder / row["file"]).read_text().splitlines()[4:]
        expected = np.array(" ".join(lines).split(), dtype=float) * STANDARD_GRAVITY
        np.testing.assert_array_equal(motion.acceleration, expected)


def test_no_fault_is_found(real_motions_folder: Path) -> None:
    assert inspect(real_motions_folder).faults == []
    assert inspect(real_motions_folder / "near_field").faults == []


def test_events_are_told_by_the_headers_without_the_catalogue(real_motions_folder: Path) -> None:
    """Components stay together; an earthquake is split only where its headers print two names or dates."""
    for name, events in {"far_field": 15, "near_field": 14}.items():
        scan = load_motions(real_motions_folder / name)
        assert len(set(scan.events)) == events


@pytest.mark.slow
def test_an_imported_suite_reads_back_bit_by_bit(suite: MotionSuite, tmp_path: Path) -> None:
    write_suite(suite, tmp_path / "suite")
    assert list(load_motions(tmp_path / "suite", sets=SET_NAMES)) == list(suite)
