"""Independent affine-invariant ensembles, resumable from a file."""

import hashlib
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.sampling.chain_file import ChainFile
from reliab.sampling.laplace import Laplace
from reliab.sampling.model import Model
from reliab.sampling.posterior_sample import FEWEST_ENSEMBLES, PosteriorSample

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from emcee import EnsembleSampler, State
    from emcee.backends import Backend

_BLOCKS = 100  # reports of progress from one ensemble
_START = 2.0  # spread of the first walkers, in spreads of the approximate posterior


@dataclass(frozen=True, kw_only=True)
class Ensembles:
    """How a posterior is sampled."""

    steps: int  # Steps of every walker; the first half is left out
    thin: int = 1  # Steps from one kept draw to the next
    count: int = FEWEST_ENSEMBLES  # Number of independent ensembles
    walkers: int = 0  # Walkers of an ensemble; by default three times as many as parameters, and at least 32
    seed: int = 2017  # Seed; each ensemble has its own stream
    # While a run has not converged its steps are doubled, but not beyond this; by default never
    longest: int = 0

    def __post_init__(self) -> None:
        least = 2 * self.thin
        if self.thin < 1 or self.steps < least or self.steps % least:
            raise InputError(
                "The number of steps must be a multiple of twice the thinning",
                value=f"{self.steps} steps, thinning {self.thin}",
                remedy=f"Give {max(least, self.steps // least * least)}",
            )
        if self.count < 1:
            raise InputError("At least one ensemble must be run", value=self.count)


def sample(
    model: Model,
    ensembles: Ensembles,
    *,
    file: Path | None = None,
    group: str = "",
    progress: Progress = silent,
) -> PosteriorSample:
    """Sample the posterior of a model.

    Every ensemble starts twice as wide as the posterior's normal approximation at its mode. Unless the
    model says otherwise, walkers leap anywhere in that approximation, widened (60 % of the moves), or step
    by differential evolution (40 %), which needs no approximation to be right: the draws are decorrelated
    ten times sooner than by differential evolution alone.

    `file`: HDF5 file; a run that stopped, or that was too short, resumes where it ended, with the result that
    it would have had without the stop; `group`: folder of the run inside the file, which may hold several.
    Returns the draws; `converged` says whether they can be relied on.

    ConvergenceWarning
        If they cannot.
    """
    posterior = draw(model, ensembles, file=file, group=group, progress=progress)
    posterior.warn_unless_converged()
    return posterior


def draw(
    model: Model,
    ensembles: Ensembles,
    *,
    file: Path | None = None,
    group: str = "",
    progress: Progress = silent,
) -> PosteriorSample:
    """Draw as :func:`sample` does, without asking whether the run has converged."""
    width = ensembles.walkers or width_of(model)
    laplace = Laplace.about_mode(model)
    with _chains(file, group, model, ensembles, width) as (chains, save):
        samplers = [_sampler(model, laplace, width, chain) for chain in chains]
        starts = [_start(laplace, width, (ensembles.seed, number)) for number in range(ensembles.count)]
        steps = ensembles.steps

        def stepped(done: int, total: int) -> None:
            save()
            progress(done, total)

        while True:
            _run(samplers, starts, steps // ensembles.thin, ensembles.thin, stepped)
            posterior = _kept_draws(model, samplers, steps // ensembles.thin // 2, ensembles.thin)
            if 2 * steps > ensembles.longest or posterior.converged:
                return posterior
            steps *= 2


def _kept_draws(model: Model, samplers: "list[EnsembleSampler]", steps: int, thin: int) -> PosteriorSample:
    """Take as many draws as are left out before them."""
    return PosteriorSample(
        names=tuple(parameter.name for parameter in model.parameters),
        draws=np.stack([sampler.get_chain(discard=steps)[:steps] for sampler in samplers]),
        thin=thin,
        accepted=float(np.mean([sampler.acceptance_fraction for sampler in samplers])),
    )


def width_of(model: Model) -> int:
    """Walkers of an ensemble: nearly three times as many as parameters, and at least 32."""
    return max(32, 2 * (4 * len(model.parameters) // 3))


def _sampler(model: Model, laplace: Laplace, width: int, backend: "Backend") -> "EnsembleSampler":
    from emcee import EnsembleSampler

    sampler = EnsembleSampler(
        width,
        len(model.parameters),
        model.log_posterior,
        vectorize=True,
        moves=model.moves or laplace.moves,
        backend=backend,
    )
    sampler.log_prob_fn = model.log_posterior  # without its wrapper, which prints every exception, Ctrl-C too
    return sampler


def _run(
    samplers: "list[EnsembleSampler]", starts: "list[State]", draws: int, thin: int, progress: Progress
) -> None:
    """Step on from where the backends end, in blocks."""
    block = max(1, draws // _BLOCKS)
    for sampler, start in zip(samplers, starts, strict=True):
        while (done := sampler.backend.iteration) < draws:
            sampler.run_mcmc(
                start if done == 0 else None,
                min(block, draws - done),
                thin_by=thin,
                skip_initial_state_check=True,  # a start is drawn in all directions, however thin
            )
            finished = sum(min(sampler.backend.iteration, draws) for sampler in samplers)
            progress(thin * finished, thin * draws * len(samplers))


def _start(laplace: Laplace, width: int, seed: tuple[int, int]) -> "State":
    from emcee import State

    sequence = np.random.SeedSequence(seed)
    walkers = laplace.around(width, _START, np.random.default_rng(sequence))
    stream = np.random.RandomState(sequence.generate_state(8))
    return State(walkers, random_state=stream.get_state())


@contextmanager
def _chains(
    file: Path | None, group: str, model: Model, ensembles: Ensembles, width: int
) -> "Iterator[tuple[list[Backend], Callable[[], None]]]":
    """Chains in memory, and what keeps them in a file where there is one."""
    from emcee.backends import Backend

    if file is None:
        yield [Backend() for _ in range(ensembles.count)], lambda: None
        return
    names = [f"{group}/ensemble_{number}".strip("/") for number in range(ensembles.count)]
    signature = _signature(model, ensembles, width)
    shape = (width, len(model.parameters))
    with ChainFile.opened(file, names, signature, shape, model=model.name) as (chain_file, chains):
        yield chains, chain_file.save


def _signature(model: Model, ensembles: Ensembles, width: int) -> str:
    settings = (model.name, model.parameters, ensembles.thin, ensembles.seed, width)
    data = np.ascontiguousarray(model.data, dtype=np.float64).tobytes()
    return hashlib.sha256(repr(settings).encode() + data).hexdigest()
