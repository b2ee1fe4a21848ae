"""What remains: of a balanced force only where models are judged, and how much where effects are named."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.naming import unexplained
from reliab.discrepancy.result.gap import Gap, HeldOutTest
from reliab.effects.cubic_stiffness import CubicStiffness

GAP = SimpleNamespace(floor=None, after=0.16, model_error=0.16)
MODEL = SimpleNamespace(space=SimpleNamespace(effects=(CubicStiffness,)), coordinates=None)


def problem(block, error):
    """A problem in which a model leaves an error over the signal at the judged frequencies."""
    signal = np.array([0.0, 3.0, 4.0])
    return SimpleNamespace(
        block=SimpleNamespace(block=block, channel=Channel.FORCE, rate=100.0),
        segments=[SimpleNamespace(test=0, spectrum=lambda values: values)],
        measured=lambda _test: signal,
        whiten=lambda *_: error * np.sqrt(2.0) * signal,
    )


@pytest.mark.parametrize(
    ("block", "error", "large"),
    [(Block.NUMERICAL, 0.01, False), (Block.NUMERICAL, 0.15, True), (Block.SPECIMEN, 0.01, True)],
)
def test_a_rough_command_is_no_missing_effect(block, error, large):
    result = unexplained._is_large(problem(block, error), MODEL, GAP)  # noqa: SLF001 - what is tested
    assert result is large


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
    verdict = problem(Block.NUMERICAL, 0.0), MODEL
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
