"""The whole workflow on campaigns whose content is known, by an independent simulator."""

import base64
import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from reliab.app.cli.diagnose import diagnose as command
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.block_diagnosis import Verdict

KEYS = {"campaign", "verdict", "where", "effects", "unknown", "gap", "criterion_shift"}

# seed, kind, observation, effect, noise, signal-to-noise ratio [dB]
REPRESENTATIVE = [
    (1, "single", "actuator_only", "first_order_lag", "white", 35.0),
    (2, "single", "command_measured", "stroke_saturation", "coloured", 40.0),
    (3, "single", "actuator_only", "backlash", "quantised", 35.0),
    (4, "single", "command_measured", "sensor_drift", "mains", 30.0),
    (5, "single", "specimen_only", "cubic_stiffness", "white", 40.0),
    (6, "single", "measured_force", "viscous_damping", "mixture", 45.0),
    (7, "single", "full", "added_mass", "coloured", 35.0),
    (8, "single", "full", "excitation_scale", "white", 30.0),
    (9, "miscalibrated", "command_measured", None, "quantised", 25.0),
    (10, "miscalibrated", "actuator_only", None, "coloured", 35.0),
    (11, "miscalibrated", "specimen_only", None, "white", 30.0),
    (12, "none", "command_measured", None, "mains", 25.0),
    (13, "miscalibrated", "measured_force", None, "mixture", 40.0),
    (14, "none", "one_channel_oscillator", None, "white", 35.0),
    (15, "outside", "command_measured", "position_dependent_gain", "white", 40.0),
    (16, "outside", "actuator_only", "gain_drift", "mains", 40.0),
    (17, "outside", "measured_force", "stiffness_degradation", "white", 40.0),
    (18, "outside", "specimen_only", "one_sided_spring", "coloured", 45.0),
    (19, "one_channel", "one_channel_oscillator", "quadratic_stiffness", "white", 40.0),
    (20, "faint", "command_measured", "rate_limit", "white", 30.0),
]


def judge_diagnosis(result, label):
    """Whether an answer is right: exact, or for faint effects without a wrong name."""
    names = {effect.name for effect in result.effects}
    if label.kind == "faint":
        return names <= label.names
    if label.kind == "outside":
        return result.verdict is Verdict.UNKNOWN_EFFECT
    return names == label.names and str(result.verdict) == label.verdict


def wrong_answers(cases, blind):
    """Cases that are answered wrongly, with the answers."""
    wrong = []
    for seed, kind, observation, effect, noise, snr in cases:
        folder, label = blind(seed, kind, observation, effect, noise, snr)
        diagnosis = diagnose(read_campaign(folder))
        if not judge_diagnosis(diagnosis, label):
            wrong.append(
                (
                    seed,
                    kind,
                    effect,
                    diagnosis.verdict,
                    [named_effect.name for named_effect in diagnosis.effects],
                )
            )
    return wrong


@pytest.mark.slow
def test_two_of_twenty_blind_campaigns(blind):
    wrong = wrong_answers(REPRESENTATIVE[10:12], blind)  # a wrong calibration, and nothing wrong
    assert not wrong


@pytest.mark.slow
def test_twenty_blind_campaigns(blind):
    wrong = wrong_answers(REPRESENTATIVE, blind)
    assert len(wrong) <= 1, wrong


def noise_of(result, label):
    """RMS of the noise that a label states over that of the channel, in the only held-out test."""
    (file,) = result.gap.held_out
    noise = next(test["noise_rms"] for test in label["tests"] if test["file"] == file)
    channels = next(test.channels for test in result.campaign.tests if test.file == file)
    return noise[result.gap.channel] / np.sqrt(np.mean(channels[result.gap.channel] ** 2))


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("name", [pytest.param("rig_a", marks=pytest.mark.slow), "rig_b", "rig_c"])
def test_sample_campaigns_answer_as_their_sealed_labels(sample_campaigns, diagnosis_of, name):
    labels = json.loads((sample_campaigns / "labels.json").read_text(encoding="utf-8"))[name]
    label = json.loads(base64.b64decode(labels))
    diagnosis = diagnosis_of(name)
    assert str(diagnosis.verdict) == label["verdict"]
    library_names = {effect["name"] for effect in label["effects"] if effect["in_library"]}
    assert {effect.name for effect in diagnosis.effects} == library_names
    if label["verdict"] == "named":
        assert diagnosis.gap.after == pytest.approx(noise_of(diagnosis, label), rel=0.05)
        truth = label["effects"][0]["parameters"]["force_n"]["value"]
        estimate = next(effect for effect in diagnosis.effects[0].estimates if effect.name == "force_n")
        assert abs(estimate.value - truth) < 4.0 * estimate.sd


@pytest.mark.parametrize("name", [pytest.param("rig_a", marks=pytest.mark.slow), "rig_b", "rig_c"])
def test_answer_has_the_keys_of_the_format_and_is_json(diagnosis_of, name):
    content = diagnosis_of(name).to_dict()
    assert set(content) >= KEYS
    assert set(content["gap"]) >= {
        "held_out", "channel", "nrmse_before", "nrmse_after", "noise_floor", "closed_fraction",
    }  # fmt: skip
    gaps = [content["gap"], *(block["gap"] for block in content["blocks"])]
    assert all(g["closed_fraction"] is None or 0.0 <= g["closed_fraction"] <= 1.0 for g in gaps)
    assert all((g["noise_floor"] is None) == (g["noise_floor_source"] is None) for g in gaps)
    assert all(
        set(effect) >= {"held_out_nrmse_with", "held_out_nrmse_without"} for effect in content["effects"]
    )
    assert all(0.0 <= place["share_of_residual"] <= 1.0 for place in content["where"])
    json.dumps(content, allow_nan=False)


@pytest.mark.slow
def test_servo_hydraulic_is_a_low_pass_with_a_bias_and_no_drifting_delay(shared_folder):
    diagnosis = diagnose(read_campaign(shared_folder / "measured" / "servo_hydraulic"))
    names = {effect.name for effect in diagnosis.effects}
    assert names == {"first_order_lag", "sensor_bias"}
    assert diagnosis.gap.before > 0.35
    assert diagnosis.gap.after <= 0.040
    assert not diagnosis.blocks[0].leaves_noise
    assert all(effect.probability <= 0.99 for effect in diagnosis.effects)
    assert all(effect.error_without > 1.5 * effect.error_with for effect in diagnosis.effects)


@pytest.mark.slow
def test_a_real_damper_is_hysteresis_alone(shared_folder):
    diagnosis = diagnose(read_campaign(shared_folder / "measured" / "mr_damper"))
    assert str(diagnosis.verdict) == "named"
    assert [effect.name for effect in diagnosis.effects] == ["hysteresis"]
    assert diagnosis.gap.after <= 0.125


@pytest.mark.slow
def test_a_real_table_clips_its_command(shared_folder):
    diagnosis = diagnose(read_campaign(shared_folder / "measured" / "shaking_table"))
    saturation = next(effect for effect in diagnosis.effects if effect.name == "stroke_saturation")
    assert saturation.effect.position == "before the dynamics"
    assert saturation.estimates[0].value == pytest.approx(0.05, rel=0.05)
    assert diagnosis.gap.source == "repeated cycles"


@pytest.mark.slow
def test_two_blocks_of_a_real_rig_are_named(shared_folder):
    diagnosis = diagnose(read_campaign(shared_folder / "measured" / "servo_and_damper"))
    assert [str(block.verdict) for block in diagnosis.blocks] == ["named", "named"]
    assert {"first_order_lag", "hysteresis"} <= {effect.name for effect in diagnosis.effects}
    assert not any(effect.on_bounds for effect in diagnosis.effects)


@pytest.mark.slow
def test_residuals_by_file_are_those_of_the_gap(diagnosis_of):
    diagnosis = diagnosis_of("rig_a")
    block = next(item for item in diagnosis.blocks if item.effects)
    assert set(block.residuals_after) == set(block.gap.held_out)
    model_before, model_after = (
        np.concatenate(list(r.values())).std() for r in (block.residuals_before, block.residuals_after)
    )
    assert model_after < model_before


@pytest.fixture
def rig_b(sample_campaigns, diagnosis_of, monkeypatch):
    """A campaign for the command line, whose diagnosis is known already."""

    def return_diagnosis(campaign, *, progress):
        progress(1, 1)
        assert campaign.name == diagnosis_of("rig_b").campaign.name
        return diagnosis_of("rig_b")

    monkeypatch.setattr("reliab.app.api.diagnosis.diagnose", return_diagnosis)
    return str(sample_campaigns / "rig_b")


def test_results_are_there_when_the_report_fails(rig_b, tmp_path, monkeypatch):
    def fail(*_args, **_options):
        raise RuntimeError("no font")

    monkeypatch.setattr("reliab.report.pdf.write_pdf", fail)
    application = typer.Typer()
    application.command()(command)
    run = CliRunner().invoke(application, [rig_b, "--out", str(tmp_path)])
    assert isinstance(run.exception, RuntimeError)
    assert json.loads((tmp_path / "diagnosis.json").read_text())["verdict"] == "no_missing_effect"
    assert (tmp_path / "model.toml").exists()
    assert run.output.index("no missing effect") < run.output.index("Next step: use the calibrated model")


@pytest.mark.slow
@pytest.mark.usefixtures("blank_figures")
def test_command_line_writes_json_and_names_the_error(rig_b, tmp_path):
    application = typer.Typer()
    application.command()(command)
    run = CliRunner().invoke(application, [rig_b, "--out", str(tmp_path), "--json", "-"])
    assert run.exit_code == 0
    assert json.loads(run.stdout)["verdict"] == "no_missing_effect"
    content = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    assert content["verdict"] == "no_missing_effect"
