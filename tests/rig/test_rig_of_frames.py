"""Tests of frames with one actuator are kept, predicted and reported; those of several are refused."""

import json

import numpy as np
import pandas as pd
import pytest
from reliab_studies.laboratory.laboratory import Rig, Sensors, run_laboratory

from reliab.app.cli import run
from reliab.core.shipped import shipped
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.frames.frame_file import read_structure
from reliab.simulation.transfer_systems.transfer_function import TransferFunction

RATE, THINNED = 4096.0, 16
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def frame_and_tests(tmp_path_factory):
    """A frame whose interface counts, and three simulated tests that are ever later."""
    folder = tmp_path_factory.mktemp("frames")
    frame = folder / "frame.toml"
    frame.write_bytes(shipped("datasets", "frames/three_storeys.toml").read_bytes())
    partition, files = read_structure(frame).partition, []
    for place, motion in enumerate(synthetic_suite(count=3)):
        servo = TransferFunction(numerator=(1.0,), denominator=(2e-6, 2e-3, 1.0), delay=0.002 + 3e-4 * place)
        ground = motion.acceleration[: int(20.0 / motion.time_step)]
        rig = Rig(transfer_system=servo, sensors=Sensors(displacement_noise=2e-6))
        found = run_laboratory(partition, rig, ground, motion.time_step, rate=RATE, seed=place)
        table = {"command_m": found.command[::THINNED], "measured_m": found.measured[::THINNED]}
        time = np.arange(table["command_m"].size) * THINNED / RATE
        files.append(folder / f"test_{place}.csv")
        pd.DataFrame({"time_s": time, **table}).to_csv(files[-1], index=False)
    return frame, files


def test_a_rig_of_frames_is_kept_and_predicted(frame_and_tests, tmp_path, capsys):
    frame, files = frame_and_tests
    rig = str(tmp_path / "rig")
    assert run(["rig", "add", rig, *map(str, files), "--structure", str(frame)]) == 0
    assert run(["rig", "list", rig]) == 0
    assert run(["rig", "show", rig, "test_1.csv"]) == 0
    assert run(["rig", "report", rig, "--out", str(tmp_path / "rig.pdf")]) == 0
    capsys.readouterr()
    assert run(["rig", "predict", rig, "--structure", str(frame), "--json", "-"]) == 0
    delay = json.loads(capsys.readouterr().out)["d_ms"]
    assert delay["median"] == pytest.approx(4.3, abs=0.2)  # 2 ms of the lag, 2.3 ms of the delay
    assert run(["rig", "plan", rig, "--f", "1"]) == 2
    assert "plans are for single-degree-of-freedom structures" in " ".join(capsys.readouterr().err.split())


def test_a_test_of_several_actuators_is_refused_in_a_sentence(tmp_path, capsys):
    rng = np.random.default_rng(0)
    time = np.arange(0.0, 8.0, 1.0 / 256.0)
    moved = np.cumsum(rng.normal(size=(2, time.size)), axis=1) * 1e-5
    columns = {f"{kind}_{place + 1}": moved[place] for place in range(2) for kind in ("command", "measured")}
    file = tmp_path / "test.csv"
    pd.DataFrame({"time_s": time, **columns}).to_csv(file, index=False)
    frame = shipped("datasets", "frames/two_actuators.toml")
    assert run(["rig", "add", str(tmp_path / "rig"), str(file), "--structure", str(frame)]) == 2
    assert "A rig keeps tests of one actuator" in " ".join(capsys.readouterr().err.split())
