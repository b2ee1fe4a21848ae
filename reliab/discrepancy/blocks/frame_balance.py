"""The numerical substructure of a frame: ground acceleration and command → the force that balances them.

With coordinates x = γq₁/γᵀγ + Nq₂, in which q₁ = γᵀx is the command and the columns of N are orthogonal to γ,
the equations of the numerical substructure are, M, C, K and the load ℓ = Mι written in these coordinates ::

    M₂₂q₂'' + C₂₂q₂' + K₂₂q₂ = −ℓ₂a_g − M₂₁q₁'' − C₂₁q₁' − K₂₁q₁
    f = −ℓ₁a_g − (M₁₁q₁'' + C₁₁q₁' + K₁₁q₁) − (M₁₂q₂'' + C₁₂q₂' + K₁₂q₂)

The command is exact; the inner motion q₂ is that of the frame with its interface held, which is stable, and
is stepped exactly for loads that are straight between samples.
"""

from functools import lru_cache

import numpy as np
from scipy.linalg import null_space

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.balance import curvature_between_samples, motion_of_command
from reliab.discrepancy.blocks.calibration import force_not_fed_back
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.discrepancy.terms.clock_offset import LateGround
from reliab.effects.effect import RecordEffect, Role, Scales
from reliab.effects.force_bias import ForceBias
from reliab.effects.registry import library
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.frame import exact_step
from reliab.structures.partition import Partition


class InnerMotion:
    """Force at the interface of a numerical substructure whose interface moves as commanded.

    `step` [s].
    """

    def __init__(self, partition: Partition, step: float) -> None:
        gamma = partition.direction
        basis = np.column_stack([gamma / (gamma @ gamma), null_space(gamma[np.newaxis])])
        mass, damping, stiffness = (
            basis.T @ matrix @ basis
            for matrix in (
                partition.numerical_mass,
                partition.numerical_damping,
                partition.numerical_stiffness,
            )
        )
        load = basis.T @ partition.frame.mass @ partition.frame.influence
        inner = gamma.size - 1
        # Rows are equations, columns the inputs a_g, q₁'', q₁', q₁.
        driven = -np.column_stack([load, mass[:, 0], damping[:, 0], stiffness[:, 0]])
        pushed = np.linalg.solve(mass[1:, 1:], driven[1:])
        dynamics = np.zeros((2 * inner, 2 * inner))
        dynamics[:inner, inner:] = np.eye(inner)
        dynamics[inner:] = -np.linalg.solve(mass[1:, 1:], np.hstack([stiffness[1:, 1:], damping[1:, 1:]]))
        loads = np.vstack([np.zeros((inner, 4)), pushed])
        self._steps = exact_step(dynamics, loads, step)
        across = mass[0, 1:]
        self._of_state = -(across @ dynamics[inner:] + np.concatenate([stiffness[0, 1:], damping[0, 1:]]))
        self._of_inputs = driven[0] - across @ pushed

    def force(self, ground: Array, motion: Array) -> Array:
        """Force that balances a ground acceleration and a motion of the command, from rest.

        `ground` [m/s²]; `motion` [m]; returns [N].
        """
        inputs = np.ascontiguousarray(np.stack([ground, motion[2], motion[1], motion[0]], axis=1))
        transition, early, late = (np.ascontiguousarray(matrix) for matrix in self._steps)
        return _balance(transition, early, late, self._of_state, self._of_inputs, inputs)


@compiled
def _balance(
    transition: Array, early: Array, late: Array, of_state: Array, of_inputs: Array, inputs: Array
) -> Array:
    """Step the inner motion and add up the force at every sample, shape (n,)."""
    states, count = early.shape
    z, z_next = np.zeros(states), np.zeros(states)
    force = np.zeros(inputs.shape[0])
    for k in range(inputs.shape[0]):
        if k > 0:
            for i in range(states):
                total = 0.0
                for j in range(states):
                    total += transition[i, j] * z[j]
                for j in range(count):
                    total += early[i, j] * inputs[k - 1, j] + late[i, j] * inputs[k, j]
                z_next[i] = total
            z[:] = z_next
        total = 0.0
        for j in range(states):
            total += of_state[j] * z[j]
        for j in range(count):
            total += of_inputs[j] * inputs[k, j]
        force[k] = total
    return force


class FrameBalanceBlock(ObservedBlock):
    """(ground acceleration, command) → force, with a frame as the numerical substructure.

    Effects on the record are searched for here; errors of the integration of a frame are not.
    """

    block = Block.NUMERICAL
    channel = Channel.FORCE
    inputs = (Channel.GROUND, Channel.COMMAND)

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        if campaign.partition is None:
            raise InputError("The balance of a frame needs a frame", remedy="Add a [structure.frame] table")
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        self.calibrations = (curvature_between_samples(), force_not_fed_back())
        self.offsets = ()
        records = (effect for effect in library().values() if effect.role is Role.RECORD)
        self.candidates = (*records, LateGround)
        self.outside = ()
        self.motions = tuple(motion_of_command(test, campaign.step) for test in campaign.tests)
        self._inner = InnerMotion(campaign.partition, campaign.step)
        self._of_command = lru_cache(maxsize=len(self.tests))(self._force_of_command)

    def _force_of_command(self, test: int) -> Array:
        motion = self.motions[test].values
        return self._inner.force(np.zeros(motion.shape[1]), motion)

    def predict(self, model: HybridTest, test: int) -> Array:
        """Force that balances ground motion and command [N], shape (n,)."""
        ground = self.tests[test].channels[Channel.GROUND]
        for effect in model.acting(Role.RECORD):
            if isinstance(effect, RecordEffect):
                ground = effect.applied(ground, 1.0 / self.rate)
        still = np.zeros((3, ground.size))
        offset = sum(effect.bias_n for effect in model.effects if isinstance(effect, ForceBias))
        return offset + self._of_command(test) + self._inner.force(ground, still)
