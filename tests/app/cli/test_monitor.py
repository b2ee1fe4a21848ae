"""`reliab monitor`: growing files, standard input, alarms."""

import contextlib
import io
import json
import os
import subprocess
import sys
import threading
import time
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from coupled_structures import coupled_response

import reliab
from reliab.app.api.monitor import follow_test
from reliab.app.cli import run
from reliab.assessment.assess import assess
from reliab.core.shipped import shipped
from reliab.recordings.following import chunks_of_text, rows_as_written
from reliab.recordings.reading import read_recording
from reliab.simulation.frames.frame_file import read_structure
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.structure import Structure

RATE = 256
TWO_ACTUATORS = shipped("datasets", "frames/two_actuators.toml")
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05)


def write_test(path: Path, delay: float, seconds: float = 12.0, quiet: float = 0.0) -> list[str]:
    """A test under noise, which becomes twenty times weaker in its last, quiet seconds."""
    shaken = np.random.default_rng(1).normal(size=int(seconds * RATE))
    shaken[shaken.size - int(quiet * RATE) :] /= 20.0
    test = HybridTest(structure=STRUCTURE, actuator=Actuator(gain=0.998, delay=delay))
    histories = run_closed_loop(test, shaken, 1.0 / RATE)
    rows = zip(np.arange(shaken.size) / RATE, histories.command.values[0], histories.measured, strict=True)
    lines = ["time_s,command_m,measured_m", *(f"{t:.6f},{c:.9e},{m:.9e}" for t, c, m in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return lines


def messages(text: str) -> list[dict]:
    return [json.loads(line) for line in text.splitlines()]


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("followed") / "good.csv"
    write_test(path, 0.004)
    return path


def follow(path: Path | str, *options: str) -> list[str]:
    return ["monitor", str(path), "--f", "1", "--xi", "0.05", "--wait", "0.1", "--json", "-", *options]


def test_final_message_equals_offline_result(good, capsys):
    assert run(follow(good, "--threshold", "0.5", "--exact")) == 0
    output = messages(capsys.readouterr().out)
    recording = read_recording(good)
    assessment = assess(recording, STRUCTURE).error.rebuilt
    end = output[-1]
    assert end["kind"] == "end"
    assert end["samples"] == recording.command.size
    assert end["error"]["rms"]["value"] == pytest.approx(assessment.rms.value, rel=1e-6)
    assert end["error"]["rms"]["high"] == pytest.approx(assessment.rms.high, rel=1e-6)
    assert end["error_m"] == pytest.approx(assessment.displacements[0].error[-1], rel=1e-3)
    assert end["alarms"] == []
    assert not any(item["near_instability"] for item in output)
    assert [item["samples"] for item in output[:3]] == [128, 256, 384]


ONE_HERTZ = {"f": 1.0, "xi": 0.05}
END = ("verdict", "reliable", "reasons", "would_decide")


@pytest.mark.default_cases(2)
@pytest.mark.parametrize(
    "options",
    [{}, {"exact": True}, {"alpha": 0.4}, {"scale": "1.01±0.001"}, {"metric": "mte"}, {"threshold": 0.04}],
)
def test_the_end_is_the_answer_of_assess(good, options):
    *_, end = follow_test(good, **ONE_HERTZ, every=60.0, wait=0.1, **options)
    content, assessment = end.to_dict(), reliab.assess(good, **ONE_HERTZ, **options).to_dict()
    assert {key: content[key] for key in END} == {key: assessment[key] for key in END}
    assert content["error"]["probability"] == assessment["probability"]
    for metric in ("rms", "mte"):
        assert content["error"][metric] == assessment["error"][metric]


@pytest.mark.slow
def test_channels_of_assess_count_at_the_end(good, tmp_path):
    """A recorded ground acceleration of another test, of which the running intervals do not become wrong."""
    lines = good.read_text(encoding="utf-8").splitlines()
    shaken = np.random.default_rng(1).normal(size=len(lines) - 1)
    rows = [f"{line},{value:.9e}" for line, value in zip(lines[1:], shaken, strict=True)]
    path = tmp_path / "shaken.csv"
    path.write_text("\n".join([f"{lines[0]},ground_acceleration_mps2", *rows]) + "\n", encoding="utf-8")
    *_, end = follow_test(path, f=1.01, xi=0.05, wait=0.1)
    assert end.assessment.equation.identified is not None
    assert end.to_dict()["error"]["rms"] == reliab.assess(path, f=1.01, xi=0.05).to_dict()["error"]["rms"]


@pytest.mark.slow
def test_undecided_is_no_answer_no_and_check_asks_for_reliable(good, capsys):
    """As with `reliab assess`: without --check only a test that is not reliable ends with exit code 1."""
    assessment = reliab.assess(good, **ONE_HERTZ).error.rebuilt.rms
    midpoint = str(0.5 * (assessment.low + assessment.high))
    for extra, code in (((), 0), (("--check",), 1)):
        assert run(follow(good, "--threshold", midpoint, *extra)) == code
        assert messages(capsys.readouterr().out)[-1]["verdict"] == "undecided"
    arguments_of_assess = ["assess", str(good), "--f", "1", "--xi", "0.05", "--threshold"]
    assert run([*arguments_of_assess, midpoint, "--check"]) == 1
    for threshold, code in (("0.5", 0), ("0.002", 1)):
        exact = ("--exact", "--check")
        assert run(follow(good, "--threshold", threshold, *exact)) == code
        assert run([*arguments_of_assess, threshold, *exact]) == code


def test_the_screen_ends_with_the_lines_of_assess(good, capsys):
    run(["monitor", str(good), "--f", "1", "--xi", "0.05", "--every", "60", "--wait", "0.1"])
    output = capsys.readouterr().out
    run(["assess", str(good), "--f", "1", "--xi", "0.05"])
    assert capsys.readouterr().out.splitlines()[0] in output.splitlines()


@pytest.mark.parametrize("rate", ["8", "1"])
def test_a_reversed_sign_is_told_while_the_test_runs_and_refused_at_its_end(good, tmp_path, capsys, rate):
    lines = good.read_text(encoding="utf-8").splitlines()
    cells = (line.split(",") for line in lines[1:])
    rows = [f"{time},{command},{-float(measured):.9e}" for time, command, measured in cells]
    path = tmp_path / "reversed.csv"
    path.write_text("\n".join([lines[0], *rows]) + "\n", encoding="utf-8")
    assert run(follow(path, "--every", rate)) == 2
    sentences = capsys.readouterr()
    first = messages(sentences.out)
    alarm = next(item for item in first if item["kind"] == "alarm")
    assert alarm["alarms"] == ["sign"]
    assert alarm["time_s"] < 4.0
    assert not any("error" in item for item in first if item["time_s"] > alarm["time_s"])
    assert "has the opposite sign of the command" in sentences.err


def test_a_replaced_file_is_judged_by_its_followed_rows(good, tmp_path):
    """No file holds the whole test any more."""
    path = tmp_path / "test.csv"
    lines = good.read_text(encoding="utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[:1500]), encoding="utf-8")
    updates = follow_test(path, **ONE_HERTZ, wait=0.3)
    next(updates)
    path.rename(tmp_path / "test.csv.1")
    path.write_text("".join([lines[0], *lines[1500:]]), encoding="utf-8")
    *_, end = updates
    assert end.assessment is None
    assert end.to_dict()["samples"] == len(lines) - 1
    assert end.to_dict()["error"]["rms"]["value"] == pytest.approx(
        reliab.assess(good, **ONE_HERTZ).error.rebuilt.rms.value, rel=0.15
    )


def test_an_unfinished_line_costs_no_verdict(good, tmp_path):
    path = tmp_path / "test.csv"
    path.write_text(good.read_text(encoding="utf-8") + "12.0,1.", encoding="utf-8")
    *_, end = follow_test(path, **ONE_HERTZ, every=60.0, wait=0.1)
    assert end.to_dict()["error"]["rms"] == reliab.assess(good, **ONE_HERTZ).to_dict()["error"]["rms"]


@pytest.mark.slow
def test_the_end_decides_and_an_alarm_is_told(tmp_path, capsys):
    path = tmp_path / "long.csv"
    write_test(path, 0.004, seconds=30.0, quiet=16.0)
    assert run(follow(path, "--threshold", "0.002", "--exact")) == 1
    output = messages(capsys.readouterr().out)
    first = next(item for item in output if item["alarms"])
    assert (first["kind"], first["alarms"], output[-1]["alarms"]) == ("alarm", ["error"], ["error"])
    assert 12.0 < first["time_s"] < 28.0
    assert output[-1]["above_threshold"]
    command_line = ["monitor", str(path), "--f", "1", "--xi", "0.05", "--wait", "0.1"]
    assert run([*command_line, "--threshold", "0.002", "--exact"]) == 1
    lines_read = " ".join(capsys.readouterr().out.split())
    assert lines_read.count("Alarm at") == 1
    assert "s: the error is above twice 0.2 %" in lines_read
    assert lines_read.index("Alarm at") < lines_read.index("NOT RELIABLE: RMS error")
    assert "No new rows for 0.1 s: test considered finished." in lines_read


@pytest.mark.slow
def test_early_threshold_crossing_does_not_decide(tmp_path, capsys):
    """A threshold between the largest error so far and the one of the whole test."""
    path = tmp_path / "early.csv"
    write_test(path, 0.004, seconds=30.0, quiet=20.0)
    run(follow(path, "--threshold", "1"))
    output = messages(capsys.readouterr().out)
    final = output[-1]["error"]["rms"]["value"]
    early = max(item["rms"] for item in output)
    assert early > 1.2 * final
    assert run(follow(path, "--threshold", str(1.1 * final), "--exact")) == 0
    output = messages(capsys.readouterr().out)
    assert (output[-1]["alarms"], output[-1]["above_threshold"]) == ([], False)


def test_a_loop_gaining_energy_raises_the_alarm(tmp_path, capsys):
    write_test(tmp_path / "unstable.csv", 0.03)
    assert run(follow(tmp_path / "unstable.csv", "--threshold", "0.5", "--exact")) == 1
    output = messages(capsys.readouterr().out)
    first = next(item for item in output if item["alarms"])
    assert (first["kind"], first["alarms"]) == ("alarm", ["unstable"])
    assert first["time_s"] < 10.5  # when the command is twice the exact peak
    assert output[-1]["net_damping_ratio"] + 2.0 * output[-1]["net_damping_deviation"] < 0.0
    assert output[-1]["near_instability"]


@pytest.mark.slow
def test_an_alarm_reaches_a_pipe_while_the_test_still_runs(tmp_path):
    lines = write_test(tmp_path / "unstable.csv", 0.03)
    arguments = ["monitor", "-", "--f", "1", "--xi", "0.05", "--threshold", "0.5", "--exact"]
    with subprocess.Popen(  # noqa: S603 - our own program
        [*PROGRAM, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as following:
        following.stdin.write("\n".join(lines[:-1]) + "\n")
        following.stdin.flush()
        alarm = next(line for line in following.stdout if line.startswith("Alarm at"))
        assert "the loop gains energy in its mode of 1 Hz and may diverge" in alarm
        following.stdin.close()
        remainder = following.stdout.read()
    assert following.returncode == 1
    assert "Alarm" not in remainder


PROGRAM = [sys.executable, "-c", "import sys; from reliab.app.cli import run; sys.exit(run(sys.argv[1:]))"]


@pytest.mark.slow
def test_a_restarted_monitor_gives_the_same_result(good, capsys):
    process = subprocess.Popen([*PROGRAM, *follow(good, "--threshold", "0.5")], stdout=subprocess.PIPE)  # noqa: S603 - our own program
    first_line = process.stdout.readline().decode()
    process.kill()
    process.wait()
    process.stdout.close()
    run(follow(good, "--threshold", "0.5"))
    assert capsys.readouterr().out.startswith(first_line)


@pytest.mark.slow
def test_standard_input_is_followed_to_its_end(good, capsys, monkeypatch):
    """Through its descriptor, as a pipe is; a pipe of a process is read in the tests above."""
    with good.open(encoding="utf-8") as pipe:
        monkeypatch.setattr("sys.stdin", pipe)
        assert run(follow("-", "--threshold", "0.5")) == 0
    output = capsys.readouterr().out
    run(follow(good, "--threshold", "0.5"))
    assert output == capsys.readouterr().out


@pytest.mark.slow
def test_monitor_waits_for_a_later_file(tmp_path, good, capsys):
    path = tmp_path / "later.csv"

    def write() -> None:
        time.sleep(0.3)
        with path.open("w", encoding="utf-8") as file:
            original = good.read_text(encoding="utf-8")
            header = original.index("\n") + 1
            file.write(original[:header])
            file.flush()
            time.sleep(0.4)  # a logger that begins later: longer than --wait
            file.write(original[header:])

    logger = threading.Thread(target=write)
    logger.start()
    assert run(follow(path, "--threshold", "0.5", "--start-within", "20")) == 0
    logger.join()
    sentences = capsys.readouterr()
    assert "Waiting up to 20 s for later.csv, which does not exist yet" in sentences.err
    run(follow(good, "--threshold", "0.5"))
    assert capsys.readouterr().out == sentences.out


def rows_while(path: Path, change) -> np.ndarray:
    """Times of the rows that are read while `change` writes, in turns with the reader."""

    def pieces():
        steps = change()
        for piece in chunks_of_text(str(path), 0.2, 1.0):
            yield piece
            next(steps, None)

    rows = rows_as_written(pieces(), name="test.csv", declarations={})
    return np.concatenate([part.time for part in rows])


def test_monitor_waits_for_the_end_of_a_line(tmp_path):
    path = tmp_path / "test.csv"
    lines = write_test(path, 0.004)
    path.write_text("\n".join(lines[:100])[:-7], encoding="utf-8")

    def change():
        with path.open("a", encoding="utf-8") as file:
            file.write(lines[99][-7:] + "\n" + "\n".join(lines[100:200]))
        yield
        time.sleep(0.05)
        yield

    read = rows_while(path, change)
    assert read.size == 198  # the last line has no end
    assert np.allclose(np.diff(read), 1.0 / RATE, atol=2e-6)


def test_a_rotated_file_is_read_to_its_end_and_then_the_new_one(tmp_path):
    path = tmp_path / "test.csv"
    lines = write_test(path, 0.004)
    path.write_text("\n".join(lines[:100]) + "\n", encoding="utf-8")

    def change():
        path.rename(tmp_path / "test.csv.1")
        with (tmp_path / "test.csv.1").open("a", encoding="utf-8") as file:
            file.write("\n".join(lines[100:150]) + "\n")
        path.write_text("\n".join([lines[0], *lines[150:300]]) + "\n", encoding="utf-8")
        yield
        yield

    read = rows_while(path, change)
    assert read.size == 299
    assert np.allclose(np.diff(read), 1.0 / RATE, atol=2e-6)


@pytest.mark.slow
def test_columns_may_have_units_and_names_of_their_own(tmp_path, good, capsys):
    lines = good.read_text(encoding="utf-8").splitlines()
    variant = ["seconds;drive_mm;lvdt_mm"]
    for line in lines[1:]:
        time_s, command, measured = line.split(",")
        variant.append(f"{time_s};{1e3 * float(command):.9e};{1e3 * float(measured):.9e}")
    (tmp_path / "other.csv").write_text("\n".join(variant) + "\n", encoding="utf-8")
    run(follow(good, "--threshold", "0.5"))
    reference = messages(capsys.readouterr().out)[-1]
    run(follow(tmp_path / "other.csv", "--threshold", "0.5", "--command", "drive_mm"))
    sentences = messages(capsys.readouterr().out)[-1]
    assert sentences["error_m"] == pytest.approx(reference["error_m"], rel=1e-6)


@pytest.mark.parametrize(
    ("text", "options", "rule"),
    [
        ("0,0,0\n1,0,0\n", (), "names no columns"),
        ("time,command,measured\n0,0\n", (), "3 in the first line"),
        ("time,command,measured\n0,0,x\n", (), "Not a finite number"),
        ("time,command,measured\n0,0,0\n", (), "more than 64 are needed"),
        ("command,measured\n" + "0,0\n" * 100, (), "No times and no sampling rate"),
        ("time,command,measured\n" + "0,0,0\n", ("--threshold", "0"), "--threshold must be positive"),
        ("time,command,measured\n" + "0,0,0\n", ("--metric", "max"), "rms or mte"),
        ("time,command,measured\n" + "0,0,0\n", ("--rate", "-1"), "--rate must be between"),
        ("time,command,measured\n" + "0,0,0\n", ("--start-within", "0"), "--start-within must be positive"),
        ("time,command,measured\n" + "0,0,0\n", ("--scale", "0"), "scale must be between"),
    ],
)
def test_bad_input_is_one_sentence(tmp_path, text, options, rule, capsys):
    (tmp_path / "bad.csv").write_text(text, encoding="utf-8")
    assert run(follow(tmp_path / "bad.csv", *options)) == 2
    assert rule in capsys.readouterr().err


def test_a_missing_sample_is_refused(tmp_path, good, capsys):
    lines = good.read_text(encoding="utf-8").splitlines()
    del lines[500]
    (tmp_path / "gap.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert run(follow(tmp_path / "gap.csv")) == 2
    assert "equal steps" in capsys.readouterr().err


def test_a_missing_file_and_frequency_are_refused(tmp_path, capsys):
    for path, limit in ((tmp_path / "none.csv", "0.1"), (tmp_path / "no_folder" / "none.csv", "600")):
        assert run(["monitor", str(path), "--f", "1", "--xi", "0.02", "--start-within", limit]) == 2
        assert "Cannot read the file" in capsys.readouterr().err
    assert run(["monitor", os.devnull]) == 2
    assert "--f" in capsys.readouterr().err
    assert run(["monitor", os.devnull, "--f", "1"]) == 2
    assert "--xi" in capsys.readouterr().err


@pytest.fixture(scope="module")
def short(tmp_path_factory) -> tuple[Path, str]:
    """The test, and what is printed of it without further options."""
    path = tmp_path_factory.mktemp("short") / "good.csv"
    write_test(path, 0.004, seconds=12.0)
    with contextlib.redirect_stdout(io.StringIO()) as stream:
        run(follow(path, "--threshold", "0.15"))
    return path, stream.getvalue()


@pytest.mark.slow
@pytest.mark.default_cases(3)
@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--f", "1.02"),
        ("--xi", "0.04"),
        ("--alpha", "0.8"),
        ("--scale", "1.01"),
        ("--feedback-lag", "1"),
        ("--metric", "mte"),
        ("--threshold", "0.002"),
        ("--every", "1"),
        ("--rate", "250"),
        ("--units", "mm"),
    ],
)
def test_every_option_changes_the_answer(short, capsys, option, value):
    path, plain = short
    run([*follow(path, "--threshold", "0.15"), option, value])
    assert capsys.readouterr().out != plain


@pytest.mark.slow
def test_a_calibration_of_the_channels_is_taken_off(tmp_path, good, capsys):
    """A reading that is late and too large, told so by channels.toml, has the error of the sound reading."""
    run(follow(good, "--threshold", "1", "--exact"))
    sound = messages(capsys.readouterr().out)[-1]["error"]["rms"]
    table = np.loadtxt(good, delimiter=",", skiprows=1)
    time, command, measured = table.T
    late = 1.02 * np.interp(time - 0.010, time, measured)
    late_file, channels = tmp_path / "late.csv", tmp_path / "channels.toml"
    rows = "\n".join(f"{t:.6f},{c:.9e},{m:.9e}" for t, c, m in zip(time, command, late, strict=True))
    late_file.write_text(f"time_s,command_m,measured_m\n{rows}\n", encoding="utf-8")
    channels.write_text("[calibration]\nskew_ms = 10.0\nskew_sd_ms = 0.1\nscale = 1.02\n", encoding="utf-8")
    run(follow(late_file, "--threshold", "1", "--exact"))
    raw = messages(capsys.readouterr().out)[-1]["error"]["rms"]
    run(follow(late_file, "--threshold", "1", "--channels", str(channels), "--exact"))
    corrected_error = messages(capsys.readouterr().out)[-1]["error"]["rms"]
    assert raw["value"] > 2.0 * sound["value"]
    assert corrected_error["value"] == pytest.approx(sound["value"], rel=0.03)
    assert corrected_error["high"] - corrected_error["low"] > 2.0 * (sound["high"] - sound["low"])
    run(follow(late_file, "--threshold", "1", "--channels", str(channels), "--scale", "1"))
    assert messages(capsys.readouterr().out)[-1]["error"]["rms"]["value"] > 1.1 * sound["value"]


@pytest.mark.slow
def test_default_uncertainties_are_those_of_assess(good, tmp_path, capsys):
    """Two doors, one interval: that of a linear specimen with ordinary equipment."""
    sizes = tmp_path / "ours.toml"
    sizes.write_text("scale = 0.0\nf = 0.0\n", encoding="utf-8")
    widths = []
    for extra in (["--exact"], ["--equipment", str(sizes)], []):
        run(follow(good, "--threshold", "0.2", *extra))
        error = messages(capsys.readouterr().out)[-1]["error"]
        widths.append(error["rms"]["high"] - error["rms"]["low"])
    assert sorted(widths) == widths
    assert error["probability"] == 0.99  # beyond which assumed sizes are not known
    assessment = reliab.assess(good, f=1, xi=0.05, threshold=0.2, specimen="linear").error.rebuilt.rms
    assert error["rms"]["value"] == pytest.approx(assessment.value, rel=1e-6)
    assert error["rms"]["low"] == pytest.approx(assessment.low, rel=0.1)
    assert error["rms"]["high"] == pytest.approx(assessment.high, rel=0.1)


def test_unused_equipment_is_refused(good, tmp_path, capsys):
    sizes = tmp_path / "ours.toml"
    sizes.write_text("scale = 0.0\n", encoding="utf-8")
    assert run(follow(good, "--exact", "--equipment", str(sizes))) == 2
    assert "no effect together with --exact" in capsys.readouterr().err


def test_messages_state_how_often_alarms_are_false(good):
    message = next(follow_test(good, **ONE_HERTZ, every=1.0))
    assert message.to_dict()["false_alarm_rates"] == {"unstable": 0.01, "error": 0.01}


def test_updates_come_at_equal_times_however_often_alarms_are_looked_for(good):
    """A tenth of a second is 26 samples, between which 64 and 100 have no place of their own."""
    for interval, samples in ((0.25, [64, 128, 192, 256]), (100 / 256, [100, 200, 300, 400])):
        updates = [
            m for m in islice(follow_test(good, f=1, xi=0.02, every=interval), 6) if m.kind == "update"
        ]
        assert [m.to_dict()["samples"] for m in updates][:4] == samples


FRAME = """
[frame]
names = ["1", "2"]
mass_matrix_kg = [[1000.0, 0.0], [0.0, 800.0]]
stiffness_matrix_n_per_m = [[1.1e5, -5e4], [-5e4, 5e4]]
[damping]
ratio = 0.05
[specimen]
{driven}
[tolerances]
stiffness = 0.03
"""
ONE_DEGREE = 'degree_of_freedom = "1"\nstiffness_n_per_m = 4e4'
TWO = 'degrees_of_freedom = ["1", "2"]\nstiffness_matrix_n_per_m = [[2e4, 0.0], [0.0, 2e4]]'


def test_a_frame_is_followed_as_it_is_assessed(good, tmp_path, capsys):
    path = tmp_path / "frame.toml"
    path.write_text(FRAME.format(driven=ONE_DEGREE), encoding="utf-8")
    arguments = ["--structure", str(path), "--json", "-"]
    assert run(["monitor", str(good), "--every", "60", "--wait", "0.1", "--threshold", "2", *arguments]) == 0
    end = messages(capsys.readouterr().out)[-1]
    rebuilt = reliab.assess(good, path, threshold=2.0).error.rebuilt
    assert end["error_m"] == pytest.approx(rebuilt.displacements[0].error[-1], rel=0.1)  # with all as stated
    assert end["error"]["rms"]["value"] == pytest.approx(rebuilt.rms.value, rel=1e-6)
    assert end["error"]["rms"]["high"] == rebuilt.rms.high
    assert end["error"]["probability"] <= 0.99


@pytest.mark.parametrize(
    ("driven", "options", "sentence"),
    [
        (ONE_DEGREE, ["--f", "1"], "--f has no effect together with"),
        (TWO, [], "Each actuator needs"),
    ],
)
def test_an_unsupported_frame_is_refused(good, tmp_path, capsys, driven, options, sentence):
    path = tmp_path / "frame.toml"
    path.write_text(FRAME.format(driven=driven), encoding="utf-8")
    assert run(["monitor", str(good), "--wait", "0.1", "--structure", str(path), *options]) == 2
    assert sentence in " ".join(capsys.readouterr().err.split())


@pytest.fixture(scope="module")
def two_actuator_test(tmp_path_factory) -> Path:
    """A test of the frame that ships, with channels in another order, of which the second one errs."""
    frame, rate = read_structure(TWO_ACTUATORS), 128
    rng = np.random.default_rng(8)
    shaken = np.convolve(rng.normal(size=20 * rate), np.ones(5) / 5.0, "same")
    run = coupled_response(frame.partition, frame.transfer_system, shaken, 1.0 / rate)
    command, measured = (frame.kinematics @ rows for rows in (run.command, run.measured))
    measured = measured + 1e-4 * np.abs(measured).max() * rng.normal(size=measured.shape)
    path = tmp_path_factory.mktemp("several") / "two.csv"
    columns = [np.arange(shaken.size) / rate, measured[1], command[1], command[0], measured[0]]
    names = "time_s,measured_2_m,command_2_m,command_1_m,measured_1_m"
    np.savetxt(path, np.array(columns).T, delimiter=",", header=names, comments="")
    return path


@pytest.mark.slow
def test_several_actuators_are_followed_as_they_are_assessed(two_actuator_test, capsys):
    arguments = ["--structure", str(TWO_ACTUATORS), "--wait", "0.1", "--threshold", "0.9"]
    assert run(["monitor", str(two_actuator_test), *arguments, "--json", "-"]) == 0
    end = messages(capsys.readouterr().out)[-1]
    content = reliab.assess(two_actuator_test, TWO_ACTUATORS, threshold=0.9).to_dict()["error"]
    error = end["error"]
    assert error["governing"] == content["governing"] == end["governing"]
    assert error["rms"] == content["rms"]
    assert error["probability"] == content["probability"]
    for name, degree in error["degrees_of_freedom"].items():
        reference = content["degrees_of_freedom"][name]
        assert {key: degree[key] for key in ("judged", "rms", "mte", "probability")} == {
            key: reference[key] for key in ("judged", "rms", "mte", "probability")
        }
        assert end["degrees_of_freedom"][name]["rms"] == pytest.approx(degree["rms"]["value"], rel=0.1)
    assert run(["monitor", str(two_actuator_test), *arguments]) == 0
    assert f"RMS error of {error['governing']}" in capsys.readouterr().out


@pytest.mark.slow
def test_a_skew_of_several_actuators_is_taken_off(two_actuator_test, tmp_path, capsys):
    channels, late = tmp_path / "channels.toml", tmp_path / "late.csv"
    channels.write_text("[calibration]\nskew_ms = 6.0\n", encoding="utf-8")
    names, *rows = two_actuator_test.read_text(encoding="utf-8").splitlines()
    columns = np.loadtxt(rows, delimiter=",").T
    for place, name in enumerate(names.split(",")):
        if name.startswith("measured"):
            columns[place] = np.interp(columns[0] - 6e-3, columns[0], columns[place])
    np.savetxt(late, columns.T, delimiter=",", header=names, comments="")
    arguments = ["--structure", str(TWO_ACTUATORS), "--wait", "0.1", "--threshold", "0.9", "--json", "-"]
    errors = []
    for file, extra in ((two_actuator_test, []), (late, ["--channels", str(channels)]), (late, [])):
        run(["monitor", str(file), *arguments, *extra])
        errors.append(messages(capsys.readouterr().out)[-1]["rms"])
    assert errors[1] == pytest.approx(errors[0], rel=0.02)
    assert abs(errors[2] / errors[0] - 1.0) > 0.1


@pytest.mark.slow
def test_another_zero_does_not_hide_an_error(good, tmp_path):
    """Strokes of a piston: their peak is counted from its end, and no error over it means anything."""
    names, *rows = good.read_text(encoding="utf-8").splitlines()
    numbers = np.loadtxt(rows, delimiter=",") + np.array([0.0, 0.2, 0.2])
    path = tmp_path / "stroke.csv"
    np.savetxt(path, numbers, delimiter=",", header=names, comments="", fmt="%.12g")
    with pytest.raises(reliab.InputError, match=r"oscillates about 200 mm.*`zero`"):
        list(follow_test(path, f=1.0, xi=0.05, wait=0.1))
    channels = tmp_path / "channels.toml"
    channels.write_text("".join(f"[channels.{name}]\nzero = 0.2\n" for name in ("command", "measured")))
    *_, end = follow_test(path, f=1.0, xi=0.05, wait=0.1, channels=channels)
    *_, plain = follow_test(good, f=1.0, xi=0.05, wait=0.1)
    assert end.to_dict()["rms"] == pytest.approx(plain.to_dict()["rms"], rel=1e-6)


@pytest.mark.slow
def test_an_offset_felt_by_the_loop_is_no_other_zero(good, tmp_path):
    names, *rows = good.read_text(encoding="utf-8").splitlines()
    path = tmp_path / "felt.csv"
    offset_rows = np.loadtxt(rows, delimiter=",") + np.array([0.0, -0.2, 0.0])
    np.savetxt(path, offset_rows, delimiter=",", header=names, comments="", fmt="%.12g")
    *_, end = follow_test(path, f=1.0, xi=0.05, wait=0.1)
    assert end.kind == "end"
