"""The paper's application: a frame with a spring under KOBE/KJM000, Tables 5 and 6, Figures 16 and 17.

A single-degree-of-freedom frame of stiffness k_n carries a spring of stiffness k_e, the specimen. The
command is integrated with the CR algorithm at 1024 Hz and sent through inverse compensation to an
actuator that is four steps late, counted from when the command is sent, one step before it is due; the
amplitude error is a gain. The first simulation has no error, the second both.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.indices.frequency_evaluation import frequency_evaluation
from reliab.indices.response_error import response_error
from reliab.loop.actuator import Actuator
from reliab.loop.hybrid_test.closed_loop import run_closed_loop
from reliab.loop.hybrid_test.compensators import InverseCompensation
from reliab.loop.hybrid_test.integrators import ChenRicles
from reliab.loop.hybrid_test.model import HybridTest
from reliab.loop.structure import Structure
from reliab.motions import Motion, resample, truncate

RATE_HZ = 1024.0
DELAY_STEPS = 4
RECORD_SECONDS = 40.0
"""Length of the record that reproduces Table 6; the full record gives about half the RMS^R."""


@dataclass(frozen=True, kw_only=True)
class PaperCase:
    """One column of Table 5.

    Parameters
    ----------
    frequency : float
        Natural frequency f_n [Hz].
    damping_ratio : float
        ξ [-].
    estimated_delay : float
        α_es of the inverse compensation [steps].
    amplitude : float
        Amplitude error, as a gain [-].
    specimen_stiffness, frame_stiffness : float, optional
        k_e and k_n [N/m].
    """

    frequency: float
    damping_ratio: float
    estimated_delay: float
    amplitude: float
    specimen_stiffness: float = 3.50
    frame_stiffness: float = 1e-6

    @property
    def mass(self) -> float:
        """Mass m = (k_e + k_n)/(2πf_n)² [kg]."""
        total = self.specimen_stiffness + self.frame_stiffness
        return total / (2.0 * np.pi * self.frequency) ** 2

    @property
    def structure(self) -> Structure:
        """The frame with its spring."""
        fraction = self.specimen_stiffness / (self.specimen_stiffness + self.frame_stiffness)
        return Structure(
            frequency=self.frequency, damping_ratio=self.damping_ratio, experimental_fraction=fraction
        )


PAPER_CASES = (
    PaperCase(frequency=1.0, damping_ratio=0.02, estimated_delay=3.6, amplitude=1.0037),
    PaperCase(frequency=0.6, damping_ratio=0.02, estimated_delay=2.7, amplitude=1.0035),
    PaperCase(frequency=1.0, damping_ratio=0.05, estimated_delay=3.4, amplitude=1.0117),
    PaperCase(frequency=1.0, damping_ratio=0.02, estimated_delay=3.2, amplitude=1.0074),
)
"""Table 5."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CaseOutcome:
    """What became of a case.

    Attributes
    ----------
    case : PaperCase
        The case.
    amplitude : float
        A [-].
    equivalent_delay : float
        d [s].
    rms : float
        RMS^R between exact response and measured displacement [-].
    times : numpy.ndarray
        Times [s], shape (n,).
    ideal, measured : numpy.ndarray
        Exact response and measured displacement [m], shape (n,).
    """

    case: PaperCase
    amplitude: float
    equivalent_delay: float
    rms: float
    times: NDArray[np.float64]
    ideal: NDArray[np.float64]
    measured: NDArray[np.float64]


def run_paper_cases(motion: Motion, cases: Sequence[PaperCase] = PAPER_CASES) -> list[CaseOutcome]:
    """Simulate cases under a ground motion.

    Parameters
    ----------
    motion : Motion
        The ground motion, KOBE/KJM000 in the paper; its first 40 s are used.
    cases : sequence of PaperCase, optional
        The cases; those of Table 5 by default.

    Returns
    -------
    list of CaseOutcome
        One for each case.
    """
    record = resample(truncate(motion, min(RECORD_SECONDS, motion.duration)), RATE_HZ)
    return [_run(record, case) for case in cases]


def _run(record: Motion, case: PaperCase) -> CaseOutcome:
    integrator = ChenRicles(structure=case.structure)
    perfect = HybridTest(structure=case.structure, mass=case.mass)
    flawed = HybridTest(
        structure=case.structure,
        mass=case.mass,
        actuator=Actuator(gain=case.amplitude, delay=(DELAY_STEPS - 1) / RATE_HZ),
    )
    first, second = (
        run_closed_loop(
            test, record.acceleration, record.time_step, integrator=integrator, compensator=compensator
        )
        for test, compensator in (
            (perfect, None),
            (flawed, InverseCompensation(steps=case.estimated_delay)),
        )
    )
    ideal = first.command.values[0]
    found = frequency_evaluation(second.command.values[0], second.measured, record.time_step)
    return CaseOutcome(
        case=case,
        amplitude=found.amplitude,
        equivalent_delay=found.equivalent_delay,
        rms=response_error(second.measured, ideal),
        times=record.times,
        ideal=ideal,
        measured=second.measured,
    )
