"""Fuzz readers for a while: `python tests/fuzz/run.py --minutes 5 [TARGET…]`.

Every target gets the same share of the time. Of a case that fails in a new place the edits that it does not
need are left out; it is kept below `--keep`, and reported; `--again FOLDER` reads a kept case.
With `--coverage` atheris chooses the cases by what they reach (`pip install atheris`), one target at a time.
"""

import argparse
import importlib
import json
import os
import signal
import sys
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from hypothesis import HealthCheck, given, settings

_READERS = (
    *(
        "reliab.motions.readers",
        "reliab.motions.catalogue",
        "reliab.motions.loading",
        "reliab.motions.checking",
    ),
    *("reliab.recordings.readers", "reliab.recordings.reading", "reliab.recordings.recognition"),
    *("reliab.recordings.naming", "reliab.recordings.clocks", "reliab.recordings.record"),
    *("reliab.discrepancy.campaign", "reliab.study.running", "reliab.study.description", "reliab.core.files"),
    *(
        "reliab.criterion.ellipse_reading",
        "reliab.criterion.criterion",
        "reliab.simulation.frames.frame_file",
    ),
    *("reliab.simulation.frames.frame_tables", "reliab.simulation.hybrid_test.model_file"),
)
_SECONDS = 10  # of processor time
_SECONDS_BLOCKED = 60
_MEMORY = 1 << 20  # kB


class TooLarge(BaseException):
    """A case took more memory than it may."""


class TooSlow(BaseException):
    """A case takes longer than it may; no `except Exception` may catch it."""


def _stop(_signal, _frame):
    raise TooSlow


def main() -> int:
    options = _options()
    if options.coverage:
        _instrument()
    from fuzz.damage import read_kept
    from fuzz.targets import SLOW_TARGETS, TARGETS, examine

    targets = {**TARGETS, **SLOW_TARGETS}
    if options.again is not None:
        print(examine(targets[options.targets[0]], read_kept(options.again)))
        return 0
    names = options.targets or list(TARGETS)
    if options.coverage:
        return _fuzz_by_coverage(names[0], targets, options)
    for signal_number in (signal.SIGALRM, signal.SIGPROF):
        signal.signal(signal_number, _stop)
    for name in names:
        targets[name].seeds()
    failures = 0
    for name in names:
        failures += _fuzz(name, targets[name], 60.0 * options.minutes / len(names), options.keep)
    return 1 if failures else 0


def _instrument() -> None:
    """Import readers so that atheris sees which of their branches a case takes; none of them is compiled."""
    import atheris  # type: ignore[import-untyped]

    with atheris.instrument_imports(include=list(_READERS)):
        for name in _READERS:
            importlib.import_module(name)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=5.0)
    parser.add_argument("--keep", type=Path, default=Path("fuzz-findings"))
    parser.add_argument("--again", type=Path)
    parser.add_argument("--coverage", action="store_true")
    parser.add_argument("targets", nargs="*")
    return parser.parse_args()


@dataclass
class _Trial:
    """Cases of one target: how many were read or refused, the slowest, the largest, findings by place."""

    target: object
    counts: Counter = field(default_factory=Counter)
    slowest: float = 0.0  # s
    largest: int = 0  # kB that the process held
    findings: Counter = field(default_factory=Counter)

    def failure(self, case) -> BaseException | None:
        """Read a case; what it raised beside an `InputError`."""
        from fuzz.targets import examine

        start = time.process_time()
        _forget_peak()
        memory_before = _peak()
        signal.setitimer(signal.ITIMER_PROF, _SECONDS)
        signal.alarm(_SECONDS_BLOCKED)
        try:
            self.counts["read" if examine(self.target, case) else "refused"] += 1
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # noqa: BLE001 - whatever it is, it is a finding
            return error
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.alarm(0)
            self.slowest = max(self.slowest, time.process_time() - start)
            self.largest = max(self.largest, peak := _peak())
        return TooLarge(f"{peak - memory_before >> 10} MB") if peak - memory_before > _MEMORY else None


def _forget_peak() -> None:
    """Let Linux measure the peak of this process's memory anew."""
    Path("/proc/self/clear_refs").write_text("5")


def _peak() -> int:
    """Most memory of this process since the peak was forgotten [kB]."""
    status = Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0])


def _fuzz(name: str, target: Any, seconds: float, keep: Path) -> int:
    """Try cases of one target until the time is over; print what was counted."""
    from fuzz.damage import apply_edits, draw_case

    trial, begin, random = _Trial(target), time.monotonic(), Random()  # noqa: S311
    while time.monotonic() - begin < seconds:
        case, edits = draw_case(random, target.seeds())
        error = trial.failure(apply_edits(case, edits))
        if error is not None:
            place = _place(error)
            trial.findings[place] += 1
            if trial.findings[place] == 1:
                fewest, error = _fewest(trial, case, edits, error)
                _report(name, len(trial.findings), apply_edits(case, fewest), error, keep)
    line = {
        "target": name,
        **trial.counts,
        "failed": trial.findings.total(),
        "findings": len(trial.findings),
        "slowest_s": round(trial.slowest, 2),
        "peak_MB": trial.largest >> 10,
    }
    print(json.dumps(line), flush=True)
    return len(trial.findings)


def _fewest(trial: _Trial, case, edits: list, error: BaseException) -> tuple[list, BaseException]:
    """Leave out edits without which a case still fails in the same place."""
    from fuzz.damage import apply_edits

    for edit in list(edits):
        fewer = [remaining for remaining in edits if remaining is not edit]
        failure = trial.failure(apply_edits(case, fewer))
        if failure is not None and _place(failure) == _place(error):
            edits, error = fewer, failure
    return edits, error


def _place(error: BaseException) -> str:
    """Where something went wrong: the last line of ours."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if "/reliab/" in frame.filename] or frames
    return (
        f"{type(error).__name__} at {ours[-1].filename}:{ours[-1].lineno}" if ours else type(error).__name__
    )


def _report(name: str, number: int, case, error: BaseException, keep: Path) -> None:
    from fuzz.damage import keep as keep_case

    folder = keep / name / f"{os.getpid()}-{number}"
    folder.mkdir(parents=True, exist_ok=True)
    keep_case(case, folder)
    print(f"FINDING {name} {_place(error)}: {str(error)[:300]!r}; kept in {folder}", flush=True)


def _fuzz_by_coverage(name: str, targets, options) -> int:
    import atheris

    from fuzz.damage import damaged_cases
    from fuzz.targets import examine

    target = targets[name]
    options.keep.mkdir(parents=True, exist_ok=True)

    @settings(deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(case=damaged_cases(target.seeds()))
    def try_case(case):
        examine(target, case)

    limits = [f"-max_total_time={int(60 * options.minutes)}", "-timeout=10", "-rss_limit_mb=2048"]
    prefix = f"-artifact_prefix={options.keep}/{name}-"
    atheris.Setup([sys.argv[0], *limits, "-len_control=0", prefix], try_case.hypothesis.fuzz_one_input)  # type: ignore[attr-defined]
    atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main())
