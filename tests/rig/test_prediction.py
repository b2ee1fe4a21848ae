"""Predictions of a rig's next test."""

import json
import math

import numpy as np
import pandas as pd
import pytest
import scipy
from reliab_studies.laboratory.laboratory import Rig, Sensors, run_laboratory
from rig_rows import keep, rig_table, rig_test

from reliab.app.cli import run
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.rig.memory import NextTest
from reliab.rig.prediction import predict_next, predict_under_motion
from reliab.rig.watching import OddTests, odd_density, ordinary_tests
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import read_structure
from reliab.simulation.transfer_systems.transfer_function import TransferFunction
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import first_order_ellipse

STRUCTURE = Structure(frequency=1.0, damping_ratio=0.02)
SHAKEN = Excitation(
    acceleration=np.sin(6.0 * np.arange(0.0, 12.0, 0.02)) * np.exp(-0.3 * np.arange(0.0, 12.0, 0.02)),
    time_step=0.02,
)


def simulate_rig(count, **changes):
    rng = np.random.default_rng(5)
    for number in range(count):
        amplitude, delay = 0.99 + 0.003 * rng.normal(), 2.0 + 0.3 * rng.normal()
        error = np.hypot((amplitude - 1.0) / np.sqrt(0.06), delay / np.sqrt(1400.0))
        values = {"A": amplitude, "d_ms": delay, "rms": error, "remainder": 0.01 * np.exp(0.2 * rng.normal())}
        yield rig_test(number, event=f"EQ{number // 2}", **values, **changes)


@pytest.fixture(scope="module")
def table():
    return rig_table(simulate_rig(12))


def test_intervals_contain_results_of_the_rig(table):
    prediction = predict_next(table, STRUCTURE, NextTest(), threshold=0.05)
    delay, error = prediction.intervals["d_ms"], prediction.intervals["rms"]
    assert delay["median"] == pytest.approx(2.0, abs=0.3)
    assert delay["low"] < delay["median"] < delay["high"]
    assert error["median"] == pytest.approx(0.07, abs=0.015)
    assert prediction.probability < 0.2
    assert sum(prediction.drivers.values()) == pytest.approx(1.0)
    assert json.dumps(prediction.to_dict(), allow_nan=False)


@pytest.mark.slow
def test_a_stiffer_structure_tolerates_less(table):
    """The same actuator errs in proportion to the frequency where its delay drives the error."""
    slow, fast = (
        predict_next(table, Structure(frequency=f, damping_ratio=0.02), NextTest(), threshold=0.05)
        for f in (0.5, 2.0)
    )
    assert fast.intervals["rms"]["median"] > slow.intervals["rms"]["median"]
    assert any("structures of 1 Hz" in note for note in fast.notes)


def test_a_known_motion_is_simulated(table):
    prediction = predict_under_motion(table, STRUCTURE, NextTest(), SHAKEN, threshold=0.05)
    interval = prediction.intervals["rms"]
    assert 0.0 < interval["low"] < interval["median"] < interval["high"] < 0.3


def test_very_late_table_is_predicted_by_the_ellipse():
    """Tests of a shaking table: a loop with 80 ms would diverge, their errors are finite."""
    rng = np.random.default_rng(6)
    tests = []
    for number in range(8):
        late = 80.0 + 3.0 * rng.normal()
        error = late / np.sqrt(9000.0) * np.exp(0.1 * rng.normal())
        values = {"A": 1.0 + 0.01 * rng.normal(), "d_ms": late, "rms": error, "own_b_ms2": 9000.0}
        tests.append(rig_test(number, **values))
    table = rig_table(tests)
    prediction = predict_under_motion(table, STRUCTURE, NextTest(), SHAKEN, threshold=0.05)
    reference = 80.0 / np.sqrt(first_order_ellipse(SHAKEN, STRUCTURE).delay)
    assert prediction.intervals["rms"]["median"] == pytest.approx(reference, rel=0.15)
    assert "diverge" in prediction.basis


def test_a_user_names_the_peak_as_a_covariate():
    """A gain that falls with the logarithm of the peak displacement is carried to the next test's."""
    peaks = 20.0 * np.exp(np.linspace(0.0, 1.5, 16))
    tests = [rig_test(n, A=1.0 - 0.01 * np.log(peak / 20.0), peak_mm=peak) for n, peak in enumerate(peaks)]
    coming = NextTest(covariates={"peak_mm": 60.0})
    interval = predict_next(rig_table(tests), STRUCTURE, coming, threshold=0.05).intervals["A"]
    assert interval["median"] == pytest.approx(1.0 - 0.01 * np.log(3.0), abs=5e-4)
    assert interval["high"] - interval["low"] < 2e-3


def test_fewer_than_three_tests_are_refused(table):
    with pytest.raises(InputError, match="needs 3 with a finite error"):
        predict_next(table.only([0, 1]), STRUCTURE, NextTest(), threshold=0.05)
    with pytest.raises(InputError, match="0 tests of the frame"):
        predict_next(table, None, NextTest(), threshold=0.05, frame="three storeys")
    frames = rig_table(simulate_rig(4, structure="two storeys"))
    with pytest.raises(
        InputError,
    ):
        predict_next(frames, STRUCTURE, NextTest(), threshold=0.05)


def test_constant_quantity_is_learned():
    tests = [rig_test(number, d_ms=2.0 + 0.1 * (number % 5)) for number in range(10)]
    prediction = predict_next(rig_table(tests), STRUCTURE, NextTest(), threshold=0.05)
    assert prediction.has_converged
    assert prediction.intervals["remainder"]["median"] == pytest.approx(0.01, rel=1e-6)


def test_unconverged_draws_are_reported(table, monkeypatch):
    monkeypatch.setattr("reliab.rig.prediction._LARGEST_R_HAT", 0.5)
    prediction = predict_next(table.only(range(4)), STRUCTURE, NextTest(), threshold=0.05)
    assert not prediction.has_converged
    assert "not to be relied on" in prediction.notes[0]


def test_the_command_predicts(tmp_path, capsys):
    keep(tmp_path, *simulate_rig(5))
    assert run(["rig", "predict", str(tmp_path), "--f", "1", "--xi", "0.02", "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert {"A", "d_ms", "rms", "probability"} <= content.keys()
    assert set(content["rms"]) == {"low", "median", "high"}
    assert run(["rig", "predict", str(tmp_path), "--f", "1", "--suite", "real_suite"]) == 0
    assert "robability" in capsys.readouterr().out
    assert run(["rig", "predict", str(tmp_path)]) == 2


def test_the_density_of_odd_tests_is_a_student_distribution():
    assert odd_density(7.0) == pytest.approx(scipy.stats.t.pdf(7.0, 2, scale=5.0))


def test_the_share_of_odd_tests_is_learned():
    rng = np.random.default_rng(1)
    result = OddTests()
    for score in rng.normal(size=270) + np.where(np.arange(270) % 10, 0.0, 30.0):
        result.learn(result.ordinary(float(score)))
    assert result.share == pytest.approx(0.1, abs=0.03)


def test_evidence_for_a_step_is_a_ratio_of_densities():
    """Without odd tests that of two normal distributions; one far off says less where they are common."""
    no_odd_tests = OddTests(odd=0.0, tests=1e9)
    assert no_odd_tests.evidence(1.0, 1.4) == pytest.approx(1.4 * 1.0 - 0.98 + math.log(0.9), abs=0.05)
    assert no_odd_tests.evidence(1.0, 1.4) == no_odd_tests.evidence(-1.0, -1.4)
    rare, common = OddTests(odd=0.0, tests=200.0), OddTests(odd=20.0, tests=200.0)
    assert rare.evidence(9.0, 1.4) > 2.0
    assert 0.0 < common.evidence(9.0, 1.4) < 1.3
    assert abs(common.evidence(-9.0, 1.4)) < 0.01


def test_level_effects_and_spread_are_those_of_ordinary_tests():
    rng = np.random.default_rng(2)
    rows = np.column_stack([np.ones(64), np.arange(64) % 2])
    values = rows @ [3.0, 5.0] + 0.1 * rng.normal(size=64)
    values[[5, 20, 33, 50, 61]] += [9.0, -7.0, 30.0, 4.0, -12.0]
    result = ordinary_tests(values, rows, np.diag([1e8, 1e4]))
    assert result.effects == pytest.approx([3.0, 5.0], abs=0.06)
    assert result.spread == pytest.approx(0.1, rel=0.25)
    assert np.flatnonzero(result.ordinary < 0.1).tolist() == [5, 20, 33, 50, 61]


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
        result = run_laboratory(partition, rig, ground, motion.time_step, rate=RATE, seed=place)
        table = {"command_m": result.command[::THINNED], "measured_m": result.measured[::THINNED]}
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


def test_a_test_of_several_actuators_is_refused_in_a_sentence(tmp_path, capsys):
    rng = np.random.default_rng(0)
    time = np.arange(0.0, 8.0, 1.0 / 256.0)
    displacement = np.cumsum(rng.normal(size=(2, time.size)), axis=1) * 1e-5
    columns = {
        f"{kind}_{place + 1}": displacement[place] for place in range(2) for kind in ("command", "measured")
    }
    file = tmp_path / "test.csv"
    pd.DataFrame({"time_s": time, **columns}).to_csv(file, index=False)
    frame = shipped("datasets", "frames/two_actuators.toml")
    assert run(["rig", "add", str(tmp_path / "rig"), str(file), "--structure", str(frame)]) == 2
    assert "A rig keeps tests of one actuator" in " ".join(capsys.readouterr().err.split())
