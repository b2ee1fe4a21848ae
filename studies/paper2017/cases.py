"""The paper's application: a frame with a spring under KOBE/KJM000, Tables 5 and 6, Figures 16 and 17.

A single-degree-of-freedom frame of stiffness k_n carries a spring of stiffness k_e, the specimen. The
command is integrated with the CR algorithm at 1024 Hz and sent through inverse compensation to an
actuator that is four steps late, counted from when the command is sent, one step before it is due; the
amplitude error is a gain. The first simulation has no error, the second both.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeVar

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from reliab_studies.laboratory.compensators.feedforward import Feedforward
from reliab_studies.laboratory.compensators.inverse import InverseCompensation
from reliab_studies.laboratory.compensators.polynomial_extrapolation import PolynomialExtrapolation
from reliab_studies.laboratory.integrators import CentralDifference, ChenRicles, OperatorSplitting

from reliab.core.errors import InputError
from reliab.core.vocabulary import MILLI
from reliab.criterion.criterion import Criterion
from reliab.criterion.laws.registry import MANY_MOTION_LAWS
from reliab.motions.motion import Motion, resample
from reliab.simulation.hybrid_test.closed_loop import Compensator, run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.integrators import ExactIntegrator, Integrator
from reliab.structures.structure import Structure
from reliab.tracking.indices.response_error import response_error
from reliab.tracking.indices.tracking import frequency_evaluation

from .printed import FIVE_PERCENT, FRAME_STIFFNESS, RATE_HZ, SPECIMEN_STIFFNESS, PrintedTables

DELAY_STEPS = 4
"""Steps by which the actuator is late; not printed, but in Table 6 d is this less α_es, in steps."""

RECORD_SECONDS = 40.0
"""Length of the record that reproduces Table 6; the full record gives about half the RMS^R."""


@dataclass(frozen=True, kw_only=True)
class PaperCase:
    """One column of Table 5.

    `frequency`: natural frequency f_n [Hz]; `damping_ratio`: ξ [-]; `estimated_delay`: α_es of the inverse
    compensation [steps]; `amplitude`: amplitude error, as a gain [-]; `specimen_stiffness`,
    `frame_stiffness`: k_e and k_n [N/m].
    """

    frequency: float
    damping_ratio: float
    estimated_delay: float
    amplitude: float
    specimen_stiffness: float = SPECIMEN_STIFFNESS
    frame_stiffness: float = FRAME_STIFFNESS

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


def list_printed_cases() -> list[PaperCase]:
    """Cases of Table 5 as printed."""
    columns = ("f_hz", "xi", "alpha_es", "amplitude_error")
    rows = PrintedTables.read().cases[list(columns)].itertuples(index=False)
    return [
        PaperCase(frequency=f, damping_ratio=xi, estimated_delay=steps, amplitude=gain)
        for f, xi, steps, gain in rows
    ]


@dataclass(frozen=True, kw_only=True, eq=False)
class CaseOutcome:
    """The outcome of a case.

    `amplitude`: A [-]; `equivalent_delay`: d [s]; `rms`: RMS^R between exact response and measured
    displacement [-]; `times`: times [s], shape (n,); `ideal`, `measured`: exact response and measured
    displacement [m], shape (n,).
    """

    case: PaperCase
    amplitude: float
    equivalent_delay: float
    rms: float
    times: NDArray[np.float64]
    ideal: NDArray[np.float64]
    measured: NDArray[np.float64]


def run_paper_cases(
    motion: Motion,
    cases: Sequence[PaperCase] | None = None,
    *,
    integrator: str = "chen_ricles",
    compensator: str = "inverse",
) -> list[CaseOutcome]:
    """Simulate cases under a ground motion."""
    samples = math.floor(RECORD_SECONDS / motion.time_step + 1e-9) + 1
    record = resample(replace(motion, acceleration=motion.acceleration[:samples]), RATE_HZ)
    cases_to_run = list_printed_cases() if cases is None else cases
    return [_run(record, case, integrator, compensator) for case in cases_to_run]


def _run(record: Motion, case: PaperCase, integrator: str, compensator: str) -> CaseOutcome:
    perfect = HybridTest(structure=case.structure, mass=case.mass)
    flawed = HybridTest(
        structure=case.structure,
        mass=case.mass,
        actuator=Actuator(gain=case.amplitude, delay=(DELAY_STEPS - 1) / RATE_HZ),
    )
    first, second = (
        run_closed_loop(
            test,
            record.acceleration,
            record.time_step,
            integrator=integrator_of(integrator, case.structure),
            compensator=control,
        )
        for test, control in ((perfect, None), (flawed, compensator_of(compensator, case.estimated_delay)))
    )
    ideal = first.command.values[0]
    index = frequency_evaluation(second.command.values[0], second.measured, record.time_step)
    return CaseOutcome(
        case=case,
        amplitude=index.amplitude,
        equivalent_delay=index.equivalent_delay,
        rms=response_error(second.measured, ideal),
        times=record.times,
        ideal=ideal,
        measured=second.measured,
    )


def cases_dataset(outcomes: Sequence[CaseOutcome], motion: Motion) -> xr.Dataset:
    """Gather the outcomes of the cases of Tables 5 and 6.

    Over `case` (1, 2, …): `f` [Hz], `xi`, `estimated_delay` [steps], `gain`, `mass` [kg], `A`, `d` [s] and
    `rms` [-]; over (case, time [s]): `ideal` and `measured` displacement [m]. Attributes: `motion`,
    `peak_acceleration` [m/s²] and `window` [s], over which the error is computed.
    """
    cases = [outcome.case for outcome in outcomes]
    numbers = {
        "f": [case.frequency for case in cases],
        "xi": [case.damping_ratio for case in cases],
        "estimated_delay": [case.estimated_delay for case in cases],
        "gain": [case.amplitude for case in cases],
        "mass": [case.mass for case in cases],
        "A": [outcome.amplitude for outcome in outcomes],
        "d": [outcome.equivalent_delay for outcome in outcomes],
        "rms": [outcome.rms for outcome in outcomes],
    }
    histories = {
        "ideal": np.stack([outcome.ideal for outcome in outcomes]),
        "measured": np.stack([outcome.measured for outcome in outcomes]),
    }
    return xr.Dataset(
        {
            **{name: ("case", values) for name, values in numbers.items()},
            **{name: (("case", "time"), values) for name, values in histories.items()},
        },
        coords={"case": np.arange(1, len(cases) + 1), "time": outcomes[0].times},
        attrs={
            "motion": motion.name,
            "peak_acceleration": float(np.abs(motion.acceleration).max()),
            "window": min(RECORD_SECONDS, motion.duration),
        },
    )


def case_table(cases: xr.Dataset) -> pd.DataFrame:
    """Verdicts on the cases by equation (18) and by their errors, beside what the paper prints.

    One row for each case: `case`, `f` [Hz], `xi`, `A`, `d` [s]; `index` of equation (18) and `index_printed`;
    `accepted` and `accepted_printed`; `rms` and `rms_printed` [-]; `good`, whether the error is at most 5 %;
    `of_rms`, the error relative to the RMS, not the peak, of the exact response.
    """
    printed = PrintedTables.read().cases.set_index("case").loc[cases["case"].values]
    f, xi, amplitude, delay, rms = (cases[name].values for name in ("f", "xi", "A", "d", "rms"))
    a, b = MANY_MOTION_LAWS["guo_2017_18"].limits(f, xi)
    index = (amplitude - 1.0) ** 2 / a + (MILLI * delay) ** 2 / b
    ideal = cases["ideal"].transpose("case", "time").values
    crest = np.abs(ideal).max(axis=1) / np.sqrt(np.mean(ideal**2, axis=1))
    return pd.DataFrame(
        {
            "case": cases["case"].values,
            "f": f,
            "xi": xi,
            "A": amplitude,
            "d": delay,
            "index": index,
            "index_printed": printed["index_eq18"].to_numpy(dtype=np.float64),
            "accepted": index <= 1.0,
            "accepted_printed": printed["fulfils_eq18"].to_numpy() == "Yes",
            "rms": rms,
            "rms_printed": printed["rms_percent"].to_numpy(dtype=np.float64) / 100.0,
            "good": rms <= FIVE_PERCENT,
            "of_rms": rms * crest,
        }
    )


CriterionOf = Callable[[float, float], Criterion]
"""Gives the criterion of a structure: frequency [Hz] and damping ratio [-]."""


def case_verdicts(
    motion: Motion,
    criteria: Mapping[str, CriterionOf],
    *,
    integrator: str = "chen_ricles",
    compensator: str = "inverse",
) -> pd.DataFrame:
    """Simulate the paper's cases under a ground motion and compare criteria with the errors.

    One row for each case and criterion: `case`, `f` [Hz], `xi` [-], `estimated_delay` [steps], `A` [-],
    `d_ms`, `rms` [-], `good` (the error is at most the threshold), `criterion`, `index` [-], `accepted`, and
    `probability` [-] of staying below the threshold, None where it is unknown.
    """
    rows = []
    outcomes = run_paper_cases(motion, integrator=integrator, compensator=compensator)
    for number, outcome in enumerate(outcomes, start=1):
        case = outcome.case
        for name, criterion_of in criteria.items():
            criterion = criterion_of(case.frequency, case.damping_ratio)
            at = (outcome.amplitude, outcome.equivalent_delay, case.frequency, case.damping_ratio)
            index = float(criterion.index(*at))
            rows.append(
                {
                    "case": number,
                    "f": case.frequency,
                    "xi": case.damping_ratio,
                    "estimated_delay": case.estimated_delay,
                    "A": outcome.amplitude,
                    "d_ms": MILLI * outcome.equivalent_delay,
                    "rms": outcome.rms,
                    "good": outcome.rms <= criterion.threshold,
                    "criterion": name,
                    "index": index,
                    "accepted": index <= 1.0,
                    "probability": float(criterion.probability(*at)) if criterion.population else None,
                }
            )
    return pd.DataFrame(rows)


Maker = TypeVar("Maker")

INTEGRATORS: Final[Mapping[str, Callable[[Structure], Integrator]]] = {
    "chen_ricles": lambda structure: ChenRicles(structure=structure),
    "central_difference": lambda _: CentralDifference(),
    "operator_splitting": lambda structure: OperatorSplitting(structure=structure),
    "exact": lambda _: ExactIntegrator(),
}
"""Integrators by name; each takes the structure of a case."""

COMPENSATORS: Final[Mapping[str, Callable[[float], Compensator | None]]] = {
    "inverse": lambda steps: InverseCompensation(steps=steps),
    "feedforward": lambda steps: Feedforward(time=(steps - 1.0) / RATE_HZ),
    "polynomial_extrapolation": lambda steps: PolynomialExtrapolation(steps=max(1, round(steps - 1.0))),
    "none": lambda _: None,
}
"""Compensators by name; each takes the delay that the case estimates [steps], counted from when the command
is sent, one step before it is due."""


def integrator_of(name: str, structure: Structure) -> Integrator:
    """Make the integrator of a name for a structure."""
    return _choose_maker(INTEGRATORS, "integrator", name)(structure)


def compensator_of(name: str, steps: float) -> Compensator | None:
    """Make the compensator of a name for an estimated delay [steps]; None for no compensation."""
    return _choose_maker(COMPENSATORS, "compensator", name)(steps)


def _choose_maker(choices: Mapping[str, Maker], what: str, name: str) -> Maker:
    if name not in choices:
        raise InputError(
            f"The {what} of the paper's cases must be known",
            value=name,
            remedy=f"Choose among {', '.join(choices)}",
        )
    return choices[name]
