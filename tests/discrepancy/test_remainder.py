"""What remains: of a balanced force only where models are judged, and how much where effects are named."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.balance import NumericalBlock
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.naming import unexplained
from reliab.discrepancy.proof import compute_nrmse
from reliab.discrepancy.result.gap import Gap, HeldOutTest
from reliab.discrepancy.segment import Segment
from reliab.effects.cubic_stiffness import CubicStiffness

MODEL = SimpleNamespace(space=SimpleNamespace(effects=(CubicStiffness,)), coordinates=None)
RATE, HIGHEST = 200.0, 45.0


def block_of(*, is_narrow):
    return SimpleNamespace(
        block=Block.NUMERICAL,
        channel=Channel.FORCE,
        rate=RATE,
        is_narrow=is_narrow,
        measured=lambda _test: np.sin(2.0 * np.pi * np.arange(400) / RATE),
    )


@pytest.mark.parametrize(("is_narrow", "error"), [(True, 0.0), (False, 0.5)])
def test_rough_derivatives_of_a_command_are_no_error_of_a_model(is_narrow, error):
    """A force that balances a command counts at the frequencies at which models are judged."""
    segment = Segment(test=0, begin=0, end=400, rate=RATE, highest=HIGHEST)
    proof = SimpleNamespace(block=block_of(is_narrow=is_narrow), segments=(segment,))
    above = 0.5 * np.sin(2.0 * np.pi * 60.0 * np.arange(400) / RATE)
    assert compute_nrmse(proof, {0: above}) == pytest.approx(error, abs=1e-9)
    assert NumericalBlock.is_narrow


@pytest.mark.parametrize(
    ("is_narrow", "error", "large"), [(True, 0.05, False), (False, 0.05, True), (True, 0.15, True)]
)
def test_floor_of_all_frequencies_is_none_of_a_narrow_block(is_narrow, error, large):
    gap = SimpleNamespace(floor=0.01, after=error, model_error=error)
    assert unexplained._is_large(block_of(is_narrow=is_narrow), gap) is large  # noqa: SLF001 - what is tested


def gap_of(error, *, noise_like=()):
    """A gap of two kinds of held-out test, of which the effects leave 0.1 and an error of the signal."""
    return Gap(
        channel="force_n", before=1.0, after=error, floors={},
        tests=tuple(
            HeldOutTest(file=kind, kind=kind, before=1.0, after=error_after, noise_like=kind in noise_like)
            for kind, error_after in (("sine", 0.1), ("sweep", error))
        ),
    )  # fmt: skip


@pytest.mark.parametrize("size", [1.0, 1e-3])
@pytest.mark.parametrize(("error", "enough"), [(0.2**0.5 - 0.01, True), (0.2**0.5 + 0.01, False)])
def test_named_leaves_a_fifth_of_the_worst_kind_of_test_at_most(monkeypatch, error, enough, size):
    for second in ("standstill", "line_above"):
        monkeypatch.setattr(unexplained, second, lambda *_: None)
    gap = gap_of(error)
    gap = replace(
        gap,
        tests=tuple(replace(test, before=size * test.before, after=size * test.after) for test in gap.tests),
    )
    verdict = SimpleNamespace(block=block_of(is_narrow=True)), MODEL
    for remaining in (None, ()):
        result = unexplained.find_unexplained(
            verdict, MODEL, (), gap, remaining, is_named=True, comparison=""
        )
        assert (result is None) is enough
        assert (gap.worst_unexplained_share <= unexplained.LARGEST_REMAINDER) is enough


def test_noise_like_remainder_is_explained_up_to_twice_the_floor():
    for floor, enough in ((0.5, True), (0.2, False)):
        gap = replace(gap_of(0.9, noise_like=["sweep"]), floors={"rest": floor})
        assert unexplained.explains_enough(gap) is enough
