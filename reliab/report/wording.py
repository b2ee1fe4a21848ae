"""How reports say things: errors, shares, structures, confidences, equations with numbers."""

import re
from collections.abc import Sequence
from typing import Final

import numpy as np

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric
from reliab.criterion.methods.registry import METHODS
from reliab.report.prose import Math, Piece

ERRORS: Final = {Metric.RMS: Math(source='"RMS"^R'), Metric.MTE: Math(source='"MTE"^R')}
"""The errors of the whole test in mathematics."""

MEANINGS_OF_ERRORS: Final = {
    Metric.RMS: "the RMS of measured minus exact displacement over the peak (not the RMS) of the exact one",
    Metric.MTE: "the largest difference of measured and exact displacement over the peak of the exact one",
}
"""What each error of the whole test is, in a clause."""


def replace_arguments_by_options(sentence: str) -> str:
    """Write arguments that a sentence names as options of the command line, which a filed report came from.

    >>> replace_arguments_by_options("Give its `force_channel`; see `reliab calibrate`.")
    'Give its --force-channel; see `reliab calibrate`.'
    """
    return re.sub(r"`([a-z]\w*)`", lambda name: f"--{name[1].replace('_', '-')}", sentence)


def window_in_words(window: str) -> str:
    """Part of the record over which the error is computed.

    >>> window_in_words("record"), window_in_words("40")
    ('the whole record', 'the first 40 s of the record')
    """
    phrases = {
        "record": "the whole record",
        "arias": "5 % to 95 % of the Arias intensity of the record",
    }
    return phrases.get(window, f"the first {window} s of the record")


def meaning_of_confidence(method: str) -> str:
    """Say what a stated confidence means by the method of a name; a method of an older file by its name.

    >>> meaning_of_confidence("order_statistic")
    'a bound by order statistics, free of any distribution'
    """
    return METHODS[method].meaning if method in METHODS else method


def probability(value: float) -> str:
    """Write a probability in per cent, without claiming that anything is certain.

    >>> probability(0.988), probability(0.0), probability(1.0)
    ('98.8 %', 'below 0.1 %', 'above 99.9 %')
    """
    if value < _RARE:
        return f"below {percent(_RARE)}"
    return f"above {percent(1.0 - _RARE)}" if value > 1.0 - _RARE else percent(value)


def values(numbers: Sequence[float], unit: str = "") -> str:
    """Write several values: few of them one by one, many by their range.

    >>> values([0.02]), values([0.5, 1.0], "Hz"), values([0.25, 0.5, 0.75, 1.0, 1.25], "Hz")
    ('0.02', '0.5 and 1 Hz', '0.25 to 1.25 Hz (5 values)')
    """
    words, ending = [f"{number:g}" for number in numbers], f" {unit}" if unit else ""
    if len(words) > _MOST_LISTED:
        return f"{words[0]} to {words[-1]}{ending} ({len(words)} values)"
    return f"{join_words(words)}{ending}"


def join_words(words: Sequence[str]) -> str:
    """Join words with commas and a last "and".

    >>> join_words(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else list(words))


def spell_out(name: str) -> str:
    """Write a name of the package as words.

    >>> spell_out("viscous_damping")
    'viscous damping'
    """
    return name.replace("_", " ")


def law_in_words(name: str) -> str:
    """Name a published law as readers of the paper know it; other names stay as they are.

    >>> law_in_words("guo_2017_18_corrected"), law_in_words("dirichlet")
    ('equation (18) corrected', 'dirichlet')
    """
    match = re.fullmatch(r"guo_2017_(\d+)(_corrected)?", name)
    if match is None:
        return name
    return f"equation ({match[1]}){' corrected' if match[2] else ''}"


def error_below(metric: str, threshold: float) -> tuple[Piece, ...]:
    """Write an error and its bound, "RMS^R below 5 %"."""
    return (ERRORS[Metric(metric)], f" below {percent(threshold)}")


def number(value: float, digits: int = 3) -> str:
    """Write a number for mathematics in typst's notation.

    >>> number(5.29e-5), number(1.048), number(0.0)
    ('5.29 dot 10^(-5)', '1.05', '0')
    """
    if value == 0.0 or not np.isfinite(value):
        return "oo" if value else "0"
    exponent = int(f"{value:.{digits - 1}e}".partition("e")[2])
    if _SMALLEST <= exponent <= _GREATEST:
        return f"{value:.{max(digits - 1 - exponent, 0)}f}"
    mantissa = f"{value:.{digits - 1}e}".partition("e")[0]
    return f"{mantissa} dot 10^({exponent})"


def ellipse(a: float, b: float) -> Math:
    """Write (A − 1)²/a + d²/b ≤ 1 with its numbers, in a line."""
    return Math(source=f"(A - 1)^2 \\/ lr(({number(a)})) + d^2 \\/ {number(b)} <= 1")


_MOST_LISTED = 4
_RARE = 1e-3
_SMALLEST, _GREATEST = -2, 3
