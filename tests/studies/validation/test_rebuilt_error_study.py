"""The rebuilt error beside criteria: the truth against another laboratory, verdicts, resume, refusals."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from rebuilt_error import laboratory
from reliab_studies.validation.beyond_the_model import Rig
from reliab_studies.validation.rebuilt_error_study import bench as simulated, rigs, study
from reliab_studies.validation.rebuilt_error_study.design import Design
from reliab_studies.validation.rebuilt_error_study.judges import CERTAIN, OWN_BOUNDARY, REBUILT, WITH_MODEL
from reliab_studies.validation.rebuilt_error_study.rigs import (
    _DECIBELS,
    CONDITIONS,
    LINEAR,
    PLAIN,
    QUANTISED,
    RIGS,
    Scales,
)
from reliab_studies.validation.rebuilt_error_study.study import shares, summarise_study, try_tests

from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.tracking.indices.response_error import response_error

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)
DURATION = 12.0


def shaken(seed=3):
    ground = laboratory.synthetic_ground(seed, DURATION, rate=simulated.RATE_HZ)
    return Motion(name=f"shaken {seed}", acceleration=ground, time_step=1.0 / simulated.RATE_HZ)


@pytest.fixture(scope="module")
def design():
    return Design.classify_motions([shaken()], [STRUCTURE], trials=1)


@pytest.fixture(scope="module")
def short(design):
    """One round with the plain condition and two wrong ones."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulated, "CONDITIONS", (PLAIN, *CONDITIONS[5:6]))
        return try_tests(design)


@pytest.mark.slow
def test_true_errors_are_those_of_another_laboratory():
    tau = 0.004
    lab = laboratory.Lab(1.0, 0.05, 1.0, laboratory.LAG, (1.0, tau, 0.0, 0.0))
    motion = shaken()
    reference_run = laboratory.run(lab, np.asarray(motion.acceleration), rate=simulated.RATE_HZ)
    bench = simulated._Bench(  # noqa: SLF001 - the truth of the study, before anything is drawn
        design=Design.classify_motions([motion], [STRUCTURE], trials=1),
        record=motion,
        structure=STRUCTURE,
        rng=np.random.default_rng(0),
        judges={},
    )
    effect = RIGS[1]
    scales = Scales(
        structure=STRUCTURE,
        displacement=1.0,
        velocity=1.0,
        duration=DURATION,
        step=motion.time_step,
        lean=0.0,
    )
    size = tau / scales.delay(1.0)
    late = bench.run(effect(size, scales), None).piston.values[0]
    ideal = bench.run(Rig(name="perfect"), None).command.values[0]
    error = response_error(late, ideal)
    assert error == pytest.approx(reference_run.rms, rel=2e-3)
    assert 0.01 < error < 0.5


@pytest.mark.slow
def test_the_rebuilt_error_is_the_true_one_whatever_the_actuator_did(short):
    plain = short[(short["specimen"] == LINEAR) & (short["stated"] == "right")]
    assert plain["rig"].nunique() == 8
    rebuilt = plain[plain["judge"] == REBUILT]
    assert np.median(np.abs(rebuilt["estimate"] / rebuilt["error"] - 1.0)) < 0.02
    clear = rebuilt[np.abs(rebuilt["error"] / 0.05 - 1.0) > 0.1]
    np.testing.assert_array_equal(clear["accepted"], clear["good"])
    own_rows = plain[plain["judge"] == OWN_BOUNDARY].set_index("rig")
    assert (
        abs(own_rows.loc["gain and delay", "estimate"] / own_rows.loc["gain and delay", "error"] - 1.0) < 0.05
    )
    assert np.abs(own_rows["estimate"] / own_rows["error"] - 1.0).max() > 0.1


@pytest.mark.slow
def test_a_wrong_frequency_moves_the_rebuilt_error(short):
    rebuilt = short[(short["judge"] == REBUILT) & (short["specimen"] == LINEAR)]
    right, wrong = (rebuilt[rebuilt["stated"] == statement] for statement in ("right", "f +2 %"))
    off = [np.abs(np.log(part["estimate"] / part["error"])).mean() for part in (right, wrong)]
    assert off[1] > 2.0 * off[0]


def test_nonlinear_specimens_are_flagged_and_rebuilt_with_their_model(short):
    nonlinear = short[short["specimen"] != LINEAR]
    assert (nonlinear["looks_nonlinear"] == 1.0).all()
    assert not nonlinear[nonlinear["judge"] == CERTAIN]["accepted"].any()
    rows_with_model = nonlinear[nonlinear["judge"] == WITH_MODEL]
    assert len(rows_with_model) == 3
    np.testing.assert_allclose(rows_with_model["estimate"] / rows_with_model["error"], 1.0, atol=0.15)


def test_a_study_goes_on_where_it_was_and_in_no_other(short, design, tmp_path, monkeypatch):
    path = tmp_path / "tests.csv"
    short.to_csv(path, index=False)

    def never(*_):
        raise AssertionError

    monkeypatch.setattr(study, "tests_of_round", never)
    resumed_rows = try_tests(design, kept=path)
    np.testing.assert_allclose(resumed_rows["error"], short["error"])
    with pytest.raises(InputError, match="resumed with its own file"):
        try_tests(replace(design, seed=1), kept=path)
    path.write_text("nothing of the kind\n1\n", encoding="utf-8")
    with pytest.raises(InputError, match="resumed with its own file"):
        try_tests(design, kept=path)


def test_every_finished_round_is_kept(short, design, tmp_path, monkeypatch):
    rows = short.to_dict(orient="records")
    rounds = iter([rows])

    def once(_, number):
        del number
        try:
            return iter(next(rounds))
        except StopIteration:
            raise KeyboardInterrupt from None

    monkeypatch.setattr(study, "tests_of_round", once)
    path = tmp_path / "tests.csv"
    with pytest.raises(KeyboardInterrupt):
        try_tests(replace(design, trials=2), kept=path)
    assert len(pd.read_csv(path)) == len(short)


def test_rates_with_no_failure_have_a_bound_and_no_false_certainty(short):
    judges = summarise_study(short)["judges"].set_index("judge")
    row = judges.loc[REBUILT]
    assert row["bad_accepted"] == 0.0
    assert row["bad_accepted_high"] > 0.9  # one earthquake
    assert list(shares(short, ["judge"]).columns[:3]) == ["judge", "tests", "motions"]


def test_the_report_shows_the_study(short, text_of_section):
    text = text_of_section(short)
    assert "The error of the test itself" in text
    assert "taken as linear" in text
    assert "equation (18)" in text


@pytest.fixture
def text_of_section():
    def text_with(tests):
        from reliab.report.prose import plain_text

        pages = pytest.importorskip("reliab_studies.validation.rebuilt_error")
        section = pages.rebuilt_error_section(tests, 0.05)
        parts = [section.title]
        for block in section.blocks:
            if hasattr(block, "text"):
                parts.append(plain_text(block.text))
            if hasattr(block, "frame"):
                parts.append(block.frame.to_string())
        return " ".join(parts)

    return text_with


@pytest.mark.slow
def test_shares_of_many_tests():
    motions = [shaken(seed) for seed in range(20)]
    tests = try_tests(Design.classify_motions(motions, [STRUCTURE], trials=20, metric=Metric.RMS))
    judges = summarise_study(tests)["judges"].set_index("judge")
    assert judges.loc[REBUILT, "bad_accepted"] < 0.05
    assert judges.loc[REBUILT, "good_accepted"] > 0.95
    assert judges.loc[CERTAIN, "bad_accepted"] < 0.02
    assert judges.loc[OWN_BOUNDARY, "bad_accepted"] > judges.loc[REBUILT, "bad_accepted"]
    assert 0.8 < judges.loc[REBUILT, "covered"] <= 1.0


def test_a_converter_has_levels_of_one_width_and_their_noise():
    condition = next(item for item in CONDITIONS if item.sensor == QUANTISED)
    true = np.sin(np.linspace(0.0, 300.0, 4000)) + 0.2
    error = condition.read(true, np.random.default_rng(1)) - true
    width = np.sqrt(12.0) * 10.0 ** (-_DECIBELS[QUANTISED] / 20.0) * np.sqrt(np.mean(true**2))
    levels = condition.read(true, np.random.default_rng(2)) / width
    np.testing.assert_allclose(levels, np.round(levels), atol=1e-9)
    assert np.abs(error).max() <= width * (1.0 + 1e-9)
    assert np.std(error) == pytest.approx(width / np.sqrt(12.0), rel=0.1)


def test_bending_specimens_have_the_stated_initial_stiffness():
    specimen = rigs._hysteresis(3e5, 0.02, np.random.default_rng(2))  # noqa: SLF001 - one of the kinds
    bends = vars(specimen.effect)
    initial_stiffness = specimen.stiffness + bends["force_n"] / bends["displacement_m"]
    assert initial_stiffness == pytest.approx(3e5)
    assert 0.2 * 0.02 <= bends["displacement_m"] <= 0.5 * 0.02
    assert 0.1 * 3e5 <= specimen.stiffness <= 0.5 * 3e5
