"""Net damping ratio of the loop with its actuator while the test runs: below zero the loop gains energy.

The actuator's error puts the restoring force k(x_m − x_c) into the loop. The part in phase with the velocity
acts as added damping, positive or negative: with x_m − x_c = a x_c + b x_c' + c ::

    ξ_net = ξ + αω₀b/2

(for a delay τ it is ξ − αω₀τ/2, whose zero is the stability limit to first order; the balance of energy is
that of Mosqueda, Stojadinovic and Mahin 2007, J. Struct. Eng. 133, 1). a, b and c are those of least squares
over a window that forgets exponentially, so that a wrong gain or an offset is not taken for damping while the
motion grows.

Play feeds energy in as well, and sets a small motion going; but the error that it causes does not grow with
the motion, and a large motion does not diverge from it. Play of half width δ takes the damping
(2α/π)(δ/A)(1 − δ/A) away at an amplitude A (its describing function). δ is at most about twice the
root mean square of the smallest error, apart from a gain and an offset, over a window in which the actuator
followed its command (A > 2δ); 2.2 times are granted. While the command has lately gone beyond the largest
exact displacement of the test so far, by a tenth, the motion is no longer the structure's own, and one time
is granted.

The alarm is raised where ξ_net, play granted, lies below zero while the motion is among the largest of the
test, by more standard errors than chance gives to one stable test in a hundred. So many are needed as there
were independent windows: the k-th is allowed a false alarm with the probability 0.01/(k(k + 1)), and all of
them together with 0.01.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure, first_mode

MEMORY = 2.0
"""Periods after which the window has forgotten all but 1/e."""

LOOKS = 4
"""Looks at the net damping in a period."""

SETTLED = 1.0
"""Periods of motion before the indicator is trusted."""

FALSE_ALARMS = 0.01
"""Probability of a false alarm in a test of any length."""

INDEPENDENT = 4.0  # samples in a period of which the errors count as independent, at least
_WHITE = 1.0  # mean square of the steps of white noise, averaged over two samples, over its own
LARGE_MOTION = 0.5  # of the largest power of the motion so far
LARGEST_PLAY = 2.2  # times the smallest error that half the width of the play may be
STRAYS = 1.1  # times the largest exact displacement so far that a command may reach of its own
PLAY_OF_STRAYING = 1.0  # times the smallest error that half the width of the play may be beyond that
FOLLOWS = 0.5  # of the command: measured motion, in phase or late, with which a piston follows it
_SINGULAR = 1e-12
_GAIN_AND_OFFSET = [0, 2]  # rows of the moments


@dataclass(frozen=True, kw_only=True)
class NetDamping:
    """Net damping of the loop with its actuator."""

    ratio: float  # ratio, deviation: ξ_net and its standard error [-]
    deviation: float
    high: float  # ξ_net and as many standard errors as chance gives to one stable test in a hundred [-]
    large: bool  # Whether the motion is among the largest so far
    follows: bool  # Whether the piston follows its command, and does not rest within some play
    error: float  # Root mean square of the actuator's error, apart from a gain and an offset [m]
    by_play: float  # Damping ratio that play takes away at most, over half its width [1/m]


@dataclass(kw_only=True)
class EnergyAlarm:
    """Looks at the net damping of a running test one after the other."""

    smallest: float = np.inf  # Smallest error so far of an actuator that follows its command [m]
    following: int = 0  # Looks since which it has followed its command
    # Largest command since the last look, and before it since the last but one [m]
    command: float = 0.0
    command_before: float = 0.0

    def add(self, command: Array) -> None:
        """Add commands [m] since the last look."""
        self.command = max(self.command, float(np.abs(command).max(initial=0.0)))

    def look(self, net: NetDamping | None, ideal: float) -> bool:
        """Return whether the loop may diverge; `ideal`: largest exact displacement so far [m]."""
        strays = max(self.command, self.command_before) > STRAYS * ideal
        self.command_before, self.command = self.command, 0.0
        if net is None:
            return False
        self.following = self.following + 1 if net.follows else 0
        if self.following > 1:  # not while it only begins to move
            self.smallest = min(self.smallest, net.error)
        play = (PLAY_OF_STRAYING if strays else LARGEST_PLAY) * self.smallest
        return net.large and net.high + net.by_play * play < 0.0


@dataclass(frozen=True, kw_only=True)
class Damping:
    """Properties of the first mode that the indicator needs."""

    ratio: float  # ξ of the lowest mode [-]
    factor: float  # k_e ν²/(2ω₀m) [1/s], half of αω₀ for one degree of freedom
    forgetting: float  # Weight that is left of the past after a step [-]
    samples: float  # Samples in a period [-]
    circular_frequency: float  # ω₀ of that mode [rad/s]

    @classmethod
    def of_structure(cls, structure: WholeStructure, time_step: float) -> "Damping":
        """Take the lowest mode of a structure.

        `time_step` [s].
        """
        shape = first_mode(structure)
        mass = float(shape @ structure.mass @ shape)
        w0 = float(np.sqrt(shape @ structure.stiffness @ shape / mass))
        ratio = float(shape @ structure.damping @ shape) / (2.0 * w0 * mass)
        return cls.of_mode(w0, ratio, structure.specimen_stiffness / mass, time_step)

    @classmethod
    def of_mode(cls, circular_frequency: float, ratio: float, specimen: float, time_step: float) -> "Damping":
        """Take a mode.

        `circular_frequency` [rad/s]; `specimen`: its stiffness over the modal mass [1/s²]; `time_step` [s].
        """
        return cls(
            ratio=ratio,
            factor=specimen / (2.0 * circular_frequency),
            forgetting=float(np.exp(-time_step * circular_frequency / (2.0 * np.pi * MEMORY))),
            samples=2.0 * np.pi / (circular_frequency * time_step),
            circular_frequency=circular_frequency,
        )

    def net(self, moments: Array, motion: Array) -> NetDamping | None:
        """Return the net damping of the loop with its actuator."""
        power = float(moments[0, 1, 1])
        if motion[0] < SETTLED * self.samples or not power > 0.0:
            return None
        scale = np.sqrt(np.maximum(np.diag(moments[0]), np.finfo(float).tiny))
        joint, steps = moments / np.outer(scale, scale)
        inverse = np.linalg.pinv(joint[:3, :3], rcond=_SINGULAR, hermitian=True)
        residual = np.append(-inverse @ joint[:3, 3], 1.0)
        rest = max(float(residual @ joint @ residual), 0.0)
        rough = min(float(residual @ steps @ residual) / rest, _WHITE) if rest > 0.0 else 0.0
        count = float(moments[0, 2, 2])
        independent = max(count * max(rough / (4.0 - rough), INDEPENDENT / self.samples), 1.0)
        errors = np.sqrt(np.maximum(np.diag(inverse), 0.0) * rest / independent)
        units = float(self.factor * scale[3] / scale[1])
        ratio = float(self.ratio) - units * float(residual[1])
        deviation = units * float(errors[1])
        window = np.ceil(motion[0] / (MEMORY * self.samples))
        needed = -float(scipy.special.ndtri(FALSE_ALARMS / (window * (window + 1.0))))
        follows = joint[_GAIN_AND_OFFSET, 3]
        known = np.linalg.pinv(
            joint[np.ix_(_GAIN_AND_OFFSET, _GAIN_AND_OFFSET)], rcond=_SINGULAR, hermitian=True
        )
        error = (1.0 - float(follows @ known @ follows)) * float(moments[0, 3, 3]) / count
        amplitude = float(np.sqrt(2.0 / count) * scale[0])
        return NetDamping(
            ratio=ratio,
            deviation=deviation,
            high=ratio + needed * deviation,
            large=power > LARGE_MOTION * float(motion[1]),
            follows=_follows(scale, residual, needed * errors),
            error=float(np.sqrt(max(error, 0.0))),
            by_play=4.0 / np.pi * self.factor / (self.circular_frequency * amplitude),
        )


def _follows(scale: Array, residual: Array, chance: Array) -> bool:
    """Whether the measured motion, as far as it is no chance, is half of the command or more at any phase."""
    in_phase = max(abs(scale[0] - residual[0] * scale[3]) - chance[0] * scale[3], 0.0)
    across = max((abs(residual[1]) - chance[1]) * scale[3], 0.0)
    return bool(np.hypot(in_phase, across) > FOLLOWS * scale[0])
