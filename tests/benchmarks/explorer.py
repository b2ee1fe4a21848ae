"""How fast the explorer answers in a headless Chromium, and a picture of it.

    python tests/benchmarks/explorer.py [--screenshot reports/explorer.png]

Needs selenium, chromium and its driver. Prints the size of the file [MB], the time from opening it to the
first picture [ms] and the longest and median time of a slider's move until the drawings stand [ms].
"""

import statistics
import tempfile
import time
from pathlib import Path

import paths  # noqa: F401 - makes the browser importable
from benchmark_script import argument_parser
from headless_browser import start
from selenium.webdriver import Chrome

from reliab.app.cli import run

SLIDERS = ("frequency", "damping", "share", "threshold", "confidence")
MOVES = 20
PAUSE = 0.15
_FRAME = 160  # pixels of the window around a page, and a margin


def move_slider(page: Chrome, slider: str, part: float) -> float:
    """Move a slider to a part of its range; return the milliseconds until everything was drawn."""
    script = (
        "const e = document.getElementById(arguments[0]), [low, high] = [Number(e.min), Number(e.max)];"
        "e.value = low + (high - low) * arguments[1]; const begin = performance.now();"
        "e.dispatchEvent(new Event('input', {bubbles: true})); return performance.now() - begin;"
    )
    return float(page.execute_script(script, slider, part))


def main() -> None:
    arguments = argument_parser(__doc__, screenshot=Path).parse_args()
    with tempfile.TemporaryDirectory() as folder:
        page = start(Path(folder) / "profile", width=1440, height=1750)
        path = Path(folder) / "criterion.html"
        run(["explore", "--out", str(path)])
        print(f"size {path.stat().st_size / 1e6:.2f} MB")
        page.get(path.as_uri())
        while not page.execute_script("return document.documentElement.dataset.ready"):
            time.sleep(0.02)
        first = page.execute_script(
            "return performance.getEntriesByName('first-contentful-paint')[0].startTime"
        )
        ready = float(page.execute_script("return document.documentElement.dataset.ready"))
        print(f"first paint {first:.0f} ms, region drawn {ready:.0f} ms")
        time.sleep(4.0)
        if arguments.screenshot:
            height = page.execute_script(
                "return document.querySelector('footer').getBoundingClientRect().bottom"
            )
            page.set_window_size(1440, int(height) + _FRAME)
            time.sleep(1.0)
            page.save_screenshot(str(arguments.screenshot))
        for slider in SLIDERS:
            times = []
            for k in range(MOVES):
                times.append(move_slider(page, slider, (k + 0.5) / MOVES))
                time.sleep(PAUSE)
            print(f"{slider}: median {statistics.median(times):.1f} ms, longest {max(times):.1f} ms")
        page.quit()


if __name__ == "__main__":
    main()
