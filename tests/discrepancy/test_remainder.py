"""An error of the balanced force is a missing effect only at frequencies at which models are judged."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.naming import unexplained
from reliab.vocabulary import Block

PROVED = SimpleNamespace(
    by_kind=(SimpleNamespace(unexplained_share=0.99, model_error=0.16, after=0.16, noise=0.0),),
    after=0.16,
    model_error=0.16,
)
MODEL = SimpleNamespace(space=SimpleNamespace(effects=("any",)), coordinates=None)


def problem(block, error):
    """A problem in which a model leaves an error over the signal at the judged frequencies."""
    signal = np.array([0.0, 3.0, 4.0])
    return SimpleNamespace(
        block=SimpleNamespace(block=block, channel=Channel.FORCE, rate=100.0),
        segments=[SimpleNamespace(test=0, spectrum=lambda values: values)],
        measured=lambda _test: signal,
        whitened=lambda *_: error * np.sqrt(2.0) * signal,
    )


@pytest.mark.parametrize(
    ("block", "error", "unknown"),
    [(Block.NUMERICAL, 0.01, False), (Block.NUMERICAL, 0.15, True), (Block.SPECIMEN, 0.01, True)],
)
def test_a_rough_command_is_no_missing_effect(block, error, unknown):
    stated = unexplained._remainder(problem(block, error), MODEL, PROVED)  # noqa: SLF001 - what is tested
    assert (stated is not None) is unknown
