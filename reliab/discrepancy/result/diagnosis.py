"""The results for a whole campaign."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from reliab.assessment.recorded_force import unit_like
from reliab.core.plain_values import Keys, ResultWithRows, html_table
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import MILLI, PERCENT, Block
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.discrepancy.locate import Finding
from reliab.discrepancy.result.block_diagnosis import NOMINAL_VALUES, BlockDiagnosis, Verdict
from reliab.discrepancy.result.gap import Gap, Remainder
from reliab.discrepancy.result.missing_effect import Estimate, MissingEffect, Unknown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NAMES = {Block.NUMERICAL: "numerical substructure"}

SHORT_RECORD = 256
"""Samples of a test below which a remark says that it is short."""

_UNIT_TOLERANCE = 0.03  # of a calibrated stiffness
_OTHER_MODELS = 0.8  # of a standard deviation, from which other models make up most of it
_CLOCK = "clock_offset"
_LATE_CHANNELS = {"lag_s": ("force", "displacement"), "ground_lag_s": ("ground acceleration", "command")}
_LIKE_A_STRUCTURE = {"added_mass", "viscous_damping", "structure_damping"}
_ONE_CHANNEL = (
    "In a single channel an added mass or a damper looks like a natural frequency or a damping ratio that is "
    "stated wrongly: check the table [structure], or record command and force as well."
)
_VERDICTS = {
    Verdict.NAMED: "The effects that the model lacks are listed below.",
    Verdict.UNKNOWN_EFFECT: "The model lacks an effect that is none of the known ones.",
    Verdict.NOT_IDENTIFIABLE: "The model lacks an effect, but these tests do not show which one.",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Diagnosis(ResultWithRows):
    """The results for a campaign.

    Attributes
    ----------
    campaign : Campaign
        The campaign.
    blocks : tuple of BlockDiagnosis
        Every observed block.
    faults : tuple of str, optional
        Faults of the recordings, sentences.
    criterion_shift : dict, optional
        Ratios of the criterion's parameters with and without the effects, where they were computed.
    """

    keys: ClassVar[Keys] = {
        "campaign": "campaign.name",
        "verdict": "verdict",
        "where": "where",
        "effects": "all_effects",
        "unknown": "unknown",
        "gap": "gap",
        "blocks": "blocks",
        "criterion_shift": "criterion_shift",
        "remarks": "remarks",
    }

    rows_in = "effects"

    campaign: Campaign
    blocks: tuple[BlockDiagnosis, ...]
    faults: tuple[str, ...] = ()
    criterion_shift: dict[str, float] | None = None

    @property
    def effects(self) -> tuple[MissingEffect, ...]:
        """Effects that are named in any block."""
        return tuple(effect for block_result in self.blocks for effect in block_result.effects)

    @property
    def doubtful(self) -> tuple[MissingEffect, ...]:
        """Effects that the data cannot tell from others."""
        return tuple(effect for block_result in self.blocks for effect in block_result.doubtful)

    @property
    def all_effects(self) -> tuple[MissingEffect, ...]:
        """Effects that are named, then those that the data cannot tell from others."""
        return (*self.effects, *self.doubtful)

    @property
    def unknown(self) -> Unknown | None:
        """The effect outside the library, in the first block that has one."""
        return next((block.unknown for block in self.blocks if block.unknown is not None), None)

    @property
    def verdict(self) -> Verdict:
        """The answer in one word."""
        return max((block.verdict for block in self.blocks), key=list(Verdict).index)

    @property
    def statement(self) -> str:
        """The verdict in a sentence."""
        return statement(self.verdict, self.blocks)

    @property
    def is_explained(self) -> bool:
        """Whether what the models leave can be taken for noise in every block."""
        return all(is_explained(block) for block in self.blocks)

    @property
    def gap(self) -> Gap:
        """The gap in the block where it shrank by the largest factor."""
        gaps = [block.gap for block in self.blocks]
        return max(gaps, key=lambda gap: gap.before / max(gap.after, 1e-300))

    @property
    def where(self) -> tuple[Finding, ...]:
        """All findings, block by block, the largest share of each block's residual first."""
        return tuple(finding for block_result in self.blocks for finding in block_result.findings)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on what limits the answer: faults, doubts, bounds, convergence, errors of models."""
        tests = self.campaign.tests
        remarks = [
            *self.faults,
            *(contradiction(item) for block in self.blocks for item in block.misstated),
            *scale_of_displacement(self.blocks),
            *(one_of_two(block.either_misstated) for block in self.blocks if block.either_misstated),
            *(effect.remark for effect in self.doubtful),
            *(limit for block in self.blocks for limit in _limits_of(block)),
        ]
        if len(tests) == 1:
            remarks.append(
                f"{tests[0].file} is the only test: effects were verified on the {self.campaign.held_out} "
                "and sought in the rest. Add a second test for a proof on other motion."
            )
        remarks += [
            f"{test.file} has only {test.size} samples: it says little about any effect."
            for test in tests
            if test.size < SHORT_RECORD
        ]
        return tuple(dict.fromkeys(remarks))

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the error on held-out tests before and after; returns its axes."""
        from matplotlib import pyplot as plt

        plot = plt.subplots(figsize=(6.0, 3.0), layout="constrained")[1] if axes is None else axes
        names = [f"{block.block.block}:\n{block.gap.channel}" for block in self.blocks]
        for shift, label in ((-0.2, "before"), (0.2, "after")):
            shares = [PERCENT * float(getattr(block.gap, label)) for block in self.blocks]
            plot.bar([place + shift for place in range(len(names))], shares, width=0.4, label=label)
        plot.set_xticks(range(len(names)), names)
        plot.set(ylabel="error [% of RMS]", title=self.campaign.name)
        plot.legend(frameon=False)
        return plot

    def __repr__(self) -> str:
        effects = ", ".join(effect.name for effect in self.all_effects)
        return f"<Diagnosis of {self.campaign.name}: {self.verdict}{f' ({effects})' if effects else ''}>"

    def _repr_html_(self) -> str:
        """Table of the verdict, the effects with their parameters, and the gap."""
        rows = {"verdict": str(self.verdict).replace("_", " ")}
        for effect in self.all_effects:
            rows[effect.name.replace("_", " ")] = (
                f"probability {significant(effect.probability)}; {effect.parameters}"
            )
        sizes = f"{percent(self.gap.before, 2)} before, {percent(self.gap.after, 2)} after"
        rows[f"error on held-out tests, {self.gap.channel}"] = sizes
        return html_table(self.campaign.name, rows, self.remarks)


def _limits_of(block: BlockDiagnosis) -> Iterator[str]:
    """Say what limits the answer for a block."""
    name, gap, effects = _NAMES.get(block.block.block, str(block.block.block)), block.gap, block.all_effects
    yield from block.choice_remarks
    for effect in effects:
        words = effect.name.replace("_", " ")
        for estimate in (item for item in effect.estimates if item.name in effect.on_bounds):
            yield (
                f"The {estimate.meaning} of {words} lies on a bound of its range, so its value and interval "
                "mean little."
            )
        for estimate in (item for item in effect.estimates if item.between > _OTHER_MODELS * item.sd):
            yield (
                f"The {estimate.meaning} of {words} is only known roughly, {estimate.size}: models that "
                "explain the tests equally well, with differing clocks or with a further effect, give other "
                "values."
            )
    if block.linear and block.is_judged_by_parts:
        yield linear_statement(name, block)
    if block.not_fed_back is not None:
        yield (
            f"The recorded force contains an offset of {significant(block.not_fed_back.value)} ± "
            f"{significant(block.not_fed_back.sd, 1)} N that the controller did not feel."
        )
    yield from (offset.remark for offset in block.uncertain_offsets)
    yield from (clock_remark(effect) for effect in block.effects if effect.name == _CLOCK)
    if block.block.inputs == (Channel.GROUND,) and {effect.name for effect in effects} & _LIKE_A_STRUCTURE:
        yield _ONE_CHANNEL
    if block.block.block is not Block.NUMERICAL and gap.after > 1.0:
        yield (
            f"On held-out tests the error of the model of the {name} is larger than the signal: check the "
            "units and signs of the columns, and the nominal values."
        )
    if block.converged is False:
        yield (
            f"The posterior of the {name} has not converged: intervals of its parameters are rough. Measure "
            "cycles of other amplitudes and speeds, which tell the parameters apart."
        )
    yield from block.inseparable
    if not block.leaves_noise:
        yield remainder_statement(name, gap, block.structured_share)


def linear_statement(name: str, block: BlockDiagnosis) -> str:
    """Say what the best linear model of a block is, whatever was stated, and what it leaves."""
    values = ", ".join(f"{item.meaning} {item.size}" for item in block.linear)
    return (
        f"The best linear model of the {name} leaves {percent(block.gap.linear or 0.0)} of the signal on "
        f"held-out tests: {values}."
    )


def clock_remark(effect: MissingEffect) -> str:
    """Say which channel is ahead of which, and that no model should make up for it."""
    (lag,) = effect.estimates
    if lag.name in _LATE_CHANNELS:
        late, reference = _LATE_CHANNELS[lag.name]
        channels = late, "later" if lag.value > 0.0 else "earlier", reference
    else:
        channels = "measured displacement", "earlier", "command"
    return (
        f"The {channels[0]} was recorded {significant(abs(MILLI * lag.value), 2)} ± "
        f"{significant(MILLI * lag.sd, 1)} ms {channels[1]} than the {channels[2]}, as by clocks, filters or"
        " multiplexers that differ: align the columns. No model is changed for it."
    )


def is_explained(block: BlockDiagnosis) -> bool:
    """Whether what the model of a block leaves can be taken for noise."""
    return block.gap.remainder is Remainder.AT_NOISE or (
        block.gap.remainder is Remainder.NOT_KNOWN and block.leaves_noise
    )


def contradiction(item: Estimate) -> str:
    """Say with which value, other than the stated one, the tests ran."""
    nominal = NOMINAL_VALUES[item.name]
    unit = unit_like(item.value, tolerance=_UNIT_TOLERANCE) if item.name == "stiffness" else ""
    unit_hint = f", as {unit} would have" if unit else ""
    return (
        f"The tests ran with a {nominal.meaning} of {significant(item.value, 4)} ± {significant(item.sd, 1)} "
        f"times the stated one{unit_hint}: {nominal.check}."
    )


def scale_of_displacement(blocks: Sequence[BlockDiagnosis]) -> list[str]:
    """Say that a wrong scale of the measured displacement would explain gain and stiffness together.

    Nothing where it would not: where the gain is as stated, or their product is another than the stated one.
    """
    gains = [item for block in blocks for item in block.calibration if item.name == "gain"]
    stiffnesses = [item for block in blocks for item in block.misstated if item.name == "stiffness"]
    return [
        f"The actuator's gain is {significant(gain.value, 4)} ± {significant(gain.sd, 1)} times the stated "
        f"one, so that a measured displacement recorded {significant(gain.value, 4)} times too large would "
        "explain both gain and stiffness: check its scale first."
        for gain in gains
        for stiffness in stiffnesses
        if abs(gain.value - 1.0) > NOMINAL_VALUES["stiffness"].tolerance
        and abs(gain.value * stiffness.value - 1.0) < NOMINAL_VALUES["stiffness"].tolerance
    ]


def one_of_two(either: Sequence[Estimate]) -> str:
    """Say that one of two stated values is wrong, and what each would be if the other were right."""
    cases = [
        f"a {NOMINAL_VALUES[item.name].meaning} of {significant(item.value, 4)} ± {significant(item.sd, 1)}"
        for item in either
    ]
    return (
        f"The tests ran with {' or '.join(cases)} times the stated one, and do not tell which: "
        f"{NOMINAL_VALUES[either[-1].name].check}."
    )


def statement(verdict: Verdict, blocks: Sequence[BlockDiagnosis]) -> str:
    """Say what a verdict means.

    Returns a sentence or two: what contradicts the campaign comes first. That nothing is missing is said only
    where every block is explained.
    """
    misstatements = [item for block in blocks for item in block.misstated]
    either = [block.either_misstated for block in blocks if block.either_misstated]
    first = ""
    if misstatements or either:
        values = [*map(_times, misstatements), *(" or ".join(map(_times, pair)) for pair in either)]
        first = f"The tests did not run with what was stated ({'; '.join(values)}). "
    if verdict is not Verdict.NO_MISSING_EFFECT:
        return f"{first}{_VERDICTS[verdict]}"
    open_ones = [str(block.block.channel) for block in blocks if not is_explained(block)]
    if open_ones:
        channels = ", ".join(dict.fromkeys(open_ones))
        return (
            f"{first}Calibration explains the tests except for a remainder in {channels} that may not be "
            "noise."
        )
    if first:
        return f"{first}With the calibrated values these tests show no missing effect."
    return "Calibration alone explains the tests: they show no missing effect."


def _times(item: Estimate) -> str:
    return f"{NOMINAL_VALUES[item.name].meaning} {significant(item.value, 4)} times"


def remainder_statement(name: str, gap: Gap, structured_share: float) -> str:
    """Say what remains of a block whose residual does not pass for noise."""
    error = percent(gap.after)
    floor = "unknown" if gap.floor is None else f"{percent(gap.floor)} by the {gap.source}"
    subject = f"On held-out tests the model of the {name} is off by {error} of the signal's RMS"
    match gap.remainder:
        case Remainder.AT_NOISE:
            size = f", which is the noise floor ({floor})"
        case Remainder.ABOVE_NOISE:
            size = (
                f", which is more than noise: the model's own error is {percent(gap.model_error)}, above "
                f"the noise floor of {floor}"
            )
        case Remainder.NOT_KNOWN:
            size = (
                "; whether the model or noise is the cause cannot be told, since the noise floor is unknown"
            )
    return (
        f"{subject}{size}. {percent(structured_share, decimals=0)} of the residual's energy follows the "
        "motion; therefore no probability above 0.99 is stated."
    )
