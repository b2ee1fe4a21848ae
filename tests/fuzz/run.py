"""Fuzz readers for a while: `python tests/fuzz/run.py --minutes 5 [TARGET…]`.

Every target gets the same share of the time. A case that fails is made as small as can be, kept below
`--keep`, and reported; `--again FOLDER` reads a kept case. With `--coverage` atheris chooses the cases by
what they reach (`pip install atheris`), one target at a time.
"""

import argparse
import json
import os
import resource
import signal
import sys
import time
import traceback
from collections import Counter
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

_BATCH = 200
_SECONDS = 10  # of processor time
_SECONDS_BLOCKED = 60
_MEMORY = 1 << 20  # kB


class TooSlow(BaseException):
    """A case takes longer than it may; no `except Exception` may catch it."""


def _stop(_signal, _frame):
    raise TooSlow


def main() -> int:
    options = _options()
    from fuzz.damage import kept
    from fuzz.targets import SLOW_TARGETS, TARGETS, examine

    targets = {**TARGETS, **SLOW_TARGETS}
    if options.again is not None:
        print(examine(targets[options.targets[0]], kept(options.again)))
        return 0
    names = options.targets or list(TARGETS)
    if options.coverage:
        return _by_coverage(names[0], targets, options)
    for signal_number in (signal.SIGALRM, signal.SIGPROF):
        signal.signal(signal_number, _stop)
    for name in names:
        targets[name].seeds()
    failures = 0
    for name in names:
        failures += _fuzz(name, targets[name], 60.0 * options.minutes / len(names), options.keep)
    return 1 if failures else 0


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


def _fuzz(name: str, target: object, seconds: float, keep: Path) -> int:
    """Try cases of one target until the time is over; print what was counted."""
    counts, slowest, failures = Counter(), 0.0, 0
    begin, failing = time.monotonic(), {}

    def attempt(case):
        nonlocal slowest
        start = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, _SECONDS)
        signal.alarm(_SECONDS_BLOCKED)
        try:
            counts["read" if _examined(target, case) else "refused"] += 1
        except BaseException:
            failing["case"] = case
            raise
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.alarm(0)
            slowest = max(slowest, time.process_time() - start)

    batch = 0
    while time.monotonic() - begin < seconds:
        batch += 1
        try:
            _batch(target, attempt, seed_number=int.from_bytes(os.urandom(4)))
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            failures += 1
            _report(name, failures, failing["case"], error, keep)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    line = {
        "target": name,
        **counts,
        "findings": failures,
        "slowest_s": round(slowest, 2),
        "peak_MB": memory >> 10,
    }
    print(json.dumps(line), flush=True)
    return failures + (memory > _MEMORY)


def _examined(target, case) -> bool:
    from fuzz.targets import examine

    return examine(target, case)


def _batch(target, attempt, seed_number: int) -> None:
    from fuzz.damage import damaged

    @seed(seed_number)
    @settings(
        max_examples=_BATCH,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.generate, Phase.shrink],
        report_multiple_bugs=False,
    )
    @given(case=st.deferred(lambda: damaged(target.seeds())))
    def tried(case):
        attempt(case)

    tried()


def _report(name: str, number: int, case, error: BaseException, keep: Path) -> None:
    from fuzz.damage import keep as keep_case

    folder = keep / name / f"{os.getpid()}-{number}"
    folder.mkdir(parents=True, exist_ok=True)
    keep_case(case, folder)
    last = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in last if "/reliab/" in frame.filename] or last
    where = f"{ours[-1].filename}:{ours[-1].lineno}"
    print(
        f"FINDING {name} {type(error).__name__}: {str(error)[:300]!r} at {where}; kept in {folder}",
        flush=True,
    )


def _by_coverage(name: str, targets, options) -> int:
    import atheris

    from fuzz.damage import damaged

    target = targets[name]

    @settings(deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(case=damaged(target.seeds()))
    def tried(case):
        _examined(target, case)

    atheris.Setup(
        [sys.argv[0], f"-max_total_time={int(60 * options.minutes)}", "-timeout=10", "-rss_limit_mb=2048"],
        tried.hypothesis.fuzz_one_input,
    )
    atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main())
