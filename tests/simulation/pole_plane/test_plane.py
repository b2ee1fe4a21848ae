"""Mean squares by a few poles, against the engines that solve every actuator by itself."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.motions.loading import load_motions
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.pole_plane import mean_squares
from reliab.structures.structure import Structure

TIME = np.arange(0.0, 30.0, 0.01)
HOSTILE = {
    "impulse": (np.abs(TIME - 3.0) < 0.005).astype(float),
    "harmonic at the structure's frequency": np.sin(2.0 * np.pi * TIME),
    "harmonic above it": np.sin(2.0 * np.pi * 9.0 * TIME),
    "step that stays": (TIME > 2.0).astype(float),
    "end in strong motion": np.random.default_rng(1).standard_normal(TIME.size) * TIME,
}


def actuators(loop: Loop, reach: float):
    """Late and early actuators whose errors scale with the damping ratio."""
    xi, w0 = loop.structure.damping_ratio, loop.structure.circular_frequency
    gain, delay = np.meshgrid(
        1.0 + reach * xi * np.linspace(-1, 1, 5), reach * xi / w0 * np.linspace(-1, 1, 7)
    )
    return loop.cells(gain=gain, delay=delay)


def plane(loop, cells):
    first = np.zeros(cells.gain.size, dtype=np.int64)
    return mean_squares([loop.responses], cells.expansions(loop.blocks.step), first)


def largest_difference(loop, cells, engine):
    """Largest difference of RMS^R where the plane answers, and the share that it answers."""
    squares, known = plane(loop, cells)
    oracle = replace(loop, engine=engine).deviation(cells).mean_square
    moved = known & (oracle > 1e-12 * loop.blocks.ideal_peak**2)
    return np.abs(np.sqrt(squares[moved] / oracle[moved]) - 1.0).max(initial=0.0), known.mean()


@pytest.mark.parametrize("seed", range(8))
def test_plane_agrees_with_the_spectral_engine(random_record, seed):
    rng = np.random.default_rng(seed)
    acceleration, time_step = random_record(rng)
    structure = Structure(
        frequency=float(rng.choice([0.25, 1.0, 2.0])),
        damping_ratio=float(rng.choice([0.02, 0.05, 0.1])),
        experimental_fraction=float(rng.choice([1.0, 0.6])),
    )
    loop = Loop(excitation=Excitation(acceleration=acceleration, time_step=time_step), structure=structure)
    difference, share = largest_difference(loop, actuators(loop, 0.4), Engine.SPECTRAL)
    assert difference < 1e-4
    assert share > 0.9


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("window", [(0.0, -1.0), (1.5, 4.2)])
def test_plane_keeps_its_tolerance_on_hostile_records(name, window):
    excitation = Excitation(acceleration=HOSTILE[name], time_step=0.01, window=window)
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.03))
    difference, _ = largest_difference(loop, actuators(loop, 0.8), Engine.POLE)
    assert difference < 3e-5


def test_plane_agrees_on_the_real_records(real_motions_folder):
    rng = np.random.default_rng(16)
    motions = load_motions(real_motions_folder)
    for index in rng.integers(0, len(motions), 12):
        motion = motions[int(index)]
        structure = Structure(
            frequency=float(rng.choice([0.25, 0.5, 1.0, 2.0])), damping_ratio=float(rng.choice([0.02, 0.05]))
        )
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        loop = Loop(excitation=excitation, structure=structure)
        difference, share = largest_difference(loop, actuators(loop, 0.4), Engine.POLE)
        assert difference < 3e-5
        assert share > 0.5


def test_what_is_not_precise_is_not_answered():
    excitation = Excitation(acceleration=HOSTILE["impulse"], time_step=0.01)
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.02))
    cells = loop.cells(gain=[1.0, 1.0, 1.6], delay=[0.001, 0.02, 0.0])
    _, known = plane(loop, cells)
    assert known.tolist() == [True, False, False]
