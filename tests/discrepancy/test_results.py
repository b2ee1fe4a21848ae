"""What a diagnosis says and draws of itself is what it holds."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.adding import _apply_posterior
from reliab.discrepancy.blocks.calibration import structure_damping
from reliab.discrepancy.naming.naming import or_stated_damping
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.result.gap import Gap, HeldOutTest
from reliab.discrepancy.result.missing_effect import (
    Estimate,
    MissingEffect,
    Rival,
    calibration,
    remark,
    widen_estimates,
)
from reliab.effects.registry import find_effect
from reliab.effects.stated_damping import StatedDamping
from reliab.recordings import behaviour


@dataclass(frozen=True)
class Block:
    """What adding changes of a diagnosed block."""

    effects: tuple
    doubtful: tuple
    converged: bool | None
    inseparable: tuple = ()


def posterior_of(*, sd, interval, has_converged=True):
    """Stand for a posterior of a force."""
    return SimpleNamespace(
        converged=has_converged,
        spread_of=lambda _name: (sd, *interval),
        inseparable=lambda _names: (),
    )


FRICTION = find_effect("coulomb_friction")


def missing(probability=0.9, rivals=(), value=5.0):
    return MissingEffect(
        effect=FRICTION,
        probability=probability,
        estimates=(Estimate(name="force_n", meaning="friction force", value=value, sd=1.0, units="N"),),
        rivals=rivals,
        error_with=0.1,
        error_without=0.2,
    )


def test_the_gap_is_drawn_as_a_pair_of_bars_for_each_block():
    gaps = [
        SimpleNamespace(channel=name, before=b, after=a) for name, b, a in (("u", 0.3, 0.1), ("f", 0.5, 0.4))
    ]
    blocks = [
        SimpleNamespace(block=SimpleNamespace(block=name), gap=gap)
        for name, gap in zip("ab", gaps, strict=True)
    ]
    plot = Diagnosis.plot(SimpleNamespace(campaign=SimpleNamespace(name="rig"), blocks=blocks))
    bars_before, bars_after = plot.containers
    assert [(bar.get_center()[0], bar.get_height()) for bar in (*bars_before, *bars_after)] == [
        (pytest.approx(x), pytest.approx(100.0 * size))
        for x, size in ((-0.2, 0.3), (0.8, 0.5), (0.2, 0.1), (1.2, 0.4))
    ]
    assert (bars_before.get_label(), bars_after.get_label()) == ("before", "after")
    assert [label.get_text() for label in plot.get_xticklabels()] == ["a:\nu", "b:\nf"]
    assert (plot.get_ylabel(), plot.get_yscale(), plot.get_title()) == ("error [% of RMS]", "linear", "rig")
    assert [text.get_text() for text in plot.get_legend().get_texts()] == ["before", "after"]
    diagnosis = SimpleNamespace(campaign=SimpleNamespace(name="other"), blocks=blocks)
    assert Diagnosis.plot(diagnosis, plot) is plot
    assert plot.get_title() == "other"


@pytest.mark.parametrize(
    ("bars_after", "floor", "sentence"),
    [(0.2, 0.2, 1.0), (0.23, 0.2, 1.0), (0.25, 0.2, 0.9766), (0.03, 0.001, 0.999), (0.2, None, None)],
)
def test_gap_is_closed_only_at_the_noise(bars_after, floor, sentence):
    gap = Gap(
        channel="u",
        before=1.0,
        after=bars_after,
        floors={} if floor is None else {"at rest": floor},
        tests=(HeldOutTest(file="t", before=1.0, after=bars_after),),
    )
    assert gap.stated_share == (None if sentence is None else pytest.approx(sentence, abs=5e-5))


def test_a_diagnosis_is_a_table_of_verdict_effects_and_gap():
    gap = SimpleNamespace(channel="force_n", before=0.31, after=0.12)
    result = SimpleNamespace(
        campaign=SimpleNamespace(name="rig"), verdict="effects_found", all_effects=[missing()], gap=gap,
        remarks=["Look."],
    )  # fmt: skip
    text = Diagnosis._repr_html_(result)
    for words in (
        "effects found", "coulomb friction", "probability 0.9; friction force 5.0 N (3.4 to 6.6)", "Look.",
        "error on held-out tests, force_n", "31 % before, 12 % after",
    ):  # fmt: skip
        assert words in text


def test_parameter_spreads_as_far_as_its_models_differ():
    def stated(value, sd):
        return (Estimate(name="force_n", value=value, sd=sd, units="N"),)

    (single,) = widen_estimates(stated(5.0, 0.3), [(0.9, stated(5.0, 0.3))])
    assert (single.sd, single.between) == (pytest.approx(0.3), 0.0)
    (wide,) = widen_estimates(stated(5.0, 0.3), [(0.4, stated(5.0, 0.3)), (0.2, stated(7.0, 0.6))])
    square = (0.4 * 0.3**2 + 0.2 * (2.0**2 + 0.6**2)) / 0.6
    assert wide.value == 5.0
    assert wide.sd == pytest.approx(np.sqrt(square))
    assert wide.between == pytest.approx(np.sqrt(square - 0.3**2))


@pytest.mark.parametrize(("value", "is_told"), [(-40.0, True), (40.0, True), (60.0, False)])
def test_damper_below_half_of_stated_damping_may_be_that_damping(value, is_told):
    estimate = Estimate(name="damping_n_s_per_m", value=value, sd=1.0, units="N·s/m", signed=True)
    damper = replace(missing(0.98), effect=find_effect("viscous_damping"), estimates=(estimate,))
    result = or_stated_damping(damper, 100.0)
    assert result.probability == pytest.approx(0.49 if is_told else 0.98)
    assert [rival.name for rival in result.rivals] == ["structure_damping"] * is_told
    assert or_stated_damping(damper, 0.0) is damper  # where a rig tells them apart
    assert or_stated_damping(missing(), 100.0).rivals == ()  # no damper


def test_restated_damping_is_calibrated_with_both_uncertainties():
    """0.99 of the stated damping, less 30 of 200 N·s/m; errors of both parts that cancel widen nothing."""
    block = SimpleNamespace(
        calibrations=(structure_damping(0.01, 0.03),), removable={StatedDamping: 200.0}, offsets=()
    )
    space = SimpleNamespace(
        block=block, size=2, effects=(StatedDamping,), places=lambda _effect: slice(1, 2),
        bounds=(np.full(2, -10.0), np.full(2, 10.0)),
        values=lambda x: np.array([1.0 + 0.01 * x[0], 100.0 * x[1]]),
        standard_deviations=lambda _x, c: np.array([0.01, 100.0]) * np.sqrt(np.diag(c)),
        covariance_of_values=lambda _x, c: np.diag([0.01, 100.0]) @ c @ np.diag([0.01, 100.0]),
    )  # fmt: skip
    covariance = np.array([[1.0, -0.02], [-0.02, 0.0004 + 1e-4]])
    model_fit = SimpleNamespace(space=space, coordinates=np.array([-1.0, -0.3]), covariance=covariance)
    (is_told,) = calibration(model_fit, is_restated=True)
    assert (is_told.name, is_told.value) == ("structure_damping", pytest.approx(0.84))
    assert is_told.sd == pytest.approx(0.005, rel=1e-3)
    assert calibration(model_fit)[0].value == pytest.approx(0.99)


def test_special_form_is_stated_as_the_simple_effect_with_its_parameters():
    special = find_effect("degrading_hysteresis")
    values = [Estimate(name=p.name, value=1.0, sd=0.1, units=p.units) for p in special.parameters]
    effect = replace(missing(), effect=special, estimates=tuple(values), on_bounds=("slip", "gamma"))
    simple = find_effect("hysteresis")
    result = effect.report_as(simple)
    assert result.name == "hysteresis"
    assert result.to_dict()["member_of"] == "degrading_hysteresis"
    assert [item.name for item in result.estimates] == [p.name for p in simple.parameters]
    assert result.on_bounds == ("gamma",)


def test_sampled_interval_is_widened_by_differing_models():
    posterior = posterior_of(sd=0.6, interval=(4.0, 6.0))
    effect = missing(value=5.0)
    distant = replace(effect, estimates=(replace(effect.estimates[0], between=0.8),))
    result = _apply_posterior(Block(effects=(distant,), doubtful=(), converged=None), posterior)
    (estimate,) = result.effects[0].estimates
    reach = np.hypot(1.0, 1.645 * 0.8)
    assert estimate.sd == pytest.approx(1.0)
    assert estimate.interval == pytest.approx((5.0 - reach, 5.0 + reach))


@pytest.mark.parametrize(
    ("lower", "signed", "least"), [(-1e-9, True, 0.0), (-0.9, True, -0.5), (0.0, False, 0.0)]
)
def test_interval_ends_at_the_bounds_of_the_parameter(lower, signed, least):
    share = Estimate(name="share", value=0.0, sd=0.1, units="-", signed=signed, bounds=(lower, 1.0))
    assert share.within_bounds((-0.5, 2.0)) == (least, 1.0)


@pytest.mark.parametrize("rivals", [(), (Rival(name="hysteresis", probability=0.4, held_out_nrmse=0.2),)])
def test_an_effect_names_its_likeliest_rival_where_it_has_one(rivals):
    reference = remark(missing().name, 0.6, ("hysteresis", 0.4) if rivals else None)
    assert missing(0.6, rivals).remark == reference
    assert ("hysteresis" in reference) is bool(rivals)


@pytest.mark.parametrize(("value", "interval"), [(5.0, (4.0, 7.0)), (3.0, (3.0, 7.0)), (8.0, (4.0, 8.0))])
def test_a_sampled_parameter_keeps_its_value_within_its_interval(value, interval):
    posterior = posterior_of(sd=0.7, interval=(4.0, 7.0))
    block = Block(effects=(missing(value=value),), doubtful=(missing(0.3, value=value),), converged=None)
    result = _apply_posterior(block, posterior)
    assert result.converged is True
    for effect in (*result.effects, *result.doubtful):
        (estimate,) = effect.estimates
        assert (estimate.value, estimate.sd, estimate.interval) == (value, 0.7, interval)
    assert _apply_posterior(block, None) is block


def test_unconverged_posterior_still_gives_intervals():
    block = Block(effects=(missing(value=5.0),), doubtful=(), converged=None)
    result = _apply_posterior(block, posterior_of(sd=0.7, interval=(4.0, 7.0), has_converged=False))
    assert result.converged is False
    assert result.effects[0].estimates[0].interval == (4.0, 7.0)


@pytest.mark.parametrize("begin", [300, 2500])
def test_histories_are_compared_where_the_first_moves_most(monkeypatch, begin):
    monkeypatch.setattr(behaviour, "_MOST_SAMPLES", 1000)
    first = 1e-3 * np.random.default_rng(1).normal(size=4000)
    first[begin : begin + 900] += np.sin(0.3 * np.arange(900))
    here, there = behaviour._strongest(first, np.arange(5000.0))  # noqa: SLF001 - the part that is looked at
    assert here.size == there.size == 1000
    np.testing.assert_array_equal(here, first[int(there[0]) : int(there[0]) + 1000])
    assert there[0] <= begin + 20
    assert there[-1] >= begin + 880
