"""What a diagnosis adds to the model: posteriors, the updated model, and what that does to the criterion."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from reliab.core.errors import InputError
from reliab.core.plain_values import ResultWithRows
from reliab.core.progress import Progress, silent
from reliab.core.threads import one_thread
from reliab.discrepancy.adding.criterion_shift import criterion_shift, shaking_of
from reliab.discrepancy.adding.posterior import Posterior, sample_posterior
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.result.missing_effect import MissingEffect, estimates
from reliab.effects.effect import Effect
from reliab.effects.excitation_scale import ExcitationScale
from reliab.effects.general.general_term import is_general
from reliab.effects.registry import library
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import MODEL_FILE, UpdatedModel, write_model

_REACH = 1.645  # standard deviations to either end of a central 90 % interval
_WITHOUT_FRAME = (
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

    diagnosis: Diagnosis
    posteriors: dict[str, Posterior]
    model: UpdatedModel

    def to_dict(self) -> dict[str, Any]:
        """Return what `reliab diagnose --json` writes."""
        return self.diagnosis.to_dict()


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
    acting = [block for block in diagnosis.blocks if block.effects or block.doubtful]
    posteriors = {}
    for count, block in enumerate(acting, start=1):
        name = str(block.block.block)
        with one_thread():
            posteriors[name] = sample_posterior(block.problem, block.best)
        progress(count, len(acting))
    blocks = tuple(_sampled(block, posteriors.get(str(block.block.block))) for block in diagnosis.blocks)
    sampled = replace(diagnosis, blocks=blocks)
    model = updated_model(sampled)
    if out is not None:
        write_model(out / MODEL_FILE, model)
    return Addition(
        diagnosis=replace(sampled, criterion_shift=_shift(diagnosis, model)),
        posteriors=posteriors,
        model=model,
    )


def _sampled(block: BlockDiagnosis, posterior: Posterior | None) -> BlockDiagnosis:
    """Use standard deviations and intervals of a posterior; values stay the most probable ones."""
    if posterior is None:
        return block
    return replace(
        block,
        converged=posterior.converged,
        inseparable=posterior.inseparable([str(m.effect.name) for m in (*block.effects, *block.doubtful)]),
        effects=tuple(_with_spread(effect, posterior) for effect in block.effects),
        doubtful=tuple(_with_spread(effect, posterior) for effect in block.doubtful),
    )


def _with_spread(effect: MissingEffect, posterior: Posterior) -> MissingEffect:
    """Take spreads from a posterior of one model, and how far models differ from the diagnosis."""
    parameters = posterior.parameters_of(str(effect.effect.name))
    estimates = []
    for estimate in effect.estimates:
        low, high = parameters[estimate.name]["interval_90"]
        value, between = estimate.value, _REACH * estimate.between
        low = value - math.hypot(value - min(low, value), between)
        high = value + math.hypot(max(high, value) - value, between)
        sd = math.hypot(parameters[estimate.name]["sd"], estimate.between)
        interval = (low if estimate.signed else max(low, 0.0), high)
        estimates.append(replace(estimate, sd=sd, interval=interval))
    return replace(effect, estimates=tuple(estimates))


def _shift(diagnosis: Diagnosis, model: UpdatedModel) -> dict[str, float] | None:
    if diagnosis.campaign.structure is None or not (diagnosis.effects or diagnosis.doubtful):
        return None
    try:
        return criterion_shift(model.test, shaking_of(diagnosis.campaign)).to_dict()
    except InputError:  # no boundary under these motions, hence no criterion
        return None


def updated_model(diagnosis: Diagnosis) -> UpdatedModel:
    """Put together the model that a diagnosis arrives at.

    Calibrated values and effects are those of the best model of the block that saw them. Effects of the
    library are added when they are named, or when something of their kind acts and they explain it best, and
    terms of a general kind where they stand in the best model. The nominal structure is kept but for values
    with which the tests clearly did not run (`BlockDiagnosis.misstated`).
    """
    test = diagnosis.campaign.nominal
    deviations: dict[str, float] = {}
    for diagnosed in diagnosis.blocks:
        test = _joined(test, diagnosed)
        deviations.update(_deviations(diagnosed))
    limits = diagnosis.remarks
    if diagnosis.campaign.partition is not None:
        limits = (*limits, _WITHOUT_FRAME)
    return UpdatedModel(name=diagnosis.campaign.name, test=test, deviations=deviations, limits=limits)


def _joined(test: HybridTest, diagnosed: BlockDiagnosis) -> HybridTest:
    """Take over from a block what it calibrated and what it names."""
    names = {calibration.parameter.name for calibration in diagnosed.block.calibrations}
    model = diagnosed.best.space.model(diagnosed.best.coordinates)
    added = _added(diagnosed)
    test = test.adding(*(effect for effect in model.effects if type(effect) in added))
    if "gain" in names or "delay_s" in names:
        test = replace(test, actuator=model.actuator)
    if any(name.startswith("stiffness") for name in names):
        test = replace(test, specimen=model.specimen)
    misstated = {item.name: item.value for item in diagnosed.misstated}
    for calibration in diagnosed.block.calibrations:
        if calibration.parameter.name in misstated:
            test = calibration.apply(test, misstated[calibration.parameter.name])
    if "damping" in names:
        test = replace(test, structure=model.structure)
    if "excitation_scale" in names:
        test = test.adding(*(effect for effect in model.effects if isinstance(effect, ExcitationScale)))
    return test


def _added(diagnosed: BlockDiagnosis) -> set[type[Effect]]:
    """Effects that go into the model: named ones, doubtful ones, and what refines or explains beside them."""
    effects = {missing.effect for missing in (*diagnosed.effects, *diagnosed.doubtful)}
    beside = {kind for kind in diagnosed.best.space.effects if is_general(kind)} | set(diagnosed.refining)
    return (effects & set(library().values())) | beside


def _deviations(diagnosed: BlockDiagnosis) -> dict[str, float]:
    """Return standard deviations in SI units of what a block calibrated and named."""
    fitted = diagnosed.best
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance).tolist()
    calibrated = {
        calibration.key: calibration.unit * sd
        for calibration, sd in zip(diagnosed.block.calibrations, spread, strict=False)
        if calibration.key
    }
    refining = {
        f"{kind.name}.{item.name}": item.sd for kind in _added(diagnosed) for item in estimates(kind, fitted)
    }
    effects = {
        f"{missing.effect.name}.{item.name}": item.sd
        for missing in (*diagnosed.effects, *diagnosed.doubtful)
        for item in missing.estimates
    }
    return {**calibrated, **refining, **effects}
