"""Numbers in sentences, and stated values."""

import ast
import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from parsed import nodes

import reliab
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, percent_with_interval, significant, value_and_interval
from reliab.core.stated_value import StatedValue

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
        if path.name != "significant_digits.py"
        for node in nodes(path)
        if isinstance(node, ast.FormattedValue) and node.format_spec is not None
        if re.search(r"\.([0-3]|\{digits\})g", ast.unparse(node.format_spec))
    ]
    assert stray == []


@given(
    value=st.floats(-1e3, 1e3),
    lower=st.floats(1e-3, 1e3),
    upper=st.floats(1e-3, 1e3),
)
def test_digits_of_a_value_follow_its_interval(value, lower, upper):
    """Rounding moves no number by more than a tenth of the shorter side."""
    low, high = value - lower, value + upper
    shorter = min(value - low, high - value)
    contents, interval = value_and_interval(value, low, high)
    for number, text in zip((value, low, high), (contents, *interval.split(" to ")), strict=True):
        assert abs(float(text) - number) <= max(0.1 * shorter, 0.5 if "." not in text else 0.0) + 1e-9
    decimals = len(contents.partition(".")[2])
    assert decimals == 0 or 10.0**-decimals > 0.01 * shorter


@pytest.mark.parametrize(
    ("value", "low", "high", "written"),
    [
        (0.0224, 0.0072, 0.0435, "2.2 % (0.7 to 4.3 %)"),
        (0.0601, 0.0201, 0.1192, "6.0 % (2.0 to 11.9 %)"),
        (0.011069, 0.011049, 0.011086, "1.11 % (1.10 to 1.11 %)"),
        (0.0123, 0.0123, 0.0123, "1.23 % (1.23 to 1.23 %)"),
    ],
)
def test_digits_of_an_error_follow_its_interval(value, low, high, written):
    assert percent_with_interval(value, low, high) == written


IN_A_LOCALE_WITHOUT_UTF_8 = "1±0.01".encode().decode("ascii", "surrogateescape")


@pytest.mark.parametrize(
    "text",
    [
        *("1±0.01", "1 ± 0.01", "1+-0.01", "1+/-0.01", "1 +/- 1e-2", "1±1%", "1+-1 %", "1,0.01", "1, 0.01"),
        *("1.0,0.01", "1,1.0%", ".1e1,.01", IN_A_LOCALE_WITHOUT_UTF_8),
    ],
)
def test_every_way_of_writing_it_gives_the_same(text):
    assert StatedValue.parse(text) == StatedValue(1.0, 0.01)


@pytest.mark.parametrize(
    "text",
    [
        *("1,5", "0,02", "1,5e-1", "1,", ",1.0", "1,0.01,0.02", "1,-0.01", "1,5±0.1", "1.5,2", "1.000,5"),
        *("", "±", "1±", "±0.01", "1±-0.01", "1±nan", "inf", "1e999", "1..0", "1±0.01\udcc2", "1\ud8000.01"),
    ],
)
def test_ambiguous_values_are_refused(text):
    with pytest.raises(InputError, match="is no number"):
        StatedValue.parse(text)


@pytest.mark.slow
@given(
    value=st.just(0.0) | st.floats(1e-30, 1e6) | st.floats(-1e6, -1e-30),
    deviation=st.just(0.0) | st.floats(1e-30, 1e3),
    sign=st.sampled_from(["±", "+-", "+/-", ", "]),
)
def test_any_number_comes_back(value, deviation, sign):
    text = f"{value:.12e}{sign}{deviation:.6e}"
    result = StatedValue.parse(text)
    assert math.isclose(result.value, value, rel_tol=1e-10)
    assert math.isclose(result.deviation, deviation, rel_tol=1e-5)
