"""The desk in Chromium: what a user sees, fills in, drops and presses."""

import json
import re
import time
from importlib.util import find_spec
from pathlib import Path

from headless_browser import PATIENCE
from selenium.webdriver.support.ui import Select

_VISIBLE_TEXTS = """
const elements = [];
const walk = (root) => { for (const element of root.querySelectorAll('*')) {
  if (element.matches(arguments[0])) elements.push(element);
  if (element.shadowRoot) walk(element.shadowRoot); } };
walk(document);
return elements;
"""
_TEXT = """
const texts = [];
const walk = (node) => {
  if (node.nodeType === 3) texts.push(node.textContent);
  if (node.shadowRoot) walk(node.shadowRoot);
  if (!['STYLE', 'SCRIPT'].includes(node.tagName)) node.childNodes.forEach(walk); };
walk(document.body);
return texts.join(' ');
"""


_POINTS = """
for (const document of Bokeh.documents)
  for (const model of document._all_models.values())
    if (model.type === "LegendItem" && model.label.value === arguments[0])
      return model.renderers[0].data_source.get_column("x").length;
return null;
"""


class DeskBrowser:
    def __init__(self, chrome, address):
        self.chrome, self.address = chrome, address

    def open(self, page, key=""):
        self.chrome.get(f"{self.address}{page}{key and f'?desk={key}'}")
        self.until(lambda: self.elements("button, select"))

    def elements(self, selector):
        return self.chrome.execute_script(_VISIBLE_TEXTS, selector)

    def text(self):
        return re.sub(r"\s+", " ", self.chrome.execute_script(_TEXT))

    def until(self, question, patience=PATIENCE):
        end = time.monotonic() + patience
        while not question():
            assert time.monotonic() < end, self.text()[-1500:]
            time.sleep(0.25)

    def wait_for(self, words, patience=PATIENCE):
        self.until(lambda: words in self.text(), patience)

    def count_points(self, label):
        """Count the points of a curve that is drawn, by its label in the legend."""
        return self.chrome.execute_script(_POINTS, label)

    def drop(self, path, place=0):
        self.elements("input[type=file]")[place].send_keys(str(path))

    def press(self, name):
        button = next(button for button in self.elements("button") if button.text.strip() == name)
        self.chrome.execute_script("arguments[0].scrollIntoView({block: 'center'})", button)
        places = [{}]
        while places[-1] != button.rect:  # until what was just shown above it has its room
            places.append(button.rect)
            time.sleep(0.2)
        button.click()

    def field(self, label, kind="input"):
        labels = [item for item in self.elements("label") if item.text.strip() == label]
        return self.chrome.execute_script(
            f"return arguments[0].getRootNode().querySelector('{kind}')", labels[0]
        )

    def fill(self, label, text):
        field = self.field(label)
        field.clear()
        field.send_keys(f"{text}\t")

    def choose(self, label, text):
        Select(self.field(label, "select")).select_by_visible_text(text)

    def state_structure(self):
        self.fill("Natural frequency f [Hz]", "1±0.01")
        self.fill("Damping ratio ξ", "0.02±0.002")

    def requests(self):
        messages = [json.loads(entry["message"])["message"] for entry in self.chrome.get_log("performance")]
        return [
            message["params"]["request"]["url"]
            for message in messages
            if message["method"] == "Network.requestWillBeSent"
            and not message["params"]["documentURL"].startswith("chrome")  # a new profile's
        ]

    def complaints(self):
        return [entry["message"] for entry in self.chrome.get_log("browser") if entry["level"] != "INFO"]

    def inaccessible(self):
        """What axe finds, by rule."""
        rules = Path(find_spec("axe_core_python").origin).with_name("axe.min.js")
        self.chrome.execute_script(rules.read_text(encoding="utf-8"))
        answer = self.chrome.execute_async_script("axe.run().then(arguments[arguments.length - 1])")
        return {rule["id"]: [node["html"] for node in rule["nodes"]] for rule in answer["violations"]}

    def overflows(self):
        """Whether the page is wider than its window."""
        return self.chrome.execute_script(
            "return document.documentElement.scrollWidth > document.documentElement.clientWidth"
        )
