"""Blunders of a recording that a model would take for an effect: signs, units, channels that do not belong.

Each test is examined as `reliab assess` examines one. Then the tests are compared with each other: one rig
may answer another motion by another amount, but not with another sign, and not a thousandfold.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Final

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.faults import plain_faults
from reliab.assessment.plausibility import require_plausible
from reliab.assessment.recorded_force import doubts_of_force, doubts_of_sign, require_restoring_force
from reliab.assessment.recorded_ground import doubts_of_ground
from reliab.assessment.tracking_index import white_noise_share
from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.recordings.recording import Recording

Pair = tuple[Channel, Channel]

_REMEDY: Final = (
    "Correct the columns of this test: metres and newtons, displacements of one direction, and a force that "
    "is positive where the specimen resists a positive displacement"
)
_REMEDY_OF_SIZE: Final = f"{_REMEDY}; leave out a test whose loop diverged"
_BINS_IN_BAND = 4.0  # of the shortest test: narrower than a resonance; noise is not coherent in a band
_COHERENT = 0.8
_NOISY = 0.001  # of the command's RMS
_SMALL: Final = {Channel.MEASURED: 0.5, Channel.FORCE: 0.1}
"""Of the largest RMS in a campaign: a motion that a gap may hide, and a force that may be noise."""
_MOTION_COHERENCE = 0.3  # mean of the upper half of the spectrum; of noise it is one over the stretches
_LONGEST_STRETCH, _FEWEST_STRETCHES = 512, 8  # samples of a spectrum, and how many are averaged
_REST_SHARE = 0.1  # of the largest displacement
_SHARED, _AGREEMENT = 0.3, 0.8  # of two tests' cross-spectra: how much they overlap, and agree where they do
_STEEPEST = 2.0  # power of the frequency with which a rig answers
_LARGEST_CHANGE = np.log(30.0)  # of its gain: setting and amplitude of a specimen may change


def require_consistent(campaign: Campaign) -> tuple[str, ...]:
    """Refuse tests whose channels contradict each other, or the other tests, by a sign or a unit."""
    faults = [sentence for test in _without_noise(campaign.tests) for sentence in _faults_of(test, campaign)]
    _require_agreement(campaign)
    return *faults, *_noise_of_commands(campaign.tests)


def _faults_of(test: MeasuredTest, campaign: Campaign) -> Iterator[str]:
    """Examine one test by itself."""
    yield from (f"{test.file}: {note}" for note in test.notes)
    reading, ground = test.channels.get(Channel.MEASURED), test.channels.get(Channel.GROUND)
    displacement = test.channels.get(Channel.COMMAND, reading)
    if displacement is None or not np.ptp(displacement) > 0.0:
        return
    # A structure that moves over a ground at rest was pulled from its own rest at the begin.
    is_pulled = abs(float(displacement[0])) >= _REST_SHARE * float(np.abs(displacement).max())
    is_still = ground is not None and not np.ptp(ground) > 0.0 and not is_pulled
    if campaign.structure is not None and ground is not None and is_still:
        raise InputError(
            "The recorded ground acceleration is constant, although the test starts at rest",
            value=f"{significant(ground[0] + 0.0)} throughout",
            remedy="Record it, or leave its column out of every test: the other channels are then diagnosed",
            where=test.file,
        )
    if reading is None:
        return
    try:
        yield from (f"{test.file}: {doubt}" for doubt in _doubts_of_channels(test, campaign, reading))
    except InputError as error:
        raise InputError(error.rule, value=error.value, remedy=_REMEDY, where=test.file) from None


def _doubts_of_channels(test: MeasuredTest, campaign: Campaign, reading: Array) -> Iterator[str]:
    """Say what may be wrong with the channels beside a measured displacement; refuse what surely is."""
    command, force = test.channels.get(Channel.COMMAND), test.channels.get(Channel.FORCE)
    specimen = campaign.nominal.specimen
    stiffness = None if specimen is None else specimen.stiffness
    if command is None:
        if force is not None:
            examined = require_restoring_force(
                reading, force, campaign.step, stiffness=stiffness, is_stiffness_fitted=True, name=test.file
            )
            yield from () if examined is None else doubts_of_sign(examined)
        return
    recording = Recording(
        command=command, measured=reading, time_step=campaign.step, name=test.file, force=force
    )
    expected_recording = replace(recording, command=campaign.nominal.actuator.gain * command)
    examined = require_plausible(expected_recording, stiffness=stiffness, is_stiffness_fitted=True)
    yield from (fault.finding for fault in plain_faults(recording))
    yield from doubts_of_force(recording, examined)
    if campaign.structure is not None and force is not None:
        shaken = replace(recording, ground=test.channels.get(Channel.GROUND))
        yield from doubts_of_ground(shaken, campaign.structure, campaign.mass)


def _without_noise(tests: Sequence[MeasuredTest]) -> Iterator[MeasuredTest]:
    """Leave out forces of tests that moved and resisted so little that a gap may leave only noise."""
    sizes = np.array([[np.std(test.channels.get(channel, 0.0)) for channel in _SMALL] for test in tests])
    is_small = (sizes > 0.0) & (sizes < sizes.max(axis=0) * list(_SMALL.values()))
    for test, may_be_noise in zip(tests, is_small.all(axis=1), strict=True):
        channels: dict[Channel, Array] = {**test.channels}
        if may_be_noise:
            del channels[Channel.FORCE]
        yield replace(test, channels=channels)


def _noise_of_commands(tests: Sequence[MeasuredTest]) -> Iterator[str]:
    """Say in which tests the command holds noise, which a diagnosis takes for motion.

    What the rig follows at the highest frequencies is motion, as of a random command.
    """
    sizes = []
    for test in tests:
        command, reading = test.channels.get(Channel.COMMAND), test.channels.get(Channel.MEASURED)
        if command is None or reading is None or not np.ptp(command) > 0.0:
            continue
        share = float(np.sqrt(white_noise_share(command)))
        if share > _NOISY:
            length = min(_LONGEST_STRETCH, command.size // _FEWEST_STRETCHES)
            frequency, coherence = scipy.signal.coherence(command, reading, nperseg=length)
            if coherence[frequency > 0.5 * frequency[-1]].mean() <= _MOTION_COHERENCE:
                sizes.append(f"{percent(share, decimals=2)} in {test.file}")
    if sizes:
        yield (
            f"The recorded command holds noise ({', '.join(sizes)}, of its RMS). A command is taken as "
            "exact: a lag of the actuator, an added mass or an error of the integration may be this noise. "
            "Record the command as the controller computed it."
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _TestSpectra:
    """One test: sizes and frequencies of its channels, and their cross-spectra in bands."""

    file: str  # Name of its file
    # size, frequency: Logarithms of RMS without the mean, up to a constant of the test, and of mean frequency
    size: Mapping[Channel, float]
    frequency: Mapping[Channel, float]
    # Cross-spectrum of a pair of channels in bands of frequency, of unit length, shape (bands,); None where
    # the two are not coherent
    crossed: Mapping[Pair, Spectrum | None]

    @classmethod
    def from_test(
        cls, test: MeasuredTest, channels: list[Channel], rate: float, width: float
    ) -> "_TestSpectra":
        """Transform the channels of a test, all of which move, into bands of a width [Hz]."""
        frequency = np.arange(1, test.size // 2 + 1) * rate / test.size
        band = (frequency / width).astype(np.intp)
        spectra, size, mean_frequency = {}, {}, {}
        for channel in channels:
            centred = test.channels[channel] - test.channels[channel].mean()
            scale = float(np.abs(centred).max())
            spectra[channel] = np.fft.rfft(centred / scale)[1:]
            power = np.abs(spectra[channel]) ** 2
            size[channel] = float(np.log(scale) + 0.5 * np.log(power.sum()))
            mean_frequency[channel] = float(np.log((frequency * power).sum() / power.sum()))
        pairs = combinations(channels, 2)
        crossed = {(a, b): _cross_spectrum(spectra[a], spectra[b], band) for a, b in pairs}
        return cls(file=test.file, size=size, frequency=mean_frequency, crossed=crossed)


def _cross_spectrum(first: Spectrum, second: Spectrum, band: NDArray[np.intp]) -> Spectrum | None:
    crossed = first.conj() * second
    band_products = np.bincount(band, crossed.real) + 1j * np.bincount(band, crossed.imag)
    powers = [np.bincount(band, np.abs(spectrum) ** 2) for spectrum in (first, second)]
    if np.abs(band_products).sum() < _COHERENT * np.sqrt(powers[0] * powers[1]).sum():
        return None
    return np.asarray(band_products / np.linalg.norm(band_products))


def _require_agreement(campaign: Campaign) -> None:
    """Compare the tests with each other: the one of most conflicts is refused, by its worst channel."""
    channels = sorted(campaign.channels)
    width = _BINS_IN_BAND * campaign.rate / min(test.size for test in campaign.tests)
    tests = [
        _TestSpectra.from_test(test, channels, campaign.rate, width)
        for test in campaign.tests
        if all(np.ptp(test.channels[channel]) > 0.0 for channel in channels)
    ]
    for what, agrees, remedy in (("signs", _same_sign, _REMEDY), ("units", _same_unit, _REMEDY_OF_SIZE)):
        conflicts: list[tuple[_TestSpectra, Pair]] = []
        for test, pair in product(tests, combinations(channels, 2)):
            votes = [agrees(test, rival, pair) for rival in tests if rival is not test]
            if votes.count(False) > votes.count(True):
                conflicts.append((test, pair))
        if not conflicts:
            continue
        files = [test.file for test, _ in conflicts]
        first = max(tests, key=lambda test: files.count(test.file))
        blamed_pairs = [pair for test, pair in conflicts if test is first]
        channel = max(channels, key=lambda name: sum(name in pair for pair in blamed_pairs))
        other_channels = [
            name for pair in blamed_pairs if channel in pair for name in pair if name != channel
        ]
        rivals = [test for test in tests if test is not first]
        place = rivals[0].file if len(rivals) == 1 else ""
        change = f"reversed against {place or 'most other tests'}"
        if agrees is _same_unit:
            gains = [
                first.size[channel] - rival.size[channel] - first.size[name] + rival.size[name]
                for name, rival in product(other_channels, rivals)
            ]
            gain = significant(np.exp(np.median(gains)))
            change = f"{gain} times what it is in {place or 'the other tests'}"
        raise InputError(
            f"The tests of a campaign must have the same {what}",
            value=f"{channel} {change}, relative to {', '.join(sorted(other_channels))}",
            remedy=remedy,
            where=first.file,
        )


def _same_sign(test: _TestSpectra, rival: _TestSpectra, pair: Pair) -> bool | None:
    """Whether two channels move alike in two tests; None where these share too few frequencies to tell."""
    mine, theirs = test.crossed[pair], rival.crossed[pair]
    if mine is None or theirs is None:
        return None
    bands = min(mine.size, theirs.size)
    products = mine[:bands].conj() * theirs[:bands]
    shared, agreement = float(np.abs(products).sum()), float(products.real.sum())
    return agreement > 0.0 if shared > _SHARED and abs(agreement) > _AGREEMENT * shared else None


def _same_unit(test: _TestSpectra, rival: _TestSpectra, pair: Pair) -> bool:
    """Whether the gain changes by no more than amplitude, frequency and setting of a rig can explain."""
    input_change, response_change = (test.size[channel] - rival.size[channel] for channel in pair)
    reach = _STEEPEST * abs(test.frequency[pair[0]] - rival.frequency[pair[0]])
    return bool(abs(response_change - input_change) < _LARGEST_CHANGE + reach)
