"""The monitor in C gives the error that Python gives, and a fault instead of a wrong number."""

import numpy as np
import pytest
from compiled_monitor import FAULT, STRICT, UNSTABLE, build, compare, follow, needs_compiler
from drawn_tests import draw_single_degree, random_test

from reliab.app.api.monitor import export_monitor
from reliab.assessment.monitor import Monitor
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.structure import Structure

pytestmark = needs_compiler


def follow_in_python(structure, command, reading, rate, lag, offset):
    """The monitor of Python after the whole test."""
    monitor = Monitor(structure, 1.0 / rate, feedback_lag=lag, sensor_offset=offset)
    monitor.feed(command, reading)
    return monitor


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("seed", "rate"), [(0, 256), (1, 1024), (2, 4096)])
def test_errors_are_those_of_python(tmp_path, seed, rate):
    compare(tmp_path, draw_single_degree(seed, rate))


def test_net_damping_and_the_alarm_are_those_of_python(tmp_path):
    """A loop whose delay is three times the critical one is caught at the same sample."""
    structure = Structure(frequency=1.5, damping_ratio=0.02)
    rate, delay = 512, 3.0 * 0.04 / (2.0 * np.pi * 1.5)
    test = HybridTest(structure=structure, actuator=Actuator(delay=delay))
    shaken = np.random.default_rng(3).normal(size=6 * rate)
    histories = run_closed_loop(test, shaken, 1.0 / rate)
    command = np.ascontiguousarray(histories.command.values[0])
    export_monitor(("c", tmp_path), f=1.5, xi=0.02, rate=rate)
    ours = follow(build(tmp_path), command, histories.measured, (0.0, 0.0))
    theirs = Monitor(structure, 1.0 / rate, sensor_offset=0.0)
    theirs.feed(command, histories.measured)
    first = int(np.flatnonzero(ours.status.astype(int) & UNSTABLE)[0])
    assert first / rate == theirs.gains_energy_since
    look = round(rate / 1.5 / 4)
    last = command.size // look * look
    second = Monitor(structure, 1.0 / rate, sensor_offset=0.0)
    second.feed(command[:last], histories.measured[:last])
    assert ours.damping[-1] == pytest.approx(second.now.damping.ratio, rel=1e-9)


def test_frame_with_drift_error_is_refused(tmp_path):
    text = shipped("datasets", "frames/benchmark_case_1.toml").read_text(encoding="utf-8")
    (tmp_path / "frame.toml").write_text(
        f'{text}\n[error]\nof = "drift"\nbetween = ["2", "1"]\n', encoding="utf-8"
    )
    with pytest.raises(InputError, match="the error of the measured interface displacement"):
        export_monitor(("c", tmp_path / "out"), structure=tmp_path / "frame.toml", rate=1024)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_frame_is_followed_as_python_does(tmp_path):
    from reliab.simulation.frames.frame_file import read_frame

    path = shipped("datasets", "frames/benchmark_case_1.toml")
    structure = read_frame(path).partition
    rng = np.random.default_rng(5)
    command = np.cumsum(rng.normal(size=6000)) * 1e-4
    reading = 0.98 * command + 1e-4 * rng.normal(size=command.size)
    text = export_monitor(("c", tmp_path), structure=path, rate=1024)
    ours = follow(build(tmp_path), command, reading, (0.0, 0.0))
    theirs = follow_in_python(structure, command, reading, 1024, 0.0, 0.0)
    assert text.degrees_of_freedom == structure.size > 1
    assert np.abs(ours.error - theirs.error).max() < 1e-12 * np.abs(command).max()


def test_an_offset_at_rest_is_learned(tmp_path):
    _, command, _ = random_test(4, 512)
    command = np.concatenate([np.zeros(512), 1e-2 * command / np.abs(command).max()])
    noise = 1e-6 * np.random.default_rng(1).normal(size=command.size)
    export_monitor(("c", tmp_path), f=1, xi=0.02, rate=512)
    ours = follow(build(tmp_path), command, 0.99 * command + 2e-3 + noise)
    assert ours.offset[-1] == pytest.approx(2e-3, abs=5e-7)
    theirs = Monitor(Structure(frequency=1.0, damping_ratio=0.02), 1 / 512, sensor_offset=ours.offset[-1])
    theirs.feed(command, 0.99 * command + 2e-3 + noise)
    moving = np.abs(command) > 1e-4
    assert np.abs(ours.error - theirs.error)[moving].max() < 1e-14
    assert ours.rms[-1] == pytest.approx(theirs.now.rms, rel=1e-4)  # without the noise of the rest
    assert ours.mte[-1] == pytest.approx(theirs.now.mte, rel=1e-11)


@pytest.fixture(scope="module")
def libraries(tmp_path_factory):
    """One monitor, compiled strictly and with fast arithmetic."""
    folders = [tmp_path_factory.mktemp("monitor") for _ in range(2)]
    for folder in folders:
        export_monitor(("c", folder), f=1, xi=0.02, rate=256)
    flags = (STRICT, ("-std=c99", "-O3", "-ffast-math"))
    return [build(folder, flags=flag) for folder, flag in zip(folders, flags, strict=True)]


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("broken", ["nan", "infinite", "absurd", "stuck", "held"])
def test_failing_channel_is_a_fault_and_never_a_number(libraries, broken):
    time = np.arange(2048) / 256
    command = 0.02 * np.sin(2.0 * np.pi * time)
    reading = 0.99 * command + 1e-6 * np.random.default_rng(2).normal(size=time.size)
    failure = {"nan": np.nan, "infinite": -np.inf, "absurd": 1e300}.get(broken, reading[1000])
    reading[1000 : 1013 if broken == "held" else None] = failure  # of 0.05 s
    for library in libraries:
        ours = follow(library, command, reading)
        faulty = ours.status.astype(int) & FAULT > 0
        first = int(np.argmax(faulty))
        assert faulty.any()
        assert first == (1008 if broken in {"stuck", "held"} else 1000)
        assert np.isnan(ours.error[first:]).all()
        assert np.isnan(ours.rms[first:]).all()
        assert not np.isnan(ours.error[:first]).any()


GROWS = 0.02 * np.sin(2.0 * np.pi * np.arange(4096) / 256) * np.minimum(np.arange(4096) / 2048, 1.0)


def test_piston_resting_in_its_play_is_no_fault(libraries):
    place, reading = 0.0, np.empty(GROWS.size)
    for k, x in enumerate(GROWS):
        place = reading[k] = min(max(place, x - 4e-4), x + 4e-4)
    for library in libraries:
        assert not (follow(library, GROWS, reading).status.astype(int) & FAULT).any()


def test_slowly_sampled_sensor_is_no_fault(libraries):
    reading = np.repeat(0.99 * GROWS[::10], 10)[: GROWS.size]
    for library in libraries:
        assert not (follow(library, GROWS, reading).status.astype(int) & FAULT).any()
