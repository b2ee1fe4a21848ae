"""The report of a diagnosis says what was found, and its figures draw it."""

import datetime as dt
import io
import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from reliab.app.cli.literal_console import LiteralConsole
from reliab.core.vocabulary import Block
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.posterior import sample_posterior
from reliab.discrepancy.result.missing_effect import Unknown
from reliab.effects.registry import find_effect
from reliab.report.content import CONTENT_FILE, files_of
from reliab.report.figures.discrepancy import discrepancy_blocks
from reliab.report.kinds.discrepancy_figures import posterior_figure
from reliab.report.kinds.discrepancy_report import (
    discrepancy_report,
    findings_in_words,
    missing_effects_section,
)
from reliab.report.pdf import compile_report
from reliab.report.style import svg
from reliab.report.terminal import print_blocks
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.frame import Specimen
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

pytestmark = pytest.mark.usefixtures("blank_figures")

RATE = 256.0
SPECIMEN = Specimen(stiffness=2000.0)


def campaign_with(*effects, lag=0.0):
    truth = HybridTest(specimen=SPECIMEN, effects=effects)
    tests = []
    for k in range(4):
        rng = np.random.default_rng(k)
        t = np.arange(0.0, 20.0, 1.0 / RATE)
        waves = [np.sin(2 * np.pi * f * t + rng.uniform(0, 7)) for f in rng.uniform(0.4, 2.0, 6)]
        displacement = 0.01 * np.sum(waves, axis=0) * np.sin(np.pi * t / t[-1]) ** 2
        force = np.interp(t - lag, t, load(truth, Motion3.interpolate(displacement, 1.0 / RATE)))
        force += 0.3 * rng.standard_normal(t.size)
        measured = displacement + 1e-6 * rng.standard_normal(t.size)
        channels = {Channel.COMMAND: displacement, Channel.MEASURED: measured, Channel.FORCE: force}
        tests.append(MeasuredTest(file=f"test_{k}.csv", motion="", held_out=k == 3, channels=channels))
    return Campaign(
        name="rig $1",
        structure=None,
        mass=1.0,
        actuator=None,
        specimen=SPECIMEN,
        rate=RATE,
        tests=tuple(tests),
    )


@pytest.fixture(scope="module")
def damping_diagnosis():
    return diagnose(campaign_with(find_effect("viscous_damping")(damping_n_s_per_m=30.0)))


def text_of(document):
    return json.loads(files_of(document)[CONTENT_FILE])


def test_missing_effects_come_first(damping_diagnosis):
    result = text_of(discrepancy_report(damping_diagnosis, provenance={"seed": 1}))
    verdict = "".join(piece["text"] for piece in result["verdict"])
    assert verdict.startswith("The model lacks viscous damping. With it the error in force_n on held-out")
    assert verdict.endswith("): what remains is at the level of the noise.")
    assert " (the best linear model leaves " in verdict
    assert ", the best rival (" in verdict


@pytest.mark.slow
def test_a_report_with_a_posterior_is_set(damping_diagnosis):
    specimen = next(item for item in damping_diagnosis.blocks if item.effects)
    posterior = sample_posterior(specimen.problem, specimen.best)
    moved_campaign = replace(damping_diagnosis, criterion_shift={"a": 1.2, "b": 1.1})
    first, second = (
        compile_report(
            discrepancy_report(moved_campaign, posteriors={"specimen": posterior}, provenance={}),
            date=dt.date(2026, 1, 2),
        )
        for _ in range(2)
    )
    assert first.startswith(b"%PDF")
    assert first == second
    _, low, high = posterior.spread_of("viscous_damping.damping_n_s_per_m")
    assert low < 30.0 < high or abs(low - 30.0) < 1.0


def test_a_failed_figure_costs_a_figure_and_a_line(damping_diagnosis, monkeypatch):
    def fail(_found):
        raise ValueError("Number of rows must be positive")

    monkeypatch.setattr("reliab.report.kinds.discrepancy_figures.gap_figure", fail)
    document = discrepancy_report(damping_diagnosis, provenance={})
    content = json.dumps(text_of(document), ensure_ascii=False)
    assert "The figure of the gap could not be drawn" in content
    assert "Number of rows must be positive" in content
    assert compile_report(document, date=dt.date(2026, 1, 2)).startswith(b"%PDF")


def test_a_terminal_shows_the_findings_without_figures(damping_diagnosis):
    stream = io.StringIO()
    unknown = Unknown(block="specimen", description="a bent spring", expression="3 x³", held_out_nrmse=0.012)
    blocks = tuple(replace(block, unknown=unknown) for block in damping_diagnosis.blocks)
    result = replace(damping_diagnosis, blocks=blocks)
    print_blocks(findings_in_words(result), LiteralConsole(file=stream, width=400))
    text = " ".join(stream.getvalue().split())
    (effect,) = result.effects
    for sentence in (
        "Where the model fails",
        f"viscous damping {effect.probability:.3f} damping coefficient",
        "An expression for it is 3 x³; with it 1.20 % of the signal remain",
        "The proof on held-out tests",
        "viscous damping yes",
        *result.remarks,
    ):
        assert sentence in text


def test_a_posterior_without_named_parameters_draws_nothing(damping_diagnosis):
    empty = SimpleNamespace(names=("stiffness",), units=("-",))
    assert posterior_figure(damping_diagnosis, "specimen", empty) is None


def test_posterior_with_an_offset_of_the_clocks_is_drawn(monkeypatch):
    """Effects outside the library have parameters, too."""
    late = diagnose(campaign_with(find_effect("cubic_stiffness")(cubic_n_per_m3=3e6), lag=0.02))
    assert {effect.name for effect in late.effects} == {"cubic_stiffness", "clock_offset"}
    calls = []
    monkeypatch.setattr(
        "reliab.report.kinds.discrepancy_figures.discrepancy_posterior",
        lambda names, draws: calls.append((names, draws.shape)),
    )
    names = ("clock_offset.lag_s", "cubic_stiffness.cubic_n_per_m3")
    for converged in (True, False):
        posterior = SimpleNamespace(
            names=names,
            meanings=("lag", "cubic stiffness"),
            units=("s", "N/m³"),
            draws=np.zeros((5, 2)),
            converged=converged,
        )
        posterior_figure(late, "specimen", posterior)
    assert calls == [(["lag [s]", "cubic stiffness [N/m³]"], (5, 2))]


def test_errors_stand_by_test_and_with_and_without_each_effect(damping_diagnosis):
    content = json.dumps(text_of(discrepancy_report(damping_diagnosis, provenance={})), ensure_ascii=False)
    effect = damping_diagnosis.effects[0]
    assert effect.error_without > 5.0 * effect.error_with
    assert "remains on held-out tests, without it" in content
    assert "Unexplained is the share of the gap's energy that remains" in content
    assert "Models that were tried" in content
    assert "is noise (band above the motion)" in content


def test_an_error_stands_in_sentences_as_in_the_table(damping_diagnosis):
    """An error of 5 % of the signal is one of 5.00 % in both, whatever its last digits."""
    gap = replace(damping_diagnosis.gap, before=0.05, after=0.0120)
    blocks = tuple(replace(block, gap=gap) if block.effects else block for block in damping_diagnosis.blocks)
    result = text_of(discrepancy_report(replace(damping_diagnosis, blocks=blocks), provenance={}))
    content = json.dumps(result, ensure_ascii=False)
    assert "falls from 5.00 % to 1.20 % of the signal" in content
    assert {"5.00", "1.20"} <= set(re.findall(r'"([0-9.]+)"', content))


def test_a_frame_is_told_by_its_size_and_lowest_frequency(damping_diagnosis):
    partition = Partition.from_structure(Structure(frequency=1.25, damping_ratio=0.02), mass=20.0)
    campaign = replace(damping_diagnosis.campaign, partition=partition)
    facts = dict(
        text_of(discrepancy_report(replace(damping_diagnosis, campaign=campaign), provenance={}))["facts"]
    )
    assert "frame of 1 degrees of freedom" in json.dumps(facts["Structure"])
    assert "f_1 = 1.25" in json.dumps(facts["Structure"])


def test_nothing_missing_is_said_so():
    document = discrepancy_report(diagnose(campaign_with()), provenance={})
    assert document.tone == "good"
    assert "".join(document.verdict) == "Calibration alone explains the tests: they show no missing effect."
    assert compile_report(document, date=dt.date(2026, 1, 2)).startswith(b"%PDF")


def test_guilty_blocks_are_coloured():
    empty_figure = discrepancy_blocks(lacking={}, observed=set(Block))
    item = discrepancy_blocks(lacking={Block.SPECIMEN: "friction"}, observed=set(Block))
    assert svg(empty_figure).count(b"#f7d9c6") == 1  # the legend's
    assert svg(item).count(b"#f7d9c6") == 2


def test_a_complete_model_has_a_residual_like_noise(damping_diagnosis):
    """Of both pairs of sentences each stands where it holds."""
    blank = {block.block: replace(block, findings=()) for block in damping_diagnosis.blocks}
    complete_model = replace(damping_diagnosis, blocks=tuple(blank.values()))
    content = json.dumps(text_of(discrepancy_report(complete_model, provenance={})))
    assert complete_model.is_explained
    assert "does not differ from noise" in content
    assert "varies with no quantity of the motion" not in content


def test_calibrated_parameters_stand_with_missing_effects(damping_diagnosis):
    section = missing_effects_section(damping_diagnosis, {})
    table = section.blocks[-1].frame
    result = [(e.meaning, e.size) for block in damping_diagnosis.blocks for e in block.calibration]
    assert result
    assert list(zip(table["parameter"], table["value"], strict=True)) == result
