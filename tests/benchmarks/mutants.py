"""Change one small thing of a room at a time, and see whether the room's own tests notice.

    python tests/benchmarks/mutants.py indices --count 40 --kind statements --out mutants.jsonl
    python tests/benchmarks/mutants.py all --count 200 --kind statements --budget 15 --reach reach/*.json

The tests of the room run once to see which lines each reaches (`pip install coverage`); a change is then
tried by those tests only that reach it, near and quick ones first as far as the budget goes, until the
first fails, in a copy of a process that has collected them; where code stands outside functions, in a
process that imports it anew. Code that is compiled is reached by whatever names it, tests too. Nothing on
disk is changed. A mutant is a line of the output as soon as it is judged, so that a run that is stopped
loses nothing and one that is started again with the same seed goes on. Slow tests are left out. Changes
that no test can notice are listed with their reasons in equivalent_mutants.toml and count neither way.
`all` draws over all rooms by their size; what tests reach may have been measured room by room (`ROOM
--count 0 --reach reach/ROOM.json`), and rooms whose own tests were not measured are left out.

A change counts as noticed only if the same tests, up to the one that failed, pass without it in the same
way and within the same limit; else it is "unsound". Limits are processor time, so that a busy machine does
not decide. "endless" is a change whose tests use a minute and five times what they used without it: it
counts as noticed. "stuck" is one whose tests wait for nothing, or want more memory than there is: it does
not count as noticed.
"""

import argparse
import json
import random
import sys
import tomllib
from collections import Counter, defaultdict
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from benchmarks.mutant_places import KINDS, ROOT, Mutant, mutants  # noqa: E402
from benchmarks.mutant_session import judge_together  # noqa: E402
from benchmarks.mutant_tests import KILLED_OUTCOMES, Reach, judge, measure_reach, merge_records  # noqa: E402
from blind_campaigns.scoring import wilson_interval  # noqa: E402


def main() -> None:
    options = _options()
    room = "" if options.room == "all" else options.room
    everything = mutants(room, options.kind)
    random_order = random.Random(options.seed).sample(everything, len(everything))  # noqa: S311 - no secret
    sample = random_order[: options.count][options.part - 1 :: options.parts]
    tests = options.tests or [f"tests/{room.partition('/')[0]}".rstrip("/"), f"reliab/{room}".rstrip("/")]
    reach = Reach(_record(options.room, tests, options.reach), options.budget)
    sample = [mutant for mutant in sample if reach.knows(mutant)]
    _try(sample, tests, reach, options.out)
    outcomes_by_key = _read_outcomes(options.out)
    for mutant in sample:
        print(f"{outcomes_by_key[_key(mutant)]:9} {mutant.file}:{mutant.line} {mutant.change}: {mutant.text}")
    print(_score(sample, outcomes_by_key), f"of {len(everything)} possible")


def _try(sample: list[Mutant], tests: list[str], reach: Reach, out: Path) -> None:
    """Try changes in one session, and in a process of its own what that cannot try."""
    outcomes_by_key = _read_outcomes(out)
    work = []
    for mutant in sample:
        if _key(mutant) not in outcomes_by_key:
            names = reach.tests(mutant)
            work.append((mutant, names, 60.0 + 5.0 * sum(reach.seconds[name] for name in names)))

    def note(mutant: Mutant, outcome: str) -> None:
        with out.open("a", encoding="utf-8") as file:
            file.write(json.dumps({**vars(mutant), "text": mutant.text, "outcome": outcome}) + "\n")

    if work:
        judge_together(tests, work, note)
    outcomes_by_key = _read_outcomes(out)
    for mutant, names, seconds in work:
        if _key(mutant) not in outcomes_by_key:
            note(mutant, judge(mutant, names, seconds))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("room", help="a room, a folder of it as discrepancy/fitting, or all")
    parser.add_argument("--tests", nargs="*", help="files and folders of tests, if not the room's")
    parser.add_argument("--kind", choices=KINDS, default=KINDS[0], help="what is changed")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--part", type=int, default=1, help="which of several parts, each with its --out")
    parser.add_argument("--parts", type=int, default=1, help="in how many processes, one on each processor")
    parser.add_argument("--out", type=Path, default=Path("mutants.jsonl"))
    parser.add_argument("--budget", type=float, default=60.0, help="processor time of a change's tests [s]")
    parser.add_argument(
        "--reach",
        type=Path,
        nargs="*",
        default=[],
        help="keep there which test reaches what, for the next run; those of several rooms are put together",
    )
    return parser.parse_args()


def _record(room: str, tests: list[str], files: list[Path]) -> dict:
    if files and all(file.exists() for file in files):
        return merge_records([json.loads(file.read_text()) for file in files])
    record = measure_reach(room, tests)
    for file in files:
        file.write_text(json.dumps(record))
    return record


def _key(mutant: Mutant) -> tuple[str, str, int]:
    return mutant.file, mutant.kind, mutant.place


def _read_outcomes(out: Path) -> dict[tuple[str, str, int], str]:
    rows = map(json.loads, out.read_text().splitlines() if out.exists() else [])
    return {(row["file"], row["kind"], row["place"]): row["outcome"] for row in rows}


def _score(sample: list[Mutant], outcomes_by_key: dict[tuple[str, str, int], str]) -> str:
    """Share of mutants that a test notices, with and without those that none can notice, and by room."""
    equivalents = tomllib.loads(
        (ROOT / "tests/benchmarks/equivalent_mutants.toml").read_text(encoding="utf-8")
    )
    equivalent = {(row["file"], row["line"], row["change"]) for row in equivalents.get("equivalent", [])}
    rooms: dict[str, Counter[str]] = defaultdict(Counter)
    for mutant in sample:
        outcome = (
            "killed"
            if outcomes_by_key[_key(mutant)] in KILLED_OUTCOMES
            else "equivalent"
            if (mutant.file, mutant.text, mutant.change) in equivalent
            else "survived"
        )
        rooms[mutant.file.split("/")[1]][outcome] += 1
    outcomes = sum(rooms.values(), Counter())
    number_killed = outcomes["killed"]
    number_counted = number_killed + outcomes["survived"]
    low, high = wilson_interval(number_killed, number_counted)
    text_by_room = ", ".join(
        f"{room} {row['killed']} of {row['killed'] + row['survived']}" for room, row in sorted(rooms.items())
    )
    return (
        f"{text_by_room}\n{dict(outcomes)}: {100 * number_killed / max(number_counted, 1):.0f} % killed "
        f"({100 * low:.0f} to {100 * high:.0f} % by Wilson), "
        f"{100 * number_killed / max(len(sample), 1):.0f} % with equivalent ones"
    )


if __name__ == "__main__":
    main()
