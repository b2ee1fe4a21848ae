"""An actuator that leads: the bounded solution, by two engines that share nothing but the equation."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad_vec

from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.motions.loading import load_motions
from reliab.simulation.effect_loop import EffectLoop
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.linear_loop import spectral
from reliab.simulation.linear_loop.pole_recursion import dominant_pole
from reliab.structures.structure import Structure, critical_delay, longest_lead, stability_margin
from reliab.sweep.request import excitation_of
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window


def random_case(rng, excitation):
    structure = Structure(
        frequency=float(rng.choice([0.25, 0.5, 1.0, 1.5, 2.0])),
        damping_ratio=float(rng.choice([0.02, 0.05, 0.1])),
        experimental_fraction=float(rng.choice([1.0, 1.0, 0.6, 0.3])),
    )
    xi = structure.damping_ratio
    reach = float(rng.choice([0.01, 0.1, 1.0, 4.0])) * xi / structure.circular_frequency
    loop = Loop(excitation=excitation, structure=structure)
    return loop, loop.cells(gain=1.0 + xi * rng.uniform(-1, 1, 3), delay=-reach * rng.uniform(0.2, 1.0, 3))


def differences(loop, cells, metric):
    pole, exact = (replace(loop, engine=item).deviation(cells) for item in (Engine.POLE, Engine.SPECTRAL))
    return np.abs(relative_error(pole, metric) / relative_error(exact, metric) - 1.0).max()


@pytest.mark.parametrize("seed", range(16))
def test_pole_and_spectral_engine_agree(random_excitation, seed):
    rng = np.random.default_rng(seed)
    window = (0.0, -1.0) if seed % 2 else (2.0, 9.5)
    loop, cells = random_case(rng, random_excitation(rng, window=window))
    assert differences(loop, cells, Metric.RMS) < 2e-4
    assert differences(loop, cells, Metric.MTE) < 2e-3


@pytest.mark.slow
def test_engines_agree_on_the_real_records(real_motions_folder):
    rng = np.random.default_rng(11)
    motions = load_motions(real_motions_folder)
    rms, mte = [], []
    for index in rng.integers(0, len(motions), 40):
        motion = motions[int(index)]
        loop, cells = random_case(rng, excitation_of(motion, Window()))
        rms.append(differences(loop, cells, Metric.RMS))
        mte.append(differences(loop, cells, Metric.MTE))
    assert max(rms) < 2e-4
    assert max(mte) < 2e-3


def test_bounded_solution_is_the_fourier_integral():
    """The oracle is the Fourier integral of a pulse whose transform is known in closed form."""
    structure = Structure(frequency=1.0, damping_ratio=0.1, experimental_fraction=0.7)
    w0, gain, lead = structure.circular_frequency, 1.05, 0.04

    def ground(t):
        return np.exp(-(((t - 3.0) / 0.3) ** 2))

    def command(w):
        stiffness = w0**2 * (0.3 + 0.7 * gain * np.exp(1j * w * lead))
        pulse = 0.3 * np.sqrt(np.pi) * np.exp(-((0.15 * w) ** 2) - 3j * w)
        return -pulse / (-(w**2) + 2j * 0.1 * w0 * w + stiffness)

    t = np.arange(0.0, 8.0, 0.05)
    reading = quad_vec(
        lambda w: np.real(gain * command(w) * np.exp(1j * w * (t + lead))) / np.pi, 0.0, 40.0, limit=300
    )[0]
    fine = np.arange(0.0, 8.0, 0.005)
    excitation = Excitation(acceleration=ground(fine), time_step=0.005)
    solution, step = spectral.response(excitation, structure, gain, -lead)
    result = np.interp(t[:-1], step * np.arange(solution.size), solution)
    assert np.abs(result - reading[:-1]).max() < 1e-4 * np.abs(reading).max()


def test_a_lead_only_adds_damping():
    structure = Structure(frequency=1.0, damping_ratio=0.02, experimental_fraction=0.8)
    lead = np.linspace(0.0, float(longest_lead(structure)), 60)
    pole = dominant_pole(structure, np.ones(60), -lead)
    assert np.isfinite(pole).all()
    assert (np.diff(pole.real) < 0.0)[: np.searchsorted(lead, 0.2)].all()
    assert (pole.real < 0.0).all()
    assert (stability_margin(structure, 1.0, -lead) >= 1.0).all()


@pytest.mark.parametrize(
    ("damping_ratio", "fraction", "gain"), [(0.02, 1.0, 1.0), (0.1, 0.4, 1.3), (0.3, 1.0, 0.7)]
)
def test_no_root_of_a_lead_lies_between_the_axis_and_its_inverse(damping_ratio, fraction, gain):
    """Count the roots inside a contour by the argument of the characteristic function."""
    structure = Structure(frequency=1.0, damping_ratio=damping_ratio, experimental_fraction=fraction)
    w0, lead = structure.circular_frequency, float(longest_lead(structure, gain))

    def characteristic(s):
        return s**2 + 2 * damping_ratio * w0 * s + w0**2 * (1 - fraction + fraction * gain * np.exp(s * lead))

    def turns(corners):
        path = [
            np.linspace(a, b, 4001)[:-1] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)
        ]
        phase = np.unwrap(np.angle(characteristic(np.concatenate([*path, [corners[0]]]))))
        return round((phase[-1] - phase[0]) / (2.0 * np.pi))

    high, right = 12.0 * w0, 1.0 / lead
    assert turns([-1j * high, right - 1j * high, right + 1j * high, 1j * high]) == 0
    assert turns([-4.0 * w0 - 1j * high, -1j * high, 1j * high, -4.0 * w0 + 1j * high]) == 2


def test_lead_joins_the_lag_smoothly(random_excitation):
    """Over a perfect actuator, x_m − x_I changes its sign with the delay, to first order."""
    excitation = random_excitation(2)
    loop = Loop(excitation=excitation, structure=Structure(frequency=1.0, damping_ratio=0.05))
    tiny = 1e-6
    result = loop.deviation(loop.cells(gain=1.0, delay=[-tiny, tiny]))
    assert result.mean_square[0] == pytest.approx(result.mean_square[1], rel=1e-3)


@pytest.fixture
def loop(random_excitation):
    return Loop(excitation=random_excitation(0), structure=Structure(frequency=1.0, damping_ratio=0.02))


def test_stepping_engine_refuses_a_lead(loop):
    stepping = replace(loop, engine=Engine.DELAY)
    with pytest.raises(InputError, match=r"early actuator.*2 ms"):
        stepping.deviation(stepping.cells(gain=1.0, delay=[0.001, -0.002]))


def test_loop_with_effects_refuses_a_lead(loop):
    effects = EffectLoop(excitation=loop.excitation, test=HybridTest(structure=loop.structure))
    with pytest.raises(InputError, match="early actuator"):
        effects.deviation(effects.cells(gain=1.0, delay=-0.002))


def test_lead_of_a_quarter_period_is_refused(loop):
    with pytest.raises(InputError, match=r"quarter of the structure's period, 250 ms"):
        loop.cells(gain=1.0, delay=-0.3)


def test_lead_beyond_the_pole_is_solved_exactly(random_excitation):
    loop = Loop(excitation=random_excitation(6), structure=Structure(frequency=0.25, damping_ratio=0.1))
    cells = loop.cells(gain=1.0, delay=[-0.5, 0.01])
    assert loop.reduction_error(cells)[0] > 3e-3
    exact = spectral.deviation(loop.excitation, loop.structure, cells.gain[:1], cells.delay[:1])
    assert loop.deviation(cells).mean_square[0] == pytest.approx(exact.mean_square[0], rel=1e-5)
    with pytest.raises(InputError, match="engine 'pole' would change"):
        replace(loop, engine=Engine.POLE).deviation(cells)


def test_actuator_at_rest_misses_the_whole_response(loop):
    history, _ = spectral.response(loop.excitation, loop.structure, 1.0, 0.0)
    remainder = loop.rest_deviation()
    assert relative_error(remainder, Metric.MTE)[0] == 1.0
    expected = np.sqrt(np.trapezoid(history**2) / (history.size - 1)) / np.abs(history).max()
    assert relative_error(remainder, Metric.RMS)[0] == pytest.approx(expected, rel=2e-4)
    effects = EffectLoop(excitation=loop.excitation, test=HybridTest(structure=loop.structure))
    assert relative_error(effects.rest_deviation(), Metric.RMS)[0] == pytest.approx(expected, rel=2e-3)


def test_lead_is_stable_where_the_lag_is_not(loop):
    limit = float(critical_delay(loop.structure))
    assert loop.cells(gain=1.0, delay=[-2.0 * limit, 2.0 * limit]).stable.tolist() == [True, False]
