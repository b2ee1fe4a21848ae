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
CONDA_NAMES = {"seaborn": "seaborn-base", "matplotlib": "matplotlib-base", "typst": "typst-py"}
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

        description = {"name": name, "version": version, "depends": list(depends)}
        place = self.folder / SUBDIR
        package = assemble_package(
            **description,
            target_platform=SUBDIR,
            build_string="0",
            output_dir=place,
            files_dir=files,
            compression_level=1,
            detect_prefix=False,
        )
        content = Path(package.path).read_bytes()
        self.packages[Path(package.path).name] = {
            **description,
            "build": "0",
            "build_number": 0,
            "sha256": hashlib.sha256(content).hexdigest(),
            "size": len(content),
            "subdir": SUBDIR,
        }
        self.write(SUBDIR, self.packages)

    def write(self, subdir: str, packages: dict[str, dict[str, object]]) -> None:
        description = {"info": {"subdir": subdir}, "packages": {}, "packages.conda": packages}
        (self.folder / subdir / "repodata.json").write_text(json.dumps(description), encoding="utf-8")


def run_python(python: Path, code: str) -> str:
    return subprocess.run([python, "-c", code], capture_output=True, text=True, check=True).stdout.strip()  # noqa: S603


def fill(channel: Channel, environment: Path, folder: Path) -> None:
    """Add Python, what builds the wheel, and what the package requires."""
    python = environment / "bin/python"
    machine_prefix = Path(run_python(python, "import sys; print(sys.base_prefix)"))
    version = run_python(python, "import platform; print(platform.python_version())")
    places = f"lib/python{version.rpartition('.')[0]}/site-packages"
    left_out = ignore_patterns("__pycache__", "test", "tests", "idlelib", "*.a", "share", "pip*", "reliab*")
    copytree(machine_prefix, folder / "python", symlinks=True, ignore=left_out)
    copytree(environment / places, folder / "packages" / places, ignore=left_out)
    wheel_folder = folder / "wheel" / places
    command = [python, "-m", "pip", "install", "--quiet", "--target", wheel_folder, "hatchling", "pip"]
    subprocess.run(command, check=True)  # noqa: S603
    channel.add("python", version, folder / "python")
    channel.add("packages", "1", folder / "packages", ["python"])
    versions = {item.name.lower(): item.version for item in distributions(path=[str(environment / places)])}
    versions |= {item.name.lower(): item.version for item in distributions(path=[str(wheel_folder)])}
    channel.add("hatchling", versions["hatchling"], folder / "wheel", ["python"])
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    kinds = {re.match(r"[\w-]+", item)[0]: "packages" for item in project["dependencies"]}
    for name, holder in {**kinds, "pip": "hatchling"}.items():
        conda_name = CONDA_NAMES.get(name, name)
        (folder / conda_name / "share").mkdir(parents=True)
        (folder / conda_name / "share" / conda_name).write_text(name, encoding="utf-8")
        channel.add(conda_name, versions[name.lower()], folder / conda_name, [holder])


def main(environment: Path, folder: Path) -> None:
    from rattler_build import Stage0Recipe, ToolConfiguration

    channel = Channel(folder / "channel")
    fill(channel, environment, folder)
    build = Stage0Recipe.from_file(RECIPE).run_build(
        tool_config=ToolConfiguration(test_strategy="native"),
        output_dir=folder / "built",
        channels=[channel.folder.resolve().as_uri()],
    )
    for package in build[0].packages:
        print(f"{package.name}: {package.stat().st_size / 1e6:.1f} MB, built and tested")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
