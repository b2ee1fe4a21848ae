"""A described transfer system, against the digital laboratory and the exact critical delay."""

from dataclasses import replace

import numpy as np
import pytest
from reliab_studies.laboratory.laboratory import Rig, run_laboratory
from scipy.io import savemat

from reliab.core.errors import InputError
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import frame_of_tables
from reliab.simulation.frames.frame_loop import FrameLoop, stable_with
from reliab.simulation.transfer_systems.transfer_function import (
    ServoHydraulic,
    TransferFunction,
    gain_and_delay,
)
from reliab.structures.critical_delay import stability_limit

TABLES = {
    "frame": {"masses_kg": [2000.0, 1500.0], "storey_stiffnesses_n_per_m": [4e5, 3e5]},
    "damping": {"ratio": 0.03},
    "specimen": {"degree_of_freedom": "1", "stiffness_n_per_m": 2e5},
}
RATE = 16384.0


def read_table(table, location="frame.toml"):
    return frame_of_tables({**TABLES, "transfer_system": table}, location)


@pytest.fixture(scope="module")
def shaking():
    generator = np.random.default_rng(6)
    return np.convolve(generator.standard_normal(1501), np.ones(5) / 5.0, "same")


@pytest.mark.slow
@pytest.mark.parametrize("case", ["function", "servo_hydraulic"])
def test_error_equals_the_digital_laboratory(case, shaking):
    if case == "function":
        frame = read_table({"poles_per_s": [-300.0, [-90.0, 120.0]]})
        partition, system = frame.partition, frame.transfer_system
    else:
        heavy = {**TABLES["specimen"], "mass_kg": 30.0, "stiffness_n_per_m": 1e5}
        tables = {**TABLES, "damping": {"ratio": 0.08}, "specimen": heavy}
        partition, system = frame_of_tables(tables, "frame.toml").partition, ServoHydraulic()
    assert stable_with(partition, system)
    # The laboratory holds a command for a step and feeds the force back one and a half steps late.
    run = run_laboratory(partition, Rig(transfer_system=system), shaking, 0.01, rate=RATE)
    loop = FrameLoop(excitation=Excitation(acceleration=shaking, time_step=0.01), partition=partition)
    test = loop.response(system)
    times = test.step * np.arange(test.measured.shape[1])
    piston = np.interp(times, np.arange(run.piston.size) / RATE, run.piston)
    deviation = test.measured[0] - test.ideal[0]
    assert np.std(test.measured[0] - piston) < 0.05 * np.std(deviation)


@pytest.mark.parametrize("output", [None, np.array([0.0, 1.0]), np.array([-1.0, 1.0])])
def test_a_gain_and_a_delay_are_those_of_the_other_engine(shaking, output):
    partition = read_table({"gain": 0.99, "delay_ms": 3.0}).partition
    excitation = Excitation(acceleration=shaking, time_step=0.01)
    loop = FrameLoop(excitation=excitation, partition=partition, output=output)
    expected = loop.deviation(loop.cells(gain=0.99, delay=0.003))
    test = loop.response(gain_and_delay(0.99, 0.003))
    deviation = test.response[0] - test.ideal[0]
    assert np.mean(deviation**2) == pytest.approx(expected.mean_square[0], rel=6e-3)
    assert np.abs(deviation).max() == pytest.approx(expected.peak[0], rel=6e-3)


@pytest.mark.parametrize("share", [0.3, 0.5, 1.0])
@pytest.mark.parametrize(("gain", "slower"), [(0.8, 1.0), (1.0, 1.0), (1.2, 1.0), (1.0, 100.0), (1.0, 0.01)])
def test_stability_changes_at_the_critical_delay(share, gain, slower):
    stiffnesses = [4e5 / slower**2, 3e5 / slower**2]
    tables = {
        **TABLES,
        "frame": {**TABLES["frame"], "storey_stiffnesses_n_per_m": stiffnesses},
        "specimen": {"degree_of_freedom": "1", "stiffness_n_per_m": stiffnesses[0] * share},
    }
    partition = frame_of_tables(tables, "frame.toml").partition
    limit = stability_limit(partition, gain).delay
    assert stable_with(partition, gain_and_delay(gain, 0.995 * limit))
    assert not stable_with(partition, gain_and_delay(gain, 1.005 * limit))


def test_each_way_of_describing_gives_the_same_system(tmp_path):
    expected = TransferFunction(numerator=(22500.0,), denominator=(1.0, 180.0, 22500.0), delay=0.001)
    savemat(tmp_path / "rig.mat", {"rig": {"num": [22500.0], "den": [1.0, 180.0, 22500.0]}})
    ways = (
        {"numerator": [22500.0], "denominator": [1.0, 180.0, 22500.0]},
        {"poles_per_s": [[-90.0, 120.0]]},
        {"file": "rig.mat", "variable": "rig"},
    )
    s = 2j * np.pi * np.linspace(0.1, 50.0, 40)
    for way in ways:
        frame = read_table({**way, "delay_ms": 1.0}, str(tmp_path / "frame.toml"))
        specimen = frame.partition.specimen
        assert frame.transfer_system.transfer(s, specimen) == pytest.approx(expected.transfer(s, specimen))
    plant = read_table({"servo_hydraulic": {"leakage_per_s": 4.0}}).transfer_system
    assert plant == replace(ServoHydraulic(), leakage=4.0)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({}, "give numerator"),
        ({"numerator": [1.0]}, "belong together"),
        ({"numerator": [1.0], "denominator": [1.0], "poles_per_s": [-1.0]}, "give numerator"),
        ({"numerator": [1.0], "denominator": [1.0, 2.0], "gain": 2.0}, "gain needs"),
        ({"gain": 1.0, "zeros_per_s": [-1.0]}, "needs poles_per_s"),
        ({"gain": 1.0, "variable": "rig"}, "needs file"),
        ({"servo_hydraulic": {}, "delay_ms": 1.0}, "takes no delay_ms"),
        ({"servo_hydraulic": {"leakage_per_s": -1.0}}, "must be positive"),
        ({"gain": -1.0}, "gain must be between"),
        ({"gain": 1.0, "delay_ms": -1.0}, "must be 0 or positive"),
        ({"gain": 1.0, "lag": 1.0}, "not a known key"),
        ({"poles_per_s": [5.0]}, "must be stable"),
        ({"poles_per_s": [[0.0, 5.0], [0.0, 5.0]]}, "repeated poles"),
        ({"numerator": [1.0, 0.0], "denominator": [1.0]}, "higher order"),
        ({"file": "rig.py"}, "MATLAB"),
        ({"file": "absent.mat"}, "No such file"),
    ],
)
def test_malformed_transfer_systems_are_refused(table, message):
    with pytest.raises(InputError, match=message):
        read_table(table)
