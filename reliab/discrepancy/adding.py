"""What a diagnosis adds to the model: posteriors, the updated model, and what that does to the criterion."""

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np

from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, ResultWithRows
from reliab.core.progress import Progress, silent
from reliab.core.threads import one_thread
from reliab.criterion.effect_shift import criterion_shift
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.discrepancy.posterior import Posterior, sample_posterior
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.result.missing_effect import NORMAL_REACH_90, MissingEffect, estimates
from reliab.effects.effect import Effect
from reliab.effects.excitation_scale import ExcitationScale
from reliab.effects.general.general_term import is_general
from reliab.effects.registry import library
from reliab.motions.loading import load_motions
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import MODEL_FILE, UpdatedModel, write_model

_FRAME_NOTE = (
    "This file holds the actuator, the specimen and the effects; the frame of these tests is described in"
    " their campaign.toml, and no closed loop can be computed without it."
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Addition(ResultWithRows):
    """A diagnosis with its posteriors, its updated model and its effect on the criterion.

    Attributes
    ----------
    diagnosis : Diagnosis
        With its `criterion_shift` where there is a structure and something was added.
    posteriors : dict of str to Posterior
        Sampled posteriors by the name of the block in which something acts.
    model : UpdatedModel
        The model with what was calibrated and named.
    """

    rows_in = "effects"
    keys: ClassVar[Keys] = {"**": "diagnosis"}

    diagnosis: Diagnosis
    posteriors: dict[str, Posterior]
    model: UpdatedModel


def add(diagnosis: Diagnosis, *, out: Path | None = None, progress: Progress = silent) -> Addition:
    """Add what was named to the model.

    Parameters
    ----------
    diagnosis : Diagnosis
        What was found.
    out : pathlib.Path, optional
        Folder for the updated model.
    progress : callable, optional
        Called after each block.

    Returns
    -------
    Addition
        Posteriors, updated model and shift of the criterion.
    """
    acting = [block for block in diagnosis.blocks if block.all_effects]
    posteriors = {}
    for count, block in enumerate(acting, start=1):
        name = str(block.block.block)
        with one_thread():
            posteriors[name] = sample_posterior(block.problem, block.best)
        progress(count, len(acting))
    blocks = tuple(
        _apply_posterior(block, posteriors.get(str(block.block.block))) for block in diagnosis.blocks
    )
    sampled_diagnosis = replace(diagnosis, blocks=blocks)
    model = update_model(sampled_diagnosis)
    if out is not None:
        write_model(out / MODEL_FILE, model)
    shift = None
    if diagnosis.campaign.structure is not None and diagnosis.all_effects:
        # Where no motion has a boundary, there is no criterion.
        with suppress(InputError):
            shift = criterion_shift(model.test, shaking_of(diagnosis.campaign))
    return Addition(
        diagnosis=replace(sampled_diagnosis, criterion_shift=shift),
        posteriors=posteriors,
        model=model,
    )


def _apply_posterior(block: BlockDiagnosis, posterior: Posterior | None) -> BlockDiagnosis:
    """Use standard deviations and intervals of a posterior; values stay the most probable ones."""
    if posterior is None:
        return block
    return replace(
        block,
        converged=posterior.converged,
        inseparable=posterior.inseparable([str(m.effect.name) for m in (*block.effects, *block.doubtful)]),
        effects=tuple(_apply_intervals(effect, posterior) for effect in block.effects),
        doubtful=tuple(_apply_intervals(effect, posterior) for effect in block.doubtful),
    )


def _apply_intervals(effect: MissingEffect, posterior: Posterior) -> MissingEffect:
    """Take spreads from a posterior of one model, and how far models differ from the diagnosis."""
    estimates = []
    for estimate in effect.estimates:
        sd, low, high = posterior.spread_of(f"{effect.effect.name}.{estimate.name}")
        value, spread_between = estimate.value, NORMAL_REACH_90 * estimate.between
        low = value - math.hypot(value - min(low, value), spread_between)
        high = value + math.hypot(max(high, value) - value, spread_between)
        interval = estimate.within_bounds((low, high))
        estimates.append(replace(estimate, sd=math.hypot(sd, estimate.between), interval=interval))
    return replace(effect, estimates=tuple(estimates))


def update_model(diagnosis: Diagnosis) -> UpdatedModel:
    """Put together the model that a diagnosis arrives at.

    Calibrated values and effects are those of the best model of the block that saw them. Effects of the
    library are added when they are named, or when something of their kind acts and they explain it best, and
    terms of a general kind where they stand in the best model. The nominal structure is kept but for values
    with which the tests clearly did not run (`BlockDiagnosis.misstated`).
    """
    test = diagnosis.campaign.nominal
    deviations: dict[str, float] = {}
    for block_result in diagnosis.blocks:
        test = _join_block(test, block_result)
        deviations.update(_deviations(block_result))
    limits = diagnosis.remarks
    if diagnosis.campaign.partition is not None:
        limits = (*limits, _FRAME_NOTE)
    return UpdatedModel(name=diagnosis.campaign.name, test=test, deviations=deviations, limits=limits)


def _join_block(test: HybridTest, block_result: BlockDiagnosis) -> HybridTest:
    """Take over from a block what it calibrated and what it names."""
    names = {calibration.parameter.name for calibration in block_result.block.calibrations}
    model = block_result.best.space.model(block_result.best.coordinates)
    new_effects = _effects_to_add(block_result)
    test = test.adding(*(effect for effect in model.effects if type(effect) in new_effects))
    if "gain" in names or "delay_s" in names:
        test = replace(test, actuator=model.actuator)
    if any(name.startswith("stiffness") for name in names):
        test = replace(test, specimen=model.specimen)
    corrections = {item.name: item.value for item in block_result.misstated}
    for calibration in block_result.block.calibrations:
        if calibration.parameter.name in corrections:
            test = calibration.apply(test, corrections[calibration.parameter.name])
    if "damping" in names:
        test = replace(test, structure=model.structure)
    if "excitation_scale" in names:
        test = test.adding(*(effect for effect in model.effects if isinstance(effect, ExcitationScale)))
    return test


def _effects_to_add(block_result: BlockDiagnosis) -> set[type[Effect]]:
    """Effects that go into the model: named ones, doubtful ones, and what refines or explains beside them."""
    named = {missing.effect for missing in block_result.all_effects} & set(library().values())
    return named | {kind for kind in block_result.best.space.effects if is_general(kind)}.union(
        block_result.refining
    )


def _deviations(block_result: BlockDiagnosis) -> dict[str, float]:
    """Return standard deviations in SI units of what a block calibrated and named."""
    fit = block_result.best
    spread = fit.space.standard_deviations(fit.coordinates, fit.covariance).tolist()
    deviations = {
        calibration.key: calibration.unit * sd
        for calibration, sd in zip(block_result.block.calibrations, spread, strict=False)
        if calibration.key
    }
    parameters = [(kind, estimates(kind, fit)) for kind in _effects_to_add(block_result)]
    parameters += [(missing.effect, missing.estimates) for missing in block_result.all_effects]
    return deviations | {f"{kind.name}.{item.name}": item.sd for kind, items in parameters for item in items}


_MOST_MOTIONS = 6
_SYNTHETIC_STRIDE = 16  # through the built-in suite, whose neighbours are of one earthquake


def shaking_of(campaign: Campaign) -> tuple[Excitation, ...]:
    """Ground motions that stand for those of a campaign.

    Returns recorded ground accelerations of up to six tests; where none was recorded, motions of the built-in
    suite, each scaled to the largest displacement of the tests.
    """
    if Channel.GROUND in campaign.channels:
        records = [test.channels[Channel.GROUND] for test in campaign.tests[:_MOST_MOTIONS]]
        return tuple(
            Excitation(acceleration=acceleration, time_step=campaign.step)
            for acceleration in records
            if np.ptp(acceleration)
        )
    channel = Channel.COMMAND if Channel.COMMAND in campaign.channels else Channel.MEASURED
    peak = max(float(np.ptp(test.channels[channel])) / 2.0 for test in campaign.tests)
    suite = load_motions("synthetic")
    scaled_motions = []
    for record in (suite[_SYNTHETIC_STRIDE * k] for k in range(_MOST_MOTIONS)):
        answer = run_closed_loop(campaign.nominal, record.acceleration, record.time_step).measured
        factor = peak / np.abs(answer).max()
        scaled_motions.append(
            Excitation(acceleration=factor * record.acceleration, time_step=record.time_step)
        )
    return tuple(scaled_motions)
