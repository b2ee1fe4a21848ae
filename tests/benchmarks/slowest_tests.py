"""Print the tests that need the most processor time.

    python tests/benchmarks/slowest_tests.py [--count 20] [pytest's own arguments, e.g. tests/app/cli]

The processor time of a test counts this process and the subprocesses that it waited for. It is measured in
one process with one thread for linear algebra, so it holds on a busy machine too; what a shared fixture costs
is counted for the first test that asks for it, in the column "setup".
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
from collections import defaultdict
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

PHASES = ("setup", "call", "teardown")


def processor_time() -> float:
    """Processor time in s of this process and of its finished subprocesses, in user and system mode."""
    usages = (resource.getrusage(scope) for scope in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


class ProcessorTimes:
    """Pytest plugin: the processor time of each test, by phase.

    Parameters
    ----------
    count
        How many tests the summary names.
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self.times: dict[str, dict[str, float]] = defaultdict(lambda: dict.fromkeys(PHASES, 0.0))

    def _measure_phase(self, item: pytest.Item, phase: str) -> Iterator[None]:
        start = processor_time()
        try:
            return (yield)
        finally:
            self.times[item.nodeid][phase] = processor_time() - start

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Iterator[None]:
        return (yield from self._measure_phase(item, "setup"))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        return (yield from self._measure_phase(item, "call"))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_teardown(self, item: pytest.Item) -> Iterator[None]:
        return (yield from self._measure_phase(item, "teardown"))

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Write the table of the slowest tests below pytest's own summary."""
        total = sum(sum(phases.values()) for phases in self.times.values())
        terminalreporter.section(f"slowest {self.count} of {len(self.times)} tests")
        terminalreporter.write_line(
            f"processor time {total:.1f} s in tests, {processor_time():.1f} s with imports and collection"
        )
        terminalreporter.write_line("   total   setup    call  test")
        sorted_tests = sorted(self.times.items(), key=lambda entry: -sum(entry[1].values()))
        for name, phases in sorted_tests[: self.count]:
            terminalreporter.write_line(
                f"{sum(phases.values()):8.2f}{phases['setup']:8.2f}{phases['call']:8.2f}  {name}"
            )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=20, help="how many tests to name")
    options, arguments = parser.parse_known_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    return pytest.main([*arguments, "-n", "0"], plugins=[ProcessorTimes(options.count)])


if __name__ == "__main__":
    sys.exit(main())
