"""Chains of ensembles in an HDF5 file that is replaced as a whole, so that no interruption damages it.

HDF5 files that are written in place are damaged when their process dies in between. The chains are kept in
memory instead, and every few seconds all of them are written to a new file that takes the place of the old
one. Groups and datasets are those of emcee's own HDF5 files.
"""

import contextlib
import io
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from reliab.core.errors import IncompleteError, InputError
from reliab.core.files import decoding, ordinary, written_whole
from reliab.core.untrusted_files import objects_of, opened_hdf5

if TYPE_CHECKING:
    import h5py
    from emcee.backends import Backend

_EVERY: Final = 5.0  # s; what a kill costs at most, beside the steps that are being made
_SHARE_OF_TIME: Final = 0.1  # that writing may take, where the chains are long
_RULE: Final = "The file of the chains must be an HDF5 file that can be read and written"
_REMEDY: Final = "Name another file, or delete it to begin anew"


class ChainFile:
    """The file in which the chains of several ensembles are kept while they are drawn.

    Use :meth:`opened`, which reads what an earlier run left.
    """

    def __init__(self, path: Path, signature: str, chains: "dict[str, Backend]") -> None:
        self.path = path
        self._signature = signature
        self._chains = chains
        self._written, self._pause = time.monotonic(), _EVERY

    @classmethod
    @contextlib.contextmanager
    def opened(
        cls, path: Path, names: Sequence[str], signature: str, shape: tuple[int, int], *, model: str
    ) -> "Iterator[tuple[ChainFile, list[Backend]]]":
        """Read the chains of an earlier run, or begin with empty ones; at the end all are written."""
        with decoding(_RULE, remedy=_REMEDY, where=path):
            stored = _read(path, names, shape)
        if any(recorded != signature for recorded, _ in stored.values() if recorded is not None):
            raise InputError(
                "A run is resumed with the model, data and settings that it began with",
                value=f"another run of {model}",
                remedy="Name another file; only the number of steps may grow",
                where=str(path),
            )
        file = cls(path, signature, {name: chain for name, (_, chain) in stored.items()})
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
        begun = time.monotonic()
        try:
            self._write()
        except OSError as error:
            raise IncompleteError(
                f"Writing {self.path} failed: {error}. Earlier draws are safe; remove the cause and "
                "run the same command again."
            ) from error
        self._written = time.monotonic()
        self._pause = max(_EVERY, (self._written - begun) / _SHARE_OF_TIME)

    def _write(self) -> None:
        """Write a new file with these chains and what the old one holds beside them."""
        import h5py

        content = io.BytesIO()  # HDF5 loses an error of the disk that shows when it closes a file
        with h5py.File(content, "w", libver="latest") as new:  # its descriptions carry checksums
            if self.path.exists():
                with opened_hdf5(self.path) as old:
                    for name in _groups(old):
                        if name not in self._chains:
                            old.copy(name, new, name)
            for name, chain in self._chains.items():
                _store(new.create_group(name), chain, self._signature)
        with written_whole(self.path) as unfinished:
            unfinished.write_bytes(content.getbuffer())


def _read(
    path: Path, names: Sequence[str], shape: tuple[int, int]
) -> "dict[str, tuple[str | None, Backend]]":
    """Signature, where there is one, and chain by name."""
    from emcee.backends import Backend

    chains: dict[str, tuple[str | None, Backend]] = {}
    with contextlib.ExitStack() as files:
        held = files.enter_context(opened_hdf5(path)) if ordinary(path).exists() else {}
        for name in names:
            chain = Backend()
            chain.reset(*shape)
            signature = None
            if name in held:
                signature = str(held[name].attrs.get("signature", ""))
                if chain_fits := held[name]["chain"].shape[1:] == shape:
                    _fill(chain, held[name])
                signature = signature if chain_fits else ""
            chains[name] = signature, chain
    return chains


def _fill(chain: "Backend", held: "h5py.Group") -> None:
    done = int(held.attrs["iteration"])
    if not done:
        return
    chain.chain, chain.log_prob = held["chain"][:done], held["log_prob"][:done]
    chain.accepted, chain.iteration = held["accepted"][...], done
    state = tuple(held.attrs[f"random_state_{number}"] for number in range(5))
    np.random.RandomState().set_state(state)
    if len(chain.chain) < done or chain.log_prob.shape != chain.chain.shape[:2]:
        message = "chains of different lengths"
        raise ValueError(message)
    if not np.isfinite(chain.chain).all():
        message = "chains with values that are not numbers"
        raise ValueError(message)
    chain.random_state = state


def _store(group: "h5py.Group", chain: "Backend", signature: str) -> None:
    from emcee import __version__

    described: dict[str, Any] = {
        "version": __version__,
        "nwalkers": chain.nwalkers,
        "ndim": chain.ndim,
        "has_blobs": False,
        "iteration": chain.iteration,
        "signature": signature,
    }
    states = {f"random_state_{number}": values for number, values in enumerate(chain.random_state or ())}
    group.attrs.update({**described, **states})
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
