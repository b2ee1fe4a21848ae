"""Build the recipe for conda, and run its tests, without a channel of conda.

    python -m pip install py-rattler-build
    python tests/packaging/conda_build.py ENVIRONMENT FOLDER

ENVIRONMENT is a virtual environment in which reliab is installed with all that it requires. Its Python and
its packages stand in for those of conda-forge, in a channel of files, under the names of the recipe.
"""

import hashlib
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from importlib.metadata import distributions
from pathlib import Path
from shutil import copytree, ignore_patterns

ROOT = Path(__file__).resolve().parents[2]
RECIPE = ROOT / ".ci/release/conda/recipe.yaml"
ON_CONDA = {"seaborn": "seaborn-base", "matplotlib": "matplotlib-base", "typst": "typst-py"}
SUBDIR = "linux-64"


class Channel:
    """A folder of packages with the list by which they are found."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.packages: dict[str, dict[str, object]] = {}
        (folder / "noarch").mkdir(parents=True)
        self.write("noarch", {})

    def add(self, name: str, version: str, files: Path, depends: Iterable[str] = ()) -> None:
        from rattler_build import assemble_package

        described = {"name": name, "version": version, "depends": list(depends)}
        place = self.folder / SUBDIR
        made = assemble_package(
            **described,
            target_platform=SUBDIR,
            build_string="0",
            output_dir=place,
            files_dir=files,
            compression_level=1,
            detect_prefix=False,
        )
        content = Path(made.path).read_bytes()
        self.packages[Path(made.path).name] = {
            **described,
            "build": "0",
            "build_number": 0,
            "sha256": hashlib.sha256(content).hexdigest(),
            "size": len(content),
            "subdir": SUBDIR,
        }
        self.write(SUBDIR, self.packages)

    def write(self, subdir: str, packages: dict[str, dict[str, object]]) -> None:
        described = {"info": {"subdir": subdir}, "packages": {}, "packages.conda": packages}
        (self.folder / subdir / "repodata.json").write_text(json.dumps(described), encoding="utf-8")


def asked(python: Path, code: str) -> str:
    return subprocess.run([python, "-c", code], capture_output=True, text=True, check=True).stdout.strip()  # noqa: S603


def fill(channel: Channel, environment: Path, folder: Path) -> None:
    """Add Python, what builds the wheel, and what the package requires."""
    python = environment / "bin/python"
    of_machine = Path(asked(python, "import sys; print(sys.base_prefix)"))
    version = asked(python, "import platform; print(platform.python_version())")
    places = f"lib/python{version.rpartition('.')[0]}/site-packages"
    left_out = ignore_patterns("__pycache__", "test", "tests", "idlelib", "*.a", "share", "pip*", "reliab*")
    copytree(of_machine, folder / "python", symlinks=True, ignore=left_out)
    copytree(environment / places, folder / "packages" / places, ignore=left_out)
    of_wheel = folder / "wheel" / places
    command = [python, "-m", "pip", "install", "--quiet", "--target", of_wheel, "hatchling", "pip"]
    subprocess.run(command, check=True)  # noqa: S603
    channel.add("python", version, folder / "python")
    channel.add("packages", "1", folder / "packages", ["python"])
    versions = {item.name.lower(): item.version for item in distributions(path=[str(environment / places)])}
    versions |= {item.name.lower(): item.version for item in distributions(path=[str(of_wheel)])}
    channel.add("hatchling", versions["hatchling"], folder / "wheel", ["python"])
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    required = {re.match(r"[\w-]+", item)[0]: "packages" for item in project["dependencies"]}
    for name, holder in {**required, "pip": "hatchling"}.items():
        called = ON_CONDA.get(name, name)
        (folder / called / "share").mkdir(parents=True)
        (folder / called / "share" / called).write_text(name, encoding="utf-8")
        channel.add(called, versions[name.lower()], folder / called, [holder])


def main(environment: Path, folder: Path) -> None:
    from rattler_build import Stage0Recipe, ToolConfiguration

    channel = Channel(folder / "channel")
    fill(channel, environment, folder)
    built = Stage0Recipe.from_file(RECIPE).run_build(
        tool_config=ToolConfiguration(test_strategy="native"),
        output_dir=folder / "built",
        channels=[channel.folder.resolve().as_uri()],
    )
    for package in built[0].packages:
        print(f"{package.name}: {package.stat().st_size / 1e6:.1f} MB, built and tested")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
