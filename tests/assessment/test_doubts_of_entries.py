"""Single entries of a matrix: the largest error that they allow decides whether a test is reliable."""

from types import SimpleNamespace
from typing import Any

from reliab.assessment.doubts import doubt_entries
from reliab.assessment.verdict import Verdict, Word

RELIABLE = Verdict(word=Word.RELIABLE, reasons=("small",), would_decide=())


def error(
    threshold: float = 0.05,
    unknown: tuple[str, ...] = ("frequency", "stiffness_entry_1_1"),
    evidence: tuple[Any, ...] | None = None,
) -> Any:
    """An error of which one draw is 6 %."""
    inferred = SimpleNamespace(
        posterior=SimpleNamespace(evidence=evidence or ()), sizes=dict.fromkeys(unknown, 0.02)
    )
    return SimpleNamespace(
        largest_drawn=0.06,
        threshold=threshold,
        inferred=None if evidence is None else inferred,
        rebuilt=SimpleNamespace(inferred=inferred),
    )


def test_one_structure_with_too_large_an_error_leaves_the_test_undecided():
    doubt = doubt_entries(RELIABLE, error())
    assert doubt.word is Word.UNDECIDED
    assert "6 %" in doubt.reasons[0]
    assert "natural frequencies" in doubt.would_decide[0]
    assert doubt_entries(RELIABLE, error(evidence=())).word is Word.UNDECIDED


def test_nothing_is_doubted_without_entries_or_without_such_a_structure():
    assert doubt_entries(RELIABLE, error(unknown=("frequency", "storey_stiffness_1"))) is RELIABLE
    assert doubt_entries(RELIABLE, error(threshold=0.07)) is RELIABLE
    assert doubt_entries(RELIABLE, error(evidence=("implied ground motion",))) is RELIABLE
    refusal = Verdict(word=Word.NOT_RELIABLE, reasons=("large",), would_decide=())
    assert doubt_entries(refusal, error()) is refusal
