"""Files of a test to judge."""

import numpy as np
import pandas as pd
import pytest

from reliab.criterion.derivation import published_criterion
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel, write_model
from reliab.structures.structure import Structure


@pytest.fixture(scope="module", autouse=True)
def assess_with_few_draws(few_draws):
    """Assess with few draws by default."""


@pytest.fixture(scope="module")
def folder_of_a_test(tmp_path_factory):
    """Files of a test of 12 s in several forms, and of what it may be judged by."""
    root = tmp_path_factory.mktemp("options")
    times = np.arange(0.0, 12.0, 1.0 / 128.0)
    rng = np.random.default_rng(2)
    command = 0.01 * np.sin(2.0 * np.pi * times) * np.sin(np.pi * times / 12.0) ** 2
    late = np.interp(times - 0.001, times, command) + 1e-6 * rng.normal(size=times.size)
    frame = pd.DataFrame(
        {
            "time_s": times,
            "command_m": command,
            "measured_m": 0.999 * late,
            "other_m": np.interp(times - 0.002, times, command) + 1e-6 * rng.normal(size=times.size),
            "slow_s": 1.1 * times,
        }
    )
    frame.to_csv(root / "test.csv", index=False)
    bare = frame[["command_m", "measured_m"]].set_axis(["command", "measured"], axis=1)
    bare.to_csv(root / "bare.csv", index=False)
    bare.assign(time=1e3 * times).to_csv(root / "ms.csv", index=False)
    frame.iloc[:, :3].to_csv(root / "bar.csv", index=False, sep="|")
    shaking = np.exp(-(((times - 4.0) / 2.0) ** 2)) * rng.normal(size=times.size)
    lines = ["# units: m/s2", "# dt = 0.0078125", *(f"{sample:.6f}" for sample in shaking)]
    (root / "ground.txt").write_text("\n".join(lines), encoding="utf-8")
    (root / "frame.toml").write_text(
        """[frame]
        masses_kg = [1000.0, 800.0]
        storey_stiffnesses_n_per_m = [1e5, 1e5]
        [damping]
        ratio = 0.03
        [specimen]
        degree_of_freedom = "1"
        stiffness_n_per_m = 5e4
        """,
        encoding="utf-8",
    )
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    rig = HybridTest(structure=structure, mass=2.0, actuator=Actuator(delay=1.0 / 128.0))
    simulation = run_closed_loop(rig, shaking, 1.0 / 128.0)
    histories = {"command_m": simulation.command.values[0], "measured_m": simulation.measured}
    pd.DataFrame({"time_s": times, **histories, "ag_mps2": shaking, "force_N": simulation.force}).to_csv(
        root / "whole.csv", index=False
    )
    cubic = find_effect("cubic_stiffness").from_values(np.array([1e5]))
    model = HybridTest(structure=structure, effects=(cubic,))
    write_model(root / "model.toml", UpdatedModel(name="cubic", test=model))
    (root / "criterion.json").write_text(published_criterion("guo_2017_18").to_json(), encoding="utf-8")
    return root
