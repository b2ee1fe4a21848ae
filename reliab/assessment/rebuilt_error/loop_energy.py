"""The energy of the loop in the modes that are watched, sample by sample while a test runs."""

from collections.abc import Sequence

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.stability_indicator import EnergyAlarm, NetDamping, Sums, net_damping
from reliab.assessment.rebuilt_error.watched_modes import WatchedMode
from reliab.compiled import compiled


class LoopEnergy:
    """Follow the motion of each mode in its band, and raise the alarm where the loop gains energy.

    `since`: Number of the sample of the alarm; None while there is none.
    `gaining`: Mode that may diverge; None while there is none.
    """

    def __init__(self, modes: Sequence[WatchedMode]) -> None:
        self.since: int | None = None
        self.gaining: WatchedMode | None = None
        self._motions = [_Motion(mode, len(modes)) for mode in modes]
        self._size = 0

    @property
    def moves(self) -> bool:
        """Whether a sample has moved so far."""
        return any(motion.totals[1] > 0.0 for motion in self._motions)

    @property
    def net(self) -> NetDamping | None:
        """Smallest net damping of those that are known; None where none is."""
        return min(self._known, key=lambda net: net.ratio, default=None)

    @property
    def near_instability(self) -> bool:
        """Whether a mode has lost most of its damping."""
        return any(net.near for net in self._known)

    @property
    def _known(self) -> list[NetDamping]:
        return [net for motion in self._motions if (net := motion.net) is not None and net.known]

    def feed(self, command: Array, measured: Array) -> None:
        """Add the next samples at the interface [m], shape (n,) or (p, n)."""
        command, measured = np.atleast_2d(command), np.atleast_2d(measured)
        alarms = [motion.feed(command, measured, self._size) for motion in self._motions]
        raised = [(at, place) for place, at in enumerate(alarms) if at is not None]
        self._size += command.shape[1]
        if raised and self.since is None:
            self.since, place = min(raised)
            self.gaining = self._motions[place].mode


class _Motion:
    """Motion of a mode, and its alarm."""

    def __init__(self, mode: WatchedMode, modes: int) -> None:
        self.mode, self._modes = mode, modes
        self._alarm = EnergyAlarm()
        self._moments, self.totals = np.zeros((2, 3, 3)), np.zeros(3)
        self._signals, self._between = np.zeros((2, 4)), np.zeros(3)

    @property
    def net(self) -> NetDamping | None:
        """Net damping at the last sample."""
        weight, moved, power = self.totals
        return net_damping(
            self.mode,
            Sums(moments=self._moments, weight=weight, moved=moved, power=power),
            self._modes,
        )

    def feed(self, command: Array, measured: Array, first: int) -> int | None:
        """Add samples, `first` the number of the first of them; return the one of the alarm."""
        mode, begin, raised = self.mode, 0, None
        moved, strayed = mode.projection @ command, mode.projection @ (measured - command)
        while begin < moved.size:
            end = min(begin + mode.look - (first + begin) % mode.look, moved.size)
            _follow(
                moved[begin:end],
                strayed[begin:end],
                first + begin == 0,
                mode.band,
                mode.forgetting,
                mode.time_step,
                self._signals,
                self._between,
                self._moments,
                self.totals,
            )
            if (first + end) % mode.look == 0 and self._alarm.look(self.net) and raised is None:
                raised = first + end - 1
            begin = end
        return raised


@compiled
def _follow(
    command: Array,
    error: Array,
    begins: bool,  # noqa: FBT001 - compiled
    band: Array,
    forgetting: float,
    time_step: float,
    signals: Array,
    between: Array,
    moments: Array,
    totals: Array,
) -> None:
    """Pass command and error through the band, and sum their products, in place.

    `signals`: first value, two states of the band-pass and last value of each of both; `totals`: sum of the
    weights, samples that moved, and the largest power.
    """
    now, stepped = np.empty(2), np.empty(3)
    for i in range(command.size):
        now[0], now[1] = command[i], error[i]
        for row in range(2):
            if begins and i == 0:
                signals[row, 0] = now[row]
            change = now[row] - signals[row, 0]
            now[row] = band[0] * change + signals[row, 1]
            signals[row, 1] = signals[row, 2] - band[1] * now[row]
            signals[row, 2] = -band[0] * change - band[2] * now[row]
        if not (begins and i == 0):
            for row in range(3):
                stepped[row] = -between[row]
            between[0] = 0.5 * (now[0] + signals[0, 3])
            between[1] = (now[0] - signals[0, 3]) / time_step
            between[2] = 0.5 * (now[1] + signals[1, 3])
            for row in range(3):
                stepped[row] += between[row]
            for row in range(3):
                for column in range(3):
                    product = between[row] * between[column]
                    moments[0, row, column] = forgetting * moments[0, row, column] + product
                    product = stepped[row] * stepped[column]
                    moments[1, row, column] = forgetting * moments[1, row, column] + product
            totals[0] = forgetting * totals[0] + 1.0
            totals[1] += 1.0 if between[1] != 0.0 else 0.0
            totals[2] = max(totals[2], moments[0, 1, 1])
        signals[0, 3], signals[1, 3] = now[0], now[1]
