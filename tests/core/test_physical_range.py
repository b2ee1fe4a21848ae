"""Numbers beyond the range of the physics are refused at the door, by every kind of file and by options."""

import math

import numpy as np
import pytest

import reliab
from reliab.assessment.budget.sizes import Equipment, ordinary_equipment, read_equipment
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.core.stated_value import LARGEST, RANGES, SMALLEST, require_physical
from reliab.recordings.channels_file import read_channels_file
from reliab.simulation.frames.frame_file import read_structure
from reliab.simulation.hybrid_test.model_file import read_model

EXTREME_NUMBERS = (5e-324, 1e-320, 1e300, -1e300, math.inf, math.nan)
MODEL = """
format = 1
structure = {{frequency_hz = 1.0, damping_ratio = 0.02, mass_kg = {mass}}}
actuator = {{gain = {gain}, delay_s = {delay}}}
specimen = {{stiffness_n_per_m = {stiffness}, damping_n_s_per_m = {damping}, mass_kg = 0.0}}
effects = []
"""
SOUND = {"mass": 1000.0, "gain": 1.0, "delay": 0.003, "stiffness": 4e4, "damping": 0.0}
FRAME = """
[frame]
masses_kg = [{mass}, 1000.0]
storey_stiffnesses_n_per_m = [2e6, {stiffness}]
[damping]
ratio = {ratio}
[specimen]
degree_of_freedom = "1"
stiffness_n_per_m = 5e5
"""


@pytest.mark.parametrize("quantity", RANGES)
def test_ends_of_a_range_belong_to_it(quantity):
    limits = RANGES[quantity]
    require_physical(quantity, limits.lowest)
    require_physical(quantity, min(limits.highest, math.nextafter(limits.below, 0.0)))
    for value in (0.5 * limits.lowest, 2.0 * min(limits.highest, limits.below), 0.0, math.nan, -1.0):
        with pytest.raises(InputError, match=r"must be .* found"):
            require_physical(quantity, value)


def test_squares_of_allowed_sizes_are_finite():
    for limits in RANGES.values():
        assert limits.lowest >= SMALLEST
        assert limits.highest <= LARGEST
        assert 0.0 < limits.lowest**2 < limits.highest**2 < math.inf


@pytest.mark.parametrize("value", EXTREME_NUMBERS)
@pytest.mark.parametrize("name", [name for name in vars(ordinary_equipment()) if name != "skew_ms"])
def test_equipment_of_no_laboratory_is_refused(tmp_path, name, value):
    (tmp_path / "equipment.toml").write_text(f"{name} = {value!r}\n")
    with pytest.raises(InputError, match=r"equipment\.toml: (.*must be|Not a finite number)"):
        read_equipment(tmp_path / "equipment.toml")
    with pytest.raises(InputError, match=name):
        Equipment(**{**vars(ordinary_equipment()), name: value})


@pytest.mark.parametrize("value", EXTREME_NUMBERS)
@pytest.mark.parametrize("name", SOUND)
def test_model_of_no_test_is_refused(tmp_path, name, value):
    (tmp_path / "model.toml").write_text(MODEL.format(**{**SOUND, name: value}))
    with pytest.raises(InputError, match=r"model\.toml: (.*must be|Not a finite number)"):
        read_model(tmp_path / "model.toml")


@pytest.mark.parametrize("value", EXTREME_NUMBERS)
@pytest.mark.parametrize("name", ["mass", "stiffness", "ratio"])
def test_frame_of_no_structure_is_refused(tmp_path, name, value):
    sound = {"mass": 1000.0, "stiffness": 2e6, "ratio": 0.02}
    (tmp_path / "frame.toml").write_text(FRAME.format(**{**sound, name: value}))
    with pytest.raises(InputError, match=r"frame\.toml: (.*must be|Not a finite number)"):
        read_structure(tmp_path / "frame.toml")


def test_negligible_mass_is_none(tmp_path):
    rows = "mass_matrix_kg = [[1e-320, 0.0], [0.0, 1000.0]]"
    text = FRAME.format(mass=1.0, stiffness=2e6, ratio=0.02).replace("masses_kg = [1.0, 1000.0]", rows)
    (tmp_path / "frame.toml").write_text(text)
    with pytest.raises(InputError, match="mass matrix must be positive definite"):
        read_structure(tmp_path / "frame.toml")


@pytest.mark.parametrize("value", EXTREME_NUMBERS)
@pytest.mark.parametrize("key", ["skew_ms", "scale", "hysteresis", "noise_m"])
def test_calibration_of_no_channel_is_refused(tmp_path, key, value):
    (tmp_path / "channels.toml").write_text(f"[calibration]\n{key} = {value!r}\n")
    with pytest.raises(InputError, match=r"channels\.toml: (.*must be|Not a finite number)"):
        read_channels_file(tmp_path / "channels.toml")


def test_model_without_stiffness_is_refused_in_words(tmp_path):
    (tmp_path / "model.toml").write_text(MODEL.format(**{**SOUND, "stiffness": 0.0}))
    test = shipped("datasets", "sample_test/test.csv")
    with pytest.raises(InputError, match=r"natural frequency of the model .* found 0 Hz.*Give the specimen"):
        reliab.assess(test, model=tmp_path / "model.toml")
    with pytest.raises(InputError, match="natural frequency of the model"):
        reliab.export_monitor(("c", tmp_path / "out"), model=tmp_path / "model.toml", rate=1024)


def test_followed_times_of_no_clock_are_refused(tmp_path):
    rows = [f"{k * 1e-300!r},{np.sin(0.1 * k)},{np.sin(0.1 * k - 0.01)}" for k in range(400)]
    (tmp_path / "test.csv").write_text("\n".join(["time_s,command_m,measured_m", *rows]))
    with pytest.raises(InputError, match=r"time step must be between 1e-06 and 1,000 s; found 1e-300 s"):
        list(reliab.follow_test(tmp_path / "test.csv", f=1, xi=0.02, wait=0.1))


@pytest.mark.parametrize(
    ("options", "rule"),
    [
        ({"f": 1e-320}, "stated|number|natural frequency"),
        ({"xi": 1e-13}, "damping ratio must be at least 1e-12"),
        ({"scale": 1e9}, "`scale` must be between 0.001 and 1,000"),
        ({"rate": 1e12}, "`rate` must be between"),
    ],
)
def test_options_share_the_ranges_of_files(options, rule):
    with pytest.raises(InputError, match=rule):
        reliab.assess(shipped("datasets", "sample_test/test.csv"), **{"f": 1, "xi": 0.02, **options})
