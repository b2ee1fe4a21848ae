import re

import pytest

from reliab.core.errors import InputError
from reliab.core.units import (
    CLOCK_UNIT,
    AccelerationUnit,
    ClockUnit,
    find_clock_unit,
    find_unit,
)
from reliab.motions.loading import load_motions

G, CM, M, MM, TENTH = AccelerationUnit


@pytest.mark.parametrize(
    ("unit", "spellings"),
    [
        (G, ["g", "G", " G.", "g's", "(g)", "[g]", "gravity"]),
        (
            CM,
            [
                "gal",
                "GALS",
                "cm/s2",
                "cm/sec2",
                "CM/SEC/SEC",
                "cm/s/s",
                "cm/s^2",
                "cm/s**2",
                "cm/s²",
                "cm s-2",
            ],
        ),
        (
            CM,
            [
                "cm/sec^2",
                "cm / s / s",
                "cm/(s2)",
                "cm.s-2",
                "cm/second/second",
                "centimeters/sec**2",
                "cmps2",
            ],
        ),
        (
            M,
            [
                "m/s2",
                "M/S/S",
                "m/sec2",
                "m/s**2",
                "m/s^2",
                "m/s²",
                "m s^-2",
                "mps2",
                "meters/second/second",
                "m/s2,",
            ],
        ),
        (MM, ["mm/s/s", "mm/s2", "MM/SEC/SEC", "millimetres/s**2"]),
        (TENTH, ["g/10", "G/10."]),
    ],
)
def test_every_spelling_is_recognised(unit: AccelerationUnit, spellings: list[str]) -> None:
    assert [find_unit(spelling) for spelling in spellings] == [unit] * len(spellings)


def test_a_square_sign_in_utf8_read_as_latin1_is_recognised() -> None:
    assert find_unit("m/s²".encode().decode("latin-1")) is M


@pytest.mark.parametrize(
    "text", ["", "cm", "cm/s", "in/s2", "mg", "mm/s", "%g", "s", "counts", "m", "furlongs"]
)
def test_anything_else_is_no_unit_of_acceleration(text: str) -> None:
    assert find_unit(text) is None
    with pytest.raises(InputError, match="Unknown unit"):
        load_motions("synthetic", units=text)


def test_one_g_is_981_gal_and_a_metre_is_a_hundred_centimetres() -> None:
    assert G.si_factor / CM.si_factor == pytest.approx(980.665, rel=1e-15)
    assert M.si_factor / CM.si_factor == pytest.approx(100.0, rel=1e-15)


@pytest.mark.parametrize(
    ("size", "is_frequency", "spellings"),
    [
        (1.0, False, ["s", "SEC", "secs", "seconds"]),
        (1e-3, False, ["ms", "MSEC", "millisec", "milliseconds", "milli seconds"]),
        (1e-6, False, ["us", "µs", "μs", "microseconds"]),
        (1.0, True, ["Hz", "hertz", "sps", "samples/sec", "samples per second"]),
        (1e3, True, ["kHz", "KHZ", "kilohertz"]),
    ],
)
def test_every_unit_of_a_step_or_rate_is_recognised(
    size: float, is_frequency: object, spellings: list[str]
) -> None:
    for spelling in spellings:
        assert find_clock_unit(spelling) == ClockUnit(size=size, is_frequency=is_frequency)
        assert re.fullmatch(CLOCK_UNIT, spelling, re.IGNORECASE)


@pytest.mark.parametrize("text", ["", "m", "g", "ticks", "cm/s2"])
def test_anything_else_is_no_unit_of_a_clock(text: str) -> None:
    assert find_clock_unit(text) is None
