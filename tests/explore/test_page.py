"""The page is one file that holds everything, allows nothing else, and refuses what it cannot show."""

import base64
import re
import zlib
from pathlib import Path

import numpy as np
import pytest

import reliab.explore
from reliab.app.cli import run
from reliab.core.errors import InputError
from reliab.criterion.carrying import protect_over_lengths
from reliab.explore.page import Settings, bundle_script, pack, render, write_page
from reliab.sweep.ellipse_dataset import write_ellipses

MOST_BYTES = 5_000_000


@pytest.fixture(scope="module")
def small(shipped_ellipses):
    return {"record": shipped_ellipses["record"].isel(f=[3], xi=[0], threshold=[3])}


def test_page_is_one_small_file_without_requests(archive, shipped_ellipses, tmp_path):
    write_page(tmp_path / "page.html", shipped_ellipses, source="a test")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert len(page.encode("utf-8")) < MOST_BYTES
    assert archive["codes"] in page
    assert not re.search(r'(src|href)\s*=|url\((?!#)|@import|https?:(?!//www\.w3\.org/2000/svg")', page)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in policy


def test_page_has_no_verdict_of_its_own(archive):
    page = render(archive, Settings(), source="a test").replace(archive["codes"], "")
    assert not re.search(r"\b(un)?reliable\b|\bundecided\b|\bverdict\b", page.partition("<body>")[2])


def test_no_placeholder_is_left_and_scripts_are_in_order():
    script = bundle_script()
    assert not re.search(r"^(import|export) ", script, flags=re.MULTILINE)
    names = re.findall(r"^const module_(\w+) =", script, flags=re.MULTILINE)
    for use in re.finditer(r"= module_(\w+);", script):
        assert script.index(f"const module_{use[1]} =") < use.start()
    assert len(names) == len(set(names))


def test_codes_hold_the_shipped_ellipses(small):
    """Decoded by the definition of a float32, not by the page."""
    archive_file = pack(small)
    planes = np.frombuffer(zlib.decompress(base64.b64decode(archive_file["codes"])), np.uint8).reshape(2, -1)
    codes = planes[0].astype(np.uint32) + 256 * planes[1].astype(np.uint32)
    table = small["record"].sel(curve="inscribed")
    order = ("threshold", "metric", "side", "f", "xi", "motion")
    protecting = protect_over_lengths(small["record"]).sel(curve="inscribed")
    for half, offset, name in zip(codes.reshape(2, -1), archive_file["offsets"], ("a", "b"), strict=True):
        values = ((half + np.uint32(offset)) << np.uint32(12)).view(np.float32)
        shape = table[name].transpose(*order).shape
        np.testing.assert_allclose(
            values.reshape(shape), protecting[name].transpose(*order).values, rtol=2.5e-4
        )


def test_names_in_the_data_cannot_end_the_script(small):
    hostile = "</script><script>alert(1)</script>"
    hostile_record = small["record"].assign_coords(motion=[f"{hostile}{k}" for k in range(100)])
    page = render(pack({"record": hostile_record}), Settings(), source=hostile)
    assert page.count("<script") == 2
    assert page.count("</script>") == 2


@pytest.mark.parametrize(
    "settings",
    [
        Settings(frequency=3.0),
        Settings(damping_ratio=0.5),
        Settings(threshold=0.5),
        Settings(confidence=0.0),
        Settings(experimental_fraction=2.0),
        Settings(metric="peak"),
    ],
)
def test_settings_missing_from_the_ellipses_are_refused(small, settings):
    with pytest.raises(InputError):
        render(pack(small), settings, source="a test")


def test_settings_at_the_ends_of_the_ellipses_are_within_them_in_spite_of_rounding(shipped_ellipses):
    archive_file = pack({"record": shipped_ellipses["record"].isel(f=[3, 4], xi=[0])})
    for f in archive_file["frequencies"]:
        for frequency in (f * (1.0 - 1e-12), f, f * (1.0 + 1e-12)):
            assert f'"frequency": {frequency}' in render(
                archive_file, Settings(frequency=frequency), source="a test"
            )
    for f in (
        min(archive_file["frequencies"]) * (1.0 - 1e-6),
        max(archive_file["frequencies"]) * (1.0 + 1e-6),
    ):
        with pytest.raises(InputError, match="ellipses are of a natural frequency"):
            render(archive_file, Settings(frequency=f), source="a test")


def test_page_opens_at_a_structure_of_its_ellipses(small):
    other_structure = small["record"].assign_coords(f=[0.4], xi=[0.07])
    page = render(pack({"record": other_structure}), Settings(), source="a test")
    assert '"frequency": 0.4, "dampingRatio": 0.07, "threshold": 0.05' in page


def test_command_writes_the_page_and_says_where(small, tmp_path, capsys):
    write_ellipses(small["record"], tmp_path / "small.nc")
    explore = ["explore", "--ellipses", str(tmp_path / "small.nc"), "--alpha", "0.5", "--out"]
    assert run([*explore, str(tmp_path / "page.html")]) == 0
    assert "page.html" in capsys.readouterr().out.replace("\n", "")
    assert '"share": 0.5' in (tmp_path / "page.html").read_text(encoding="utf-8")
    assert run([*explore, str(tmp_path / "missing" / "page.html")]) == 2
    assert run([*explore, str(tmp_path / "page.html"), "--f", "5"]) == 2
    assert run(["explore", "--ellipses", str(tmp_path / "none.nc"), "--out", str(tmp_path / "p.html")]) == 2


def palettes():
    """Colours of the page by name: of a light and of a dark screen."""
    style = (Path(reliab.explore.__file__).parent / "web" / "style.css").read_text(encoding="utf-8")
    blocks = re.findall(r":root \{(.*?)\}", style, re.DOTALL)
    return [dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6});", block)) for block in blocks]


def luminance(colour):
    """Relative luminance of a colour by the Web Content Accessibility Guidelines."""
    shares = np.array([int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)])
    linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


@pytest.mark.parametrize("palette", palettes(), ids=["light", "dark"])
@pytest.mark.parametrize("ground", ["paper", "card", "tinted", "field"])
@pytest.mark.parametrize("text", ["ink", "soft", "red"])
def test_text_stands_out_from_its_ground(palette, ground, text):
    dark, bright = sorted((luminance(palette[ground]), luminance(palette[text])))
    assert (bright + 0.05) / (dark + 0.05) >= 4.5  # level AA
