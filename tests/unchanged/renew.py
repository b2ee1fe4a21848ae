"""Keep answers anew, all or those that are named.

python tests/unchanged/renew.py [NAME...]
"""

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parents[2])]

from unchanged.asking import QUESTIONS, answers, versions  # noqa: E402
from unchanged.laboratory import write_laboratory  # noqa: E402


def main() -> None:
    if len(sys.argv) == 1:
        kept = json.dumps(versions(), indent=0)
        Path(__file__).with_name("versions.json").write_text(kept + "\n", encoding="utf-8")
    with TemporaryDirectory() as name:
        folder = Path(name).resolve()
        write_laboratory(folder)
        for question in sys.argv[1:] or QUESTIONS:
            found = answers(QUESTIONS[question]["question"], folder)
            text = json.dumps(found, ensure_ascii=False, indent=0)
            Path(__file__).with_name("kept").joinpath(f"{question}.json").write_text(
                text + "\n", encoding="utf-8"
            )


if __name__ == "__main__":
    main()
