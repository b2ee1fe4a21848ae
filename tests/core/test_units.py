import re

import pytest

from reliab.core.errors import InputError
from reliab.core.units import CLOCK_UNIT, AccelerationUnit, ClockUnit, find_clock_unit, find_unit
from reliab.motions.loading import load_motions
from reliab.recordings.words import Measurand, unit_of

G, CM, M, MM, TENTH = AccelerationUnit
LENGTHS = {CM: ["cm", "centimeters"], M: ["m", "metre"], MM: ["mm", "millimetres"]}
QUOTIENTS = [
    "/s2",
    "/sec2",
    "/s/s",
    "/SEC/SEC",
    "/s^2",
    "/s**2",
    "/s²",
    "/(s2)",
    "/second/second",
    " / s / s",
]
POWERS = ["s-2", " s-2", ".s-2", "*s^-2", " s^-2", "ps2"]  # behind the symbol of a length
SPELLINGS = [
    (unit, f"{length}{square}")
    for unit, lengths in LENGTHS.items()
    for length in lengths
    for square in (*QUOTIENTS, *(POWERS if len(length) <= len("mm") else ()))
]


@pytest.mark.parametrize(("unit", "text"), SPELLINGS)
def test_every_spelling_is_recognised_in_records_and_recordings(unit: AccelerationUnit, text: str) -> None:
    assert find_unit(text) is find_unit(f"{text.upper()},") is unit
    stated = unit_of(text)
    assert stated is not None
    assert (stated.quantity, stated.factor) == (Measurand.ACCELERATION, unit.si_factor)


@pytest.mark.parametrize(
    ("unit", "spellings"),
    [
        (G, ["g", "G", " G.", "g's", "(g)", "[g]", "gravity"]),
        (CM, ["gal", "GALS"]),
        (TENTH, ["g/10", "G/10."]),
    ],
)
def test_other_names_of_units_are_recognised(unit: AccelerationUnit, spellings: list[str]) -> None:
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


@pytest.mark.parametrize(
    ("factor", "spellings"),
    [
        (1.0, ["sec", "SECONDS", "m", "metre", "meters"]),
        (1e-3, ["ms", "msecs", "milliseconds", "mm", "millimeter"]),
        (1e-6, ["µs", "μs", "[usec]", "microsecond", "µm", "um", "microns", "micrometer"]),
        (1e-9, ["ns", "nsec", "nanoseconds"]),
        (60.0, ["min", "minutes"]),
    ],
)
def test_units_of_channels_are_recognised_in_every_spelling(factor: float, spellings: list[str]) -> None:
    for spelling in spellings:
        unit = unit_of(spelling)
        assert unit is not None
        assert unit.factor == factor


@pytest.mark.parametrize("text", ["d.", "F.", "s.", "millis", "milli", "micro", "kilo", "mN"])
def test_anything_else_is_no_unit_of_a_channel(text: str) -> None:
    assert unit_of(text) is None
