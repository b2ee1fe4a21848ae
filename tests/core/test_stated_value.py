"""A number with its standard deviation is read as it was meant, or refused."""

import math

import pytest
from hypothesis import given, strategies as st

from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue

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
def test_what_may_mean_something_else_is_refused(text):
    with pytest.raises(InputError, match="is no number"):
        StatedValue.parse(text)


@pytest.mark.slow
@given(
    value=st.just(0.0) | st.floats(1e-30, 1e6) | st.floats(-1e6, -1e-30),
    deviation=st.just(0.0) | st.floats(1e-30, 1e3),
    sign=st.sampled_from(["±", "+-", "+/-", ", "]),
)
def test_any_number_comes_back(value, deviation, sign):
    written = f"{value:.12e}{sign}{deviation:.6e}"
    found = StatedValue.parse(written)
    assert math.isclose(found.value, value, rel_tol=1e-10)
    assert math.isclose(found.deviation, deviation, rel_tol=1e-5)
