"""Effects of the faults of a recording on the error of the test."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from reliab.assessment.budget.sizes import Size, Source
from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test
from reliab.assessment.error_with_threshold import ErrorWithThreshold
from reliab.assessment.faults import Fault, repair_recording
from reliab.core.plain_values import finite
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording

AnyRecording = TypeVar("AnyRecording", Recording, CoupledRecording)
_Error = TypeVar("_Error", bound=ErrorWithThreshold)


@dataclass(frozen=True, kw_only=True, eq=False)
class FaultEffect:
    """A fault of the recording with what it does to the error."""

    fault: Fault  # The fault
    # Error of the test without the fault; where the verdict already excludes the fault because the loop did
    # not feel it, the error with the fault; None where that is not known
    otherwise: ErrorWithThreshold | None

    def to_dict(self, error: ErrorWithThreshold) -> dict[str, Any]:
        """Put it into plain values beside the error of the test, with the actuator if there are several."""
        fault, error_otherwise = self.fault, self.otherwise
        return {
            **({"actuator": fault.actuator} if fault.actuator else {}),
            "kind": fault.kind,
            "finding": fault.finding,
            "in_loop": fault.in_loop,
            "error": finite(error.estimate(error.metric).value),
            "error_otherwise": None
            if error_otherwise is None
            else finite(error_otherwise.estimate(error.metric).value),
        }


def error_with_faults(
    recording: AnyRecording,
    faults: Sequence[Fault],
    rebuilt: Callable[[AnyRecording, frozenset[int], Mapping[str, Size]], _Error],
) -> tuple[_Error, tuple[FaultEffect, ...]]:
    """Error of the test without the faults that the loop did not feel, and the effect of each fault on it.

    `rebuilt` takes a recording, the places of sensors whose offsets are known, since the faults say what they
    read, and what repairs leave unknown.
    Returns `effects`: for each fault the error without it, or with it where `error` already excludes it.
    """
    unfelt = [fault for fault in faults if fault.in_loop is False]
    sensors = frozenset(fault.place for fault in faults if fault.size)
    error = rebuilt(repair_recording(recording, unfelt), sensors, _sizes_left(unfelt) | _sizes_open(faults))
    effects = []
    for fault in faults:
        other_faults = (
            [fault] if fault.in_loop is not False else [effect for effect in unfelt if effect is not fault]
        )
        repaired_recording = (
            rebuilt(repair_recording(recording, other_faults), sensors, _sizes_left(other_faults))
            if fault.repairable
            else None
        )
        effects.append(FaultEffect(fault=fault, otherwise=repaired_recording))
    return error, tuple(effects)


def error_of_one_with_faults(
    recording: Recording, faults: Sequence[Fault], question: Question
) -> tuple[ErrorOfTest, tuple[FaultEffect, ...]]:
    """Error of a test with one actuator, and the effect of each fault on it; see `error_with_faults`."""
    return error_with_faults(
        recording,
        faults,
        lambda test, sensors, repairs: error_of_test(
            test, question, sensor_offset=0.0 if sensors else None, left_by_repairs=repairs
        ),
    )


def _sizes_open(faults: Sequence[Fault]) -> dict[str, Size]:
    """Offsets and drifts of which the command does not show whether the loop felt them."""
    return {
        fault.name_quantity("open"): Size(deviation=fault.size, source=Source.LEARNED)
        for fault in faults
        if fault.size and fault.in_loop is None
    }


def _sizes_left(faults: Sequence[Fault]) -> dict[str, Size]:
    """Sizes of what the repair of faults leaves unknown, by the names of the tolerances."""
    return {
        fault.name_quantity("sensor"): Size(deviation=fault.deviation, source=Source.LEARNED)
        for fault in faults
        if fault.deviation
    }
