"""Follow the first pages of the site where nothing but the wheel is installed, and print what that takes.

    python tests/packaging/new_user.py reliab-*.whl [FOLDER]

Every command and every cell of the first pages runs as it is written, one after the other,
in an empty folder with an empty home, in which no kernel is compiled. Words are all that a page shows, code
too. The exit code is 1 where a step does not work.
"""

import os
import resource
import shlex
import subprocess
import sys
import time
import venv
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "site")]

from pages import SITE, code, commands

PAGES = (
    "index",
    "tutorial/first_verdict",
    "how_to/judge_a_frame",
    "tutorial/campaign",
    "tutorial/criterion",
)
WORDS_A_MINUTE = 200


@dataclass(frozen=True)
class Step:
    """A command or the cells of a page, and what they took."""

    page: str
    text: str
    wall: float  # s
    processor: float  # s
    failure: str  # the end of what it printed; empty where it worked


class Newcomer:
    """A person with an empty home folder, an environment and a wheel."""

    def __init__(self, folder: Path, wheel: Path) -> None:
        self.work, self.wheel = folder / "work", wheel.resolve()
        self.programs = folder / "environment" / ("Scripts" if os.name == "nt" else "bin")
        for name in ("home", "kernels", "work"):
            (folder / name).mkdir(parents=True)
        venv.create(folder / "environment", with_pip=True)
        prefixes = ("XDG_", "PYTHON", "NUMBA_", "MPL", "RELIAB_")
        environment = {name: value for name, value in os.environ.items() if not name.startswith(prefixes)}
        self.environment = {
            **environment,
            "HOME": str(folder / "home"),
            "MPLBACKEND": "Agg",
            "NUMBA_CACHE_DIR": str(folder / "kernels"),
            "PATH": os.pathsep.join([str(self.programs), os.environ["PATH"]]),
            "PYTHONPATH": str(SITE),  # cells that the site hides import what shows answers there
        }

    def install(self) -> Step:
        return self.do(
            "installation", "pip install", [*self.python(), "-m", "pip", "install", str(self.wheel)]
        )

    def follow(self, page: str) -> list[Step]:
        path = SITE / f"{page}.md"
        lines = [line for block in commands(path) for line in block]
        steps = [self.do(page, line, self.program(line)) for line in lines]
        cells = code(path)
        if cells:
            steps.append(self.do(page, f"{len(cells)} cells", [*self.python(), "-c", "\n".join(cells)]))
        return steps

    def python(self) -> list[str]:
        return [str(self.programs / "python")]

    def program(self, line: str) -> list[str]:
        name, *arguments = shlex.split(line)
        return [str(self.programs / name), *arguments]

    def do(self, page: str, text: str, command: list[str]) -> Step:
        began, processor_start = time.perf_counter(), processor_seconds()
        process = subprocess.run(  # noqa: S603 - what our own site tells its readers to type
            command, cwd=self.work, env=self.environment, capture_output=True, text=True, check=False
        )
        wall, processor = time.perf_counter() - began, processor_seconds() - processor_start
        failure = (process.stdout + process.stderr)[-2000:] if process.returncode else ""
        return Step(page, text, wall, processor, failure)


def processor_seconds() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def words(page: str) -> int:
    return len((SITE / f"{page}.md").read_text(encoding="utf-8").split())


def report(steps: list[Step]) -> None:
    print("| page | words | step | wall [s] | processor [s] |\n|---|---|---|---|---|")
    for step in steps:
        print(f"| {step.page} | | {step.text} | {step.wall:.1f} | {step.processor:.1f} |")
    for page in PAGES:
        print(f"| {page} | {words(page)} | | | |")
    number, waiting = sum(map(words, PAGES)), sum(step.wall for step in steps) / 60.0
    reading = number / WORDS_A_MINUTE
    print(
        f"\n{number} words, {reading:.1f} minutes at {WORDS_A_MINUTE} a minute; {len(steps)} steps, "
        f"{waiting:.1f} minutes of waiting; {reading + waiting:.1f} minutes in all"
    )


def main(wheel: str, folder: str) -> int:
    newcomer = Newcomer(Path(folder), Path(wheel))
    steps = [newcomer.install()]
    for page in PAGES:
        steps += newcomer.follow(page)
    report(steps)
    failures = [step for step in steps if step.failure]
    for step in failures:
        print(f"\n{step.page}: {step.text}\n{step.failure}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    with TemporaryDirectory() as temporary:
        sys.exit(main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else temporary))
