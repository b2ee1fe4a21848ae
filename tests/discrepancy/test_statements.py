"""No sentence on a diagnosis contradicts the numbers that stand beside it, whatever these are."""

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from reliab.core.vocabulary import Block
from reliab.discrepancy.naming import unexplained
from reliab.discrepancy.naming.naming import offset_odds
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Verdict
from reliab.discrepancy.result.diagnosis import (
    contradiction,
    linear_statement,
    one_of_two,
    remainder_statement,
    scale_of_displacement,
    statement,
)
from reliab.discrepancy.result.gap import Gap, HeldOutTest, Remainder
from reliab.discrepancy.result.missing_effect import Estimate
from reliab.report.kinds.discrepancy_outcome import _describe_closed_gap, describe_remainder
from reliab.report.prose import plain_text

UNCERTAINTY, ROUNDING = 1.2, 1.01
SOURCES = ("repeated tests", "repeated cycles", "band above the motion", "rest")
SIZES = st.floats(1e-5, 1.5)


@st.composite
def gaps(draw):
    """Errors and floors of any sizes, most of them near each other."""
    error_after = draw(SIZES)
    sizes = st.one_of(SIZES, st.floats(0.2, 5.0).map(lambda times: times * error_after))
    floors = draw(st.dictionaries(st.sampled_from(SOURCES), sizes, max_size=3))
    error_before = draw(st.one_of(SIZES, st.just(error_after)))
    return Gap(
        channel="force_n",
        before=error_before,
        after=error_after,
        floors=floors,
        tests=(HeldOutTest(file="a.csv", before=error_before, after=error_after),),
    )


@st.composite
def blocks(draw):
    return SimpleNamespace(
        gap=draw(gaps()),
        leaves_noise=draw(st.booleans()),
        structured_share=draw(st.floats(0.02, 1.0)),
        misstated=(),
        either_misstated=(),
        held_out="a.csv",
        block=SimpleNamespace(block=Block.SPECIMEN, channel="force_n"),
    )


def numbers(text):
    return [float(number) for number in re.findall(r"\d+\.?\d*(?:e-?\d+)?", text)]


@given(gaps())
def test_floor_is_never_far_above_the_remainder(gap):
    floor, error_after = gap.to_dict()["noise_floor"], gap.to_dict()["nrmse_after"]
    assert floor is None or floor <= UNCERTAINTY * error_after
    assert (floor is None) == all(size > UNCERTAINTY * error_after for size in gap.floors.values())


@given(blocks())
def test_remainder_is_an_error_only_above_the_noise(block):
    sentence = remainder_statement("specimen", block.gap, block.structured_share)
    error_after, *remaining = numbers(sentence)
    assert error_after > 0.0
    if "the model's own error" in sentence:
        error, floor = remaining[:2]
        assert 0.0 < error <= ROUNDING * error_after
        assert floor < error_after
    elif "which is the noise floor" in sentence:
        assert error_after <= ROUNDING * UNCERTAINTY * remaining[0]
    else:
        assert "unknown" in sentence
        assert block.gap.floor is None


@pytest.mark.slow
@given(blocks())
def test_the_report_calls_no_more_noise_than_remains(block):
    sentence = describe_remainder(block)
    sentence = sentence if isinstance(sentence, str) else str(sentence)
    if "no model explains" in sentence:
        floor, remainder = numbers(sentence)[:2]
        assert 0.0 < floor < ROUNDING * 100.0 * block.gap.after
        assert 0.0 < remainder <= ROUNDING * 100.0 * block.gap.after
    elif "at the level of the noise" in sentence:
        error_after, floor = numbers(sentence)[:2]
        assert error_after <= ROUNDING * UNCERTAINTY * floor


@given(st.lists(blocks(), min_size=1, max_size=3), st.sampled_from(Verdict))
def test_nothing_is_missing_only_where_every_block_is_at_its_noise(observed, verdict):
    sentence = statement(verdict, observed)
    if "no missing effect" in sentence:
        assert verdict is Verdict.NO_MISSING_EFFECT
        for block in observed:
            floor = block.gap.floor
            assert block.leaves_noise if floor is None else block.gap.after <= UNCERTAINTY * floor


@given(blocks())
def test_a_gap_is_wholly_closed_only_at_the_noise(block):
    block.effects, block.unknown = (), None
    sentence = _describe_closed_gap(SimpleNamespace(gap=block.gap, blocks=[block], effects=(), unknown=None))
    assert block.gap.conclusion in sentence
    wholly = "100.0 % of the gap closed" in sentence or "at the level of the noise" in sentence
    assert not wholly or block.gap.is_noise_before or block.gap.remainder is Remainder.AT_NOISE
    if block.gap.remainder is Remainder.NOT_KNOWN:
        assert "of the error is noise" in plain_text(describe_remainder(block))


@pytest.mark.parametrize(("times", "missing"), [(1.0, False), (1.5, False), (3.0, True), (10.0, True)])
def test_three_times_the_noise_is_something_missing(times, missing):
    gap = Gap(
        channel="force_n",
        before=0.005 * times,
        after=0.005 * times,
        floors={"rest": 0.005},
        tests=(HeldOutTest(file="a.csv", before=0.005 * times, after=0.005 * times),),
    )
    block = SimpleNamespace(is_narrow=False)
    assert unexplained._is_large(block, gap) is missing  # noqa: SLF001 - what is tested


def a_gap(**errors):
    """A gap of held-out tests, by file: kind, error before and after."""
    return Gap(
        channel="force_n",
        before=0.5,
        after=0.1,
        floors={},
        tests=tuple(
            HeldOutTest(file=file, kind=kind, before=error_before, after=error_after)
            for file, (kind, error_before, error_after) in errors.items()
        ),
    )


def test_the_least_explained_kind_of_test_and_the_least_explained_test_come_first():
    gap = a_gap(a=("sine", 0.5, 0.05), b=("sine", 0.5, 0.2), c=("irregular motion", 0.4, 0.3))
    assert [kind.kind for kind in gap.by_kind] == ["irregular motion", "sine"]
    assert [test.files for test in gap.by_test] == [("c",), ("b",), ("a",)]
    assert gap.by_test[0].unexplained_share == pytest.approx(0.3**2 / 0.4**2)
    assert gap.by_kind[1].unexplained_share == pytest.approx((0.05**2 + 0.2**2) / (2.0 * 0.5**2))
    content = gap.to_dict()
    assert list(content["tests"]) == ["c", "b", "a"]
    assert content["kinds"][0]["tests"] == ["c"]


def test_a_floor_is_a_larger_share_of_a_weaker_test():
    gap = replace(a_gap(a=("sine", 0.5, 0.1), b=("sine", 0.5, 0.1)), floors={"rest": 0.02})
    weak = replace(gap, tests=(gap.tests[0], replace(gap.tests[1], size=0.25))).by_test
    assert {test.files[0]: test.noise for test in weak} == pytest.approx({"a": 0.02, "b": 0.08})


@pytest.mark.parametrize(("error_after", "is_named"), [(0.21, True), (0.24, False)])
def test_effects_are_the_answer_where_they_explain_four_fifths_of_every_kind_of_test(error_after, is_named):
    """An earthquake stands at 0.21 or 0.24 of the signal, of 0.5, where sines are explained wholly."""
    gap = a_gap(a=("sine", 0.5, 0.01), b=("sine", 0.5, 0.01), c=("irregular motion", 0.5, error_after))
    assert unexplained.explains_enough(gap) is is_named


@pytest.mark.parametrize(("floor", "is_named"), [(0.0055, True), (0.0045, False), (None, False)])
def test_half_closed_small_gap_is_named_only_near_the_noise(floor, is_named):
    """From 0.02 to 0.01 of the signal: with a floor of 0.0055 a fifth of the energy above it remains."""
    floors = {} if floor is None else {"repeated tests": floor}
    gap = replace(a_gap(a=("sine", 0.02, 0.01)), before=0.02, after=0.01, floors=floors)
    assert unexplained.explains_enough(gap) is is_named


def test_remainder_is_described_by_its_looks():
    remainder = [
        SimpleNamespace(kind="frequency_band", detail="In force_n of the specimen X.", share_of_residual=0.9),
        SimpleNamespace(kind="velocity", detail="In force_n of the specimen Y.", share_of_residual=0.42),
    ]
    assert unexplained._looks(remainder) == "; 42 % of it: In force_n of the specimen Y"  # noqa: SLF001 - what is tested


@pytest.mark.parametrize("verdict", Verdict)
def test_contradictions_come_first(verdict):
    mass = Estimate(name="structure_mass", value=1.0312, sd=0.0003, units="-", signed=True)
    gap = Gap(
        channel="force_n",
        before=0.01,
        after=0.01,
        floors={},
        tests=(HeldOutTest(file="a", before=0.01, after=0.01),),
    )
    block = SimpleNamespace(gap=gap, leaves_noise=True, misstated=(mass,), either_misstated=())
    assert statement(verdict, [block]).startswith(
        "The tests did not run with what was stated (mass 1.031 times). "
    )
    assert "1.031 ± 0.0003 times the stated one: check the table [structure]" in contradiction(mass)


@pytest.mark.parametrize(
    ("gain", "stiffness", "statement"), [(1.1, 1.0 / 1.1, 1), (1.1, 1.0, 0), (1.1, 0.8, 0), (1.002, 0.9, 0)]
)
def test_displacement_scale_behind_gain_and_stiffness_is_said(gain, stiffness, statement):
    estimates = {
        name: Estimate(name=name, value=value, sd=1e-4, units="-", signed=True)
        for name, value in (("gain", gain), ("stiffness", stiffness))
    }
    blocks = [
        SimpleNamespace(calibration=(estimates["gain"],), misstated=()),
        SimpleNamespace(
            calibration=(estimates["stiffness"],),
            misstated=(estimates["stiffness"],) if stiffness != 1.0 else (),
        ),
    ]
    sentences = scale_of_displacement(blocks)
    assert len(sentences) == statement
    assert all("recorded 1.1 times too large" in sentence for sentence in sentences)


def test_one_of_two_stated_values_is_said_to_be_wrong():
    frequency = Estimate(name="structure_frequency", value=0.9806, sd=0.0001, units="-", signed=True)
    mass = Estimate(name="structure_mass", value=1.029, sd=0.0002, units="-", signed=True)
    sentence = one_of_two((frequency, mass))
    assert "natural frequency of 0.9806 ± 0.0001 or a mass of 1.029 ± 0.0002 times" in sentence
    assert "do not tell which" in sentence


def structure_of(frequency, mass, *, correlation):
    """A block whose tests tell a combination of frequency and mass, to a thousandth, and `alike` of another.

    Along the combination (1, -1) a change of both leaves the tests the same.
    """
    common_direction, untold = np.array([1.0, 1.0]) / np.sqrt(2.0), np.array([1.0, -1.0]) / np.sqrt(2.0)
    covariance = 1e-8 * np.outer(common_direction, common_direction) + correlation**2 * np.outer(
        untold, untold
    )
    names = ("structure_frequency", "structure_mass")
    block = SimpleNamespace(
        calibrations=[SimpleNamespace(parameter=SimpleNamespace(name=name)) for name in names]
    )
    space = SimpleNamespace(
        values=lambda _x: np.array([frequency, mass]), covariance_of_values=lambda _x, _c: covariance
    )
    result = object.__new__(BlockDiagnosis)
    object.__setattr__(result, "problem", SimpleNamespace(block=block, flat=False))
    fit = SimpleNamespace(space=space, coordinates=None, covariance=None)
    object.__setattr__(result, "believed", SimpleNamespace(fit=fit))
    sds = np.sqrt(np.diag(covariance))
    items = [
        Estimate(name=name, value=value, sd=float(sd), units="-", signed=True)
        for name, value, sd in zip(names, (frequency, mass), sds, strict=True)
    ]
    object.__setattr__(result, "calibration", tuple(items))
    return result


def test_best_linear_model_is_stated_with_values_and_remainder():
    values = (("stiffness over its nominal value", 1.25, "-"), ("moving mass", 0.5, "kg"))
    linear = tuple(
        Estimate(name="", meaning=meaning, value=value, sd=0.1, units=units)
        for meaning, value, units in values
    )
    block = SimpleNamespace(linear=linear, gap=SimpleNamespace(linear=0.427))
    assert linear_statement("specimen", block) == (
        "The best linear model of the specimen leaves 42.7 % of the signal on held-out tests: stiffness over "
        "its nominal value 1.25 (1.09 to 1.41), moving mass 0.50 kg (0.34 to 0.66)."
    )


def test_frequency_and_mass_contradict_only_together():
    result = structure_of(1.01, 1.01, correlation=0.01)
    assert result.misstated == ()
    assert [item.value for item in result.either_misstated] == pytest.approx([1.02, 1.02], abs=1e-3)


def test_values_as_stated_or_clear_raise_no_doubt():
    assert (
        structure_of(1.01, 0.99, correlation=0.01).either_misstated == ()
    )  # along what the tests do not tell
    assert (
        structure_of(1.002, 1.002, correlation=0.01).either_misstated == ()
    )  # within what goes without a remark
    clear = structure_of(1.02, 1.0, correlation=0.001)
    assert [item.name for item in clear.misstated] == ["structure_frequency"]
    assert clear.either_misstated == ()


@pytest.mark.parametrize(
    ("sd", "signed", "size"),
    [
        (580_611.0, False, "not determined"),
        (580_611.0, True, "9 kN/m (−946 to 964)"),
        (40.0, False, "8933 N/m (8867 to 8999)"),
    ],
)
def test_undetermined_parameter_is_not_shown_as_a_number(sd, signed, size):
    estimate = Estimate(name="stiffness_n_per_m", value=8933.0, sd=sd, units="N/m", signed=signed)
    assert estimate.size == size
    assert estimate.to_dict()["determined"] is (size != "not determined")


@pytest.mark.parametrize("stretches", [1, 2, 3])
def test_line_exceeds_the_one_in_ten_million_level_of_noise(stretches):
    """The mean of some squares of noise is Erlang's; the chance is shared among the frequencies tried."""
    trials = 500
    level = stretches * unexplained._threshold(stretches, trials)  # noqa: SLF001 - what is tested
    terms = (level**k / math.factorial(k) for k in range(stretches))
    assert math.exp(-level) * sum(terms) == pytest.approx(1e-7 / trials, rel=1e-6)


def test_a_line_stands_eight_times_above_its_surroundings_in_any_number_of_stretches():
    assert unexplained._threshold(200, 500) == 8.0  # noqa: SLF001 - what is tested


@pytest.mark.parametrize(("value", "deviation"), [(0.3, 0.1), (0.02, 0.01), (5.0, 2.0)])
def test_odds_of_an_offset_are_those_of_savage_and_dickey(value, deviation):
    """Density of the prior over that of the posterior at zero, less what a parameter costs."""
    model_fit = SimpleNamespace(
        covariance=np.diag([9.0, deviation**2]),
        coordinates=np.array([7.0, value]),
        space=SimpleNamespace(places=lambda _offset: slice(1, 2)),
    )
    reference = 0.5 * (value / deviation) ** 2 + math.log(deviation) - 4.0
    assert offset_odds(model_fit, type) == pytest.approx(reference)
