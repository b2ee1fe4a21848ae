"""The report of a rig: two pages and an appendix."""

import numpy as np
from rig_rows import keep, rig_table, rig_test

from reliab.app.api.rigs import report_rig
from reliab.report.kinds.rig_report import rig_report
from reliab.rig.memory import NextTest
from reliab.rig.prediction import predict_next
from reliab.structures.structure import Structure

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.02)


def perform_tests(count, step=0.0):
    """Tests whose delay grows by a step in the middle."""
    rng = np.random.default_rng(1)
    for number in range(count):
        delay = 2.0 + 0.3 * rng.normal() + step * (number >= count // 2)
        yield rig_test(
            number,
            date=f"2026-01-{1 + number // 2:02d}T{9 + number % 2:02d}:00:00",
            event=f"EQ{number // 2}",
            d_ms=delay,
            A=0.99 + 0.003 * rng.normal(),
            remainder=0.01 * np.exp(0.2 * rng.normal()),
            rms=float(np.hypot(0.04, delay / np.sqrt(1400.0))),
        )


def test_a_rig_is_reported_for_the_head_of_the_laboratory(text_of):
    table = rig_table(perform_tests(34, 2.0))
    prediction = predict_next(rig_table(perform_tests(6)), STRUCTURE, NextTest(), threshold=0.05)
    text = text_of(rig_report("A & $b$", table, prediction, structure=STRUCTURE, provenance={}))
    for words in (
        "34 of 34 tests were judged reliable",
        "delay +2",
        "R-hat",
        "the last ten",
    ):
        assert words in text
    assert "Next test" not in text_of(rig_report("frames", table, prediction, structure=None, provenance={}))


def test_the_report_is_written_of_a_folder(tmp_path):
    keep(tmp_path, *perform_tests(6))
    out = report_rig(tmp_path, tmp_path / "report.pdf")
    assert out.read_bytes().startswith(b"%PDF")
