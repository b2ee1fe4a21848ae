"""The verdict on a test, whether it can be trusted."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from reliab.criterion import Criterion
from reliab.errors import InputError
from reliab.indices.window import Window
from reliab.loop.stability import critical_delay, stability_margin
from reliab.loop.structure import Structure
from reliab.motions import Motion
from reliab.validation.assessment.default_criterion import default_criterion
from reliab.validation.assessment.improvement import Improvement, improvement
from reliab.validation.assessment.moving_windows import Windows, track_windows
from reliab.validation.assessment.own_boundary import OwnBoundary
from reliab.validation.assessment.placement import Placement, place
from reliab.validation.assessment.recording import Recording
from reliab.validation.assessment.tracking_index import TrackingIndex, track
from reliab.vocabulary import Metric

LEVEL = 0.95
"""Level of the intervals."""

_FEWEST_PERIODS = 2.0
_LONGEST_STEP = 0.2  # of a period
_LARGEST_NOISE = 0.5
_DRAWS = 200


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnPlacement:
    """A test against the boundary of its own ground motion.

    Attributes
    ----------
    motion : str
        The ground motion.
    duration : float
        Its length [s].
    error : float
        Error of a test with this A and d under this motion [-].
    error_interval : tuple of float
        Its 95 % interval.
    index : float
        1 on the boundary, growing with the square of the distance.
    index_interval : tuple of float
        Its 95 % interval, the index growing with the square of the error.
    probability : float
        Probability that the error stays below the threshold, over what noise leaves open of A and d.
    a, b : float
        Ellipse fitted to the boundary [-] and [ms²].
    """

    motion: str
    duration: float
    error: float
    error_interval: tuple[float, float]
    index: float
    index_interval: tuple[float, float]
    probability: float
    a: float
    b: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Assessment:
    """What is found about a test.

    Attributes
    ----------
    recording : Recording
        The test.
    structure : Structure
        The structure under test.
    criterion : Criterion
        The criterion.
    tracking : TrackingIndex
        A and d with their uncertainty.
    windows : Windows
        A and d in moving windows.
    population : Placement
        The test against the population of ground motions.
    own : OwnPlacement or None
        The test against its own ground motion's boundary, where that is known.
    """

    recording: Recording
    structure: Structure
    criterion: Criterion
    tracking: TrackingIndex
    windows: Windows
    population: Placement
    own: OwnPlacement | None

    @property
    def index(self) -> float:
        """Index of the verdict: of the test's own motion where that is known, else of the population."""
        return self.population.index if self.own is None else self.own.index

    @property
    def index_interval(self) -> tuple[float, float]:
        """95 % interval of the index."""
        return self.population.index_interval if self.own is None else self.own.index_interval

    @property
    def reliable(self) -> bool:
        """Whether the test is accepted."""
        return self.index <= 1.0

    @property
    def probability(self) -> float | None:
        """Probability that the error of the test stays below the threshold."""
        return self.population.probability if self.own is None else self.own.probability

    @property
    def stability_margin(self) -> float:
        """Share of the critical delay that is still free [-]."""
        late = max(self.tracking.delay, 0.0)
        return float(stability_margin(self.structure, self.tracking.amplitude, late))

    @property
    def critical_delay(self) -> float:
        """Delay [s] at which the loop would lose stability; infinite where none does."""
        return float(critical_delay(self.structure, self.tracking.amplitude))

    @property
    def limits(self) -> tuple[float, float]:
        """Ellipse parameters a [-] and b [ms²] behind the verdict."""
        behind = self.population if self.own is None else self.own
        return behind.a, behind.b

    @property
    def improvement(self) -> Improvement:
        """What to improve first."""
        return improvement(self.tracking.amplitude, self.tracking.delay, *self.limits)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What should be known before the verdict is relied on."""
        from reliab.validation.assessment.cautions import cautions

        return cautions(self)

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain numbers with stable keys; see `reliab.validation.assessment.summary`."""
        from reliab.validation.assessment.summary import summarise

        return summarise(self)


def assess(
    recording: Recording,
    structure: Structure,
    *,
    motion: Motion | None = None,
    criterion: Criterion | None = None,
    threshold: float = 0.05,
    confidence: float = 0.95,
    metric: str = "rms",
    error_window: Window | None = None,
    taper: str = "hann",
    seed: int = 0,
) -> Assessment:
    """Judge a real test by its command and measured displacement.

    Parameters
    ----------
    recording : Recording
        The test.
    structure : Structure
        The structure under test.
    motion : Motion, optional
        Its ground motion; the verdict is then by that motion's own boundary, exact by simulation.
    criterion : Criterion, optional
        The criterion; by default the one that ships with the package, for the threshold, metric and
        confidence given. A criterion that is given brings its own.
    threshold : float, optional
        Error of the whole test [-].
    confidence : float, optional
        Share of ground motions.
    metric : str, optional
        Which error, "rms" or "mte".
    error_window : Window, optional
        Stretch of the ground motion over which its error is taken.
    taper : str, optional
        Window of the evaluation index.
    seed : int, optional
        Seed of the bootstrap.

    Returns
    -------
    Assessment
        Index, verdict, probability, stability margin and what to improve first.

    Raises
    ------
    InputError
        If the test is too short, sampled too coarsely, or the measured displacement does not follow
        the command.
    """
    _check_length(recording, structure)
    chosen = criterion or default_criterion(
        structure.frequency, structure.damping_ratio, threshold, confidence, metric=metric
    )
    tracking = track(recording, window=taper, seed=seed)
    _check_following(tracking, recording)
    own = None
    if motion is not None:
        boundary = OwnBoundary(
            motion=motion,
            structure=structure,
            threshold=chosen.threshold,
            metric=Metric(chosen.metric),
            window=error_window or Window(),
        )
        own = _own(boundary, tracking)
    return Assessment(
        recording=recording,
        structure=structure,
        criterion=chosen,
        tracking=tracking,
        windows=track_windows(recording, tracking, window=taper),
        population=place(chosen, structure, tracking.amplitude, tracking.delay, tracking.draws),
        own=own,
    )


def _own(boundary: OwnBoundary, tracking: TrackingIndex) -> OwnPlacement:
    error = float(boundary.error(np.array([tracking.amplitude]), np.array([tracking.delay]))[0])
    index = boundary.index(tracking.amplitude, tracking.delay)
    errors = boundary.error(*tracking.draws[:, :_DRAWS])
    low, high = np.quantile(errors, [0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)]).tolist()
    a, b = boundary.ellipse()
    return OwnPlacement(
        motion=boundary.motion.name,
        duration=boundary.motion.duration,
        error=error,
        error_interval=(low, high),
        index=index,
        index_interval=(index * (low / error) ** 2, index * (high / error) ** 2) if error else (0.0, 0.0),
        probability=float(np.mean(errors <= boundary.threshold)),
        a=a,
        b=b,
    )


def _check_length(recording: Recording, structure: Structure) -> None:
    periods = recording.duration * structure.frequency
    if periods < _FEWEST_PERIODS:
        raise InputError(
            f"A test must last at least {_FEWEST_PERIODS:g} periods of the structure",
            value=f"{periods:.2g} ({recording.duration:g} s at {structure.frequency:g} Hz)",
            remedy="Give the whole test; times are in seconds unless --time-units says otherwise",
            where=recording.name,
        )
    if recording.time_step * structure.frequency > _LONGEST_STEP:
        raise InputError(
            f"A step must be at most {_LONGEST_STEP:g} of a period of the structure",
            value=f"{recording.time_step:g} s at {structure.frequency:g} Hz",
            remedy="Times are in seconds; if they are in milliseconds, give --time-units ms",
            where=recording.name,
        )


def _check_following(tracking: TrackingIndex, recording: Recording) -> None:
    if tracking.noise_share > _LARGEST_NOISE or not tracking.amplitude > 0.0:
        raise InputError(
            "The measured displacement must follow the command",
            value=f"{tracking.noise_share:.0%} of it is unrelated to the command",
            remedy="Check that the columns and their units are the right ones",
            where=recording.name,
        )
