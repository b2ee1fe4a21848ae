"""Build reliab-core: the same code with the few requirements of a verdict, for control rooms.

    python -m pip install build
    python .ci/release/core.py [FOLDER]

What it requires is listed in `[tool.reliab]` of pyproject.toml; all else is that of the wheel of reliab.
"""

import re
import subprocess
import sys
import tomllib
from pathlib import Path
from shutil import copy2
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[2]
_REQUIREMENT = re.compile(r'  "([A-Za-z0-9-]+)>=.*')
_REQUIREMENTS = re.compile(r"^dependencies = \[\n(.*?)^\]$", re.MULTILINE | re.DOTALL)


def describe(project: str) -> str:
    """Return pyproject.toml of reliab-core, from that of reliab."""
    few = set(tomllib.loads(project)["tool"]["reliab"]["core"])
    lines = _REQUIREMENTS.search(project)[1].splitlines()
    wanted = [line for line in lines if _REQUIREMENT.fullmatch(line)[1] in few]
    if len(wanted) != len(few):
        raise SystemExit(f"[tool.reliab] names requirements that reliab does not have: {sorted(few)}")
    described = _REQUIREMENTS.sub(lambda _: "\n".join(("dependencies = [", *wanted, "]")), project)
    return described.replace('name = "reliab"', 'name = "reliab-core"', 1)


def build(folder: Path) -> None:
    """Build the wheel from the files that git tracks."""
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout  # noqa: S607
    with TemporaryDirectory() as sources:
        for name in files.decode().rstrip("\0").split("\0"):
            (Path(sources) / name).parent.mkdir(parents=True, exist_ok=True)
            copy2(ROOT / name, Path(sources) / name)
        description = Path(sources) / "pyproject.toml"
        description.write_text(describe(description.read_text(encoding="utf-8")), encoding="utf-8")
        command = [sys.executable, "-m", "build", "--wheel", "--outdir", str(folder.resolve()), sources]
        subprocess.run(command, check=True)  # noqa: S603


if __name__ == "__main__":
    build(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "dist")
