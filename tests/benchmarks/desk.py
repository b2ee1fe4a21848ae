"""How fast the desk answers in a headless Chromium, and pictures of its pages.

    python tests/benchmarks/desk.py [--screenshots reports]

Needs selenium, chromium and its driver. Prints the seconds from `reliab desk` to its address, from there to a
page, from dropping a test to its drawing, from the button to the verdict, and of a slider's move [ms].
"""

import io
import json
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import paths  # noqa: F401 - makes the browser importable
from benchmark_script import argument_parser
from desk_browser import DeskBrowser
from headless_browser import start
from PIL import Image

from reliab.core.shipped import shipped

MOVES = 20
_COLOURS = 200  # of a picture, which then has less than 150 kB
SAMPLE = shipped("datasets", "sample_test/test.csv")


def print_time(label: str, act: Callable[[], object]) -> None:
    """Print how long something takes."""
    begin = time.monotonic()
    act()
    print(f"{label}: {time.monotonic() - begin:.2f} s")


def measure_judge(desk: DeskBrowser) -> None:
    """Drop the shipped test and judge it."""
    print_time("page ready", lambda: desk.open("judge"))
    time.sleep(30.0)  # until the workers are warm
    desk.drop(SAMPLE)
    print_time("drawn", lambda: desk.wait_for("What was recognised in"))
    desk.state_structure()
    desk.press("Judge this test")
    print_time("verdict", lambda: desk.wait_for("likely to be below 5 %"))
    print_time("report", lambda: desk.wait_for("The whole report"))


def measure_sliders(desk: DeskBrowser) -> None:
    """Move the slider of the damping ratio, one step after the other."""
    desk.open("before")
    desk.wait_for("but not both at once")
    slider = next(
        element for element in desk.elements("input[type=range]") if element.get_attribute("max") == "0.1"
    )
    times = []
    for _ in range(MOVES):
        text, begin = desk.text(), time.monotonic()
        slider.send_keys("\ue014")  # right arrow
        while desk.text() == text:
            time.sleep(0.005)
        times.append(1e3 * (time.monotonic() - begin))
        time.sleep(0.2)
    print(f"slider: median {statistics.median(times):.0f} ms, longest {max(times):.0f} ms")
    desk.choose("Show the tests of a rig", "the rig that comes with reliab")
    time.sleep(2.0)


def follow(desk: DeskBrowser) -> None:
    """Follow the shipped test until intervals are there."""
    desk.open("live")
    desk.choose("File in the folder of the desk", "the test that comes with reliab")
    desk.state_structure()
    desk.press("Follow")
    desk.until(lambda: re.search(r"[34]\d\.\d s RMS error so far \d", desk.text()))


def show_rig(desk: DeskBrowser) -> None:
    """Show the shipped rig."""
    desk.open("rig")
    desk.press("Show the rig")
    desk.wait_for("What to expect of the next test", 200.0)
    time.sleep(1.0)


def main() -> None:
    arguments = argument_parser(__doc__, screenshots=Path).parse_args()
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "reliab", "desk", folder, "--no-browser", "--json", "-"]
        begin = time.monotonic()
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:  # noqa: S603
            output = ""
            while not output.rstrip().endswith("}"):
                output += server.stdout.readline() if server.stdout else ""
            print(f"address: {time.monotonic() - begin:.2f} s")
            chrome = start(Path(folder) / "profile", width=1280, height=915)
            desk = DeskBrowser(chrome, json.loads(output)["address"])
            for name, act in (
                ("judge", measure_judge),
                ("before", measure_sliders),
                ("live", follow),
                ("rig", show_rig),
            ):
                act(desk)
                if arguments.screenshots is not None:
                    chrome.execute_script("window.scrollTo(0, 0)")
                    chrome.execute_script("document.activeElement.blur()")
                    picture = Image.open(io.BytesIO(chrome.get_screenshot_as_png()))
                    picture.convert("RGB").quantize(_COLOURS).save(
                        arguments.screenshots / f"desk-{name}.png", optimize=True
                    )
            chrome.quit()
            server.terminate()


if __name__ == "__main__":
    main()
