"""Which tests a study of the rebuilt error simulates."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version

from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.core.vocabulary import Metric
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.validation.folds import earthquakes_among

from .judges import Question


@dataclass(frozen=True, kw_only=True)
class Design:
    """Which tests are simulated."""

    motions: Sequence[Motion]  # Ground motions; each round takes the next one
    structures: Sequence[Structure]  # Structures, each of which sees every round
    trials: int  # Rounds: tests of each kind of actuator and of specimen, for each structure
    threshold: float  # Error up to which a test is good [-]; tests are made with 0.2 to 3 times this error
    metric: Metric  # Which error
    confidence: float  # Share of the population's ground motions that the criterion states [-]
    # For each motion its earthquake in the suite from which the shipped criterion was learned
    learned_without: Sequence[str | None]
    seed: int = 0  # Seed of sizes, noise and specimens

    def __post_init__(self) -> None:
        if not self.motions:
            raise InputError("The study needs ground motions", value="none", remedy="Give `motions`")

    @classmethod
    def classify_motions(
        cls,
        motions: Sequence[Motion],
        structures: Sequence[Structure],
        *,
        trials: int,
        threshold: float = 0.05,
        metric: Metric = Metric.RMS,
        confidence: float = 0.95,
        seed: int = 0,
    ) -> "Design":
        """Find out of each motion whether the shipped criterion was learned from its earthquake."""
        among = earthquakes_among(
            [motion.event for motion in motions],
            [motion.checksum for motion in motions],
            open_ellipses(shipped("datasets", "real_suite/ellipses.nc")),
        )
        return cls(
            motions=motions,
            structures=structures,
            trials=trials,
            threshold=threshold,
            metric=metric,
            confidence=confidence,
            learned_without=among,
            seed=seed,
        )

    @property
    def question(self) -> Question:
        """The error and threshold by which every test is judged."""
        return Question(threshold=self.threshold, metric=self.metric, confidence=self.confidence)

    @property
    def digest(self) -> str:
        """Identification of the study in its rows."""
        content = {
            "version": version("reliab"),
            "motions": [motion.checksum for motion in self.motions],
            "structures": [repr(structure) for structure in self.structures],
            "asked": [self.threshold, str(self.metric), self.confidence, self.seed],
            "without": list(self.learned_without),
        }
        return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:16]
