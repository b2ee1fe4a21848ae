"""Fixtures shared by all rooms."""

import gc
import json
import os
import pickle
import sys
import unicodedata
from collections import OrderedDict, defaultdict
from contextlib import contextmanager, suppress
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from reliab.core.shipped import find_shipped_folder, shipped

# What takes seconds to import is imported where it is needed: the process that only hands out tests does
# without, and so does a session of one file.

settings.register_profile("few", derandomize=True, deadline=None, max_examples=40)
settings.register_profile("many", settings.get_profile("few"), max_examples=300)

_SHARED = Path(__file__).resolve().parents[2] / "shared"


def pytest_addoption(parser):
    """`--record` notes when and on which commit the slow tests last passed."""
    parser.addoption(
        "--record", action="store_true", help="note the slow tests that pass in tests/slow_tests.json"
    )


def pytest_configure(config):
    """Few examples of each property by default, many where the slow tests run too (`-m ""`).

    Where several processes share the work, each uses one thread for linear algebra, as what it starts does.
    """
    # modules and tests are allocated by the million and stay: they need not be gone through for cycles
    gc.set_threshold(100_000, *gc.get_threshold()[1:])
    # compiled modules are kept beside the code as compiled kernels are: each process that the tests start
    # would compile hundreds of them anew
    sys.dont_write_bytecode = False
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    settings.load_profile("few" if config.getoption("markexpr") == "not slow" else "many")
    if config.getoption("numprocesses", None):
        os.environ.setdefault("OMP_NUM_THREADS", "1")
    if getattr(config, "workerinput", {}).get("workerid") == "gw1":
        for name in _IMPORTED_FIRST_BY_THE_SECOND:
            with suppress(ImportError):
                import_module(name)
    if config.getoption("record", default=False) and not hasattr(config, "workerinput"):
        from slow_record import RECORD, SlowRecord, commit

        config.pluginmanager.register(SlowRecord(RECORD, commit()))


_IMPORTED_FIRST_BY_THE_SECOND = ("panel", "distributed", "matplotlib.pyplot", "scipy.stats")
"""What the second process imports first: in a new environment each then compiles what the other reads."""


def pytest_collection(session):
    """Make the studies importable as `reliab_studies` in processes that read tests."""
    if hasattr(session.config, "workerinput") or not session.config.getoption("numprocesses", None):
        from reliab.study import description  # noqa: F401


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path):
    """Look for examples only in files that have some: pytest would import every benchmark for them."""
    collectors = yield
    if not collectors or ">>> " in file_path.read_text(encoding="utf-8"):
        return collectors
    return [collector for collector in collectors if type(collector) is pytest.Module]


@pytest.hookimpl(tryfirst=True)  # before pytest takes out what `-m` does not name
def pytest_collection_modifyitems(items):
    """Make slow tests of cases that do not run by default; skip what needs studies that were taken away."""
    for item in _cases_beyond_the_default(items):
        item.add_marker(pytest.mark.slow)
    if not find_shipped_folder("studies").is_dir():
        for item in items:
            if item.get_closest_marker("of_studies"):
                item.add_marker(pytest.mark.skip(reason="the studies were taken away"))


_DEFAULT_CASES, _LONG_CASES = 2, 1
"""Cases of one test that run by default, so that `.ci/run` takes ten minutes; the second of verdicts."""

_FOLDERS_OF_VERDICTS = ("tests/app/", "tests/assessment/")


def _cases_beyond_the_default(items):
    """Cases of each test but for a few, spread evenly; `default_cases(N)` says how many."""
    cases = defaultdict(list)
    for item in items:
        cases[item.nodeid.partition("[")[0]].append(item)
    for group in cases.values():
        marker = group[0].get_closest_marker("default_cases")
        usual = _LONG_CASES if group[0].nodeid.startswith(_FOLDERS_OF_VERDICTS) else _DEFAULT_CASES
        number = min(marker.args[0] if marker else usual, len(group))
        run = {rank * len(group) // number for rank in range(number)}
        yield from (item for rank, item in enumerate(group) if rank not in run)


def pytest_xdist_auto_num_workers(config):
    """No worker for a single file or test: starting workers would take longer than the tests.

    Every worker imports what it tests, so there are never more than eight.
    """
    if config.args_source == config.ArgsSource.ARGS and len(config.args) == 1:
        path = Path(config.args[0].partition("::")[0])
        if path.is_file():
            return 0
    return min(usable_processors(), 8)


def usable_processors():
    """Processors on which this process may run."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@pytest.fixture(scope="session")
def shared_folder() -> Path:
    """The folder beside the checkout with real records, skipped where it is absent."""
    if not _SHARED.is_dir():
        pytest.skip(f"the real records are not here ({_SHARED})")
    return _SHARED


@pytest.fixture(scope="session")
def real_motions_folder(shared_folder: Path) -> Path:
    """The folder of real ground-motion records."""
    return shared_folder / "motions"


def blank(figure):
    """An empty SVG as large as a figure."""
    width, height = figure.get_size_inches()
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{72.0 * width}pt" height="{72.0 * height}pt"/>'
    ).encode()


@pytest.fixture(scope="session")
def figures_are_drawn(pytestconfig):
    """Whether reports are set with their figures: only where the slow tests run too.

    Drawing takes ten times as long as everything else in a report. By default a figure is an empty one of
    the same size; `tests/report/figures` and the studies of `tests/study/test_kinds.py` draw theirs.
    """
    return pytestconfig.getoption("markexpr") != "not slow"


@contextmanager
def use_blank_figures(figures_are_drawn):
    """Write reports with empty figures, unless they are to be drawn."""
    with pytest.MonkeyPatch.context() as patch:
        if not figures_are_drawn:
            patch.setattr("reliab.report.content.svg", blank)
        yield


@pytest.fixture(scope="session")
def written(figures_are_drawn):
    """Function that writes what typst reads of a report."""

    from reliab.report.content import files_of

    def write(document):
        with use_blank_figures(figures_are_drawn):
            return files_of(document)

    return write


@pytest.fixture(scope="module")
def blank_figures(figures_are_drawn):
    """Reports that a module's tests write have empty figures by default."""
    with use_blank_figures(figures_are_drawn):
        yield


@pytest.fixture(scope="session")
def set_without_warnings(written):
    """Function that sets a report as PDF, of which typst has nothing to warn."""

    import typst

    from reliab.report.document import Document
    from reliab.report.pdf import templates

    def check(document):
        content = written(document) if isinstance(document, Document) else document
        files = {**templates(), **content}
        inputs = {"date": "2026-01-01", "version": "0"}
        pdf, warnings = typst.compile_with_warnings(
            files, ignore_system_fonts=True, format="pdf", sys_inputs=inputs
        )
        assert warnings == []
        return pdf

    return check


@pytest.fixture(scope="session")
def text_of(set_without_warnings, written):
    """Function that sets a report as PDF and returns what a reader reads in it, pieces joined by blanks."""

    from reliab.report.content import CONTENT_FILE
    from reliab.report.document import Document

    def read(document):
        files = written(document) if isinstance(document, Document) else document
        set_without_warnings(files)
        content = json.loads(files[CONTENT_FILE])
        words = " ".join(_words(content))
        return " ".join(unicodedata.normalize("NFKC", words).replace("\u200b", "").split())

    return read


def _words(content):
    """Every text of a report's content, in its order; a sentence with formulas stays one."""
    if isinstance(content, list):
        if content and all(isinstance(piece, dict) and piece.get("kind") in _PIECES for piece in content):
            yield "".join(piece.get("text", piece.get("source", "")) for piece in content)
        else:
            for part in content:
                yield from _words(part)
    elif isinstance(content, dict):
        for name, part in content.items():
            if name in _READ or isinstance(part, list | dict):
                yield from _words(part)
    elif isinstance(content, str):
        yield content


_PIECES = ("text", "math", "strong", "source", "reference")
_READ = ("text", "digits", "title", "unit", "math", "heading", "caption", "verdict")


@pytest.fixture(scope="session")
def grouped_ellipses():
    """Ellipses of 60 motions of 20 earthquakes at six structures, skewed, correlated and grouped."""
    import xarray as xr

    from reliab.criterion.laws.law import scales

    rng = np.random.default_rng(2017)
    f, xi = np.array([0.5, 1.0, 2.0]), np.array([0.02, 0.05])
    event = np.repeat(np.arange(20), 3)
    effect = 0.3 * rng.normal(size=20)[event][:, None, None]
    common = effect + rng.gamma(2.0, 0.35, (60, 3, 2))
    log_alpha = -1.6 + 0.2 * np.log(f)[:, None] + common + 0.05 * rng.normal(size=common.shape)
    log_beta = -2.0 + 0.8 * common + 0.05 * rng.normal(size=common.shape)
    scale_a, scale_b = scales(f[:, None], xi[None, :])
    dims = ("motion", "f", "xi", "threshold", "metric", "curve")
    a, b = (np.exp(x) * s for x, s in ((log_alpha, scale_a), (log_beta, scale_b)))
    return xr.Dataset(
        {name: (dims, rows[..., None, None, None]) for name, rows in (("a", a), ("b", b))},
        coords={
            "motion": [f"E{e}/M{m}" for m, e in enumerate(event)],
            "event": ("motion", [f"E{e}" for e in event]),
            "checksum": ("motion", [f"{m:064d}" for m in range(60)]),
            "f": f,
            "xi": xi,
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
        },
        attrs={"window": "record"},
    )


@pytest.fixture(scope="session", autouse=True)
def decode_shipped_results_once():
    """Results and ellipses that ship take seconds to decode; the tests of a process read them once."""
    import xarray as xr

    from reliab.sweep.netcdf import read_netcdf
    from reliab.sweep.results import open_compact

    shipped_folder = shipped("datasets", "real_suite")
    decode, read = cache(open_compact), cache(lambda path: read_netcdf(path, "", ""))

    def open_cached(path):
        return decode(path).copy() if path.parent == shipped_folder else open_compact(path)

    def read_cached(path, rule, remedy, select=xr.Dataset.copy):
        if Path(path).parent == shipped_folder:
            return select(read(Path(path))).copy(deep=True)
        return read_netcdf(path, rule, remedy, select)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("reliab.sweep.results.open_compact", open_cached)
        patch.setattr("reliab.sweep.ellipse_dataset.read_netcdf", read_cached)
        yield


@pytest.fixture(scope="session", autouse=True)
def disk_is_not_waited_for():
    """Files are written as ever, but no test waits until the disk has them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda _descriptor: None)
        yield


@pytest.fixture(scope="session", autouse=True)
def questions_are_judged_once(pytestconfig):
    """What many tests ask about one recording is computed once by default.

    Where the slow tests run too, which compare answers to one question, each is computed anew.
    """
    if pytestconfig.getoption("markexpr") != "not slow":
        yield
        return
    from reliab.assessment.assess import assess
    from reliab.assessment.inferred_error import infer_errors

    cache = OrderedDict()

    def judge(*arguments, **options):
        try:
            question = pickle.dumps((arguments, options, infer_errors.__kwdefaults__["draws"]))
        except (AttributeError, TypeError, pickle.PicklingError):
            return assess(*arguments, **options)
        if question not in cache:
            cache[question] = assess(*arguments, **options)
            while len(cache) > _ASSESSMENTS_IN_MEMORY:
                cache.popitem(last=False)
        return cache[question]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("reliab.app.api.assessment.assess_recording", judge)
        yield


_ASSESSMENTS_IN_MEMORY = 32


@contextmanager
def _draws_of_posteriors(number):
    from reliab.assessment.inferred_error import infer_errors
    from reliab.assessment.rebuild import rebuild

    with pytest.MonkeyPatch.context() as patch:
        for function in (infer_errors, rebuild):
            patch.setitem(function.__kwdefaults__, "draws", number)
        yield


@pytest.fixture(scope="module")
def few_draws(pytestconfig):
    """The error of a test has a quarter of its draws by default, as a property has few examples.

    That halves the time of an assessment. Where the slow tests run too it has all, and with `all_draws`.
    """
    if pytestconfig.getoption("markexpr") != "not slow":
        yield
        return
    with _draws_of_posteriors(64):
        yield


@pytest.fixture
def all_draws(few_draws):  # noqa: ARG001 - before it
    """For a test that asks for the draws that users get."""
    from reliab.assessment.inference.posterior import DRAWS

    with _draws_of_posteriors(DRAWS):
        yield


@pytest.fixture(scope="session")
def printed_table2():
    """Ellipses of the paper's Table 2, as a dataset."""
    from reliab.criterion.ellipse_reading import read_ellipses

    return read_ellipses(shipped("datasets", "paper/table2.csv"))


@pytest.fixture(scope="session")
def ellipses_of():
    """Function that makes ellipses of motions of several earthquakes over a grid of structures."""
    import xarray as xr

    def make(frequencies=(0.5, 1.0, 2.0), damping_ratios=(0.02, 0.05), motions=24, events=8, names=None):
        rng = np.random.default_rng(1)
        event = np.arange(motions) % events
        scatter = 0.3 * rng.normal(size=events)[event] + 0.5 * rng.normal(size=motions)
        f, xi = np.array(frequencies), np.array(damping_ratios)
        thresholds = np.array([0.02, 0.05])
        shape = (motions, f.size, xi.size, thresholds.size, 1, 1, 1)
        size = (
            np.exp(scatter).reshape(-1, 1, 1, 1, 1, 1, 1)
            * (thresholds / 0.05).reshape(1, 1, 1, -1, 1, 1, 1) ** 2
        )
        noise = np.exp(0.1 * rng.normal(size=(2, *shape)))
        damping_factor = (xi / 0.02).reshape(1, 1, -1, 1, 1, 1, 1) ** 2
        a = 1.5e-4 * size * damping_factor * noise[0]
        b = 2.5 * size * damping_factor / f.reshape(1, -1, 1, 1, 1, 1, 1) ** 2 * noise[1]
        dimensions = ("motion", "f", "xi", "threshold", "metric", "curve", "side")
        names = [f"E{each}/M{rank}" for rank, each in enumerate(event)] if names is None else names
        return xr.Dataset(
            {"a": (dimensions, np.broadcast_to(a, shape)), "b": (dimensions, np.broadcast_to(b, shape))},
            coords={
                "motion": np.array(names),
                "event": ("motion", np.array([f"E{each}" for each in event])),
                "duration": ("motion", np.full(motions, 40.0)),
                "f": f,
                "xi": xi,
                "threshold": thresholds,
                "metric": ["rms"],
                "curve": ["ellipse"],
                "side": ["lag"],
            },
            attrs={"window": "record", "experimental_fraction": 1.0},
        )

    return make


@pytest.fixture(scope="session")
def rates():
    """Rates of two criteria at three confidences, over all structures and at two frequencies."""
    import pandas as pd

    rows = [
        {
            "measure": measure,
            "candidate": name,
            "confidence": confidence,
            "f": f,
            "rate": rate,
            "low": max(rate - 0.05, 0.0),
            "high": min(rate + 0.04, 1.0),
        }
        for measure, factor in (("containment", 1.0), ("false_safe", 0.02), ("accepted_share", 0.5))
        for name in ("ours", "printed #1")
        for confidence in (0.8, 0.9, 0.95)
        for f in (np.nan, 0.5, 1.0)
        for rate in (factor * confidence,)
    ]
    return pd.DataFrame(rows)
