"""Single entries of a matrix: the largest error that they allow decides whether a test is reliable."""

from types import SimpleNamespace
from typing import Any

from reliab.assessment.checks import check_matrix_entries
from reliab.assessment.verdict import Word


def judged(
    threshold: float = 0.05,
    unknown: tuple[str, ...] = ("frequency", "stiffness_entry_1_1"),
    evidence: tuple[Any, ...] | None = None,
    word: Word = Word.RELIABLE,
) -> Any:
    """A test of whose error one draw is 6 %."""
    inferred = SimpleNamespace(
        posterior=SimpleNamespace(evidence=evidence or ()), sizes=dict.fromkeys(unknown, 0.02)
    )
    error = SimpleNamespace(
        largest_drawn=0.06,
        threshold=threshold,
        inferred=None if evidence is None else inferred,
        rebuilt=SimpleNamespace(inferred=inferred),
    )
    return SimpleNamespace(error=error, judgement=SimpleNamespace(word=word))


def test_one_structure_with_too_large_an_error_leaves_the_test_undecided():
    (doubt,) = check_matrix_entries(judged())
    assert "6 %" in doubt.finding
    assert "natural frequencies" in doubt.remedy
    assert len(list(check_matrix_entries(judged(evidence=())))) == 1


def test_nothing_is_doubted_without_entries_or_without_such_a_structure():
    assert not list(check_matrix_entries(judged(unknown=("frequency", "storey_stiffness_1"))))
    assert not list(check_matrix_entries(judged(threshold=0.07)))
    assert not list(check_matrix_entries(judged(evidence=("implied ground motion",))))
    assert not list(check_matrix_entries(judged(word=Word.NOT_RELIABLE)))
