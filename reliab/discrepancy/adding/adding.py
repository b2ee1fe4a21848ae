"""What a diagnosis adds to the model: posteriors, the updated model, and what that does to the criterion."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from reliab.discrepancy.adding.criterion_shift import criterion_shift, shaking_of
from reliab.discrepancy.adding.posterior import Posterior, sample_posterior
from reliab.discrepancy.adding.update import updated_model
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.discrepancy.result.missing_effect import MissingEffect
from reliab.errors import InputError
from reliab.progress import Progress, silent
from reliab.renamed import renamed_method
from reliab.simulation.hybrid_test import MODEL_FILE, UpdatedModel, write_model


@renamed_method("0.4", "as_dict", "to_dict")
@dataclass(frozen=True, kw_only=True, eq=False)
class Addition:
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
        Folder for the updated model and for the chains, from which an interrupted run resumes.
    progress : callable, optional
        Called after each block.

    Returns
    -------
    Addition
        Posteriors, updated model and shift of the criterion.
    """
    acting = [block for block in diagnosis.blocks if block.effects or block.doubtful]
    posteriors = {}
    for done, block in enumerate(acting, start=1):
        name = str(block.block.block)
        chains = None if out is None else out / f"posterior_{name.replace(' ', '_')}.h5"
        with threadpool_limits(limits=1, user_api="blas"):
            posteriors[name] = sample_posterior(block.problem, block.best, out=chains)
        progress(done, len(acting))
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
    """Use standard deviations and intervals of a converged posterior; values stay the most probable ones."""
    if posterior is None:
        return block
    if not posterior.converged:
        return replace(block, converged=False)
    return replace(
        block,
        converged=True,
        effects=tuple(_with_spread(effect, posterior) for effect in block.effects),
        doubtful=tuple(_with_spread(effect, posterior) for effect in block.doubtful),
    )


def _with_spread(effect: MissingEffect, posterior: Posterior) -> MissingEffect:
    known = posterior.of(str(effect.effect.name))
    estimates = []
    for estimate in effect.estimates:
        low, high = known[estimate.name]["interval_90"]
        interval = (min(low, estimate.value), max(high, estimate.value))
        estimates.append(replace(estimate, sd=known[estimate.name]["sd"], interval=interval))
    return replace(effect, estimates=tuple(estimates))


def _shift(diagnosis: Diagnosis, model: UpdatedModel) -> dict[str, float] | None:
    if diagnosis.campaign.structure is None or not (diagnosis.effects or diagnosis.doubtful):
        return None
    try:
        return criterion_shift(model.test, shaking_of(diagnosis.campaign)).to_dict()
    except InputError:  # no boundary under these motions, hence no criterion
        return None
