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
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, Stretch
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
from reliab.discrepancy.terms import ClockOffset, LateGround, lag_of
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
            diagnoses.append(_diagnose_block(block, campaign, advance))
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
        return _align_force(BalanceBlock(campaign, scales), campaign, diagnoses)
    return ActuatorBlock(campaign, scales) if kind is ActuatorBlock else FrameBalanceBlock(campaign, scales)


def _specimen(
    campaign: Campaign, scales: Scales, motions: tuple[Motion3, ...], actuator: BlockDiagnosis | None
) -> SpecimenBlock:
    """Build the specimen's block under the motion of the piston that is known best."""
    if actuator is None:
        return SpecimenBlock(campaign, scales, motions, is_smoothed=True)
    model_pistons, sensor_pistons = _pistons(actuator)
    if sensor_pistons is None:
        return SpecimenBlock(campaign, scales, model_pistons)
    sensor_block = SpecimenBlock(campaign, scales, sensor_pistons)
    model_block = SpecimenBlock(campaign, scales, model_pistons, is_timed=False)
    energies = [_linear_energy(block, campaign) for block in (model_block, sensor_block)]
    return model_block if energies[0] < _LEAST_EXPLAINED * energies[1] else sensor_block


def _align_force(
    block: BalanceBlock, campaign: Campaign, diagnoses: Sequence[BlockDiagnosis]
) -> BalanceBlock:
    """Read the force as late as the specimen shows it to be, where that is more credible than one in time.

    A lag τ of the force beside the ground acceleration looks like a damping ratio larger by half of ω₀τ.
    Where the displacement was early in place of the force late, the force is in time with the ground.
    """
    lags = (_possible_lag(result) for result in diagnoses if isinstance(result.block, SpecimenBlock))
    lag = next((lag for lag in lags if lag), 0.0)
    if not lag:
        return block
    late = block.read_late(lag)
    searches = [Search(_problem(clock, campaign, campaign.training)) for clock in (block, late)]
    punctual_score, late_score = (search.score(search.null) for search in searches)
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


def _pistons(actuator: BlockDiagnosis) -> tuple[list[Motion3], list[Motion3] | None]:
    """Motion of the piston in every test: by the actuator's best model, and with what the sensor saw beside.

    What the model leaves beyond noise is motion of the piston or, where the force is explained far better
    without it, an error of the sensor. Of neither the specimen must be blamed. Where only noise is left,
    there is no second motion.
    """
    block, best = actuator.block, actuator.best
    if not isinstance(block, ActuatorBlock):
        raise TypeError
    model = best.space.model(best.coordinates)
    model_pistons = [block.piston(model, test) for test in range(len(block.tests))]
    if actuator.leaves_noise:
        return model_pistons, None
    residuals = [block.measured(test) - block.predict(model, test) for test in range(len(block.tests))]
    step, highest = 1.0 / block.rate, block.highest_signal
    sensor_pistons = [
        Motion3(values=piston.values + smooth_motion(error, step, highest).values, step=piston.step)
        for piston, error in zip(model_pistons, residuals, strict=True)
    ]
    return model_pistons, sensor_pistons


def _linear_energy(block: SpecimenBlock, campaign: Campaign) -> float:
    """Energy that the best linear model of a specimen leaves, whatever stiffness is stated."""
    search = Search(_problem(block.release_stiffness(), campaign, campaign.training))
    return _energy(search.linear, search)


def _diagnose_block(block: ObservedBlock, campaign: Campaign, advance: Callable[[], None]) -> BlockDiagnosis:
    """Search a block in at most `_STEPS` steps; `advance` is called after each."""
    search = begin_search(block, campaign)
    advance()
    search_result: Search | None = None
    if not (isinstance(block, BalanceBlock) or search.reaches_noise()):
        search_result = _search_by_parts(search, campaign)
    if search_result is None or not is_model_error(
        *as_judged_by_noise(search_result.problem, search_result.best)
    ):
        search_result = _search_by_noise(search, campaign, advance)
    search_result.sharpen()
    search_result.fit_beside_clocks()
    return diagnose_block(search_result, _problem(search_result.problem.block, campaign, campaign.proof))


def _search_by_noise(search: Search, campaign: Campaign, advance: Callable[[], None]) -> Search:
    """Search with noise as the judge, and with left-out parts where the best model leaves an error."""
    block, search_result = search.problem.block, _run_search(search)
    advance()
    if isinstance(block, BalanceBlock):
        search_result = _search_integration(block, campaign, search_result)
    advance()
    search_result = _choose_judge(search_result, campaign)
    advance()
    if isinstance(search_result, ErrorSearch):
        return search_result
    search_result.try_twins()
    search_result.settle()  # rejects what does not matter, before and after special forms are tried
    search_result.refine()
    search_result.settle()
    return _choose_judge(search_result, campaign)  # refinement may have uncovered an error of the model


def begin_search(block: ObservedBlock, campaign: Campaign) -> Search:
    """Calibrate a block: with a stiffness of any value where that is more credible than the stated one.

    What is stated is then contradicted, or in another unit. An effect that happens to bring the missing
    stiffness would otherwise make up for it.
    """
    search = Search(_problem(block, campaign, campaign.training))
    is_contradicted = _STIFFNESS in search.null.space.find_bounds(search.null.coordinates)
    if not (is_contradicted and isinstance(block, SpecimenBlock | LoopBlock)):
        return search
    open_search = Search(_problem(block.release_stiffness(), campaign, campaign.training))
    return open_search if open_search.score(open_search.null) > search.score(search.null) else search


def _run_search(search: Search) -> Search:
    """Search for what is missing, and again with the error of the converter that the best model expects."""
    search.run()
    return search.rerun_converted()


def _choose_judge(search: Search, campaign: Campaign) -> Search:
    """Judge models by left-out parts where the best one leaves an error, else by noise as before.

    What an offset of the clocks beside the model would explain is no error of it.
    """
    if isinstance(search, ErrorSearch):
        return search
    search.fit_beside_clocks()
    late = search.with_clocks.get(frozenset({*search.best.space.names, str(ClockOffset.name)}), search.best)
    errors = (is_model_error(search.problem, model) for model in (search.best, late))
    return _search_by_parts(search, campaign) if all(errors) else search


def _search_by_parts(search: Search, campaign: Campaign) -> ErrorSearch:
    """Search with left-out parts as the judge.

    Nothing that is stated of a specimen counts then: any part of it may be made up for by what the model
    lacks.
    """
    problem = search.problem
    if isinstance(problem.block, SpecimenBlock):
        problem = _problem(problem.block.release_stiffness(), campaign, campaign.training)
    search_result = ErrorSearch(problem)
    search_result.run()
    return search_result


def _problem(block: ObservedBlock, campaign: Campaign, stretches: Sequence[Stretch]) -> Problem:
    """Return the stretches of a block that a model can predict, as segments."""
    thinning = math.lcm(block.every, block.sketch.every)
    predictable = skip_end(
        skip_transient(stretches, block.motions, block.memory), block.motions, block.answer_time
    )
    return Problem(block=block, segments=cut_segments(predictable, campaign.rate, block.highest_of, thinning))


def _energy(fit: Fit, search: Search) -> float:
    """Energy of what a model leaves at the judged frequencies, in the square of the channel's unit."""
    plain = replace(search.problem, tempering=(), powers=())
    rows = plain.whiten(fit.space, fit.coordinates, NoiseModel.white(plain.block.rate, 1.0))
    return float(rows @ rows)


def _search_integration(block: BalanceBlock, campaign: Campaign, search: Search) -> Search:
    """Search where the command explains the force, if the integration errs.

    Frequencies at which it does not can spoil the first search, whose model then explains too few of the
    others. With the model of a second search, up to there, the band is determined anew. In a narrow band a
    late ground is like an error of the integration: one that the first search did not need is left out.
    """
    if _is_slightly_late(search.best):
        block = block.fix_ground_clock()
        search = search.move_to(_problem(block, campaign, campaign.training))
    effects = search.best.space.effects
    if not any(effect.role is Role.INTEGRATION for effect in effects):
        return search
    if LateGround not in effects:
        block = block.fix_ground_clock()
    wide = search.problem
    for _ in range(2):
        narrow = block.limit_band(highest_informed_frequency(wide, search.best))
        search = search.move_to(_problem(narrow, campaign, campaign.training))
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
