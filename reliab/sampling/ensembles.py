"""Bayesian models and their sampling by independent affine-invariant ensembles, resumable from a file."""

import contextlib
import hashlib
import io
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.errors import IncompleteError, InputError
from reliab.core.files import decoding, ordinary, written_whole
from reliab.core.progress import Progress, silent
from reliab.core.untrusted_files import objects_of, open_hdf5
from reliab.sampling.posterior_sample import FEWEST_ENSEMBLES, PosteriorSample

if TYPE_CHECKING:
    import h5py
    from emcee import EnsembleSampler, State
    from emcee.backends import Backend
    from emcee.moves import Move


@dataclass(frozen=True, kw_only=True)
class SampledParameter:
    """One parameter on the unbounded scale on which it is sampled, with a normal prior."""

    name: str  # What it is called in tables and figures
    mean: float  # mean, spread: Mean and standard deviation of its prior
    spread: float


class Model(ABC):
    """A posterior over unbounded parameters, given the data that the model holds."""

    name: ClassVar[str]  # What the model is called in files

    @property
    @abstractmethod
    def parameters(self) -> tuple[SampledParameter, ...]:
        """Parameters in the order of the sampled vectors."""

    @abstractmethod
    def log_likelihood(self, theta: Array) -> Array:
        """Log-likelihood up to a constant of parameter vectors, shape (vectors, parameters) to (vectors,)."""

    @abstractmethod
    def simulate(self, theta: Array, rng: np.random.Generator) -> Self:
        """Make the same model with data drawn at one parameter vector, shape (parameters,)."""

    @property
    @abstractmethod
    def data(self) -> Array:
        """The data, for their checksum and for prior-predictive checks."""

    def log_prior(self, theta: Array) -> Array:
        """Log-density up to a constant of the priors, shape (vectors,)."""
        means, spreads = self._prior
        return np.asarray(-0.5 * (((theta - means) / spreads) ** 2).sum(axis=1))

    @property
    def moves(self) -> "Move | list[tuple[Move, float]] | None":
        """How walkers move; None leaves it to :func:`reliab.sampling.ensembles.sample`."""
        return None

    def draw_prior(self, count: int, rng: np.random.Generator) -> Array:
        """Draw parameter vectors from the prior, shape (count, parameters)."""
        means, spreads = self._prior
        return rng.normal(means, spreads, (count, means.size))

    def log_posterior(self, theta: Array) -> Array:
        """Log-density up to a constant of the posterior, shape (vectors,); minus infinity where undefined."""
        with np.errstate(all="ignore"):
            density = self.log_prior(theta) + self.log_likelihood(theta)
        return np.where(np.isfinite(density), density, -np.inf)

    @property
    def _prior(self) -> tuple[Array, Array]:
        means = np.array([parameter.mean for parameter in self.parameters])
        return means, np.array([parameter.spread for parameter in self.parameters])


_DIFFERENCE = 1e-3  # of the spread of the prior
_FARTHEST = 6.0
_DESERT = 1e30
_DEGREES = 8.0  # tails of the leaps
_WIDER = 1.1
_LEAPS = 0.6  # share of the moves


@dataclass(frozen=True, kw_only=True, eq=False)
class Laplace:
    """Normal approximation of a posterior about its mode."""

    mode: Array  # Parameters of the greatest density
    # Square root of the covariance, mapping standard normal variables to deviations from the mode
    factor: Array

    @classmethod
    def about_mode(cls, model: Model) -> Self:
        """Approximate the posterior of a model.

        The approximation is nowhere wider than the prior.
        """
        begin = np.array([parameter.mean for parameter in model.parameters])
        spreads = np.array([parameter.spread for parameter in model.parameters])

        def loss(deviations: Array) -> Array:
            return np.minimum(-model.log_posterior(begin + spreads * deviations), _DESERT)

        bounds = [(-_FARTHEST, _FARTHEST)] * begin.size
        optimum = scipy.optimize.minimize(
            lambda deviations: _value_and_gradient(loss, deviations),
            np.zeros_like(begin),
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": 2000},
        )
        steps = _DIFFERENCE * np.eye(begin.size)
        gradients = [
            (_value_and_gradient(loss, optimum.x + step)[1] - _value_and_gradient(loss, optimum.x - step)[1])
            / (2.0 * _DIFFERENCE)
            for step in steps
        ]
        curvature, axes = np.linalg.eigh((np.array(gradients) + np.array(gradients).T) / 2.0)
        factor = spreads[:, None] * axes / np.sqrt(np.maximum(curvature, 1.0))
        return cls(mode=begin + spreads * optimum.x, factor=factor)

    def around(self, count: int, width: float, rng: np.random.Generator) -> Array:
        """Draw parameter vectors about the mode, `width` times as far as the posterior reaches."""
        return self.mode + width * rng.standard_normal((count, self.mode.size)) @ self.factor.T

    @property
    def moves(self) -> "list[tuple[Move, float]]":
        """Leaps anywhere in the approximation, widened, and steps of differential evolution."""
        from emcee.moves import DEMove, MHMove

        return [(MHMove(self._leap), _LEAPS), (DEMove(), 1.0 - _LEAPS)]

    def _leap(self, walkers: Array, rng: np.random.RandomState) -> tuple[Array, Array]:
        """Independent Student-t proposals, with the logarithms of their Hastings factors."""
        normal = rng.standard_normal(walkers.shape)
        longer = np.sqrt(_DEGREES / rng.chisquare(_DEGREES, (len(walkers), 1)))
        proposal = normal * longer * _WIDER
        present = np.asarray(np.linalg.solve(self.factor, (walkers - self.mode).T).T, dtype=np.float64)
        return self.mode + proposal @ self.factor.T, _log_density(present) - _log_density(proposal)


def _value_and_gradient(loss: Callable[[Array], Array], point: Array) -> tuple[float, Array]:
    """Value and central differences, all evaluated at once."""
    steps = _DIFFERENCE * np.concatenate([np.zeros((1, point.size)), np.eye(point.size), -np.eye(point.size)])
    values = loss(point + steps)
    ahead, backward_values = np.split(values[1:], 2)
    return float(values[0]), (ahead - backward_values) / (2.0 * _DIFFERENCE)


def _log_density(standard: Array) -> Array:
    """Student-t density up to a constant of standardised vectors."""
    squares = (standard**2).sum(axis=1) / _WIDER**2
    return np.asarray(-0.5 * (_DEGREES + standard.shape[1]) * np.log1p(squares / _DEGREES))


_SAVING_INTERVAL: Final = 5.0  # s; what a kill costs at most, beside the steps that are being made
_SHARE_OF_TIME: Final = 0.1  # that writing may take, where the chains are long
_RULE: Final = "The file of the chains must be an HDF5 file that can be read and written"
_REMEDY: Final = "Name another file, or delete it to begin anew"


class ChainFile:
    """The file in which the chains of several ensembles are kept while they are drawn.

    Use :meth:`open`, which reads what an earlier run left.
    """

    def __init__(self, path: Path, signature: str, chains: "dict[str, Backend]") -> None:
        self.path = path
        self._signature = signature
        self._chains = chains
        self._written, self._pause = time.monotonic(), _SAVING_INTERVAL

    @classmethod
    @contextlib.contextmanager
    def open(
        cls, path: Path, names: Sequence[str], signature: str, shape: tuple[int, int], *, model: str
    ) -> "Iterator[tuple[ChainFile, list[Backend]]]":
        """Read the chains of an earlier run, or begin with empty ones; at the end all are written."""
        with decoding(_RULE, remedy=_REMEDY, where=path):
            stored_runs = _read(path, names, shape)
        if any(origin != signature for origin, _ in stored_runs.values() if origin is not None):
            raise InputError(
                "The stored chains belong to another model, other data or other settings",
                value=f"another run of {model}",
                remedy="Name another file; only the number of steps may grow",
                where=str(path),
            )
        file = cls(path, signature, {name: chain for name, (_, chain) in stored_runs.items()})
        with decoding(_RULE, remedy=_REMEDY, where=path):
            file._write()
        try:
            yield file, list(file._chains.values())
        except BaseException:
            with contextlib.suppress(Exception):
                file._write()
            raise
        file.save(now=True)

    def save(self, *, now: bool = False) -> None:
        """Write the chains if some seconds have passed."""
        if not now and time.monotonic() - self._written < self._pause:
            return
        start = time.monotonic()
        try:
            self._write()
        except OSError as error:
            raise IncompleteError(
                f"Writing {self.path} failed: {error}. Earlier draws are safe; remove the cause and "
                "run the same command again."
            ) from error
        self._written = time.monotonic()
        self._pause = max(_SAVING_INTERVAL, (self._written - start) / _SHARE_OF_TIME)

    def _write(self) -> None:
        """Write a new file with these chains and what the old one holds beside them."""
        import h5py

        content = io.BytesIO()  # HDF5 loses an error of the disk that shows when it closes a file
        with h5py.File(content, "w", libver="latest") as new:  # its descriptions carry checksums
            if self.path.exists():
                with open_hdf5(self.path) as old:
                    for name in _groups(old):
                        if name not in self._chains:
                            old.copy(name, new, name)
            for name, chain in self._chains.items():
                _store(new.create_group(name), chain, self._signature)
        with written_whole(self.path) as partial_file:
            partial_file.write_bytes(content.getbuffer())


def _read(
    path: Path, names: Sequence[str], shape: tuple[int, int]
) -> "dict[str, tuple[str | None, Backend]]":
    """Signature, where there is one, and chain by name."""
    from emcee.backends import Backend

    chains: dict[str, tuple[str | None, Backend]] = {}
    with contextlib.ExitStack() as files:
        groups = files.enter_context(open_hdf5(path)) if ordinary(path).exists() else {}
        for name in names:
            chain = Backend()
            chain.reset(*shape)
            signature = None
            if name in groups:
                signature = str(groups[name].attrs.get("signature", ""))
                if chain_fits := groups[name]["chain"].shape[1:] == shape:
                    _fill(chain, groups[name])
                signature = signature if chain_fits else ""
            chains[name] = signature, chain
    return chains


def _fill(chain: "Backend", group: "h5py.Group") -> None:
    iteration = int(group.attrs["iteration"])
    if not iteration:
        return
    chain.chain, chain.log_prob = group["chain"][:iteration], group["log_prob"][:iteration]
    chain.accepted, chain.iteration = group["accepted"][...], iteration
    state = tuple(group.attrs[f"random_state_{number}"] for number in range(5))
    np.random.RandomState().set_state(state)
    if len(chain.chain) < iteration or chain.log_prob.shape != chain.chain.shape[:2]:
        message = "chains of different lengths"
        raise ValueError(message)
    if not np.isfinite(chain.chain).all():
        message = "chains with values that are not numbers"
        raise ValueError(message)
    chain.random_state = state


def _store(group: "h5py.Group", chain: "Backend", signature: str) -> None:
    from emcee import __version__

    attributes: dict[str, Any] = {
        "version": __version__,
        "nwalkers": chain.nwalkers,
        "ndim": chain.ndim,
        "has_blobs": False,
        "iteration": chain.iteration,
        "signature": signature,
    }
    states = {f"random_state_{number}": values for number, values in enumerate(chain.random_state or ())}
    group.attrs.update({**attributes, **states})
    group.create_dataset("accepted", data=chain.accepted, fletcher32=True)
    for name in ("chain", "log_prob"):
        values = getattr(chain, name)[: chain.iteration]
        group.create_dataset(name, data=values, maxshape=(None, *values.shape[1:]), fletcher32=True)


def _groups(file: "h5py.File") -> list[str]:
    """Every group with a chain in it."""
    return [
        name.removesuffix("/chain")
        for name, item in objects_of(file)
        if name.endswith("/chain") and hasattr(item, "shape")
    ]


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

        def save_and_report(finished_steps: int, total: int) -> None:
            save()
            progress(finished_steps, total)

        while True:
            _run(samplers, starts, steps // ensembles.thin, ensembles.thin, save_and_report)
            kept = steps // ensembles.thin // 2  # as many draws as are left out before them
            posterior = PosteriorSample(
                names=tuple(parameter.name for parameter in model.parameters),
                draws=np.stack([sampler.get_chain(discard=kept)[:kept] for sampler in samplers]),
                thin=ensembles.thin,
                accepted=float(np.mean([sampler.acceptance_fraction for sampler in samplers])),
            )
            if 2 * steps > ensembles.longest or posterior.has_converged:
                return posterior
            steps *= 2


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
        while (iteration := sampler.backend.iteration) < draws:
            sampler.run_mcmc(
                start if iteration == 0 else None,
                min(block, draws - iteration),
                thin_by=thin,
                skip_initial_state_check=True,  # a start is drawn in all directions, however thin
            )
            total_draws = sum(min(sampler.backend.iteration, draws) for sampler in samplers)
            progress(thin * total_draws, thin * draws * len(samplers))


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
    with ChainFile.open(file, names, signature, shape, model=model.name) as (chain_file, chains):
        yield chains, chain_file.save


def _signature(model: Model, ensembles: Ensembles, width: int) -> str:
    settings = (model.name, model.parameters, ensembles.thin, ensembles.seed, width)
    data = np.ascontiguousarray(model.data, dtype=np.float64).tobytes()
    return hashlib.sha256(repr(settings).encode() + data).hexdigest()
