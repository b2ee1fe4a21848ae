"""Carry out the steps of the Dockerfile without Docker, in a folder that becomes the root of the file system.

    sudo python .ci/release/image_steps.py PYTHON FOLDER

PYTHON is the folder of a Python (with `bin/python3`), which stands in for that of `python:3.13-slim` and is
copied to `/usr/local` of the image. All else of `/usr`, `/bin` and `/lib` is that of this machine, and read
only; `/etc` is a copy. Afterwards the first and the second verdict of a container are timed.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OF_MACHINE = ("usr", "opt")
LINKS = ("bin", "lib", "lib64", "sbin")
PROGRAMS = "/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
VERDICT = "reliab assess sample_test --f 1 --xi 0.02"


class Image:
    """A root folder, and who works in it where."""

    def __init__(self, folder: Path, python: Path) -> None:
        self.root, self.local = folder / "root", folder / "local"
        self.user, self.place = "root", "/"
        pip = {name: value for name, value in os.environ.items() if name.startswith("PIP_")}
        self.environment = {"PATH": PROGRAMS, "LD_LIBRARY_PATH": "/usr/local/lib", **pip}
        for name in (*OF_MACHINE, "proc", "dev", "tmp", "home", "wheels", "sources", "var/cache"):
            (self.root / name).mkdir(parents=True)
        (self.root / "tmp").chmod(0o1777)
        for name in LINKS:
            (self.root / name).symlink_to(f"usr/{name}")
        shutil.copytree("/etc", self.root / "etc", symlinks=True)
        shutil.copytree(python, self.local, symlinks=True)
        (self.local / "bin/python").unlink(missing_ok=True)
        (self.local / "bin/python").symlink_to("python3")

    def run(self, command: str) -> None:
        """Run a command of the shell inside, with mounts that end with it."""
        bound = [f"mount --rbind -o ro /{name} {self.root}/{name}" for name in OF_MACHINE]
        bound += [f"mount --rbind /{name} {self.root}/{name}" for name in ("proc", "dev")]
        bound.append(f"mount --bind {self.local} {self.root}/usr/local")
        variables = [f"{name}={value}" for name, value in self.environment.items()]
        inside = shlex.join(["env", "-i", *variables, "sh", "-ec", f"cd {self.place}; {command}"])
        entered = f"exec chroot --userspec={self.user} {self.root} {inside}"
        script = "; ".join(["set -e", *bound, entered])
        subprocess.run(["unshare", "--mount", "sh", "-c", script], check=True)  # noqa: S603, S607

    def step(self, instruction: str, rest: str) -> None:
        """Do what one instruction of the Dockerfile says."""
        if instruction == "ENV":
            self.environment |= dict(item.split("=", 1) for item in shlex.split(rest))
        elif instruction == "USER":
            self.user = rest
            self.environment["HOME"] = f"/home/{rest}"
        elif instruction == "WORKDIR":
            self.place = rest
        elif instruction == "COPY":
            copy_sources(self.root / self.place.strip("/"))
        elif instruction == "RUN":
            self.run(re.sub(r"--mount=\S+\s+", "", rest))


def copy_sources(place: Path) -> None:
    """Copy what git tracks, which is what a fresh clone would send to Docker."""
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout  # noqa: S607
    for name in files.decode().rstrip("\0").split("\0"):
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, place / name)


def instructions(text: str) -> list[tuple[str, str]]:
    """Return the instructions of a Dockerfile by name, without its comments."""
    lines = [line for line in text.replace("\\\n", " ").splitlines() if line and not line.startswith("#")]
    return [(name, rest) for name, _, rest in (line.partition(" ") for line in lines)]


def megabytes(folder: Path) -> float:
    """Return the size of all files in a folder [MB]."""
    files = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return sum(file.stat().st_size for file in files) / 1e6


def main(python: Path, folder: Path) -> None:
    """Make the image in a folder, and time two verdicts in it."""
    image = Image(folder, python)
    before = megabytes(image.local)
    for instruction, rest in instructions((ROOT / ".ci/release/Dockerfile").read_text(encoding="utf-8")):
        if instruction == "FROM":
            image.user, image.place = "root", "/"
        image.step(instruction, rest)
    added = megabytes(image.local) - before + megabytes(image.root / "var/cache/reliab")
    print(f"{added:.0f} MB added to the image of Python")
    for number in ("first", "second"):
        began = time.perf_counter()
        image.run(VERDICT)
        print(f"{number} verdict of a container: {time.perf_counter() - began:.1f} s of wall")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
