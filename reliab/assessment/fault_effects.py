"""Effects of the faults of a recording on the error of the test."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test
from reliab.assessment.faults import Fault, repair_recording
from reliab.core.plain_values import Keys, PlainResult
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording


@dataclass(frozen=True, kw_only=True, eq=False)
class FaultEffect(PlainResult):
    """A fault of the recording with what it does to the error."""

    keys: ClassVar[Keys] = {
        "actuator?": "fault.actuator",
        **{name: f"fault.{name}" for name in ("kind", "finding", "in_loop")},
        "error": "error.judged_estimate.value",
        "error_otherwise": "otherwise.judged_estimate.value",
    }

    fault: Fault  # The fault
    error: ErrorOfTest  # Error of the test
    # Error of the test without the fault; where the verdict already excludes the fault because the loop did
    # not feel it, the error with the fault; None where that is not known
    otherwise: ErrorOfTest | None


def error_with_faults(
    recording: Recording | CoupledRecording, faults: Sequence[Fault], question: Question
) -> tuple[ErrorOfTest, tuple[FaultEffect, ...]]:
    """Error of the test without the faults that the loop did not feel, and the effect of each fault on it.

    Returns `effects`: for each fault the error without it, or with it where `error` already excludes it.
    """
    unfelt = [fault for fault in faults if fault.in_loop is False]
    known_offsets = {fault.place for fault in faults if fault.size}

    def error_without(some: Sequence[Fault], open_sizes: Mapping[str, float]) -> ErrorOfTest:
        return error_of_test(
            repair_recording(recording, some),
            question,
            known_offsets=known_offsets,
            left_by_repairs={**_sizes_left(some), **open_sizes},
        )

    def others(fault: Fault) -> Sequence[Fault]:
        return [other for other in unfelt if other is not fault] if fault.in_loop is False else [fault]

    error = error_without(unfelt, _sizes_open(faults))
    return error, tuple(
        FaultEffect(
            fault=fault,
            error=error,
            otherwise=error_without(others(fault), {}) if fault.repairable else None,
        )
        for fault in faults
    )


def _sizes_open(faults: Sequence[Fault]) -> dict[str, float]:
    """Offsets and drifts of which the command does not show whether the loop felt them."""
    return {
        fault.name_quantity("open"): fault.size for fault in faults if fault.size and fault.in_loop is None
    }


def _sizes_left(faults: Sequence[Fault]) -> dict[str, float]:
    """Sizes of what the repair of faults leaves unknown, by the names of the tolerances."""
    return {fault.name_quantity("sensor"): fault.deviation for fault in faults if fault.deviation}
