"""The published laws against the tables and the text that they come from."""

import numpy as np
import pandas as pd
import pytest

from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.criterion.laws import guo_2017
from reliab.criterion.laws.registry import MANY_MOTION_LAWS


@pytest.fixture(scope="module")
def table3():
    return pd.read_csv(shipped("datasets", "paper/table3.csv"))


@pytest.fixture(scope="module")
def table4():
    return pd.read_csv(shipped("datasets", "paper/table4.csv"))


def geometric_mean(values):
    return float(np.exp(np.log(values).mean()))


@pytest.mark.parametrize(
    ("equation", "f", "xi", "a", "b"),
    [
        (guo_2017.Equation11(), 1.0, 0.02, 1.3e-4, 2.3),
        (guo_2017.Equation12(), 1.0, 0.02, 5.3e-5, 1.04),
        (guo_2017.Equation14(), 0.5, 0.02, 5.8e-5, 97.0 * np.exp(-1.7)),
        (guo_2017.Equation15(), 0.5, 0.02, 5.6e-5, 121.6 * np.exp(-3.3)),
        (guo_2017.Equation17(), 1.0, 0.05, 0.0023, 5.0),
        (guo_2017.Equation18(), 0.5, 0.05, 0.00105, 304.0 * np.exp(-3.3)),
    ],
)
def test_each_law_is_as_printed(equation, f, xi, a, b):
    result = equation.limits(f, xi)
    assert (float(result[0]), float(result[1])) == (pytest.approx(a), pytest.approx(b))


def test_the_text_under_equation_15():
    """Amplitude error below 0.0073 (√5.3e-5; √5.6e-5 is 0.0075); 4.8 ms at 0.25 Hz."""
    a, b = guo_2017.Equation15().limits(0.25, 0.02)
    assert np.sqrt(a) == pytest.approx(0.0075, abs=0.00005)
    assert np.sqrt(b) == pytest.approx(4.8, abs=0.05)


def test_the_indices_of_table_6():
    cases = pd.read_csv(shipped("datasets", "paper/tables5_6.csv"))
    a, b = guo_2017.Equation18().limits(cases["f_hz"], cases["xi"])
    index = (cases["A"] - 1.0) ** 2 / a + cases["d_ms"] ** 2 / b
    assert index.tolist() == pytest.approx(cases["index_eq18"].tolist(), abs=0.0006)


def test_the_exponential_of_equation_15_meets_table_3_at_its_first_frequency_only(table3):
    _, b = guo_2017.Equation15().limits(table3["f_hz"], 0.02)
    ratio = b / table3["b"].to_numpy()
    assert ratio[0] == pytest.approx(1.0, abs=0.01)
    assert (ratio[2:] < 0.6).all()
    assert ratio[-1] < 0.001


def test_equation_18_is_seven_and_a_half_times_as_generous_in_a_as_equation_15():
    generous, strict = (law.limits(1.0, 0.02)[0] for law in (guo_2017.Equation18(), guo_2017.Equation15()))
    assert float(generous / strict) == pytest.approx(7.5)


def test_the_corrected_equation_15_meets_table_3(table3):
    a, b = guo_2017.Equation15Corrected().limits(table3["f_hz"], 0.02)
    assert float(a[0]) == pytest.approx(geometric_mean(table3["a"]), rel=0.01)
    assert float(b[3]) == pytest.approx(geometric_mean(table3["b"] * table3["f_hz"] ** 2), rel=0.01)
    np.testing.assert_allclose(b, table3["b"], rtol=0.3)


def test_the_corrected_equation_17_meets_every_row_of_table_4_read_as_roots(table4):
    a, b = guo_2017.Equation17Corrected().limits(1.0, table4["xi"])
    np.testing.assert_allclose(a, table4["a"], rtol=0.15)
    np.testing.assert_allclose(b, table4["b"] ** 2, rtol=0.15)


def test_squares_in_equation_17_would_be_too_generous_at_the_least_damping(table4):
    """Powers of 2, fitted by their geometric means."""
    for truth, excess in ((table4["a"], 1.6), (table4["b"] ** 2, 1.4)):
        square = geometric_mean(truth / table4["xi"] ** 2) * table4["xi"] ** 2
        assert float(square[0] / truth[0]) == pytest.approx(excess, abs=0.05)


def test_the_corrected_equation_18_joins_the_other_two():
    joint_law, frequency_law = guo_2017.Equation18Corrected(), guo_2017.Equation15Corrected()
    for f in (0.25, 1.0, 2.0):
        assert joint_law.limits(f, 0.02) == frequency_law.limits(f, 0.02)
        np.testing.assert_allclose(
            np.ravel(joint_law.limits(f, 0.04)), 4.0 * np.ravel(frequency_law.limits(f, 0.02))
        )


@pytest.mark.parametrize(
    "equation", [each() for each in (*guo_2017.PUBLISHED_EQUATIONS, *guo_2017.CORRECTED_EQUATIONS)]
)
def test_use_outside_of_the_validity_is_refused(equation):
    valid = equation.validity
    for f in (valid.frequency[0] / 2.0, valid.frequency[1] * 2.0):
        with pytest.raises(InputError, match="does not hold for this"):
            equation.limits(f, valid.damping_ratio[0])
    for xi in (valid.damping_ratio[0] / 2.0, valid.damping_ratio[1] * 2.0):
        with pytest.raises(InputError, match="does not hold for this damping ratio"):
            equation.limits(valid.frequency[0], xi)
    with pytest.raises(InputError, match=r"error of 0\.05 only"):
        valid.require_error(0.1, "rms")
    with pytest.raises(InputError, match="metric rms only"):
        valid.require_error(0.05, "mte")


def test_laws_of_one_motion_promise_no_confidence():
    assert not {"guo_2017_11", "guo_2017_14", "guo_2017_17"} & set(MANY_MOTION_LAWS)
