"""Errors of every floor and storey of a tested frame, beside that of the measured interface displacement."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from reliab.arrays import Array
from reliab.assessment.plain_error import plain_estimate
from reliab.assessment.rebuilt_error import Estimate, RebuiltError
from reliab.assessment.rebuilt_error.responses import Ground, StrayedResponses, stray_of_responses
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.motions import Motion
from reliab.recordings import Recording
from reliab.significant import percent, percent_with_interval
from reliab.structures import Partition
from reliab.vocabulary import MILLI, Metric

_AGREES = 0.25  # relative, of the interface's peak under the ground motion and in the test
_MEASURED = (
    "Errors of floors and storeys are computed for linear specimens only; that of this test is measured."
)
_NEEDS = (
    "The errors of floors and storeys are stated in millimetres: over the largest response, they need the "
    "ground motion of the test, as `motion` or as a channel of its file."
)


@dataclass(frozen=True, kw_only=True)
class ResponseError:
    """Error of a floor's displacement, or of a storey's drift, as the computer had it in the test."""

    name: str  # "floor 3" or "storey 2"
    kind: str  # "floor" or "storey"
    # rms_mm, peak_mm: RMS and largest deviation from the undisturbed structure [mm]
    rms_mm: Estimate
    peak_mm: Estimate
    # rms, mte: The same over the largest undisturbed response [-]; None without the ground motion
    rms: Estimate | None
    mte: Estimate | None

    def to_dict(self) -> dict[str, Any]:
        """Put it into plain values."""
        return {
            "name": self.name,
            "kind": self.kind,
            "rms_mm": plain_estimate(self.rms_mm),
            "peak_mm": plain_estimate(self.peak_mm),
            "rms": None if self.rms is None else plain_estimate(self.rms),
            "mte": None if self.mte is None else plain_estimate(self.mte),
        }

    @property
    def size(self) -> float:
        """What it is ordered by: RMS^R, or the RMS in millimetres where that is not known."""
        return self.rms_mm.value if self.rms is None else self.rms.value


@dataclass(frozen=True, kw_only=True)
class ResponseErrors:
    """Errors of all floors and storeys, the largest first, of a frame whose specimen is linear."""

    each: tuple[ResponseError, ...]
    # Peak of the interface under the ground motion over that in the test, less one [-]; None without it
    disagreement: float | None
    measured: bool = False  # Whether the specimen is measured: nothing is then computed

    @property
    def governing_storey(self) -> ResponseError | None:
        """The storey with the largest error; None where the frame has no storeys."""
        return next((error for error in self.each if error.kind == "storey"), None)

    @property
    def sentence(self) -> str:
        """Which storey governs, or what is needed to say so."""
        governing = self.governing_storey
        if self.measured:
            return _MEASURED
        if governing is None or governing.rms is None:
            return _NEEDS
        rms = governing.rms
        return (
            f"Of all storeys, the drift of {governing.name} is most wrong: RMS^R "
            f"{percent_with_interval(rms.value, rms.low, rms.high)} of its own peak, the specimen being "
            "linear."
        )

    @property
    def warnings(self) -> tuple[str, ...]:
        """Where the ground motion is not that of the test, in a sentence."""
        if self.disagreement is None or abs(self.disagreement) <= _AGREES:
            return ()
        more = "larger" if self.disagreement > 0.0 else "smaller"
        sentence = (
            f"Under the ground motion the largest displacement of the interface would be {more} than the "
            f"test shows, by {percent(abs(self.disagreement))}: errors of floors and storeys are over peaks "
            "that are scaled to the test's, and wrong if this was not its motion."
        )
        return (sentence,)

    def to_dict(self) -> dict[str, Any]:
        """Put them into plain values."""
        governing = self.governing_storey
        return {
            "in_words": self.sentence,
            "specimen": "measured" if self.measured else "linear",
            "governing_storey": None if governing is None else governing.name,
            "each": [error.to_dict() for error in self.each],
            "peak_disagreement": self.disagreement,
            "needs": _NEEDS if self.disagreement is None and not self.measured else None,
        }


def errors_of_responses(
    rebuilt: RebuiltError, partition: Partition, recording: Recording, motion: Motion | None
) -> ResponseErrors:
    """Compute the errors of all floors and storeys; the ground motion may be a channel of the recording."""
    names, weights = _responses(partition)
    ground = _ground(partition, recording, motion)
    strayed = stray_of_responses(rebuilt, weights, ground)
    errors = [_response(strayed, place, *name) for place, name in enumerate(names)]
    return ResponseErrors(
        each=tuple(sorted(errors, key=lambda error: -error.size)), disagreement=strayed.disagreement
    )


def _responses(partition: Partition) -> tuple[list[tuple[str, str]], Array]:
    """Kinds and names of floors and storeys, and their weights of the degrees of freedom."""
    frame = partition.frame
    storeys, drifts = weights_of_storeys(frame.names, np.asarray(frame.influence))
    names = [("floor", name) for name in frame.names] + [("storey", name) for name in storeys]
    return names, np.vstack([np.eye(frame.size), drifts])


def weights_of_storeys(names: tuple[str, ...], influence: Array) -> tuple[list[str], Array]:
    """Names of storeys, and the weights of all degrees of freedom in their drifts; none without names.

    A storey lies below each floor that the ground moves along with it, above the one before.
    """
    along = np.flatnonzero(influence) if names else np.zeros(0, dtype=np.int64)
    drifts = np.diff(np.eye(influence.size)[along], axis=0, prepend=np.zeros((1, influence.size)))
    return [names[place] for place in along], drifts


def _ground(partition: Partition, recording: Recording, motion: Motion | None) -> Ground | None:
    if motion is not None:
        acceleration, step = motion.acceleration, motion.time_step
    elif recording.ground is not None:
        acceleration, step = recording.ground, recording.time_step
    else:
        return None
    return Ground(
        acceleration=np.asarray(acceleration),
        time_step=step,
        influence=np.asarray(partition.frame.influence, dtype=np.float64),
    )


def _response(strayed: StrayedResponses, place: int, kind: str, name: str) -> ResponseError:
    """Error of one response."""
    values = strayed.sizes[:, place]
    rms_mm, peak_mm = _estimates(strayed.spread(place, scale=1.0 / MILLI), MILLI * values)
    rms = mte = None
    if strayed.largest is not None and strayed.largest_of_draws is not None:
        spread = strayed.spread(place, scale=strayed.largest_of_draws[:, place])
        rms, mte = _estimates(spread, values / strayed.largest[place])
    return ResponseError(name=f"{kind} {name}", kind=kind, rms_mm=rms_mm, peak_mm=peak_mm, rms=rms, mte=mte)


def _estimates(spread: Spread, values: Array) -> list[Estimate]:
    """RMS and peak with their intervals."""
    metrics = zip((Metric.RMS, Metric.MTE), values.tolist(), strict=True)
    return [spread.estimate(metric, value) for metric, value in metrics]
