"""The monitor in C of a specimen with a model gives the error of Python's monitor, which is the true one."""

import numpy as np
import pytest
from compiled_monitor import compare, needs_compiler
from drawn_tests import EFFECT_NAMES, draw_model, nonlinear_test

from reliab.app.api.monitor import export_monitor, follow_test
from reliab.assessment.monitor import Monitor
from reliab.core.errors import InputError
from reliab.core.vocabulary import Block
from reliab.effects.effect import Role, SteppedEffect
from reliab.effects.kernel import Kernel
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.structure import Structure


@pytest.mark.default_cases(1)
@needs_compiler
@pytest.mark.parametrize(("kind", "rate"), [("hysteresis", 256), ("coulomb_friction", 1024)])
def test_error_equals_python_and_truth(tmp_path, kind, rate):
    ours = compare(tmp_path, draw_model(1, rate, (kind,), noise=0.0))
    _, _, reading, exact = nonlinear_test(1, rate, (kind,))
    true = reading - exact
    assert np.abs(ours.error[0] - true).max() < 0.02 * np.abs(true).max()
    assert ours.rms[0, -1] == pytest.approx(np.sqrt(np.mean(true**2)) / np.abs(exact).max(), rel=0.01)


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize("rate", [256, 1024, 4096])
@pytest.mark.parametrize("kind", EFFECT_NAMES)
def test_every_shipped_effect_is_computed_in_c(tmp_path, kind, rate):
    for seed in range(2):
        compare(tmp_path / f"{seed}", draw_model(seed, rate, (kind,), noise=1e-3 * seed))


@pytest.mark.slow
@pytest.mark.parametrize("kind", EFFECT_NAMES)
def test_every_shipped_effect_has_the_true_error(kind):
    model, command, reading, exact = nonlinear_test(11, 1024, (kind,))
    monitor = Monitor(UpdatedModel(name="", test=model), 1.0 / 1024, sensor_offset=0.0)
    monitor.feed(command, reading)
    true = np.sqrt(np.mean((reading - exact) ** 2)) / np.abs(exact).max()
    assert monitor.now.rms == pytest.approx(true, rel=0.01)


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_several_effects_act_together(tmp_path, seed):
    kinds = np.random.default_rng(seed).choice(
        [k for k in EFFECT_NAMES if "hysteresis" not in k], 3, replace=False
    )
    compare(tmp_path, draw_model(seed, 512, tuple(kinds), noise=1e-4))


@pytest.mark.slow
def test_noise_of_the_sensor_is_not_taken_for_friction_or_cycles():
    """Sixteen tests with noise of a thousandth of the peak: RMS^R within 5 % in the mean, 15 % in each."""
    ratios = []
    for kind in ("coulomb_friction", "hysteresis"):
        for seed in range(100, 108):
            model, command, reading, exact = nonlinear_test(seed, 1024, (kind,))
            noise = 1e-3 * np.abs(exact).max() * np.random.default_rng(seed).normal(size=reading.size)
            monitor = Monitor(UpdatedModel(name="", test=model), 1.0 / 1024, sensor_offset=0.0)
            monitor.feed(command, reading + noise)
            true = np.sqrt(np.mean((reading + noise - exact) ** 2)) / np.abs(exact).max()
            ratios.append(monitor.now.rms / true)
    assert abs(np.mean(ratios) - 1.0) < 0.05
    assert np.abs(np.array(ratios) - 1.0).max() < 0.15


def _force(motion, _time, _step, coefficients, _state):
    return coefficients[0] * sum(motion[k] for k in range(2))


class Unwritable(SteppedEffect):
    """A force whose step has no form in C."""

    name = "sum_of_motion"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "an effect of another package"
    parameters = ()
    kernel = Kernel(function=_force)


def test_effect_without_c_code_is_refused_by_name(tmp_path):
    test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.02), effects=(Unwritable(),))
    with pytest.raises(InputError, match="whose step has a form in C, and sum_of_motion has none"):
        export_monitor(("c", tmp_path / "out"), model=UpdatedModel(name="", test=test), rate=256)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("declared_values", [{"f": 1}, {"xi": 0.02}, {"alpha": 0.5}, {"feedback_lag": 1}])
def test_the_structure_of_a_model_is_not_stated_twice(tmp_path, declared_values):
    test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.02))
    model = UpdatedModel(name="", test=test)
    for ask in (
        lambda: export_monitor(("c", tmp_path), model=model, rate=256, **declared_values),
        lambda: next(follow_test("sample_test", model=model, **declared_values)),
    ):
        with pytest.raises(InputError, match="has no effect together with `model`"):
            ask()
