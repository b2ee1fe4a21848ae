"""Words of the field that a report uses, explained in a sentence each at its end."""

import re
from dataclasses import dataclass
from typing import Final

from reliab.report.prose import Prose, prose


@dataclass(frozen=True, kw_only=True)
class Term:
    """A word that is explained where a report uses it."""

    name: Prose  # The word, as it stands in the glossary
    pattern: str  # Regular expression of its forms in running text
    meaning: Prose  # What it means


TERMS: Final = (
    Term(
        name="amplitude A",
        pattern=r"amplitude",
        meaning=prose(
            "Measured over commanded displacement at the equivalent frequency; 1 for an exact actuator."
        ),
    ),
    Term(
        name="assurance",
        pattern=r"\bassurance\b",
        meaning=prose(
            "Probability that a criterion holds for at least the stated share of the population's ground "
            "motions, although it was learned from few."
        ),
    ),
    Term(
        name="boundary of equal error",
        pattern=r"\bboundar(?:y|ies)\b",
        meaning=prose(
            "All amplitudes and delays with which the error of a test under one ground motion equals the "
            "threshold."
        ),
    ),
    Term(
        name="confidence",
        pattern=r"\bconfidence\b",
        meaning=prose(
            "Share of the population's ground motions for which a test inside a criterion stays below the "
            "threshold."
        ),
    ),
    Term(
        name="criterion",
        pattern=r"\bcriteri(?:on|a)\b",
        meaning=prose(
            "Ellipse of amplitude errors and delays that are accepted, for a structure and a threshold."
        ),
    ),
    Term(
        name="delay d",
        pattern=r"\bdelay",
        meaning=prose(
            "Time by which the measured displacement follows the command; negative where it leads."
        ),
    ),
    Term(
        name="held-out test",
        pattern=r"held[- ]out",
        meaning=prose("A test or an earthquake that was not used to derive what is judged by it."),
    ),
    Term(
        name="interval",
        pattern=r"\binterval",
        meaning=prose("Range that holds the true value with the stated probability."),
    ),
    Term(
        name="rebuilt error",
        pattern=r"\brebuilt\b",
        meaning=prose("Error of a test, computed from its own channels."),
    ),
    Term(
        name=prose('RMS error $"RMS"^R$, largest error $"MTE"^R$'),
        pattern=r"RMS|MTE|[Ll]argest error",
        meaning=prose(
            "Root mean square, and largest value, of measured minus exact displacement, over the peak of the "
            "exact displacement."
        ),
    ),
    Term(
        name="share of the stiffness α",
        pattern=r"α|share of the stiffness|experimental fraction",
        meaning=prose("Share of the structure's stiffness that the specimen in the laboratory has."),
    ),
    Term(
        name="stability margin",
        pattern=r"stability margin",
        meaning=prose("Share of the critical delay, at which the loop becomes unstable, that is still free."),
    ),
    Term(
        name="window",
        pattern=r"\bwindow\b",
        meaning=prose("Part of a record over which the error is computed."),
    ),
)
"""Words that are explained, in alphabetical order."""


def glossary_of(text: str) -> list[Term]:
    """Choose the words that a report uses.

    >>> [term.name for term in glossary_of("The stability margin of a held-out test")]
    ['held-out test', 'stability margin']
    """
    return [term for term in TERMS if re.search(term.pattern, text)]
