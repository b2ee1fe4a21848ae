"""Effects of the faults of a recording on the error of the test."""

from collections.abc import Callable, Mapping, Sequence

from reliab.assessment.budget import Size, Source
from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.faults import Fault, repaired
from reliab.assessment.findings import FaultEffect
from reliab.recordings import Recording


def error_with_faults(
    recording: Recording,
    faults: Sequence[Fault],
    rebuilt: Callable[[Recording, float | None, Mapping[str, Size]], ErrorOfTest],
) -> tuple[ErrorOfTest, tuple[FaultEffect, ...]]:
    """Error of the test without the faults that the loop did not feel, and the effect of each fault on it.

    `rebuilt` takes a recording, the sensor's offset [m] where it is known, and what repairs leave unknown.
    Returns `effects`: for each fault the error without it, or with it where `error` already excludes it.
    """
    unfelt = [fault for fault in faults if fault.in_loop is False]
    known = 0.0 if any(fault.size for fault in faults) else None
    error = rebuilt(repaired(recording, unfelt), known, _sizes_left(unfelt) | _sizes_open(faults))
    effects = []
    for fault in faults:
        others = (
            [fault] if fault.in_loop is not False else [effect for effect in unfelt if effect is not fault]
        )
        changed = (
            rebuilt(repaired(recording, others), known, _sizes_left(others)) if fault.repairable else None
        )
        effects.append(FaultEffect(fault=fault, otherwise=changed))
    return error, tuple(effects)


def _sizes_open(faults: Sequence[Fault]) -> dict[str, Size]:
    """Offsets and drifts of which the command does not show whether the loop felt them."""
    return {
        f"open_{fault.kind}": Size(deviation=fault.size, source=Source.LEARNED)
        for fault in faults
        if fault.size and fault.in_loop is None
    }


def _sizes_left(faults: Sequence[Fault]) -> dict[str, Size]:
    """Sizes of what the repair of faults leaves unknown, by the names of the tolerances."""
    return {
        f"sensor_{fault.kind}": Size(deviation=fault.deviation, source=Source.LEARNED)
        for fault in faults
        if fault.deviation
    }
