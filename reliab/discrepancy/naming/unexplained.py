"""Effects that are not in the library: other terms, a reading that drops out, a disturbance, a remainder."""

from collections.abc import Sequence

import numpy as np
import scipy
from scipy import fft

from reliab.core.arrays import Array
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.locate import Finding
from reliab.discrepancy.result.gap import FLOOR_EXCESS, Gap
from reliab.discrepancy.result.missing_effect import Unknown, estimates
from reliab.effects.general.general_term import GeneralTerm
from reliab.effects.general.periodic import Disturbance
from reliab.signals.filters import filter_symmetrically, low_pass
from reliab.signals.noise import near_mains
from reliab.signals.spectra import detrend, hann

LARGEST_REMAINDER = 0.2
"""Share of the gap's energy that may remain unexplained where the effects are `named`, in the kind of
held-out test of which they explain least.

What remains is then at most half of what the effects explain, in RMS. Beyond it the verdict is
`unknown_effect`."""

SMALLEST_GAP = 0.1
"""RMS of a remainder over that of the signal from which it is called an effect where no effect was found."""

_CHANCE = 1e-7  # that noise alone shows a line anywhere
_LEAST = 8.0  # times the power around it, on the average of the stretches
_SPRING_EXCESS = 9.0  # times the power with which the spring answers what the displacement shows
_AROUND = 25  # bins
_AUDIBLE = 0.05  # of the energy of all that is left: every recording has lines far below its noise
_FEWEST_SAMPLES = 5
_FEWEST_EVENTS = 3
_TIMES = 4.0  # of what the reading usually differs by
_SHARE = 0.01  # of the channel's RMS
_LEAST_OF_REMAINDER = 0.05  # share of the energy that the model leaves


def find_unexplained(
    noise_judgement: tuple[Problem, Fit],
    best: Fit,
    general_terms: Sequence[type[GeneralTerm]],
    proof_gap: Gap,
    remaining: Sequence[Finding] | None,
    *,
    is_named: bool,
    comparison: str,
) -> Unknown | None:
    """Return an effect outside the library, or a remainder that is too large.

    `general_terms` holds terms of the best model that are no members of the library; `remaining` what the
    remainder varies with, None where it is noise; `comparison` says how well models do. Where effects have a
    name they must explain enough of every kind of held-out test, however small the remainder is.
    """
    problem, fit = noise_judgement
    formula, block = "", str(problem.block.block)
    if dropout := standstill(problem, fit):
        expression, description = dropout
    elif general_terms:
        parameters = [estimates(effect, best) for effect in general_terms]
        values = [", ".join(f"{e.name} = {e.value:.4g} {e.units}" for e in items) for items in parameters]
        sizes = [", ".join(f"{e.meaning} {e.size}" for e in items) for items in parameters]
        shapes = [effect.expression for effect in general_terms]
        expression = " + ".join(f"{shape} ({value})" for shape, value in zip(shapes, values, strict=True))
        formula = "; and ".join(f"{shape}, with {size}" for shape, size in zip(shapes, sizes, strict=True))
        description = "; ".join(effect.description for effect in general_terms)
        block = str(general_terms[0].block)
    elif line := line_above(problem, fit):
        expression, description = line
    else:
        large = remaining is not None and _is_large(problem.block, proof_gap)
        if explains_enough(proof_gap) if is_named else not large:
            return None
        expression = ""
        description = f"the remainder follows the motion: {comparison}{_looks(remaining or ())}"
    return Unknown(
        block=block,
        expression=expression,
        description=description,
        held_out_nrmse=proof_gap.after,
        formula=formula,
    )


def explains_enough(proof_gap: Gap) -> bool:
    """Whether what was found may be `named`: it explains the kind of held-out test that it explains least."""
    share = proof_gap.worst_unexplained_share
    return share is None or share <= LARGEST_REMAINDER


def _is_large(block: ObservedBlock, proof_gap: Gap) -> bool:
    """Whether the error of a model is large beside the signal, or beside the noise floor.

    The derivatives from which a narrow block computes its channel have noise of their own, above that floor.
    """
    floor = None if block.is_narrow else proof_gap.floor
    exceeds_floor = floor is not None and proof_gap.after > FLOOR_EXCESS * floor
    return proof_gap.model_error > SMALLEST_GAP or exceeds_floor


def _looks(remaining: Sequence[Finding]) -> str:
    """Say what a remainder looks like, by what it varies with most."""
    telling = [finding for finding in remaining if finding.kind != "frequency_band"] or list(remaining)
    if not telling:
        return ""
    return f"; {percent(telling[0].share_of_residual, decimals=0)} of it: {telling[0].detail.rstrip('.')}"


def line_above(problem: Problem, best: Fit) -> tuple[str, str] | None:
    """Describe the strongest line of a force above the frequencies that are judged, up to those of a signal.

    Where only a noisy displacement was recorded, models of the specimen are judged up to the frequency at
    which it is mostly signal; a disturbance may act above. Its line must stand out in all stretches together,
    exceed the spring's response to a line of the displacement, and be no multiple of the mains' frequency.
    """
    block = problem.block
    if block.block is not Block.SPECIMEN or block.highest >= block.highest_signal:
        return None
    longest = max(problem.segments, key=lambda segment: segment.end - segment.begin)
    grid = np.arange((longest.end - longest.begin) // 2) * block.rate / (longest.end - longest.begin)
    residual = problem.residuals(best)
    forces = _powers(problem, residual, grid)
    read = {s.test: block.tests[s.test].channels[Channel.MEASURED] for s in problem.segments}
    specimen = best.space.model(best.coordinates).specimen
    spring = 0.0 if specimen is None else specimen.stiffness
    around = scipy.ndimage.median_filter(forces, (1, _AROUND)) / np.log(2.0)
    clear = np.mean(forces / np.maximum(around, 1e-300), axis=0)
    spring_power = _SPRING_EXCESS * spring**2 * _powers(problem, read, grid).mean(axis=0)
    clear[forces.mean(axis=0) < spring_power] = 0.0
    clear[(grid <= block.highest) | (grid >= block.highest_signal)] = 0.0
    clear[near_mains(grid, 0.5 * block.rate)] = 0.0
    place = int(np.argmax(clear))
    if clear[place] < _threshold(len(problem.segments), grid.size):
        return None
    frequency, amplitudes = float(grid[place]), []
    parts = [residual[s.test][s.begin : s.end] for s in problem.segments]
    for part in parts:
        turns = np.exp(-2j * np.pi * frequency / block.rate * np.arange(part.size))
        amplitudes.append(2.0 * np.abs((hann(part.size) * part) @ turns) / hann(part.size).sum())
    amplitude = float(np.sqrt(np.mean(np.square(amplitudes))))
    if 0.5 * amplitude**2 < _AUDIBLE * float(np.mean([part.var() for part in parts])):
        return None
    return f"{amplitude:.4g} N sin(2π {frequency:.4g} Hz t + phase)", Disturbance.description


def _threshold(stretches: int, trials: int) -> float:
    """Mean power over its expectation that noise exceeds by chance only."""
    return max(float(scipy.special.gammainccinv(stretches, _CHANCE / trials)) / stretches, _LEAST)


def _powers(problem: Problem, values: dict[int, Array], grid: Array) -> Array:
    """Power of each segment under a window that keeps strong slow parts where they are, on one grid."""
    rows = []
    for segment in problem.segments:
        stretch = detrend(values[segment.test][segment.begin : segment.end])
        power = np.abs(fft.rfft(stretch * hann(stretch.size))) ** 2 / stretch.size
        rows.append(np.interp(grid, fft.rfftfreq(stretch.size, 1.0 / segment.rate), power))
    return np.stack(rows)


def standstill(problem: Problem, best: Fit) -> tuple[str, str] | None:
    """Describe a reading that stands still now and then although the model moves on: the sensor drops out.

    Noise and motion make every sample differ from the one before it. A run of equal samples counts where the
    model moves on by much more than the reading usually changes, or misses it. Equal samples at the ends of a
    record are rest, and a few events that contain almost none of the residual are no explanation. The force
    that the numerical substructure would balance is no prediction of the load cell: it is computed back from
    the command, which a controller with steps of its own holds, too.
    """
    if problem.block.is_narrow:
        return None
    block, lengths = problem.block, list[int]()
    event_energy = total_energy = 0.0
    for test, residual in problem.residuals(best).items():
        read = block.measured(test)
        usual = max(problem.steps[test], float(np.median(np.abs(residual))))
        for begin, end in _standing_stretches(read, read - residual, usual, block.highest / block.rate):
            lengths.append(end - begin)
            event_energy += float((residual[begin:end] ** 2).sum())
        total_energy += float((residual**2).sum())
    if len(lengths) < _FEWEST_EVENTS or event_energy < _LEAST_OF_REMAINDER * total_energy:
        return None
    seconds = significant(float(np.median(lengths)) / block.rate)
    return (
        f"{block.channel} held {len(lengths)} times, for {seconds} s typically",
        "the reading stands still now and then while the model moves on: the sensor drops out",
    )


def _standing_stretches(
    read: Array, expected_signal: Array, usual: float, highest: float
) -> list[tuple[int, int]]:
    """First sample of each event in a test and the one after the last.

    The model moves on where its part below the highest frequency, in units of the sampling rate, does.
    """
    changes = np.diff(read)
    edges = np.concatenate([[0], np.flatnonzero(changes) + 1, [read.size]])
    runs = [
        (begin, end)
        for begin, end in zip(edges[1:-2].tolist(), edges[2:-1].tolist(), strict=True)
        if end - begin >= _FEWEST_SAMPLES
    ]
    if not runs:
        return []
    expected_signal = filter_symmetrically(expected_signal, low_pass(highest, 1.0))
    if changes.any():
        usual = max(usual, float(np.median(np.abs(changes[changes != 0.0]))))
    least = _TIMES * usual + _SHARE * float(read.std())
    return [(begin, end) for begin, end in runs if float(np.ptp(expected_signal[begin:end])) > least]
