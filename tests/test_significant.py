"""Numbers of sentences: rounded, and never with a power of ten where people write none."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest
from parsed import nodes

import reliab
from reliab.core.significant_digits import percent, significant

ORDINARY = [*np.geomspace(0.01, 1000.0, 400).tolist(), 0.995, 9.96, 99.5, 99.96, 999.5, 999.96, 1000.0]


@pytest.mark.parametrize("digits", [1, 2, 3, 4])
def test_ordinary_numbers_have_no_power_of_ten(digits):
    for value in (*ORDINARY, *(-value for value in ORDINARY)):
        text = significant(value, digits)
        assert "e" not in text
        assert float(text) == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits))
        assert "e" not in percent(value, digits)


def test_the_whole_is_a_hundred_per_cent():
    assert (percent(1.0, 2), percent(0.999, 2), percent(1.0, 1)) == ("100 %", "100 %", "100 %")


def test_very_small_and_large_numbers_keep_their_power_of_ten():
    assert (significant(5.29e-5), significant(3.2e9), significant(0.0)) == ("5.29e-05", "3.2e+09", "0")


def test_no_sentence_is_written_past_it():
    """A format such as `.2g` writes 99.6 as 1e+02."""
    stray = [
        f"{path}:{node.lineno}"
        for path in sorted(Path(reliab.__file__).parent.rglob("*.py"))
        if path.name != "significant.py"
        for node in nodes(path)
        if isinstance(node, ast.FormattedValue) and node.format_spec is not None
        if re.search(r"\.([0-3]|\{digits\})g", ast.unparse(node.format_spec))
    ]
    assert stray == []
