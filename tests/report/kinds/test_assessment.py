"""An assessment is set on two pages; its verdict says what was found."""

import re
import zlib

import numpy as np
import pytest

from reliab.assessment.assess import assess
from reliab.core.significant_digits import percent_and_interval
from reliab.core.stated_value import StatedValue
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.methods.registry import method_of
from reliab.recordings.recording import Recording
from reliab.report.kinds.assessment.report import assessment_report
from reliab.report.prose import replace_arguments_by_options
from reliab.structures.structure import Structure


def pages(pdf):
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL)
    content = [pdf]
    for stream in streams:
        try:
            content.append(zlib.decompress(stream))
        except zlib.error:
            continue
    return len(re.findall(rb"/Type\s*/Page\b", b"\n".join(content)))


@pytest.fixture(scope="module")
def criterion(ellipses_of):
    return derive_criterion(ellipses_of(), method=method_of("dirichlet"), joint=True)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("delay", "deviation", "tone", "word"),
    [
        (1e-4, 0.0, "good", "reliable"),
        (1e-3, 0.006, "plain", "undecided"),
        (4e-3, 0.0, "bad", "not reliable"),
    ],
)
def test_a_test_is_reported_on_two_pages(
    criterion, set_without_warnings, text_of, delay, deviation, tone, word
):
    times = np.arange(0.0, 40.0, 1.0 / 256.0)
    command = 0.02 * np.sin(2.0 * np.pi * times) * np.hanning(times.size)
    noise = 1e-6 * np.random.default_rng(1).normal(size=times.size)
    measured = 0.999 * np.interp(times - delay, times, command) + noise
    recording = Recording(command=command, measured=measured, time_step=1.0 / 256.0, name="#1 $test$")
    values = {"f": StatedValue(1.0), "xi": StatedValue(0.02, deviation)}
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    assessment = assess(recording, structure, stated=values, criterion=criterion)
    notes = ("A remark of the laboratory, long enough to take more than one line of the sheet. " * 2,) * 3
    document = assessment_report(assessment, provenance={"file": "a.csv"}, notes=notes)
    assert document.tone == tone
    assert pages(set_without_warnings(document)) == 2
    read = text_of(document)
    assert f"The test is {word}" in read
    assert "over the test's own 40 s" in read
    assert f"with the test {assessment.scope.position} of them" in read
    rms = assessment.error.rebuilt.rms
    value, interval = percent_and_interval(rms.value, rms.low, rms.high)
    sizes = {"undecided": f"{interval} (90 % interval)"}
    assert f"RMS error {sizes.get(word, f'{value} (90 % interval {interval})')}, " in read
    assert "likely to be below 5 %" in read
    assert f"RMS error {value} {interval} ".replace(" %", "") in read  # as the table has them
    assert all(replace_arguments_by_options(remedy) in read for remedy in assessment.would_decide)
