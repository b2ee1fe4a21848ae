"""One new law, method, effect, format or kind of study is one file and one entry point."""

import re
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.registry import read_entry_points
from reliab.criterion.laws.registry import FITTED_LAWS, law_from_dict, law_to_dict
from reliab.criterion.methods.registry import METHODS, method_of
from reliab.discrepancy.adding import update_model
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.diagnose import diagnose
from reliab.effects.registry import find_effect, library
from reliab.motions.loading import load_motions
from reliab.motions.readers.registry import FORMATS
from reliab.report.prose import meaning_of_confidence
from reliab.simulation.hybrid_test.model_file import read_model, write_model
from reliab.structures.frame import Specimen
from reliab.study.kinds import KINDS
from reliab.study.running import read_study

ADDITIONS = {
    "law": (
        "reliab.laws",
        "Constant",
        """
        from dataclasses import dataclass
        import numpy as np
        from reliab.criterion.laws.law import LogLinearLaw

        @dataclass(frozen=True, kw_only=True)
        class Constant(LogLinearLaw):
            name = "constant"
            equation = "a = c, b = c'"

            @staticmethod
            def _terms(f, xi):
                return np.ones_like(f)[..., None], np.ones_like(f)[..., None]

            @staticmethod
            def _references(f, xi):
                return np.ones_like(f), np.ones_like(f)
        """,
    ),
    "method": (
        "reliab.criterion_methods",
        "Least",
        """
        from dataclasses import dataclass
        from reliab.criterion.methods.method import BoundMethod

        @dataclass(frozen=True, kw_only=True)
        class Least(BoundMethod):
            name = "least"
            meaning = "the least of the motions at hand"
            distribution_free = True

            def _lower_bound(self, logarithms, events, confidence):
                return float(logarithms.min())
        """,
    ),
    "effect": (
        "reliab.effects",
        "Thermal",
        """
        from reliab.effects.sensor_bias import SensorBias

        class Thermal(SensorBias):
            name = "thermal_bias"
            description = "the sensor warms up"
        """,
    ),
    "format": (
        "reliab.record_formats",
        "FORMAT",
        """
        from reliab.motions.readers import text
        from reliab.motions.readers.registry import RecordFormat

        FORMAT = RecordFormat(
            name="pairs",
            endings=(".pairs",),
            recognises=lambda source: source.path.suffix == ".pairs",
            headers=text.headers,
        )
        """,
    ),
    "kind": (
        "reliab.study_kinds",
        "KIND",
        """
        from reliab.study.description import Study
        from reliab.study.description import StudyKind

        KIND = StudyKind(
            name="nothing", tables=Study, stages=lambda study: (), report=lambda study, folder: {}
        )
        """,
    ),
}
REGISTRIES = {
    "law": FITTED_LAWS,
    "method": METHODS,
    "effect": library(),
    "format": FORMATS,
    "kind": KINDS,
}


def forget() -> None:
    read_entry_points.cache_clear()
    for registry in REGISTRIES.values():
        vars(registry).pop("_items", None)


@pytest.fixture
def plugin(tmp_path, monkeypatch):
    """Return what installs one addition as a package of one file."""

    def install(thing: str, addition: tuple[str, str, str] | None = None) -> None:
        group, item, text = addition or ADDITIONS[thing]
        (tmp_path / f"plugin_{thing}.py").write_text(textwrap.dedent(text), encoding="utf-8")
        about = tmp_path / f"plugin_{thing}-1.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Name: plugin_{thing}\nVersion: 1\n", encoding="utf-8")
        (about / "entry_points.txt").write_text(
            f"[{group}]\n{item} = plugin_{thing}:{item}\n", encoding="utf-8"
        )
        forget()

    monkeypatch.syspath_prepend(tmp_path)
    yield install
    for thing in (*ADDITIONS, "guide"):
        sys.modules.pop(f"plugin_{thing}", None)
    forget()


def test_law_is_fitted_and_comes_back_from_json(plugin):
    plugin("law")
    law = FITTED_LAWS.find("constant").fit(
        [1.0, 2.0], [0.02, 0.05], np.full((2, 2), 1e-4), np.full((2, 2), 2.0)
    )
    assert law.limits(1.5, 0.03) == pytest.approx((1e-4, 2.0))
    assert law_from_dict(law_to_dict(law)) == law


def test_method_bounds_and_tells_the_meaning_of_its_confidence(plugin):
    plugin("method")
    assert method_of("least").lower_bound(np.array([3.0, 1.0, 2.0]), np.array(["p", "q", "r"]), 0.9) == 1.0  # type: ignore[attr-defined]
    assert meaning_of_confidence("least") == "the least of the motions at hand"


def test_an_effect_is_known_by_name(plugin):
    plugin("effect")
    assert find_effect("thermal_bias").__name__ == "Thermal"


def test_effect_of_the_guide_is_named_with_its_parameters(plugin, tmp_path):
    """The module as the page prints it; the tests are computed here, f = 40 N at w = 4 mm beside a spring."""
    page = (Path(__file__).parents[1] / "reports/site/how_to/add_your_own.md").read_text(encoding="utf-8")
    (module,) = re.findall(r"```python\n# magnetic_centring\.py\n(.*?)```", page, flags=re.DOTALL)
    plugin("guide", ("reliab.effects", "MagneticCentring", module))
    rng, tests = np.random.default_rng(3), []
    t = np.arange(0.0, 12.0, 1.0 / 128.0)
    for k in range(3):
        waves = [np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 7.0)) for f in rng.uniform(0.4, 1.5, 5)]
        x = 0.005 * np.sum(waves, axis=0) * np.sin(np.pi * t / t[-1])
        force = 8e3 * x + 40.0 * x / 0.004 * np.exp(0.5 - 0.5 * (x / 0.004) ** 2)
        force += 0.5 * rng.standard_normal(t.size)
        channels = {Channel.MEASURED: x, Channel.FORCE: force}
        tests.append(MeasuredTest(file=f"{k}.csv", motion="waves", held_out=k == 2, channels=channels))
    specimen = Specimen(stiffness=8e3)
    campaign = Campaign(
        name="", structure=None, mass=1.0, actuator=None, specimen=specimen, rate=128.0, tests=tuple(tests)
    )
    diagnosis = diagnose(campaign)
    (effect,) = diagnosis.effects
    assert effect.name == "magnetic_centring"
    write_model(tmp_path / "model.toml", update_model(diagnosis))
    (read_effect,) = read_model(tmp_path / "model.toml").test.effects
    assert read_effect.values == pytest.approx([estimate.value for estimate in effect.estimates], rel=1e-3)
    for estimate, truth in zip(effect.estimates, (40.0, 0.004), strict=True):
        assert estimate.value == pytest.approx(truth, abs=4.0 * estimate.sd)
        assert estimate.sd < 0.1 * truth


def test_format_is_read_from_a_folder(plugin, tmp_path):
    plugin("format")
    folder = tmp_path / "records"
    folder.mkdir()
    t = 0.01 * np.arange(600)
    rows = "\n".join(f"{x:.2f} {np.sin(x):.6e}" for x in t)
    (folder / "shake.pairs").write_text(rows + "\n", encoding="utf-8")
    (motion,) = load_motions(folder, units="m/s2")
    assert motion.time_step == pytest.approx(0.01)


def test_kind_of_study_is_read_with_its_tables_only(plugin, tmp_path):
    plugin("kind")
    path = tmp_path / "study.toml"
    path.write_text('title = "Nothing"\nkind = "nothing"\n', encoding="utf-8")
    assert read_study(path).kind == "nothing"
    path.write_text('title = "Nothing"\nkind = "nothing"\n[criterion]\nlaw = "table"\n', encoding="utf-8")
    with pytest.raises(InputError, match="criterion"):
        read_study(path)


@pytest.mark.parametrize("thing", REGISTRIES)
def test_addition_under_a_taken_name_is_refused(plugin, thing, tmp_path):
    plugin(thing)
    about = tmp_path / "plugin_twice-1.dist-info"
    about.mkdir()
    group, item, _ = ADDITIONS[thing]
    (about / "METADATA").write_text("Name: plugin_twice\nVersion: 1\n", encoding="utf-8")
    (about / "entry_points.txt").write_text(f"[{group}]\nagain = plugin_{thing}:{item}\n", encoding="utf-8")
    with pytest.raises(InputError, match="must be unique"):
        list(REGISTRIES[thing])
