"""Written campaigns: format, sealed labels, reproducible bytes, noise and ratios as the label says."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from blind_campaigns.campaign import Options, generate
from blind_campaigns.case import Observation
from blind_campaigns.catalogue import registry
from blind_campaigns.kinds import Kind
from blind_campaigns.labels import Label, read_labels, write_label
from blind_campaigns.motions import RecordFolder, chirp, multisine, synthetic_accelerogram
from blind_campaigns.simulator import simulate_loop, simulate_prescribed
from blind_campaigns.system import Actuator, Rig, Specimen, Structure

LIBRARY = {
    *(
        "first_order_lag",
        "second_order_dynamics",
        "delay_drift",
        "rate_limit",
        "stroke_saturation",
        "backlash",
    ),
    *(
        "sensor_bias",
        "sensor_drift",
        "force_bias",
        "cubic_stiffness",
        "quadratic_stiffness",
        "coulomb_friction",
    ),
    *("viscous_damping", "quadratic_damping", "hysteresis", "added_mass", "gap"),
    *("excitation_scale", "time_step_error", "integration_error"),
}


@pytest.fixture(scope="module")
def damped_campaign(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Label]:
    """A fully observed campaign with viscous damping in white noise."""
    folder = tmp_path_factory.mktemp("damped") / "campaign"
    options = Options(
        kind=Kind.SINGLE, effect="viscous_damping", noise_kind="white", snr_db=40.0, with_rivals=False,
        observation=Observation.FULL,
    )  # fmt: skip
    return folder, generate(15, folder, options=options)


def columns(folder: Path, file: str) -> dict[str, np.ndarray]:
    path = folder / file
    table = pd.read_csv(path)
    return {name: table[name].to_numpy() for name in table.columns}


def true_rig(label: Label) -> Rig:
    """The linear part of the labelled system."""
    calibration = label.calibration
    return Rig(
        structure=Structure(**label.structure),
        actuator=Actuator(gain=calibration["gain"]["true"], delay_s=calibration["delay_s"]["true"]),
        specimen=Specimen(**label.specimen),
    )


def test_registry_holds_the_contracts_names_and_at_least_eight_others() -> None:
    definitions = registry()
    assert {name for name, definition in definitions.items() if definition.in_library} == LIBRARY
    assert sum(not definition.in_library for definition in definitions.values()) >= 8


@pytest.mark.slow
def test_folder_is_in_the_contracts_format(damped_campaign: tuple[Path, Label]) -> None:
    folder, label = damped_campaign
    campaign = tomllib.loads((folder / "campaign.toml").read_text(encoding="utf-8"))
    assert {"name", "structure", "actuator", "sampling", "tests"} <= set(campaign)
    assert [test["file"] for test in campaign["tests"]] == [test["file"] for test in label.tests]
    assert campaign["sampling"]["rate_hz"] == label.rate_hz
    for test in campaign["tests"]:
        table = columns(folder, test["file"])
        assert list(table) == ["time_s", "ground_acceleration_mps2", "command_m", "measured_m", "force_n"]
        assert np.diff(table["time_s"]) == pytest.approx(1.0 / label.rate_hz, rel=1e-6)


@pytest.mark.slow
def test_labels_never_stand_in_the_campaigns_folder(
    damped_campaign: tuple[Path, Label], tmp_path: Path
) -> None:
    folder, label = damped_campaign
    assert {path.suffix for path in folder.iterdir()} == {".toml", ".csv"}
    text = (folder / "campaign.toml").read_text(encoding="utf-8")
    assert not any(name in text for name in registry())
    assert label.kind not in text
    write_label(label, tmp_path)
    assert read_labels(tmp_path)[label.campaign] == Label(
        **json.loads((tmp_path / "campaign.json").read_text("utf-8"))
    )


@pytest.mark.slow
def test_same_seed_writes_the_same_bytes(tmp_path: Path) -> None:
    options = Options(kind=Kind.MISCALIBRATED)
    for name in ("one", "other"):
        generate(7, tmp_path / name / "campaign", options=options)
    files = sorted(path.name for path in (tmp_path / "one" / "campaign").iterdir())
    assert files
    for file in files:
        assert (tmp_path / "one/campaign" / file).read_bytes() == (
            tmp_path / "other/campaign" / file
        ).read_bytes()


def test_command_is_exact_and_noise_is_as_labelled(damped_campaign: tuple[Path, Label]) -> None:
    folder, label = damped_campaign
    damping = label.effects[0]["parameters"]["damping_n_s_per_m"]["value"]
    true = true_rig(label)
    specimen = replace(true.specimen, damping_n_s_per_m=true.specimen.damping_n_s_per_m + damping)
    rig = replace(true, specimen=specimen)
    test = label.tests[0]
    table = columns(folder, test["file"])
    run = simulate_loop(rig, table["ground_acceleration_mps2"], rate_hz=label.rate_hz)
    assert np.abs(run.command - table["command_m"]).max() < 1e-9 * np.abs(run.command).max()
    for name, clean in (("measured_m", run.piston), ("force_n", run.force)):
        error = np.sqrt(np.mean((table[name] - clean) ** 2))
        assert error == pytest.approx(test["noise_rms"][name], rel=1e-3)
        assert error == pytest.approx(label.noise["rms"][name], rel=0.02)


def test_labelled_ratio_is_seen_in_the_files(damped_campaign: tuple[Path, Label]) -> None:
    folder, label = damped_campaign
    residual, count = 0.0, 0
    for test in label.tests:
        if test["held_out"]:
            continue
        table = columns(folder, test["file"])
        run = simulate_prescribed(true_rig(label), table["command_m"], rate_hz=label.rate_hz)
        basis = np.stack([run.piston, np.ones(run.piston.size)], axis=1)
        residual_force = table["force_n"] - run.force
        remainder = residual_force - basis @ np.linalg.lstsq(basis, residual_force, rcond=None)[0]
        residual, count = residual + remainder @ remainder, count + remainder.size
    noise = label.noise["rms"]["force_n"]
    seen_db = 10 * np.log10((residual / count - noise**2) / noise**2)
    assert seen_db == pytest.approx(label.effects[0]["effect_to_noise_db"], abs=0.7)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [Kind.SINGLE, Kind.FAINT])
def test_kinds_keep_their_promise(kind: Kind, tmp_path: Path) -> None:
    label = generate(3, tmp_path / "campaign", options=Options(kind=kind, effect="gap", with_rivals=False))
    assert (label.effects[0]["effect_to_noise_db"] >= 0.0) == (kind is Kind.SINGLE)
    assert label.verdict == "named"


def test_motions_start_and_stay_within_one() -> None:
    rng = np.random.default_rng(8)
    for make in (synthetic_accelerogram, chirp, multisine):
        wave = make(rng, duration_s=20.0, rate_hz=256.0)
        assert wave.size == 20 * 256 + 1
        assert abs(wave[0]) < 1e-3
        assert np.abs(wave).max() == pytest.approx(1.0, abs=0.02)


def test_accelerogram_is_band_limited_and_nonstationary() -> None:
    wave = synthetic_accelerogram(np.random.default_rng(8), duration_s=40.0, rate_hz=1024.0)
    power = np.abs(np.fft.rfft(wave)) ** 2
    frequency = np.fft.rfftfreq(wave.size, 1 / 1024.0)
    assert power[(frequency > 0.1) & (frequency < 30.0)].sum() > 0.995 * power.sum()
    thirds = [np.sqrt(np.mean(part**2)) for part in np.array_split(wave, 3)]
    assert max(thirds) > 1.5 * min(thirds)


def test_records_of_a_folder_become_motions(tmp_path: Path) -> None:
    peer = "PEER\nevent\nACCELERATION\nNPTS= 400, DT= .02 SEC\n" + " ".join(
        f"{np.sin(i / 9):.5f}" for i in range(400)
    )
    (tmp_path / "EVENT_ST000.AT2").write_text(peer, encoding="ascii")
    name, wave = RecordFolder(tmp_path).draw(np.random.default_rng(1), duration_s=5.0, rate_hz=512.0)
    assert name == "EVENT_ST000"
    assert wave.size == 5 * 512 + 1
    assert np.abs(wave).max() == pytest.approx(1.0)
    with pytest.raises(ValueError, match="holds none"):
        RecordFolder(tmp_path / "nowhere")


def test_nothing_here_imports_the_product() -> None:
    for path in Path(__file__).parent.glob("*.py"):
        for line in path.read_text(encoding="utf-8").splitlines():
            assert not line.strip().startswith(("import reliab", "from reliab"))
