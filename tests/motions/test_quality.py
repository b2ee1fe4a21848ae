from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.motions.checking import find_flaws, inspect
from reliab.motions.loading import load_motions

Write = Callable[[str, str | bytes], Path]
STEP = 0.01
TIMES = STEP * np.arange(2000)


@pytest.fixture(scope="module")
def record() -> np.ndarray:
    """A record without flaws: noise in an envelope, at rest at both ends, whose velocity ends at zero."""
    random = np.random.default_rng(3)
    noise = np.convolve(random.normal(size=TIMES.size + 8), np.hanning(9), mode="valid")
    shaken = noise * np.exp(-(((TIMES - 8) / 3) ** 2))
    return shaken - shaken.sum() / TIMES.size * np.hanning(TIMES.size) * 2


def flaws(acceleration: np.ndarray) -> list[str]:
    return [value for value, _ in find_flaws(acceleration, STEP)]


def test_sound_record_has_no_flaws(record: np.ndarray) -> None:
    assert flaws(record) == []
    assert flaws(np.round(record, 2)) == []


@pytest.mark.parametrize("sides", ["both", "upper", "lower"])
@pytest.mark.parametrize("share", [0.35, 0.7])
def test_clipping_is_noted(sides: str, share: float, record: np.ndarray) -> None:
    low = share * record.min() if sides != "upper" else None
    high = share * record.max() if sides != "lower" else None
    assert any("flat tops" in flaw for flaw in flaws(np.clip(record, low, high)))


def test_equal_samples_at_a_coarse_resolution_are_no_clipping(record: np.ndarray) -> None:
    weak = np.round(record / np.abs(record).max() * 30)  # counts of a weak record
    assert not any("flat tops" in flaw for flaw in flaws(weak))


@pytest.mark.parametrize("offset", [0.05, -0.3])
def test_constant_offset_is_noted_by_its_velocity(offset: float, record: np.ndarray) -> None:
    (flaw,) = [flaw for flaw in flaws(record + offset) if "velocity" in flaw]
    assert f"ends at {'-' if offset < 0 else ''}{abs(offset) * TIMES[-1]:.3g}" in flaw


@pytest.mark.parametrize("samples", [[900], [900, 1300], [2, 700], [0], [1999]])
def test_single_spikes_are_noted(samples: list[int], record: np.ndarray) -> None:
    corrupt = record.copy()
    corrupt[samples] += 1.5 * np.abs(record).max()
    (flaw,) = [flaw for flaw in flaws(corrupt) if "spike" in flaw]
    assert flaw.endswith(" s" if len(samples) == 1 else " and 1 more")


def test_lasting_jump_is_no_spike(record: np.ndarray) -> None:
    corrupt = record.copy()
    corrupt[800:806] += 1.5 * np.abs(record).max() * np.array([1.0, 0.95, 0.9, 0.8, 0.6, 0.3])
    assert not any("spike" in flaw for flaw in flaws(corrupt))


@pytest.mark.parametrize("value", [0.0, 0.4])
def test_filled_gap_is_noted(value: float, record: np.ndarray) -> None:
    corrupt = record.copy()
    corrupt[780:820] = value
    assert any("held from 7.80 s for 40 samples" in flaw for flaw in flaws(corrupt))


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (1.0, ""),
        (-1.0, " with its sign reversed"),
        (1.7, " times 1.7"),
        (-0.25, " times 0.25 with its sign reversed"),
    ],
)
def test_check_notes_flaws_and_copies_that_are_scaled_reversed_and_cut(
    factor: float, words: str, record: np.ndarray, write: Write
) -> None:
    def write_record(name: str, samples: np.ndarray, step: float = STEP) -> Path:
        rows = "\n".join(f"{value:.6f}" for value in samples)
        return write(f"{name}.txt", f"# dt: {step}\n# units: m/s2\n{rows}")

    write_record("a", record)
    write_record("b", factor * record[200:1700])
    write_record("c", record[::-1] + 0.3)
    inspection = inspect(write_record("slower", record, 2 * STEP).parent)
    assert inspection.faults == []
    (copy,) = [note for note in inspection.notes if note.rule == "Duplicate record"]
    assert (Path(copy.file).name, copy.value) == ("b.txt", f"the same record as a{words}")
    drift = next(note for note in inspection.notes if note.value.startswith("velocity that ends at"))
    assert Path(drift.file).name == "c.txt"


def test_synthetic_suite_has_no_flaws() -> None:
    for motion in load_motions("synthetic")[::5]:
        assert list(find_flaws(motion.acceleration, motion.time_step)) == []
