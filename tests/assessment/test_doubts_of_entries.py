"""Single entries of a matrix: the largest error that they allow decides whether a test is reliable."""

import numpy as np

from reliab.assessment.doubts import doubted_by_entries
from reliab.assessment.verdict import Verdict, Word

RELIABLE = Verdict(word=Word.RELIABLE, reasons=("small",), would_decide=())
ERRORS = np.array([0.01, 0.02, 0.06])
ENTRY = ("frequency", "stiffness_entry_1_1")


def test_one_structure_with_too_large_an_error_leaves_the_test_undecided():
    doubted = doubted_by_entries(RELIABLE, ENTRY, ERRORS, 0.05, learned=False)
    assert doubted.word is Word.UNDECIDED
    assert "6.00 %" in doubted.reasons[0]
    assert "natural frequencies" in doubted.would_decide[0]


def test_nothing_is_doubted_without_entries_or_without_such_a_structure():
    assert (
        doubted_by_entries(RELIABLE, ("frequency", "storey_stiffness_1"), ERRORS, 0.05, learned=False)
        is RELIABLE
    )
    assert doubted_by_entries(RELIABLE, ENTRY, ERRORS, 0.07, learned=False) is RELIABLE
    assert doubted_by_entries(RELIABLE, ENTRY, ERRORS, 0.05, learned=True) is RELIABLE
    refused = Verdict(word=Word.NOT_RELIABLE, reasons=("large",), would_decide=())
    assert doubted_by_entries(refused, ENTRY, ERRORS, 0.05, learned=False) is refused
