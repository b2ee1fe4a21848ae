"""The tests of a round: simulated with errors near target values, and judged under every condition."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Final

import numpy as np

from reliab.assessment.rebuild import RebuiltError, rebuild
from reliab.assessment.rebuilt_error.specimen_check import FEWEST_PERIODS, examine_specimen
from reliab.core.arrays import Array
from reliab.motions.motion import Motion, resample
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.closed_loop import LoopHistories, run_closed_loop
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.structure import Structure
from reliab.tracking.indices.response_error import response_error

from ..beyond_the_model import Rig
from .design import Design
from .judges import WITH_MODEL, ByIndices, Judgement, judge_by_rebuilt_error, judge_by_verdict
from .rigs import CONDITIONS, LINEAR, PLAIN, RIGHT, RIGS, SPECIMENS, Condition, NonlinearSpecimen, Scales

RATE_HZ: Final = 512.0
LONGEST: Final = 40.0
"""Length up to which a record is used [s]."""

_DRAWS = 64
_SMALLEST, _LARGEST = 0.2, 3.0  # target values of the true error, as shares of the threshold
_STARTING_SIZE = 0.1
_ATTEMPTS = 6
_RAN_AWAY = 1.0  # relative error of a test that nobody would take for good
_NEAR = 0.15  # relative: near enough to the target value of the error
_MODEL_OFF = 0.01  # standard deviation of a model's parameters, relative
_GAIN_AND_DELAY = 0  # of RIGS: what drives nonlinear specimens


@dataclass(frozen=True, kw_only=True, eq=False)
class _Bench:
    """A ground motion with a structure under it."""

    design: Design
    record: Motion
    structure: Structure
    rng: np.random.Generator
    judges: Mapping[str, ByIndices]

    def run(self, rig: Rig, nonlinear: NonlinearSpecimen | None) -> LoopHistories:
        behaviour = () if nonlinear is None else (nonlinear.effect,)
        test = HybridTest(
            structure=self.structure,
            actuator=rig.actuator,
            specimen=None if nonlinear is None else nonlinear.specimen(),
            effects=(*rig.effects, *behaviour),
        )
        with np.errstate(over="ignore", invalid="ignore"):
            return run_closed_loop(
                test, self.record.acceleration, self.record.time_step, compensator=rig.compensator
            )


def tests_of_round(design: Design, number: int) -> Iterator[dict[str, object]]:
    """Simulate the tests of a round, and have them judged."""
    place = number % len(design.motions)
    motion = _cut(design.motions[place])
    record = resample(motion, RATE_HZ)
    without = design.learned_without[place]
    count = 0
    for order, structure in enumerate(design.structures):
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        bench = _Bench(
            design=design,
            record=record,
            structure=structure,
            rng=np.random.default_rng([design.seed, number, order]),
            judges={
                each.stated: ByIndices.from_excitation(
                    excitation, each.structure(structure), design.question, without
                )
                for each in {each.stated: each for each in CONDITIONS}.values()
            },
        )
        kinds = [*product([LINEAR], range(len(RIGS))), *product(SPECIMENS, [_GAIN_AND_DELAY])]
        for specimen, rig in kinds:
            for row in _try(bench, specimen, rig):
                head = {"study": design.digest, "round": number, "motion": motion.name, "test": count}
                yield {**head, "event": motion.event, **row}
            count += 1


def _cut(motion: Motion) -> Motion:
    samples = int(LONGEST / motion.time_step) + 1
    return replace(motion, acceleration=motion.acceleration[:samples])


def _try(bench: _Bench, specimen: str, kind: int) -> Iterator[dict[str, object]]:
    """Rows of one test; none where no size of the actuator gives a test that stays bounded."""
    perfect = bench.run(Rig(name="perfect"), None).command
    nonlinear = None
    if specimen != LINEAR:
        stiffness = bench.structure.experimental_fraction * bench.structure.circular_frequency**2
        peak = float(np.abs(perfect.values[0]).max())
        nonlinear = SPECIMENS[specimen](stiffness, peak, bench.rng)
        perfect = bench.run(Rig(name="perfect"), nonlinear).command
    ideal = perfect.values[0]
    scales = Scales(
        structure=bench.structure,
        displacement=float(np.abs(ideal).max()),
        velocity=float(np.abs(perfect.values[1]).max()),
        duration=bench.record.duration,
        step=bench.record.time_step,
        lean=bench.rng.uniform(-1.0, 1.0),
    )
    simulated = _draw_test(bench, kind, scales, nonlinear, ideal)
    if simulated is None:
        return
    rig, histories, error = simulated
    structure = bench.structure
    row = {
        "rig": rig.name,
        "specimen": specimen,
        "f": structure.frequency,
        "xi": structure.damping_ratio,
        "alpha": structure.experimental_fraction,
        "error": error,
        "good": error <= bench.design.threshold,
    }
    for condition in CONDITIONS if nonlinear is None else (PLAIN,):
        said = {"sensor": condition.sensor, "stated": condition.stated}
        for judgement, looks_nonlinear in _judge_tests(bench, histories, condition, nonlinear):
            yield {**row, **said, **vars(judgement), "looks_nonlinear": looks_nonlinear}


def _draw_test(
    bench: _Bench, kind: int, scales: Scales, nonlinear: NonlinearSpecimen | None, ideal: Array
) -> tuple[Rig, LoopHistories, float] | None:
    """Test whose error is near one that is drawn, evenly in its logarithm around the threshold."""
    spread = np.log([_SMALLEST, _LARGEST])
    aim = bench.design.threshold * float(np.exp(bench.rng.uniform(*spread)))
    size, best = _STARTING_SIZE, None
    for _ in range(_ATTEMPTS):
        rig = RIGS[kind](size, scales)
        histories = bench.run(rig, nonlinear)
        piston = histories.piston.values[0]
        error = response_error(piston, ideal, bench.design.metric) if np.isfinite(piston).all() else np.inf
        if not error < _RAN_AWAY:
            size *= 0.25
            continue
        if best is None or abs(np.log(error / aim)) < abs(np.log(best[2] / aim)):
            best = rig, histories, error
        if error > 0.0 and abs(error / aim - 1.0) < _NEAR:
            break
        size *= float(np.clip(aim / error, 0.2, 5.0)) if error > 0.0 else 5.0
    return best


def _judge_tests(
    bench: _Bench, histories: LoopHistories, condition: Condition, nonlinear: NonlinearSpecimen | None
) -> Iterator[tuple[Judgement, float]]:
    question, step = bench.design.question, bench.record.time_step
    stated = condition.structure(bench.structure)
    command = histories.command.values[0]
    measured = condition.read(histories.piston.values[0], bench.rng)
    error = rebuild(command, measured, step, stated, known=condition.known, draws=_DRAWS)
    looks_nonlinear = np.nan
    periods = command.size * step * stated.frequency
    if condition.stated == RIGHT and periods >= FEWEST_PERIODS:
        force = condition.read(histories.force, bench.rng)
        seen = examine_specimen(error.histories.measured[0], force, step, stated.frequency)
        looks_nonlinear = float(seen.nonlinear)
    yield judge_by_rebuilt_error(error, question), looks_nonlinear
    yield judge_by_verdict(error, question, looks_nonlinear=looks_nonlinear == 1.0), looks_nonlinear
    if nonlinear is not None:
        modelled = _rebuild_with_model(bench, command, measured, nonlinear)
        yield judge_by_rebuilt_error(modelled, question, WITH_MODEL), looks_nonlinear
    for judgement in bench.judges[condition.stated].judge(command, measured, step):
        yield judgement, looks_nonlinear


def _rebuild_with_model(
    bench: _Bench, command: Array, measured: Array, nonlinear: NonlinearSpecimen
) -> RebuiltError:
    """Rebuild with a model whose every parameter is wrong by about 1 %, with that tolerance stated."""
    effect, specimen = nonlinear.effect, nonlinear.specimen()
    free = effect.values * np.array([parameter.units != "-" for parameter in effect.parameters])
    values = effect.values + _MODEL_OFF * bench.rng.standard_normal(free.size) * free
    stiffness = specimen.stiffness * (1.0 + _MODEL_OFF * bench.rng.standard_normal())
    deviations = {
        f"{effect.name}.{parameter.name}": _MODEL_OFF * abs(float(value))
        for parameter, value in zip(effect.parameters, free, strict=True)
    }
    test = HybridTest(
        structure=bench.structure,
        specimen=replace(specimen, stiffness=stiffness),
        effects=(effect.from_values(values),),
    )
    deviations["stiffness_n_per_m"] = _MODEL_OFF * specimen.stiffness
    model = UpdatedModel(name="", test=test, deviations=deviations)
    return rebuild(command, measured, bench.record.time_step, model, draws=_DRAWS)
