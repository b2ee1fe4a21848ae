"""Formulas of reports: numbers, letters, signs and the words of mathematics that reports use.

The template evaluates formulas, and typst's language can read files: `#read(…)`, or without a sign
`std.read(…)`. A formula is therefore built of what is listed here and of nothing else, whoever wrote it.
"""

import re
from typing import Final

_SIGNS: Final = re.compile(r"""(?:[A-Za-z0-9\s.,!'"|()\[\]_^=<>+*/-]|\\/)*""")
_WORD: Final = re.compile(r'"[^"]*"|[A-Za-z][A-Za-z0-9]+(?:\.[A-Za-z0-9]+)*')
_GREEK: Final = (
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega "
    "Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"
)
_OTHERS: Final = (
    "abs approx arg bold cos dif dot dot.double exp frac hat in infinity integral lr ln log max min norm "
    "overline plus.minus prod quad sin sqrt sum tan tilde times upright"
)
_KNOWN: Final = frozenset(f"{_GREEK} {_OTHERS}".split())


def require_formula(source: str) -> None:
    """Refuse what is no formula, before it is evaluated.

    >>> require_formula('"RMS"^R = sqrt(x_m - x_I) / (max abs(x_I))')
    >>> require_formula('std.read("/etc/hosts")')
    Traceback (most recent call last):
    ...
    ValueError: A formula is built of numbers, letters, signs and known words, not of 'std.read'.
    """
    words = [word for word in _WORD.findall(source) if not word.startswith('"')]
    unknown = [word for word in words if word not in _KNOWN]
    if unknown or not _SIGNS.fullmatch(source):
        first = unknown[0] if unknown else source
        message = f"A formula is built of numbers, letters, signs and known words, not of {first!r}."
        raise ValueError(message)
