"""No sentence on a diagnosis contradicts the numbers that stand beside it, whatever these are."""

import re
from types import SimpleNamespace

import pytest
from hypothesis import given, strategies as st

from reliab.cli.diagnose import _proved
from reliab.discrepancy import Gap, Verdict
from reliab.discrepancy.naming import unexplained
from reliab.discrepancy.result.diagnosis import remainder_statement, statement
from reliab.discrepancy.result.gap import Remainder
from reliab.report.kinds.discrepancy.report import _closed, _floor
from reliab.vocabulary import Block

UNCERTAINTY, PRINTED = 1.2, 1.01
SOURCES = ("repeated tests", "repeated cycles", "band above the motion", "rest")
SIZES = st.floats(1e-5, 1.5)


@st.composite
def gaps(draw):
    """Errors and floors of any sizes, most of them near each other."""
    after = draw(SIZES)
    sizes = st.one_of(SIZES, st.floats(0.2, 5.0).map(lambda times: times * after))
    floors = draw(st.dictionaries(st.sampled_from(SOURCES), sizes, max_size=3))
    before = draw(st.one_of(SIZES, st.just(after)))
    return Gap(
        held_out=("a.csv",),
        channel="force_n",
        before=before,
        after=after,
        floors=floors,
        tests_before={"a.csv": before},
        tests_after={"a.csv": after},
    )


@st.composite
def blocks(draw):
    return SimpleNamespace(
        gap=draw(gaps()),
        leaves_noise=draw(st.booleans()),
        structured_share=draw(st.floats(0.02, 1.0)),
        block=SimpleNamespace(block=Block.SPECIMEN, channel="force_n"),
    )


def numbers(text):
    return [float(one) for one in re.findall(r"\d+\.?\d*(?:e-?\d+)?", text)]


@given(gaps())
def test_a_floor_is_never_far_above_what_the_model_leaves(gap):
    floor, after = gap.to_dict()["noise_floor"], gap.to_dict()["nrmse_after"]
    assert floor is None or floor <= UNCERTAINTY * after
    assert (floor is None) == all(size > UNCERTAINTY * after for size in gap.floors.values())


@given(blocks())
def test_what_remains_is_called_an_error_only_where_it_stands_above_the_noise(block):
    said = remainder_statement("specimen", block.gap, block.structured_share)
    after, *others = numbers(said)
    assert after > 0.0
    if "the model's own error" in said:
        error, floor = others[:2]
        assert 0.0 < error <= PRINTED * after
        assert floor < after
    elif "which is the noise floor" in said:
        assert after <= PRINTED * UNCERTAINTY * others[0]
    else:
        assert "unknown" in said
        assert block.gap.floor is None


@given(blocks())
def test_the_report_calls_no_more_noise_than_remains(block):
    said = _floor(block)
    said = said if isinstance(said, str) else str(said)
    if "no model can explain" in said:
        floor, left = numbers(said)[:2]
        assert 0.0 < floor < PRINTED * 100.0 * block.gap.after
        assert 0.0 < left <= PRINTED * 100.0 * block.gap.after
    elif "at the noise" in said:
        after, floor = numbers(said)[:2]
        assert after <= PRINTED * UNCERTAINTY * floor


@given(st.lists(blocks(), min_size=1, max_size=3), st.sampled_from(Verdict))
def test_nothing_is_missing_only_where_every_block_is_at_its_noise(observed, verdict):
    said = statement(verdict, observed)
    if "nothing is missing" in said:
        assert verdict is Verdict.NO_MISSING_EFFECT
        for block in observed:
            floor = block.gap.floor
            assert block.leaves_noise if floor is None else block.gap.after <= UNCERTAINTY * floor


@given(blocks())
def test_a_gap_is_wholly_closed_only_at_the_noise(block):
    wholly = "100.0 % of the gap closed" in _proved(block)
    closes = "closes to the noise" in _closed(SimpleNamespace(gap=block.gap))
    assert not (wholly or closes) or block.gap.remainder is Remainder.AT_NOISE
    if block.gap.remainder is Remainder.NOT_KNOWN:
        assert "noise not known" in _proved(block)


@pytest.mark.parametrize(("times", "missing"), [(1.0, False), (1.5, False), (3.0, True), (10.0, True)])
def test_three_times_the_noise_is_something_missing(times, missing):
    gap = Gap(
        held_out=("a.csv",),
        channel="force_n",
        before=0.005 * times,
        after=0.005 * times,
        floors={"rest": 0.005},
        tests_before={},
        tests_after={},
    )
    problem = SimpleNamespace(block=SimpleNamespace(block=Block.SPECIMEN, channel="force_n"))
    model = SimpleNamespace(space=SimpleNamespace(effects=()))
    found = unexplained._remainder(problem, model, gap)  # noqa: SLF001 - what is tested
    assert (found is not None) is missing
