"""Damaged files give a result or one clear error; `run.py` tries many more of them."""

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from fuzz.damage import damaged_cases
from fuzz.targets import TARGETS, examine


@pytest.mark.slow
@pytest.mark.default_cases(7)
@pytest.mark.parametrize("name", TARGETS)
def test_sound_files_are_read(name):
    target = TARGETS[name]
    outcomes = [examine(target, case) for case in target.seeds()]
    assert any(outcomes)


@pytest.mark.slow
@pytest.mark.default_cases(7)
@pytest.mark.parametrize("name", TARGETS)
@settings(max_examples=5, suppress_health_check=list(HealthCheck))
@given(choice=st.data())
def test_damaged_files_are_read_or_refused(name, choice):
    target = TARGETS[name]
    examine(target, choice.draw(damaged_cases(target.seeds())))
