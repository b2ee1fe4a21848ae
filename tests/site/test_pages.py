"""What the documentation site tells its readers to type works."""

import json
import os
import re
import shlex
import subprocess
import sys
import tomllib

import matplotlib as mpl
import pytest
from pages import PAGES, SITE, code, commands, name_of
from written_commands import blocks, command_blocks, parameters, reliab_lines

from reliab.app.cli import run

README = SITE.parents[1] / "README.md"
LONG_CODE = ("tutorial/campaign", "explanation/paper", "explanation/criterion", "explanation/earthquakes")
LINES = {line for page in PAGES for line in reliab_lines(page.read_text(encoding="utf-8"))}


def pages_with(kind, long):
    return [
        pytest.param(page, id=name_of(page), marks=pytest.mark.slow if long(page) else ())
        for page in PAGES
        if kind(page)
    ]


@pytest.mark.default_cases(12)
@pytest.mark.parametrize("line", sorted(LINES))
def test_every_command_is_understood(line):
    """Each option exists and takes its value."""
    assert parameters(line)


@pytest.mark.usefixtures("empty_folder")
@pytest.mark.slow
@pytest.mark.parametrize("page", pages_with(commands, lambda page: False))  # noqa: ARG005
def test_commands_of_a_page_run_one_after_the_other(page):
    for block in commands(page):
        if any("--scheduler" in line for line in block):
            continue  # tests/test_readme.py starts a scheduler and workers for the same recipe
        for line in block:
            assert run(shlex.split(line)[1:]) == 0, line


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("page", pages_with(code, lambda page: name_of(page) in LONG_CODE))
def test_code_of_a_page_runs(page, monkeypatch):
    monkeypatch.syspath_prepend(SITE)
    monkeypatch.setattr(mpl, "use", mpl.use)
    mpl.use("Agg")
    import matplotlib.pyplot as plt

    try:
        exec("\n".join(code(page)), {"__name__": "page"})  # noqa: S102 - our own site
    finally:
        plt.close("all")


def test_the_cluster_of_a_page_is_the_tested_one():
    cluster_blocks = [
        block for block in command_blocks(README.read_text(encoding="utf-8")) if "dask" in str(block)
    ]
    (block,) = [block for page in PAGES for block in commands(page) if "dask" in str(block)]
    lines_without_ports = [
        [re.sub(r":?\b879\d", "", line) for line in lines] for lines in (*cluster_blocks, block)
    ]
    assert lines_without_ports[0][: len(block)] == lines_without_ports[-1]


@pytest.mark.slow
def test_the_plugin_on_its_page_is_known_by_its_name(tmp_path):
    """Its files as the page prints them, laid out as `pip install` lays them out."""
    page = (SITE / "how_to" / "add_your_own.md").read_text(encoding="utf-8")
    module = blocks(page, "python")[0]
    name = re.match(r"# (\w+)\.py\n", module)[1]
    project = tomllib.loads(blocks(page, "toml")[0])["project"]
    ((group, items),) = project["entry-points"].items()
    about = tmp_path / f"{name}-{project['version']}.dist-info"
    about.mkdir()
    (tmp_path / f"{name}.py").write_text(module, encoding="utf-8")
    (about / "METADATA").write_text(f"Name: {project['name']}\nVersion: 1\n", encoding="utf-8")
    lines = [f"[{group}]", *(f"{item} = {location}" for item, location in items.items())]
    (about / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")
    command = ["criterion", "--ellipses", "real_suite", "--f", "1", "--xi", "0.02", "--method", "least"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(SITE.parents[1]), str(tmp_path)])}
    process = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "reliab", *command, "--json", "-"],
        env=environment,
        check=True,
        capture_output=True,
    )
    limits = json.loads(process.stdout)["criteria"][0]
    assert limits["method"] == "least"
    assert limits["b"] > 0.0


def test_projects_of_the_guide_name_their_module():
    """Otherwise `pip install .` takes a campaign's folder beside the module for a second package."""
    page = (SITE / "how_to" / "add_your_own.md").read_text(encoding="utf-8")
    modules = [re.match(r"# (\w+)\.py\n", block)[1] for block in blocks(page, "python")]
    projects = [tomllib.loads(block) for block in blocks(page, "toml")]
    assert [project["tool"]["setuptools"]["py-modules"] for project in projects] == [[m] for m in modules]


def test_first_page_and_readme_show_one_answer():
    (answer,) = blocks((SITE / "index.md").read_text(encoding="utf-8"), "text")
    assert answer in README.read_text(encoding="utf-8")


def test_every_link_between_pages_leads_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert ":" in target or (page.parent / target).exists(), f"{name_of(page)}: {target}"


def test_every_page_is_in_the_table_of_contents():
    contents = (SITE / "index.md").read_text(encoding="utf-8")
    pages_in_contents = set(re.findall(r"^([\w/]+)$", contents, flags=re.MULTILINE))
    assert {name_of(page) for page in PAGES} - {"index"} == pages_in_contents


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # Sphinx and its extensions deprecate what they use of each other
def test_site_is_built_without_a_warning(tmp_path):
    pytest.importorskip(
        "myst_nb", reason="the site is built by sphinx and myst-nb, which are not installed here"
    )
    pytest.importorskip("furo", reason="the theme furo is not installed here")
    from sphinx.cmd.build import build_main

    assert build_main(["-W", "--keep-going", "-q", "-b", "html", str(SITE), str(tmp_path / "site")]) == 0
    reference = (tmp_path / "site" / "reference" / "python.html").read_text(encoding="utf-8")
    assert re.findall(r"&lt;(?:function|class|.* object at)\b", reference) == []


WORDS = (
    *("units", "semicolon", "TDMS", "skew", "delimiter", "decimal comma", "millimetres", "MATLAB"),
    "Simulink",
    *("LabVIEW", "HDF5", "header", "clipping", "spikes", "encoder", "undecided", "threshold", "compensator"),
    *("backlash", "friction", "batch", "exit codes", "proxy", "Windows", "Docker", "conda", "uninstall"),
    *("OpenSees", "tracking indicator", "FACE", "PEI", "memory", "damping", "storeys"),
)
"""What users type into the search."""


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_the_search_finds_the_words_of_users(tmp_path):
    pytest.importorskip("myst_nb", reason="the site is built by sphinx and myst-nb")
    pytest.importorskip("furo", reason="the theme furo is not installed here")
    from sphinx.cmd.build import build_main
    from sphinx.search.en import SearchEnglish

    options = ["-D", "nb_execution_mode=off", "-q", "-b", "html", str(SITE), str(tmp_path)]
    assert build_main(options) == 0
    index = (tmp_path / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(index.removeprefix("Search.setIndex(").removesuffix(")"))
    language = SearchEnglish({})
    stems = {language.stem(word.lower()) for words in WORDS for word in words.split()}
    assert {stem for stem in stems if stem not in {**index["terms"], **index["titleterms"]}} == set()
