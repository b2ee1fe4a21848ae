"""Rows of a test that is still written, with the measured displacement at the times to which it belongs."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from reliab.arrays import Array
from reliab.recordings.following import Rows


def rows_without_skew(rows: Iterator[Rows], samples: float) -> Iterator[Rows]:
    """Take a skew off, positive where the measured displacement was recorded later [samples].

    Commands wait for the reading that belongs to them, which is a cubic through the four next samples; the
    last commands, whose reading never comes, are left out. Before its first sample a reading stands still.

    >>> time = np.arange(9.0)
    >>> late = Rows(time=time, command=time**2, measured=(time - 1.5) ** 2)
    >>> (moved,) = rows_without_skew(iter([late]), 1.5)
    >>> moved.measured.tolist() == moved.command.tolist() == [0.0, 1.0, 4.0, 9.0, 16.0, 25.0]
    True
    """
    ahead = int(np.floor(samples))
    weights = _cubic(samples - ahead)
    first = 1 - ahead  # sample of the command whose cubic begins with the first reading
    waiting: Rows | None = None
    read = np.empty(0)
    for part in rows:
        if waiting is None:
            read = np.repeat(part.measured[..., :1], max(first, 0), axis=-1)
        read = np.concatenate([read, part.measured], axis=-1)
        waiting = part if waiting is None else _joined(waiting, part)
        if first < 0:
            dropped = min(-first, read.shape[-1])
            read, first = read[..., dropped:], first + dropped
        ready = min(read.shape[-1] - weights.size + 1, waiting.command.shape[-1]) if first >= 0 else 0
        if ready > 0:
            nodes = np.lib.stride_tricks.sliding_window_view(read, weights.size, axis=-1)
            yield replace(
                waiting,
                time=None if waiting.time is None else waiting.time[:ready],
                command=waiting.command[..., :ready],
                measured=nodes[..., :ready, :] @ weights,
                force=None if waiting.force is None else waiting.force[:ready],
            )
            waiting, read = _after(waiting, ready), read[..., ready:]


def _cubic(place: float) -> Array:
    """Weights of samples at −1, 0, 1 and 2 for a cubic at a place between 0 and 1 (Lagrange)."""
    nodes = np.array([-1.0, 0.0, 1.0, 2.0])
    others = [np.delete(nodes, k) for k in range(nodes.size)]
    return np.array([np.prod((place - o) / (node - o)) for node, o in zip(nodes, others, strict=True)])


def _joined(before: Rows, after: Rows) -> Rows:
    return replace(
        after,
        time=_one_after_the_other(before.time, after.time),
        command=np.concatenate([before.command, after.command], axis=-1),
        force=_one_after_the_other(before.force, after.force),
    )


def _one_after_the_other(before: Array | None, after: Array | None) -> Array | None:
    return None if before is None or after is None else np.concatenate([before, after])


def _after(rows: Rows, count: int) -> Rows:
    return replace(
        rows,
        time=None if rows.time is None else rows.time[count:],
        command=rows.command[..., count:],
        force=None if rows.force is None else rows.force[count:],
    )
