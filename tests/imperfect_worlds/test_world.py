"""Worlds are what they say: reproducible, imperfect, and shaped as their equations are."""

import numpy as np
import pytest

from imperfect_worlds.specimens import SPECIMENS, dahl, stribeck
from imperfect_worlds.world import FURTHER, RATE, WORLDS, write_world
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.effects.registry import library

TIME = np.arange(0.0, 10.0, 1.0 / RATE)
X = 0.02 * np.sin(2.0 * np.pi * TIME) * np.sin(np.pi * TIME / 10.0)
V = np.gradient(X, 1.0 / RATE)


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("seed", range(0, len(WORLDS), 3))
def test_every_kind_of_world_is_a_campaign(tmp_path, seed):
    world = write_world(tmp_path, seed)
    campaign = read_campaign(tmp_path)
    assert world.name == WORLDS[seed]
    assert 0.0 < world.model_error <= 0.2
    assert (tmp_path / FURTHER).exists()
    assert [test.held_out for test in campaign.tests] == [False, False, False, True, True]
    labels = {effect.label() for effect in library().values()}
    assert set(world.accepted) <= labels
    for test in campaign.tests:
        assert all(np.isfinite(values).all() for values in test.channels.values())


@pytest.mark.slow
def test_a_seed_gives_the_same_world_twice(tmp_path):
    folders = [tmp_path / name for name in "ab"]
    for folder in folders:
        folder.mkdir()
        write_world(folder, 3)
    assert (folders[0] / "test_0.csv").read_bytes() == (folders[1] / "test_0.csv").read_bytes()


def test_friction_of_dahl_stays_below_its_limit_and_dissipates():
    force = dahl(TIME, X, V, 0.02, np.abs(V).max(), np.random.default_rng(1))
    assert 0.9 < np.abs(force).max() < 1.02
    assert np.trapezoid(force, X) > 0.0


def test_friction_of_stribeck_is_strongest_at_low_speed():
    force = stribeck(TIME, X, V, 0.02, np.abs(V).max(), np.random.default_rng(1))
    slow = (np.abs(V) < 0.05 * np.abs(V).max()) & (np.abs(V) > 0.02 * np.abs(V).max())
    fast = np.abs(V) > 0.8 * np.abs(V).max()
    assert np.abs(force[slow]).mean() > 1.05 * np.abs(force[fast]).mean()


@pytest.mark.parametrize("seed", [2, 3])
@pytest.mark.parametrize("name", list(SPECIMENS))
def test_specimens_are_of_unit_size_under_the_fastest_motion(name, seed):
    moved = 0.02 * np.sin(2.0 * np.pi * 3.0 * TIME) * np.sin(np.pi * TIME / 10.0)
    velocity = np.gradient(moved, 1.0 / RATE)
    force = SPECIMENS[name][0](
        TIME, moved, velocity, 0.02, np.abs(velocity).max(), np.random.default_rng(seed)
    )
    assert 0.05 < np.abs(force).max() < 1.7
