"""Figures of a diagnosis, from its blocks."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from reliab.core.significant_digits import readable_unit
from reliab.core.vocabulary import Block
from reliab.discrepancy.campaign.campaign import Channel
from reliab.discrepancy.posterior import Posterior
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.report.document import Block as DocumentBlock, Figure
from reliab.report.figures.discrepancy import (
    STRETCHES,
    GapPanel,
    ModelledHistory,
    discrepancy_blocks,
    discrepancy_gap,
    discrepancy_histories,
    discrepancy_posterior,
    discrepancy_state_plane,
    discrepancy_time_frequency,
)
from reliab.report.prose import prose, spell_out

_STRETCHES, _SHORTEST_STRETCH = 5, 4.0  # of a test; s
_UNITS = {
    Channel.COMMAND: ("mm", 1e3),
    Channel.GROUND: ("m/s²", 1.0),
    Channel.MEASURED: ("mm", 1e3),
    Channel.FORCE: ("N", 1.0),
}
_HIGHEST = 45.0  # Hz
_DENSITY_POINTS = 1025
_MOST_PARAMETERS = 5
_NEARLY_ALL, _FEWEST_ROWS = 0.99, 6.0  # of a residual's power; rows of a spectrogram
_KILO = 1e4  # N, of the force from which it is shown in kN


def block_figure(diagnosis: Diagnosis) -> Figure:
    """Draw the loop with what is missing."""
    lacking: dict[Block, str] = {}
    for effect in (*diagnosis.effects, *diagnosis.doubtful):
        block = effect.effect.block
        names = [lacking[block]] if block in lacking else []
        lacking[block] = "\n".join([*names, spell_out(effect.name)])
    if diagnosis.unknown is not None:
        lacking[Block(diagnosis.unknown.block)] = "unknown effect"
    observed = {block_diagnosis.block.block for block_diagnosis in diagnosis.blocks}
    observed |= {
        candidate.block
        for block_diagnosis in diagnosis.blocks
        for candidate in block_diagnosis.block.candidates
    }
    caption = "The loop of the test; blocks that no recorded channel shows are dashed."
    return Figure(
        drawing=discrepancy_blocks(lacking=lacking, observed=observed), caption=caption, label="fig:blocks"
    )


def _place(block_diagnosis: BlockDiagnosis, file: str) -> int:
    """Place of a test among those of a block."""
    return next(k for k, test in enumerate(block_diagnosis.block.tests) if test.file == file)


def _residuals_of_held_out_test(
    block_diagnosis: BlockDiagnosis,
) -> tuple[str, NDArray[np.float64], NDArray[np.float64]]:
    """File and residuals of the held-out test in which the calibrated model fails most."""
    file = max(
        block_diagnosis.residuals_before,
        key=lambda name: float(np.std(block_diagnosis.residuals_before[name])),
    )
    return file, block_diagnosis.residuals_before[file], block_diagnosis.residuals_after[file]


def _test_in_words(block_diagnosis: BlockDiagnosis, file: str) -> str:
    """Name the test that a figure shows whole, and what of it is held out."""
    third = block_diagnosis.held_out.partition(" of ")[0]
    return f"held-out test {file}" if len(block_diagnosis.block.tests) > 1 else f"{file}, {third} held out"


def _unit(block_diagnosis: BlockDiagnosis) -> tuple[str, float]:
    """Return the unit in which the channel of a block is shown, and the factor to it."""
    unit, factor = _UNITS[block_diagnosis.block.channel]
    largest = max(
        float(np.abs(block_diagnosis.block.measured(s.test)).max()) for s in block_diagnosis.proof.segments
    )
    return ("kN", 1e-3) if unit == "N" and largest > _KILO else (unit, factor)


def _noise(block_diagnosis: BlockDiagnosis) -> float | None:
    """RMS of what the recordings do not repeat, in the unit of the channel; None where it is not known."""
    residuals = np.concatenate(list(block_diagnosis.residuals_before.values()))
    if block_diagnosis.gap.floor is None:
        return None
    return (
        float(np.sqrt(np.mean(residuals**2)))
        * block_diagnosis.gap.floor
        / max(block_diagnosis.gap.before, 1e-300)
    )


def _density(block_diagnosis: BlockDiagnosis) -> NDArray[np.float64]:
    """Smooth spectrum of what the best model leaves of the tests that it was fitted to."""
    frequency = np.linspace(0.0, 0.5 * block_diagnosis.block.rate, _DENSITY_POINTS)
    plain = replace(block_diagnosis.problem, tempering=(), powers=(), conversion={})
    return plain.noise_of(block_diagnosis.best.space, block_diagnosis.best.coordinates).density(frequency)


def _highest_shown_frequency(residual: NDArray[np.float64], rate: float) -> float:
    """Frequency [Hz] of twice the band that holds nearly all of a residual, no fewer than some pixels."""
    frequency, power = signal.periodogram(residual, fs=rate, window="hann")
    summed = np.cumsum(power)
    band = float(frequency[np.searchsorted(summed, _NEARLY_ALL * summed[-1])])
    return max(2.0 * band, _FEWEST_ROWS * STRETCHES * rate / residual.size)


def time_frequency_figure(block_diagnosis: BlockDiagnosis) -> Figure:
    """Draw residuals of a block over time and frequency."""
    file, before, after = _residuals_of_held_out_test(block_diagnosis)
    rate = block_diagnosis.block.rate
    drawing = discrepancy_time_frequency(
        before,
        after,
        density=_density(block_diagnosis),
        rate=rate,
        highest=min(_highest_shown_frequency(before, rate), _HIGHEST, 0.5 * rate),
    )
    caption = prose(
        "Power of the residual of {channel} over that of the noise, {test}.",
        channel=str(block_diagnosis.block.channel),
        test=_test_in_words(block_diagnosis, file),
    )
    return Figure(drawing=drawing, caption=caption, label=f"fig:time-{block_diagnosis.block.block}")


def state_plane_figure(block_diagnosis: BlockDiagnosis) -> Figure:
    """Draw residuals of a block over the state of the specimen."""
    file, before, after = _residuals_of_held_out_test(block_diagnosis)
    test = _place(block_diagnosis, file)
    motion = block_diagnosis.block.motions[test].values
    unit, factor = _unit(block_diagnosis)
    drawing = discrepancy_state_plane(motion[0], motion[1], before, after, unit=unit, factor=factor)
    caption = prose(
        "Mean residual of {channel} over displacement and velocity, {test}.",
        channel=str(block_diagnosis.block.channel),
        test=_test_in_words(block_diagnosis, file),
    )
    return Figure(drawing=drawing, caption=caption, label=f"fig:state-{block_diagnosis.block.block}")


def histories_figure(block_diagnosis: BlockDiagnosis) -> Figure:
    """Draw the channel of a held-out test where it moves most, and what the models leave of it."""
    file, before, after = _residuals_of_held_out_test(block_diagnosis)
    test = _place(block_diagnosis, file)
    measured, driven = (
        block_diagnosis.block.measured(test),
        block_diagnosis.block.tests[test].channels[block_diagnosis.block.inputs[-1]],
    )
    cut = _strongest(measured, block_diagnosis.block.rate)
    unit, factor = _unit(block_diagnosis)
    input_unit, input_factor = _UNITS[block_diagnosis.block.inputs[-1]]
    history = ModelledHistory(
        time=np.arange(measured.size)[cut] / block_diagnosis.block.rate,
        driven=input_factor * driven[cut],
        measured=factor * measured[cut],
        before=factor * before[cut],
        after=factor * after[cut],
        input_label=f"{block_diagnosis.block.inputs[-1]} [{input_unit}]",
        label=f"{block_diagnosis.block.channel} [{unit}]",
        residual_label=f"Residual [{unit}]",
    )
    caption = prose(
        "Measured {channel} of {test} in the stretch in which it is strongest, and its residual below: "
        "over time, and over {driven}.",
        channel=str(block_diagnosis.block.channel),
        test=_test_in_words(block_diagnosis, file),
        driven=str(block_diagnosis.block.inputs[-1]),
    )
    return Figure(
        drawing=discrepancy_histories(history),
        caption=caption,
        label=f"fig:histories-{block_diagnosis.block.block}",
    )


def _strongest(values: NDArray[np.float64], rate: float) -> slice:
    """Stretch of a test, a fifth of it but some seconds at least, that holds most of the signal."""
    length = min(max(values.size // _STRETCHES, int(_SHORTEST_STRETCH * rate)), values.size)
    sums = np.concatenate([[0.0], np.cumsum((values - values.mean()) ** 2)])
    begin = int(np.argmax(sums[length:] - sums[:-length]))
    return slice(begin, begin + length)


def draw_or_skip(what: str, draw: Callable[[], Figure | None]) -> tuple[DocumentBlock, ...]:
    """Return a figure as a block, or a line that says why it could not be drawn; the report goes on."""
    try:
        figure = draw()
    except Exception as error:  # noqa: BLE001 - whatever fails in a figure must cost the figure alone
        reason = f"{type(error).__name__}: {error}"
        return (prose("The figure of {what} could not be drawn ({reason}).", what=what, reason=reason),)
    return () if figure is None else (figure,)


def gap_figure(diagnosis: Diagnosis) -> Figure:
    """Draw what is left in every observed channel."""
    caption = (
        "Residuals on held-out data before and after the effects are added, and their size over all "
        "held-out tests: of the calibrated model (before), the best linear one, the best rival that lacks "
        "one of the effects, the model with the effects (after), and the noise, if they are known."
    )
    drawing = discrepancy_gap([_panel(block_diagnosis) for block_diagnosis in diagnosis.blocks])
    return Figure(drawing=drawing, caption=caption, label="fig:gap", leads=True)


def _panel(block_diagnosis: BlockDiagnosis) -> GapPanel:
    file, before, after = _residuals_of_held_out_test(block_diagnosis)
    unit, factor = _unit(block_diagnosis)
    noise = _noise(block_diagnosis)
    return GapPanel(
        title=f"{block_diagnosis.block.block}: {block_diagnosis.block.channel}, {file}",
        label=f"Residual [{unit}]",
        rate=block_diagnosis.block.rate,
        before=factor * before,
        after=factor * after,
        noise=None if noise is None else factor * noise,
        errors=_errors(block_diagnosis),
    )


def _errors(block_diagnosis: BlockDiagnosis) -> dict[str, float]:
    """Errors on held-out tests of the models that are compared, and of the noise, where it is known."""
    gap = block_diagnosis.gap
    errors = {
        "before": gap.before,
        "linear": gap.linear if block_diagnosis.linear else None,
        "rival": gap.rival,
        "after": gap.after,
        "noise": gap.floor,
    }
    return {name: error for name, error in errors.items() if error is not None}


def posterior_figure(diagnosis: Diagnosis, block: str, posterior: Posterior) -> Figure | None:
    """Draw the posterior of the effects that are named in a block, None where it has not converged."""
    block_diagnosis = next(one for one in diagnosis.blocks if str(one.block.block) == block)
    effects = {str(effect.effect.name) for effect in block_diagnosis.effects}
    places = [k for k, name in enumerate(posterior.names) if name.rpartition(".")[0] in effects][
        :_MOST_PARAMETERS
    ]
    if not (places and posterior.converged):
        return None
    readable = [
        readable_unit(posterior.units[k], float(np.abs(posterior.draws[:, k]).max(initial=0.0)))
        for k in places
    ]
    scales = [scale for scale, _ in readable]
    names = [
        f"{posterior.meanings[k]} [{unit.removeprefix('·') or '-'}]"
        for k, (_, unit) in zip(places, readable, strict=True)
    ]
    caption = prose(
        "Posterior of the effects in the {block}: 90 % intervals, and contours around 50 and 90 % of draws. "
        "A name stands above the column of its parameter, at the end of its row.",
        block=block,
    )
    drawing = discrepancy_posterior(names, posterior.draws[:, places] / scales)
    return Figure(drawing=drawing, caption=caption, label=f"fig:posterior-{block}")
