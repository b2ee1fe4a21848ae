"""Figures of a diagnosis, from its blocks."""

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy import BlockDiagnosis, Channel, Diagnosis
from reliab.discrepancy.adding.posterior import Posterior
from reliab.loop.effects import find_effect
from reliab.report.document import Figure
from reliab.report.figures.discrepancy_blocks import discrepancy_blocks
from reliab.report.figures.discrepancy_gap import GapPanel, discrepancy_gap
from reliab.report.figures.discrepancy_posterior import discrepancy_posterior
from reliab.report.figures.discrepancy_state_plane import discrepancy_state_plane
from reliab.report.figures.discrepancy_time_frequency import discrepancy_time_frequency
from reliab.report.prose import prose
from reliab.vocabulary import Block

_UNITS = {Channel.MEASURED: ("mm", 1e3), Channel.FORCE: ("N", 1.0)}
_HIGHEST = 45.0  # Hz
_DENSITY_POINTS = 1025
_MOST_PARAMETERS = 5


def block_figure(found: Diagnosis) -> Figure:
    """Draw the loop with what is missing."""
    guilty: dict[Block, str] = {}
    for effect in (*found.effects, *found.doubtful):
        block = effect.effect.block
        names = [guilty[block]] if block in guilty else []
        guilty[block] = "\n".join([*names, effect.name.replace("_", " ")])
    if found.unknown is not None:
        guilty[Block(found.unknown.block)] = "unknown effect"
    observed = {one.block.block for one in found.blocks}
    observed |= {candidate.block for one in found.blocks for candidate in one.block.candidates}
    caption = "The loop of the test; blocks that no recorded channel shows are dashed."
    return Figure(
        drawing=discrepancy_blocks(guilty=guilty, observed=observed), caption=caption, label="fig:blocks"
    )


def _held_out(one: BlockDiagnosis) -> tuple[str, NDArray[np.float64], NDArray[np.float64]]:
    """File and residuals of the held-out test in which the calibrated model fails most."""
    file = max(one.residuals_before, key=lambda name: float(np.std(one.residuals_before[name])))
    return file, one.residuals_before[file], one.residuals_after[file]


def _noise(one: BlockDiagnosis) -> float:
    """RMS of the noise in the unit of the channel."""
    left = np.concatenate(list(one.residuals_before.values()))
    return float(np.sqrt(np.mean(left**2))) * one.gap.floor / one.gap.before


def _density(one: BlockDiagnosis) -> NDArray[np.float64]:
    """Spectrum of the noise; what a converter adds to it is white."""
    frequency = np.linspace(0.0, 0.5 * one.block.rate, _DENSITY_POINTS)
    white = max(_noise(one) ** 2 - one.best.noise.rms**2, 0.0)
    return one.best.noise.density(frequency) + white


def time_frequency_figure(one: BlockDiagnosis) -> Figure:
    """Draw residuals of a block over time and frequency."""
    file, before, after = _held_out(one)
    rate = one.block.rate
    drawing = discrepancy_time_frequency(
        before,
        after,
        density=_density(one),
        rate=rate,
        highest=min(_HIGHEST, 0.5 * rate),
    )
    caption = prose(
        "Power of the residual of {channel} over that of the noise, held-out test {file}.",
        channel=str(one.block.channel),
        file=file,
    )
    return Figure(drawing=drawing, caption=caption, label=f"fig:time-{one.block.block}", floats=True)


def state_plane_figure(one: BlockDiagnosis) -> Figure:
    """Draw residuals of a block over the state of the specimen."""
    file, before, after = _held_out(one)
    test = next(k for k, each in enumerate(one.block.tests) if each.file == file)
    motion = one.block.motions[test].values
    unit, factor = _UNITS[one.block.channel]
    drawing = discrepancy_state_plane(motion[0], motion[1], before, after, unit=unit, factor=factor)
    caption = prose(
        "Mean residual of {channel} over displacement and velocity, held-out test {file}.",
        channel=str(one.block.channel),
        file=file,
    )
    return Figure(drawing=drawing, caption=caption, label=f"fig:state-{one.block.block}", floats=True)


def gap_figure(found: Diagnosis) -> Figure:
    """Draw what is left in every observed channel."""
    caption = (
        "Residuals on a held-out test before and after what was found is added, and their size over all "
        "held-out tests beside that of the noise."
    )
    drawing = discrepancy_gap([_panel(one) for one in found.blocks])
    return Figure(drawing=drawing, caption=caption, label="fig:gap")


def _panel(one: BlockDiagnosis) -> GapPanel:
    file, before, after = _held_out(one)
    unit, factor = _UNITS[one.block.channel]
    return GapPanel(
        title=f"{one.block.block}: {one.block.channel}, {file}",
        label=f"Residual [{unit}]",
        rate=one.block.rate,
        before=factor * before,
        after=factor * after,
        noise=factor * _noise(one),
        errors=(one.gap.before, one.gap.after, one.gap.floor),
    )


def _meaning(name: str) -> str:
    """Words for a parameter of an effect, by "effect.parameter"."""
    effect, _, parameter = name.partition(".")
    return next(one.meaning for one in find_effect(effect).parameters if one.name == parameter)


def posterior_figure(found: Diagnosis, block: str, posterior: Posterior) -> Figure:
    """Draw the posterior of the effects that are named in a block."""
    named = {effect.name for one in found.blocks if str(one.block.block) == block for effect in one.effects}
    chosen = [k for k, name in enumerate(posterior.names) if name.split(".")[0] in named][:_MOST_PARAMETERS]
    names = [f"{_meaning(posterior.names[k])} [{posterior.units[k]}]" for k in chosen]
    caption = prose(
        "Posterior of the effects in the {block}: 90 % intervals, and contours around 50 and 90 % of draws.",
        block=block,
    )
    drawing = discrepancy_posterior(names, posterior.draws[:, chosen])
    return Figure(drawing=drawing, caption=caption, label=f"fig:posterior-{block}", floats=True)
