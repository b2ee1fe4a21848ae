"""Files of a small laboratory, in units and sizes of which none is one."""

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
from coupled_structures import coupled_response

from reliab.core.shipped import shipped
from reliab.criterion.derivation import published_criterion
from reliab.effects.registry import find_effect
from reliab.simulation.frames.frame_file import read_frame, read_structure
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel, write_model
from reliab.structures.inner_motion import InnerMotion
from reliab.structures.structure import Structure

RATE = 200.0
SECONDS = 9.0
STRUCTURE = Structure(frequency=2.7, damping_ratio=0.037, experimental_fraction=0.8)

FRAME = """name = "two storeys"
[frame]
masses_kg = [1300.0, 800.0]
storey_stiffnesses_n_per_m = [9e5, 6e5]
[damping]
ratio = 0.033
[specimen]
degree_of_freedom = "1"
stiffness_n_per_m = 4e5
[tolerances]
stiffness = 0.03
"""

EQUIPMENT = """xi = 0.11
scale = 0.004
skew_samples = 0.3
hysteresis = 0.002
yielding = 0.3
"""

CAMPAIGN = """name = "shear spring"
[structure]
frequency_hz = 2.58
damping_ratio = 0.037
mass_kg = 35.0
[sampling]
rate_hz = 200.0
[specimen]
stiffness_n_per_m = 9e3
damping_n_s_per_m = 20.0
"""


def write_laboratory(folder: Path) -> None:
    """Write every file that a question names."""
    _write_tests(folder)
    _write_frame_test(folder)
    _write_coupled_test(folder)
    _write_campaign(folder / "friction", friction=9.0)
    _write_campaign(folder / "spring", bias=0.0)
    _write_campaign(folder / "bias", bias=17.0)
    _write_campaign(folder / "late", late=0.006)
    _write_campaign(folder / "soft", stated="4e3")
    _write_frame_campaign(folder / "storeys")
    _write_loop_campaign(folder / "loop")
    (folder / "frame.toml").write_text(FRAME, encoding="utf-8")
    (folder / "equipment.toml").write_text(EQUIPMENT, encoding="utf-8")
    (folder / "criterion.json").write_text(published_criterion("guo_2017_18").to_json(), encoding="utf-8")
    hardening = find_effect("cubic_stiffness").from_values(np.array([3e6]))
    model = HybridTest(structure=STRUCTURE, mass=35.0, effects=(hardening,))
    write_model(folder / "model.toml", UpdatedModel(name="hardening", test=model))
    shutil.copy(shipped("datasets", "paper/table2.csv"), folder / "table2.csv")
    _write_ellipses(folder / "ellipses.csv")


def ground(seed: int, rate: float = RATE, seconds: float = SECONDS) -> np.ndarray:
    """Return a short earthquake-like acceleration [m/s²]."""
    time = np.arange(0.0, seconds, 1.0 / rate)
    random = np.random.default_rng(seed)
    frequency, phase = random.uniform(0.6, 9.0, 40), random.uniform(0.0, 2.0 * np.pi, 40)
    waves = np.sin(2.0 * np.pi * frequency * time[:, np.newaxis] + phase) @ random.uniform(0.02, 0.1, 40)
    return 2.0 * (time / 2.5) ** 2 * np.exp(2.0 - 2.0 * time / 2.5) * waves


def _write_tests(folder: Path) -> None:
    """Write two tests of one rig with force and ground acceleration, and the first in other forms."""
    time = np.arange(0.0, SECONDS, 1.0 / RATE)
    for name, seed, delay, gain in (("first", 3, 0.0021, 0.991), ("second", 4, 0.0007, 1.003)):
        shaking = ground(seed)
        rig = HybridTest(structure=STRUCTURE, mass=35.0, actuator=Actuator(gain=gain, delay=delay))
        run = run_closed_loop(rig, shaking, 1.0 / RATE)
        noise = 3e-6 * np.random.default_rng(seed).normal(size=time.size)
        table = pd.DataFrame(
            {
                "time [ms]": 1e3 * time,
                "command [mm]": 1e3 * run.command.values[0],
                "measured [mm]": 1e3 * (run.measured + noise),
                "force [kN]": 1e-3 * run.force,
                "ag [g]": shaking / 9.80665,
            }
        )
        table.to_csv(folder / f"{name}.csv", index=False, float_format="%.9g")
        table.iloc[:, :3].to_csv(folder / f"{name}_bare.csv", index=False, float_format="%.9g")
        lines = ["# units: m/s2", f"# dt = {1.0 / RATE}", *(f"{sample:.7f}" for sample in shaking)]
        (folder / f"ground_{name}.txt").write_text("\n".join(lines), encoding="utf-8")
    (folder / "channels.toml").write_text(
        'command = { column = "command [mm]", factor = 0.00101 }\nmeasured = "measured [mm]"\n',
        encoding="utf-8",
    )


def _write_frame_test(folder: Path) -> None:
    """Write the motion of a first floor that follows 2 ms late."""
    time = np.arange(0.0, SECONDS, 1.0 / RATE)
    command = 0.011 * np.sin(15.0 * time) * np.sin(np.pi * time / SECONDS) ** 2
    late = 0.996 * np.interp(time - 0.002, time, command)
    noise = 2e-6 * np.random.default_rng(8).normal(size=time.size)
    table = {"time_s": time, "command_m": command, "measured_m": late + noise}
    pd.DataFrame(table).to_csv(folder / "floor.csv", index=False, float_format="%.9g")


def _write_coupled_test(folder: Path) -> None:
    """Write a test of a corner that translates and turns, on two actuators."""
    path = shutil.copy(shipped("datasets", "frames/two_actuators.toml"), folder / "corner.toml")
    frame = read_structure(Path(path))
    shaking = ground(6)
    run = coupled_response(frame.partition, frame.transfer_system, shaking, 1.0 / RATE)
    time = np.arange(shaking.size) / RATE
    noise = 1e-6 * np.random.default_rng(1).normal(size=(2, time.size))
    command, measured = frame.kinematics @ run.command, frame.kinematics @ run.measured + noise
    table = {"time_s": time}
    for place in range(2):
        table |= {f"command_{place + 1}": command[place], f"measured_{place + 1}": measured[place]}
    pd.DataFrame(table).to_csv(folder / "corner.csv", index=False, float_format="%.9g")


def _write_campaign(
    folder: Path, *, friction: float = 0.0, bias: float = 0.0, late: float = 0.0, stated: str = "9e3"
) -> None:
    """Write two tests of a spring with a damper, and what no model has: friction, a bias, a late force."""
    folder.mkdir()
    time = np.arange(0.0, SECONDS, 1.0 / RATE)
    text = CAMPAIGN.replace("9e3", stated)
    for number, size in ((1, 0.02), (2, 0.013)):
        random = np.random.default_rng(number)
        frequency, phase = random.uniform(0.4, 4.0, 12), random.uniform(0.0, 2.0 * np.pi, 12)
        waves = 2.0 * np.pi * frequency * time[:, np.newaxis] + phase
        window = np.sin(np.pi * time / SECONDS)[:, np.newaxis] ** 2
        moved = size * (window * np.sin(waves)).sum(axis=1) / 4.0
        velocity = np.gradient(moved, time)
        force = 9.2e3 * moved + 20.0 * velocity + friction * np.tanh(velocity / 0.004)
        force = bias + np.interp(time - late, time, force)
        force += 0.4 * random.normal(size=time.size)
        table = {"time_s": time, "measured_m": moved, "force_N": force}
        pd.DataFrame(table).to_csv(folder / f"test_{number}.csv", index=False, float_format="%.9g")
        text += f'[[tests]]\nfile = "test_{number}.csv"\nheld_out = {json.dumps(number == 2)}\n'
    (folder / "campaign.toml").write_text(text, encoding="utf-8")


def _write_frame_campaign(folder: Path) -> None:
    """Write the forces that balance a frame whose first floor moves as commanded, under a stronger motion."""
    folder.mkdir()
    text = """name = "storeys"
[structure.frame]
mass_matrix_kg = [[1300.0, 0.0], [0.0, 800.0]]
stiffness_matrix_n_per_m = [[1.5e6, -6e5], [-6e5, 6e5]]
[structure.damping]
ratio = 0.033
[structure.specimen]
degree_of_freedom = 1
stiffness_n_per_m = 4e5
[sampling]
rate_hz = 200.0
"""
    (folder / "frame.toml").write_text(FRAME, encoding="utf-8")
    partition = read_frame(folder / "frame.toml").partition
    inner = InnerMotion(partition, 1.0 / RATE)
    time = np.arange(0.0, SECONDS, 1.0 / RATE)
    for number in (1, 2):
        shaking, rate = ground(30 + number), 11.0 + number
        envelope = 0.006 * np.sin(np.pi * time / SECONDS) ** 2
        moved = envelope * np.sin(rate * time)
        speed = np.gradient(moved, time)
        motion = np.stack([moved, speed, np.gradient(speed, time)])
        noise = 2.0 * np.random.default_rng(number).normal(size=time.size)
        table = {
            "time_s": time,
            "ground_acceleration_mps2": shaking,
            "command_m": moved,
            "force_n": inner.force(1.04 * shaking, motion) + noise,
        }
        pd.DataFrame(table).to_csv(folder / f"test_{number}.csv", index=False, float_format="%.9g")
        text += f'[[tests]]\nfile = "test_{number}.csv"\n'
    (folder / "campaign.toml").write_text(text, encoding="utf-8")


def _write_loop_campaign(folder: Path) -> None:
    """Write three tests of a loop whose actuator has play, in all channels."""
    folder.mkdir()
    believed = {"frequency_hz": 2.7, "damping_ratio": 0.037, "mass_kg": 35.0, "experimental_fraction": 0.8}
    text = "\n".join(
        ['name = "play"', "[structure]", *(f"{name} = {value}" for name, value in believed.items())]
    )
    text += "\n[actuator]\ngain = 0.99\ndelay_s = 0.004\n[sampling]\nrate_hz = 200.0\n"
    play = find_effect("backlash").from_values(np.array([4e-4]))
    actuator = Actuator(gain=0.99, delay=0.0045)
    rig = HybridTest(structure=STRUCTURE, mass=35.0, actuator=actuator, effects=(play,))
    for number in (1, 2, 3):
        shaking = ground(20 + number)
        run = run_closed_loop(rig, shaking, 1.0 / RATE)
        noise = np.random.default_rng(number).normal(size=(2, shaking.size))
        table = {
            "time_s": np.arange(shaking.size) / RATE,
            "ground_acceleration_mps2": shaking,
            "command_m": run.command.values[0],
            "measured_m": run.measured + 1e-5 * noise[0],
            "force_n": run.force + 0.1 * noise[1],
        }
        pd.DataFrame(table).to_csv(folder / f"test_{number}.csv", index=False, float_format="%.9g")
        text += f'[[tests]]\nfile = "test_{number}.csv"\n'
    (folder / "campaign.toml").write_text(text, encoding="utf-8")


def _write_ellipses(path: Path) -> None:
    """Write ellipses of 30 motions of ten earthquakes."""
    random = np.random.default_rng(12)
    event = np.arange(30) % 10
    common = 0.4 * random.normal(size=10)[event] + 0.3 * random.normal(size=30)
    table = {
        "motion": [f"E{each}/M{rank}" for rank, each in enumerate(event)],
        "event": [f"E{each}" for each in event],
        "a": 4e-4 * np.exp(common + 0.1 * random.normal(size=30)),
        "b": 7.0 * np.exp(common + 0.2 * random.normal(size=30)),
    }
    pd.DataFrame(table).to_csv(path, index=False, float_format="%.9g")
