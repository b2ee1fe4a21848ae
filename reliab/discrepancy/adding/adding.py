"""What a diagnosis adds to the model: posteriors, the updated model, and what that does to the criterion."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from reliab.discrepancy.adding.criterion_shift import criterion_shift, shaking_of
from reliab.discrepancy.adding.posterior import Posterior, sample_posterior
from reliab.discrepancy.adding.update import updated_model
from reliab.discrepancy.result import BlockDiagnosis, Diagnosis
from reliab.errors import InputError
from reliab.loop.hybrid_test.model_file import MODEL_FILE, UpdatedModel, write_model
from reliab.progress import Progress, silent


@dataclass(frozen=True, kw_only=True, eq=False)
class Addition:
    """A diagnosis with all that follows from it.

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

    def as_dict(self) -> dict[str, Any]:
        """Return what `reliab diagnose --json` writes; parameters are those of the posteriors."""
        content = self.diagnosis.as_dict()
        for block, posterior in self.posteriors.items():
            for effect in content["effects"]:
                if effect["name"] in _effects_of(self.diagnosis, block):
                    effect["parameters"].update(posterior.of(effect["name"]))
        return content


def add(diagnosis: Diagnosis, *, out: Path | None = None, progress: Progress = silent) -> Addition:
    """Add what was named to the model.

    Parameters
    ----------
    diagnosis : Diagnosis
        What was found.
    out : pathlib.Path, optional
        Folder for the chains, from which a run that was cut short goes on, and for the updated model.
    progress : callable, optional
        Called after each block.

    Returns
    -------
    Addition
        Posteriors, updated model and shift of the criterion.
    """
    acting = [one for one in diagnosis.blocks if one.effects or one.doubtful]
    posteriors = {}
    for done, one in enumerate(acting, start=1):
        name = str(one.block.block)
        chains = None if out is None else out / f"posterior_{name.replace(' ', '_')}.h5"
        with threadpool_limits(limits=1, user_api="blas"):
            posteriors[name] = sample_posterior(one.problem, one.best, out=chains)
        progress(done, len(acting))
    model = updated_model(diagnosis)
    if out is not None:
        write_model(out / MODEL_FILE, model)
    return Addition(
        diagnosis=replace(diagnosis, criterion_shift=_shift(diagnosis, model)),
        posteriors=posteriors,
        model=model,
    )


def _shift(diagnosis: Diagnosis, model: UpdatedModel) -> dict[str, float] | None:
    if diagnosis.campaign.structure is None or not model.test.effects:
        return None
    try:
        return criterion_shift(model.test, shaking_of(diagnosis.campaign)).as_dict()
    except InputError:  # no boundary under these motions: there is no criterion to be shifted
        return None


def _effects_of(diagnosis: Diagnosis, block: str) -> set[str]:
    """Names of the effects that a block saw, offsets of its sensor among them."""
    seen: list[BlockDiagnosis] = [one for one in diagnosis.blocks if str(one.block.block) == block]
    return {effect.name for one in seen for effect in one.effects}
