"""Effects in a block that are not in the library."""

from collections.abc import Sequence

import numpy as np

from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.locating.line_above import line_above
from reliab.discrepancy.locating.standstill import standstill
from reliab.discrepancy.naming.estimates import estimates
from reliab.discrepancy.result.gap import Gap
from reliab.discrepancy.result.missing_effect import Unknown
from reliab.discrepancy.spectra.segment import energy_of
from reliab.discrepancy.terms import OutsideTerm
from reliab.discrepancy.terms.periodic import Disturbance
from reliab.signals import NoiseModel
from reliab.significant import significant
from reliab.vocabulary import Block

LARGEST_REMAINDER = 0.2
"""Share of the gap's energy that may remain unexplained where the effects are `named`.

What remains is then at most half of what the effects explain, in RMS. Beyond it the verdict is
`unknown_effect`."""

_ABOVE_FLOOR = 2.0
"""Times the noise floor from which a remainder is called an effect where no effect was found: three quarters
of its energy are then no noise."""

SMALLEST_GAP = 0.1
"""RMS of a remainder over that of the signal from which it is called an effect where no effect was found."""


def unexplained(judged: tuple[Problem, Fit], best: Fit, proved: Gap, *, noise: bool) -> Unknown | None:
    """Return an effect outside the library, or a remainder that is too large beside the found effects."""
    problem = judged[0]
    outside = [kind for kind in best.space.effects if issubclass(kind, OutsideTerm)]
    interrupted = _interrupted(problem, judged[1], proved.after)
    if interrupted is not None:
        return interrupted
    if outside:
        return _unknown(outside, best, proved.after)
    disturbance = _disturbance(problem, judged[1], proved.after)
    if disturbance is not None:
        return disturbance
    return None if noise else _remainder(judged[0], best, proved)


def _remainder(problem: Problem, best: Fit, proved: Gap) -> Unknown | None:
    """Return an error of the model that is large beside the found effects, or beside the signal.

    The force that balances a command is computed from derivatives of the command. Where these are rough, at
    frequencies above those that are judged, the error is one of this computation.
    """
    if _is_balanced(problem) and not _judged_error(problem, best) > SMALLEST_GAP:
        return None
    large = proved.model_error > SMALLEST_GAP
    if best.space.effects:
        large = large and proved.unexplained_share > LARGEST_REMAINDER
    elif proved.floor is not None:
        large = large or proved.after > _ABOVE_FLOOR * proved.floor
    if not large:
        return None
    return Unknown(
        block=str(problem.block.block),
        expression="",
        description="the remainder follows the motion, and no effect or term that was tried explains it",
        held_out_nrmse=proved.after,
    )


def _is_balanced(problem: Problem) -> bool:
    """Whether the channel is the force that the numerical substructure would balance."""
    return problem.block.block is Block.NUMERICAL and problem.block.channel is Channel.FORCE


def _judged_error(problem: Problem, best: Fit) -> float:
    """RMS of what a model leaves over that of the channel, at the frequencies at which it is judged."""
    unit = NoiseModel.white(problem.block.rate, 1.0)
    rows = problem.whitened(best.space, best.coordinates, unit)
    signal = sum(energy_of(s.spectrum(problem.measured(s.test))) for s in problem.segments)
    return float(np.sqrt(rows @ rows / max(signal, 1e-300)))


def _unknown(outside: Sequence[type[OutsideTerm]], best: Fit, error: float) -> Unknown:
    terms = []
    for effect in outside:
        values = ", ".join(f"{e.name} = {e.value:.4g} {e.units}" for e in estimates(effect, best))
        terms.append(f"{effect.expression} ({values})")
    description = "; ".join(effect.description for effect in outside)
    return Unknown(
        block=str(outside[0].block),
        expression=" + ".join(terms),
        description=description,
        held_out_nrmse=error,
    )


def _interrupted(problem: Problem, best: Fit, error: float) -> Unknown | None:
    """Describe a reading that stands still now and then.

    The force that the numerical substructure would balance is no prediction of the load cell: it is computed
    back from the command, which a controller with steps of its own holds, too.
    """
    seen = None if _is_balanced(problem) else standstill(problem, best)
    if seen is None:
        return None
    return Unknown(
        block=str(problem.block.block),
        expression=f"{problem.block.channel} held {seen.events} times, for {significant(seen.seconds)} s "
        "as a rule",
        description="the reading stands still now and then while the model moves on: the sensor drops out",
        held_out_nrmse=error,
    )


def _disturbance(problem: Problem, best: Fit, error: float) -> Unknown | None:
    """Describe a disturbance at frequencies that are too high to judge models."""
    line = line_above(problem, best)
    if line is None:
        return None
    return Unknown(
        block=str(problem.block.block),
        expression=f"{line.amplitude:.4g} N sin(2π {line.frequency:.4g} Hz t + phase)",
        description=Disturbance.description,
        held_out_nrmse=error,
    )
