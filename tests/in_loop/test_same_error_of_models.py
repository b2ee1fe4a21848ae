"""The monitor in C of a specimen with a model gives the error of Python's monitor, which is the true one."""

import numpy as np
import pytest
from compiled_monitor import built, followed

from reliab.api import export_monitor, follow_test
from reliab.assessment.rebuilt_error import Monitor
from reliab.effects import Role, SteppedEffect, find_effect, library
from reliab.effects.kernel import Kernel
from reliab.errors import InputError
from reliab.simulation.actuator import Actuator
from reliab.simulation.hybrid_test import HybridTest, UpdatedModel, run_closed_loop
from reliab.structures import Structure
from reliab.vocabulary import Block

FINE = 4096
SHIPPED = [name for name, effect in library().items() if effect.role is Role.FORCE]


def effects(kind, peak, stiffness, frequency):
    """Effects of a size that shows in a motion of a peak [m]; `stiffness` [N/m], `frequency` [rad/s]."""
    force, speed = stiffness * peak, peak * frequency
    friction = {"force_n": 0.1 * force, "regularisation_velocity_m_per_s": 0.01 * speed}
    yields = {"force_n": 0.3 * force, "displacement_m": 0.3 * peak, "lost_share": 1.0}
    sizes = {
        "series_play": {"width_m": 0.05 * peak},
        "cubic_stiffness": {"cubic_n_per_m3": 0.5 * stiffness / peak**2},
        "quadratic_stiffness": {"quadratic_n_per_m2": 0.2 * stiffness / peak},
        "coulomb_friction": friction,
        "directional_friction": {**friction, "asymmetry": 0.2},
        "viscous_damping": {"damping_n_s_per_m": 0.05 * stiffness / frequency},
        "quadratic_damping": {"coefficient_n_s2_per_m2": 0.1 * force / speed**2},
        "power_law_damping": {"coefficient": 0.05 * force / speed**0.4, "exponent": 0.4},
        "hysteresis": yields,
        "degrading_hysteresis": {**yields, "stiffness_loss": 0.02, "strength_loss": 0.02, "slip": 0.5},
        "added_mass": {"mass_kg": 0.1 * stiffness / frequency**2},
        "gap": {"gap_m": 0.1 * peak},
    }
    return (find_effect(kind)(**sizes[kind]),)


def nonlinear_test(seed, rate, kinds, seconds=10.0):
    """A model, and command, measured and exact displacement of a simulated test."""
    rng = np.random.default_rng((seed, 40))
    structure = Structure(
        frequency=float(np.exp(rng.uniform(np.log(0.5), np.log(3.0)))),
        damping_ratio=float(rng.uniform(0.02, 0.06)),
        experimental_fraction=float(rng.uniform(0.5, 1.0)),
    )
    mass = float(np.exp(rng.uniform(0.0, 8.0)))
    time = np.arange(int(seconds * FINE)) / FINE
    shaken = np.interp(time, np.arange(int(seconds * 32)) / 32, rng.normal(size=int(seconds * 32)))
    plain = HybridTest(structure=structure, mass=mass)
    peak = float(np.abs(run_closed_loop(plain, shaken, 1.0 / FINE).command.values[0]).max())
    sized = [effects(kind, peak, plain.specimen.stiffness, structure.circular_frequency) for kind in kinds]
    model = HybridTest(structure=structure, mass=mass, effects=tuple(one for (one,) in sized))
    late = rng.uniform(0.2, 0.8) * 2.0 * structure.damping_ratio / structure.circular_frequency
    late = Actuator(gain=float(rng.uniform(0.98, 1.02)), delay=float(late))
    run = run_closed_loop(
        HybridTest(structure=structure, mass=mass, effects=model.effects, actuator=late), shaken, 1.0 / FINE
    )
    exact = run_closed_loop(model, shaken, 1.0 / FINE).command.values[0]
    every = FINE // rate
    return model, *(np.ascontiguousarray(x[::every]) for x in (run.command.values[0], run.measured, exact))


def compare(folder, seed, rate, kinds, noise=0.0):
    model, command, measured, exact = nonlinear_test(seed, rate, kinds)
    read = measured + noise * np.abs(exact).max() * np.random.default_rng(seed).normal(size=measured.size)
    export_monitor(("c", folder), model=UpdatedModel(name="", test=model), rate=rate)
    ours = followed(built(folder), command, read, (0.0, 0.0))
    theirs = Monitor(UpdatedModel(name="", test=model), 1.0 / rate, sensor_offset=0.0)
    theirs.feed(command, read)
    assert np.abs(ours.error - theirs.error).max() < 1e-12 * np.abs(exact).max()
    assert ours.rms[-1] == pytest.approx(theirs.now.rms, rel=1e-9)
    return theirs, measured - exact, np.abs(exact).max()


@pytest.mark.parametrize(("kind", "rate"), [("hysteresis", 256), ("coulomb_friction", 1024)])
def test_the_error_is_that_of_python_and_the_true_one(tmp_path, kind, rate):
    theirs, true, peak = compare(tmp_path, 1, rate, (kind,))
    assert np.abs(theirs.error - true).max() < 0.02 * np.abs(true).max()
    assert theirs.now.rms == pytest.approx(np.sqrt(np.mean(true**2)) / peak, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("rate", [256, 1024, 4096])
@pytest.mark.parametrize("kind", SHIPPED)
def test_every_shipped_effect_is_computed_in_c(tmp_path, kind, rate):
    for seed in range(2):
        (tmp_path / f"{seed}").mkdir()
        compare(tmp_path / f"{seed}", seed, rate, (kind,), noise=1e-3 * seed)


@pytest.mark.slow
@pytest.mark.parametrize("kind", SHIPPED)
def test_every_shipped_effect_has_the_true_error(kind):
    model, command, measured, exact = nonlinear_test(11, 1024, (kind,))
    monitor = Monitor(UpdatedModel(name="", test=model), 1.0 / 1024, sensor_offset=0.0)
    monitor.feed(command, measured)
    true = np.sqrt(np.mean((measured - exact) ** 2)) / np.abs(exact).max()
    assert monitor.now.rms == pytest.approx(true, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_several_effects_act_together(tmp_path, seed):
    kinds = np.random.default_rng(seed).choice(
        [k for k in SHIPPED if "hysteresis" not in k], 3, replace=False
    )
    compare(tmp_path, seed, 512, tuple(kinds), noise=1e-4)


@pytest.mark.slow
def test_noise_of_the_sensor_is_not_taken_for_friction_or_cycles():
    """Sixteen tests with noise of a thousandth of the peak: RMS^R within 5 % in the mean, 15 % in each."""
    ratios = []
    for kind in ("coulomb_friction", "hysteresis"):
        for seed in range(100, 108):
            model, command, measured, exact = nonlinear_test(seed, 1024, (kind,))
            noise = 1e-3 * np.abs(exact).max() * np.random.default_rng(seed).normal(size=measured.size)
            monitor = Monitor(UpdatedModel(name="", test=model), 1.0 / 1024, sensor_offset=0.0)
            monitor.feed(command, measured + noise)
            true = np.sqrt(np.mean((measured + noise - exact) ** 2)) / np.abs(exact).max()
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


def test_an_effect_that_has_no_form_in_c_is_refused_by_name(tmp_path):
    test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.02), effects=(Unwritable(),))
    with pytest.raises(InputError, match="whose step has a form in C, which sum_of_motion has not"):
        export_monitor(("c", tmp_path / "out"), model=UpdatedModel(name="", test=test), rate=256)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("stated", [{"f": 1}, {"xi": 0.02}, {"alpha": 0.5}, {"feedback_lag": 1}])
def test_the_structure_of_a_model_is_not_stated_twice(tmp_path, stated):
    test = HybridTest(structure=Structure(frequency=1.0, damping_ratio=0.02))
    model = UpdatedModel(name="", test=test)
    for ask in (
        lambda: export_monitor(("c", tmp_path), model=model, rate=256, **stated),
        lambda: next(follow_test("sample_test", model=model, **stated)),
    ):
        with pytest.raises(InputError, match="has no meaning beside `model`"):
            ask()
