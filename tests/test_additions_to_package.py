"""One new reader, effect, law, method or kind of study touches two or three files.

Each is added to a copy of the package, as a colleague would add it; a process that uses this copy finds them.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest
from test_additions import ADDITIONS

import reliab

FILES = {
    "reader": {
        "motions/readers/pairs.py": """
            from reliab.motions.readers import text

            headers = text.headers


            def recognises(source):
                return source.path.suffix == ".pairs"
        """,
    },
    "effect": {"effects/thermal.py": ADDITIONS["effect"][-1]},
    "law": {"criterion/laws/constant.py": ADDITIONS["law"][-1]},
    "method": {"criterion/methods/least.py": ADDITIONS["method"][-1]},
    "study": {
        "../studies/nothing/study.toml": """
            title = "A study"
            kind = "nothing"
        """,
        "../studies/nothing/kind.py": """
            from reliab.study.description import Study
            from reliab.study.description import Kind

            from .pages import nothing_report


            def report(study, folder):
                return nothing_report(study.title)


            KIND = Kind(name="nothing", tables=Study, stages=lambda study, show: (), report=report)
        """,
        "../studies/nothing/pages.py": """
            from reliab.report.document import Document


            def nothing_report(title):
                return Document(kind="Nothing", title=title, verdict="Nothing was asked.", blocks=())
        """,
    },
}
"""New files of each addition, by their paths in the package."""

REGISTRIES = {
    "reader": (
        "motions/readers/registry.py",
        "from reliab.motions.readers import ",
        "pairs, ",
        "_SHIPPED = (",
        'Format(name="pairs", endings=(".pairs",), recognises=pairs.recognises, headers=pairs.headers),',
    ),
    "effect": (
        "effects/registry.py",
        "",
        "from reliab.effects.thermal import Thermal\n",
        "_SHIPPED: tuple[type[Effect], ...] = (",
        "Thermal,",
    ),
    "law": (
        "criterion/laws/registry.py",
        "",
        "from reliab.criterion.laws.constant import Constant\n",
        "items=(",
        "Constant,",
    ),
    "method": (
        "criterion/methods/registry.py",
        "",
        "from reliab.criterion.methods.least import Least\n",
        "items=(",
        "Least,",
    ),
}
"""The registry of an addition: its file, where the import goes and what it is, the same for the name."""

MOST_FILES = {"reader": 2, "effect": 2, "law": 2, "method": 2, "study": 3}

USE = """
    import json
    import sys
    from pathlib import Path

    import numpy as np

    from reliab.criterion.laws.registry import FITTED_LAWS, law_from_dict, law_to_dict
    from reliab.criterion.methods.registry import method_of
    from reliab.effects.registry import find_effect
    from reliab.motions.loading import load_motions
    from reliab.report.prose import meaning_of_confidence
    from reliab.study.kinds import KINDS
    from reliab.study.running import open_study

    folder = Path(sys.argv[1])
    t = 0.01 * np.arange(600)
    rows = "\\n".join(f"{x:.2f} {np.sin(x):.6e}" for x in t)
    (folder / "shake.pairs").write_text(rows + "\\n", encoding="utf-8")
    a, b = np.full((2, 2), 1e-4), np.full((2, 2), 2.0)
    law = FITTED_LAWS.find("constant").fit([1.0, 2.0], [0.02, 0.05], a, b)
    study = open_study("nothing")
    answer = {
        "reader": load_motions(folder / "shake.pairs", units="m/s2")[0].acceleration.size,
        "effect": find_effect("thermal_bias").description,
        "law": law_from_dict(law_to_dict(law)).limits(1.5, 0.03)[1].round(6).tolist(),
        "method": method_of("least").lower_bound(np.array([3.0, 1.0]), np.array(["p", "q"]), 0.9),
        "meaning": meaning_of_confidence("least"),
        "study": KINDS[study.kind].report(study, folder).verdict,
    }
    print(json.dumps(answer))
"""


def add(thing: str, package: Path) -> set[Path]:
    """Add a thing to a package, and return the files that were written for it."""
    new_files = set()
    for path, text in FILES[thing].items():
        (package / path).parent.mkdir(exist_ok=True, parents=True)
        (package / path).write_text(dedent(text).lstrip(), encoding="utf-8")
        new_files.add(package / path)
    if thing in REGISTRIES:
        path, place_of_import, import_line, opening, name = REGISTRIES[thing]
        text = (package / path).read_text(encoding="utf-8")
        place = (
            text.index(place_of_import) + len(place_of_import)
            if place_of_import
            else text.index("from reliab")
        )
        text = text[:place] + import_line + text[place:]
        text = text.replace(opening, f"{opening}\n    {name}", 1)
        (package / path).write_text(text, encoding="utf-8")
        new_files.add(package / path)
    return new_files


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """Return a folder with a copy of the package, and an empty one for studies."""
    folder = tmp_path_factory.mktemp("checkout")
    shutil.copytree(
        Path(reliab.__file__).parent, folder / "reliab", ignore=shutil.ignore_patterns("__pycache__")
    )
    (folder / "studies").mkdir()
    return folder


@pytest.mark.slow
def test_additions_touch_few_files_and_are_then_found(copy, tmp_path):
    new_files = {thing: add(thing, copy / "reliab") for thing in FILES}
    assert {thing: len(files) for thing, files in new_files.items()} == MOST_FILES
    process = subprocess.run(  # noqa: S603
        [sys.executable, "-c", dedent(USE), str(tmp_path)],
        capture_output=True,
        text=True,
        check=False,
        cwd=copy,
        env={"PYTHONPATH": str(copy), "NUMBA_CACHE_DIR": str(tmp_path)},
    )
    assert process.returncode == 0, process.stderr
    assert json.loads(process.stdout) == {
        "reader": 600,
        "effect": "the sensor warms up",
        "law": 2.0,
        "method": 1.0,
        "meaning": "the least of the motions at hand",
        "study": "Nothing was asked.",
    }
