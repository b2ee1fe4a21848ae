"""The whole workflow: observe the blocks of a campaign, search each for missing effects, verify them."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.threads import one_thread
from reliab.discrepancy.blocks.actuator import ActuatorBlock
from reliab.discrepancy.blocks.balance import BalanceBlock, FrameBalanceBlock
from reliab.discrepancy.blocks.loop import LoopBlock
from reliab.discrepancy.blocks.observed import ObservedBlock, lag_of
from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.discrepancy.campaign.contradictions import require_consistent
from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.fitting.error_search import ErrorSearch
from reliab.discrepancy.fitting.fit import Fit, as_judged_by_noise
from reliab.discrepancy.fitting.noise_test import is_model_error
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.naming.naming import diagnose_block
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.segment import (
    Segment,
    cut_segments,
    motions_of,
    scales_of,
    skip_end,
    skip_transient,
    smooth_motion,
)
from reliab.effects.clock_offset import ClockOffset, LateGround
from reliab.effects.effect import Role, Scales
from reliab.signals.noise import NoiseModel
from reliab.simulation.hybrid_test.open_loop import Motion3

_STEPS = 6  # of the search of a block
_LEAST_EXPLAINED = 0.5  # of the channel's power
_SMOOTHING_BAND = 1.0  # Hz
_FINEST = 0.1  # Hz
_SLIGHT = 0.0015  # s
_STIFFNESS = "stiffness"  # of the specimen, calibrated within its bounds


def diagnose(campaign: Campaign | str | Path, *, progress: Progress = silent) -> Diagnosis:
    """Find where a campaign's model fails, name the missing effects and verify them on held-out tests.

    Parameters
    ----------
    campaign : Campaign, str or pathlib.Path
        Measured tests and the nominal model, their folder, or the name of a campaign that ships ("rig_a").
    progress : Progress, optional
        Called after each step of the search of each block.

    Returns
    -------
    Diagnosis
        Verdict, places, names, proof, and all fits.

    Raises
    ------
    InputError
        If no block is observed, no displacement moves, or tests contradict themselves or each other by a sign
        or a unit.
    """
    if isinstance(campaign, str | Path):
        campaign = read_campaign(campaign)
    faults = require_consistent(campaign)
    kinds = _observable_blocks(campaign)
    motions = motions_of(campaign)
    scales = scales_of(campaign, motions)
    diagnoses: list[BlockDiagnosis] = []
    # Matrix products are small and fits run in parallel: further threads would only wait for each other.
    with one_thread():
        total_steps = _STEPS * len(kinds)
        for number, kind in enumerate(kinds):
            steps = iter(range(_STEPS * number, _STEPS * (number + 1)))

            def advance(steps: Iterator[int] = steps) -> None:
                progress(next(steps), total_steps)

            advance()
            block = _block(kind, campaign, scales, motions, diagnoses)
            diagnoses.append(_diagnose_block(block, advance))
            for step in steps:
                progress(step, total_steps)
        progress(total_steps, total_steps)
    return Diagnosis(campaign=campaign, blocks=tuple(diagnoses), faults=faults)


def _observable_blocks(campaign: Campaign) -> list[type[ObservedBlock]]:
    """Blocks whose input and output follow from the recorded channels, in the order of the loop."""
    channels, nominal = campaign.channels, campaign.nominal
    has_balance = channels >= {Channel.GROUND, Channel.COMMAND, Channel.FORCE}
    observable: list[type[ObservedBlock]] = []
    if channels >= {Channel.COMMAND, Channel.MEASURED}:
        observable.append(ActuatorBlock)
    if channels >= {Channel.MEASURED, Channel.FORCE} and (nominal.specimen is not None or not observable):
        observable.append(SpecimenBlock)
    if has_balance and campaign.structure is not None:
        observable.append(BalanceBlock)
    if has_balance and campaign.partition is not None:
        observable.append(FrameBalanceBlock)
    if channels >= {Channel.GROUND, Channel.MEASURED} and campaign.structure is not None and not observable:
        observable.append(LoopBlock)
    if not observable:
        raise InputError(
            "The columns and tables of a campaign must cover at least one block: command_m and measured_m, or"
            " measured_m and force_n, or ground_acceleration_mps2 and measured_m with a [structure] table of"
            " one degree of freedom",
            value=", ".join(sorted(channels)) or "no channel that all tests have",
            remedy="Add the columns that were recorded, in every test, or the table",
            where="campaign.toml",
        )
    return observable


def _block(
    kind: type[ObservedBlock],
    campaign: Campaign,
    scales: Scales,
    motions: tuple[Motion3, ...],
    diagnoses: Sequence[BlockDiagnosis],
) -> ObservedBlock:
    if kind is SpecimenBlock:
        return _specimen(campaign, scales, motions, diagnoses[0] if diagnoses else None)
    if kind is LoopBlock:
        return LoopBlock(campaign, scales, motions)
    if kind is BalanceBlock:
        return _align_force(BalanceBlock(campaign, scales), diagnoses)
    return ActuatorBlock(campaign, scales) if kind is ActuatorBlock else FrameBalanceBlock(campaign, scales)


def _specimen(
    campaign: Campaign, scales: Scales, motions: tuple[Motion3, ...], actuator: BlockDiagnosis | None
) -> SpecimenBlock:
    """Build the specimen's block under the motion of the piston that is known best.

    That is what the actuator's best model says, and what the sensor saw beside it. What the model leaves
    beyond noise is motion of the piston or, where the force is explained far better without it, an error of
    the sensor. Of neither the specimen must be blamed.
    """
    if actuator is None or not isinstance(actuator.block, ActuatorBlock):
        return SpecimenBlock(campaign, scales, motions, is_smoothed=True)
    block, model = actuator.block, actuator.best.space.model(actuator.best.coordinates)
    pistons = [block.piston(model, test) for test in range(len(block.tests))]
    if actuator.leaves_noise:
        return SpecimenBlock(campaign, scales, pistons)
    sensor_pistons = []
    for test, piston in enumerate(pistons):
        error = block.measured(test) - block.predict(model, test)
        motion = piston.values + smooth_motion(error, 1.0 / block.rate, block.highest_signal).values
        sensor_pistons.append(Motion3(values=motion, step=piston.step))
    blocks = (
        SpecimenBlock(campaign, scales, pistons, is_timed=False),
        SpecimenBlock(campaign, scales, sensor_pistons),
    )
    energies = []
    for tried in blocks:  # that the best linear model leaves, whatever stiffness is stated
        search = Search(_problem(tried.release_stiffness()))
        plain, linear = replace(search.problem, tempering=(), powers=()), search.linear
        rows = plain.whiten(linear.space, linear.coordinates, NoiseModel.white(tried.rate, 1.0))
        energies.append(float(rows @ rows))
    return blocks[0] if energies[0] < _LEAST_EXPLAINED * energies[1] else blocks[1]


def _align_force(block: BalanceBlock, diagnoses: Sequence[BlockDiagnosis]) -> BalanceBlock:
    """Read the force as late as the specimen shows it to be, where that is more credible than one in time.

    A lag τ of the force beside the ground acceleration looks like a damping ratio larger by half of ω₀τ.
    Where the displacement was early in place of the force late, the force is in time with the ground.
    """
    lags = (_possible_lag(result) for result in diagnoses if isinstance(result.block, SpecimenBlock))
    lag = next((lag for lag in lags if lag), 0.0)
    if not lag:
        return block
    late = block.read_late(lag)
    punctual_score, late_score = (
        search.score(search.null) for search in (Search(_problem(clock)) for clock in (block, late))
    )
    return late if late_score > punctual_score else block


def _possible_lag(specimen: BlockDiagnosis) -> float:
    """Time [s] by which the force may be recorded late: that of the most probable model with an offset.

    Zero where no offset of the clocks is named, nor doubted.
    """
    rivals = (rival.name for effect in specimen.doubtful for rival in effect.rivals)
    effects = {*(effect.name for effect in (*specimen.effects, *specimen.doubtful)), *rivals}
    fits = [row.fit for row in specimen.ranked if ClockOffset in row.fit.space.effects]
    if ClockOffset.name not in effects or not fits:
        return 0.0
    return lag_of(fits[0].space.model(fits[0].coordinates))


def _diagnose_block(block: ObservedBlock, advance: Callable[[], None]) -> BlockDiagnosis:
    """Search a block in at most `_STEPS` steps; `advance` is called after each."""
    search = begin_search(block)
    advance()
    search_result: Search | None = None
    if not (isinstance(block, BalanceBlock) or search.reaches_noise()):
        search_result = _search_by_parts(search)
    if search_result is None or not is_model_error(
        *as_judged_by_noise(search_result.problem, search_result.best)
    ):
        search_result = _search_by_noise(search, advance)
    search_result.sharpen()
    search_result.fit_beside_clocks()
    return diagnose_block(search_result, _problem(search_result.problem.block, is_proof=True))


def begin_search(block: ObservedBlock) -> Search:
    """Calibrate a block: with a stiffness of any value where that is more credible than the stated one.

    What is stated is then contradicted, or in another unit. An effect that happens to bring the missing
    stiffness would otherwise make up for it.
    """
    search = Search(_problem(block))
    is_contradicted = _STIFFNESS in search.null.space.find_bounds(search.null.coordinates)
    if not (is_contradicted and isinstance(block, SpecimenBlock | LoopBlock)):
        return search
    open_search = Search(_problem(block.release_stiffness()))
    return open_search if open_search.score(open_search.null) > search.score(search.null) else search


def _search_by_noise(search: Search, advance: Callable[[], None]) -> Search:
    """Search with noise as the judge, and with left-out parts where the best model leaves an error.

    The search is repeated with the error of the converter that the best model expects.
    """
    block = search.problem.block
    search.run()
    search = search.rerun_converted()
    advance()
    if isinstance(block, BalanceBlock):
        search = _search_integration(block, search)
    advance()
    search = _choose_judge(search)
    advance()
    if isinstance(search, ErrorSearch):
        return search
    search.try_twins()
    search.settle()  # rejects what does not matter, before and after special forms are tried
    search.refine()
    search.settle()
    return _choose_judge(search)  # refinement may have uncovered an error of the model


def _choose_judge(search: Search) -> Search:
    """Judge models by left-out parts where the best one leaves an error, else by noise as before.

    What an offset of the clocks beside the model would explain is no error of it.
    """
    if isinstance(search, ErrorSearch):
        return search
    search.fit_beside_clocks()
    late = search.with_clocks.get(search.best.space.key | {str(ClockOffset.name)}, search.best)
    errors = (is_model_error(search.problem, model) for model in (search.best, late))
    return _search_by_parts(search) if all(errors) else search


def _search_by_parts(search: Search) -> ErrorSearch:
    """Search with left-out parts as the judge.

    Nothing that is stated of a specimen counts then: any part of it may be made up for by what the model
    lacks.
    """
    problem = search.problem
    if isinstance(problem.block, SpecimenBlock):
        problem = _problem(problem.block.release_stiffness())
    search_result = ErrorSearch(problem)
    search_result.run()
    return search_result


def _problem(block: ObservedBlock, *, is_proof: bool = False) -> Problem:
    """Return what is held out of the tests, or all else, as far as models of a block can predict it."""
    stretches, motions = block.campaign.proof if is_proof else block.campaign.training, block.motions
    predictable = skip_end(skip_transient(stretches, motions, block.memory), motions, block.answer_time)
    thinning = math.lcm(block.every, block.sketch.every)
    return Problem(block=block, segments=cut_segments(predictable, block.rate, block.highest_of, thinning))


def _search_integration(block: BalanceBlock, search: Search) -> Search:
    """Search where the command explains the force, if the integration errs.

    Frequencies at which it does not can spoil the first search, whose model then explains too few of the
    others. With the model of a second search, up to there, the band is determined anew. In a narrow band a
    late ground is like an error of the integration: one that the first search did not need is left out.
    """
    if _is_slightly_late(search.best):
        block = block.fix_ground_clock()
        search = search.move_to(_problem(block))
    effects = search.best.space.effects
    if not any(effect.role is Role.INTEGRATION for effect in effects):
        return search
    if LateGround not in effects:
        block = block.fix_ground_clock()
    wide = search.problem
    for _ in range(2):
        narrow = block.limit_band(highest_informed_frequency(wide, search.best))
        search = search.move_to(_problem(narrow))
    return search.rerun_converted()


def _is_slightly_late(fit: Fit) -> bool:
    """Whether a ground acceleration is late or early by what an integration with short steps does, too."""
    effects = fit.space.model(fit.coordinates).effects
    return any(abs(effect.ground_lag_s) < _SLIGHT for effect in effects if isinstance(effect, LateGround))


def highest_informed_frequency(problem: Problem, fit: Fit) -> float:
    """Frequency above the strongest motion from which a model explains less than half of the channel [Hz].

    Returns the highest frequency that is judged, where the model explains more than half of the power up to
    there.
    """
    remainders = problem.residuals(fit)
    highest = max(segment.highest for segment in problem.segments)
    grid = np.arange(_FINEST, highest, _FINEST)
    signal, remainder = np.zeros(grid.size), np.zeros(grid.size)
    for segment in problem.segments:
        signal += _power_of(segment, problem.measured(segment.test), grid)
        remainder += _power_of(segment, remainders[segment.test], grid)
    strongest = int(np.argmax(signal))
    gaps = np.flatnonzero(remainder[strongest:] > (1.0 - _LEAST_EXPLAINED) * signal[strongest:])
    return float(grid[strongest + gaps[0]]) if gaps.size else highest


def _power_of(segment: Segment, values: Array, grid: Array) -> Array:
    """Mean power within half a hertz of each frequency of a grid, shape of `grid`."""
    frequency, power = segment.frequency[1:], np.abs(segment.spectrum(values)[1:]) ** 2
    total = np.concatenate([[0.0], np.cumsum(power)])
    begin = np.searchsorted(frequency, grid - 0.5 * _SMOOTHING_BAND)
    end = np.searchsorted(frequency, grid + 0.5 * _SMOOTHING_BAND, side="right")
    return np.asarray((total[end] - total[begin]) / np.maximum(end - begin, 1))
