"""What a release is made of beside the wheel says what the project says."""

import re
import tomllib

import pytest
from conda_build import CONDA_NAMES, RECIPE, ROOT

from reliab.version import __version__

RELEASE = ROOT / ".ci/release"


def test_recipe_and_project_have_the_same_requirements():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    pairs = (re.match(r"([\w-]+)>=([\d.]+)", item).groups() for item in project["dependencies"])
    requirements = {f"{CONDA_NAMES.get(name, name)} >={least}" for name, least in pairs}
    run_section = re.search(r"  run:\n((?:    - .*\n)+)", RECIPE.read_text(encoding="utf-8"))[1]
    lines_of_recipe = {line.removeprefix("    - ") for line in run_section.splitlines()}
    assert lines_of_recipe == requirements | {f"python {project['requires-python']}"}


def test_the_recipe_has_this_version():
    version_line = f'env.get("RELIAB_VERSION", default="{__version__}")'
    assert version_line in RECIPE.read_text(encoding="utf-8")


def test_the_recipe_is_one_of_a_package_for_every_platform():
    rattler_build = pytest.importorskip("rattler_build", reason="py-rattler-build, which renders recipes")
    recipe = rattler_build.Stage0Recipe.from_yaml(RECIPE.read_text(encoding="utf-8"))
    (variant,) = recipe.render(rattler_build.VariantConfig(), rattler_build.RenderConfig())
    package = variant.recipe
    assert (package.package.name, str(package.package.version)) == ("reliab", __version__)
    assert package.build.noarch == "python"


def test_the_image_installs_the_wheel_and_runs_as_no_administrator():
    lines = (RELEASE / "Dockerfile").read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.startswith("USER ")] == ["USER laboratory"]
    assert lines.index("USER laboratory") < lines.index('ENTRYPOINT ["reliab"]')
