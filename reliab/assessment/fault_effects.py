"""Effects of the faults of a recording on the error of the test."""

from collections.abc import Callable, Sequence

from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.faults import Fault, repaired
from reliab.assessment.findings import FaultEffect
from reliab.recordings import Recording


def error_with_faults(
    recording: Recording,
    faults: Sequence[Fault],
    rebuilt: Callable[[Recording, float | None], ErrorOfTest],
) -> tuple[ErrorOfTest, tuple[FaultEffect, ...]]:
    """Error of the test without the faults that the loop did not feel, and the effect of each fault on it.

    `rebuilt` [m].
    Returns `effects`: for each fault the error without it, or with it where `error` already excludes it.
    """
    unfelt = [fault for fault in faults if fault.in_loop is False]
    known = 0.0 if any(fault.kind == "offset" for fault in faults) else None
    error = rebuilt(repaired(recording, unfelt), known)
    effects = []
    for fault in faults:
        others = (
            [fault] if fault.in_loop is not False else [effect for effect in unfelt if effect is not fault]
        )
        changed = rebuilt(repaired(recording, others), known) if fault.repairable else None
        effects.append(FaultEffect(fault=fault, otherwise=changed))
    return error, tuple(effects)
