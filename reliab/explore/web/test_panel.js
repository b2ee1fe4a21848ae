// The part of the page about a test: reading a dropped file, its A and d, its histories, and who judges it.

import { testedStructure } from "./controls.js";
import { index } from "./criterion.js";
import { node } from "./drawing.js";
import { among, examine, judgingCommand, place, rangesAt } from "./dropped_test.js";
import { drawHistories } from "./histories.js";
import { readTest, ReadingError } from "./reading.js";
import { responseMeasures } from "./response.js";

const field = (id) => document.getElementById(id);
const LARGEST_FILE = 200e6; // bytes

// Panel of one test at a time; `changed` is called when another test was read.
export class TestPanel {
  test = null;

  #reading = 0;

  #changed;

  #words;

  #motions;

  constructor(words, motions, changed) {
    this.#words = words;
    this.#motions = motions;
    this.#changed = changed;
    this.#listen();
  }

  // Write what the test has to do with the question; returns A and d, or null without a test.
  show(asked, limits) {
    if (this.test === null) return null;
    const placed = place(this.test, asked.threshold), { amplitude, delay, notes } = placed;
    const value = index(delay < 0 && limits.lead ? limits.lead : limits.lag, amplitude, delay);
    const lies = this.among();
    const where = lies?.position === "outside" ? "none: the criterion does not cover such a test"
      : Number.isFinite(value) ? `${value.toPrecision(4)}: ${value <= 1 ? "inside" : "outside"} the region` : "none: no test is accepted";
    this.#write([
      ["Amplitude A", amplitude.toFixed(5)],
      ["Equivalent delay d", `${(1e3 * delay).toFixed(4)} ms`],
      ["Index by the criterion", where],
      ...(lies ? [["Among the criterion's motions", `${lies.position}: ${lies.words} ${lies.value.toPrecision(3)}${lies.unit}; range of the motions ${lies.least.toPrecision(3)} to ${lies.greatest.toPrecision(3)}${lies.unit}`]] : []),
      ["Length and sampling rate", `${this.test.duration.toFixed(2)} s at ${(1 / this.test.step).toPrecision(5)} Hz`],
    ]);
    field("notes").replaceChildren(...notes.map((text) => node("li", "", text)));
    const { structure, deviations } = testedStructure();
    field("command").textContent = judgingCommand(this.test.name, structure, deviations, asked);
    return placed;
  }

  // Where the test lies among the criterion's motions; null without a test, or where nothing is known of them.
  among() {
    if (this.test === null) return null;
    const { structure } = testedStructure(), { command, step, duration } = this.test;
    const quantities = { length: duration, ...responseMeasures(command, step, structure) };
    return among(quantities, rangesAt(this.#motions, structure));
  }

  // Read another test; nothing of the one before stays, and of several files the last one counts.
  async read(file) {
    this.#reading += 1;
    const reading = this.#reading;
    this.test = null;
    field("test").hidden = true;
    field("problem").textContent = "";
    field("reading").textContent = `Reading ${file.name} …`;
    this.#changed();
    await new Promise((resume) => { setTimeout(resume, 0); }); // the browser shows it
    let test = null, problem = "";
    try {
      if (file.size > LARGEST_FILE) throw new ReadingError("The file is larger than 200 MB; use reliab assess.");
      const text = await file.text();
      if (reading !== this.#reading) return;
      test = { name: file.name, ...examine(readTest(text, this.#words)) };
    } catch (error) {
      if (!(error instanceof ReadingError || error instanceof RangeError)) throw error;
      problem = `${file.name}: ${error.message}`;
    }
    if (reading !== this.#reading) return;
    this.test = test;
    field("reading").textContent = "";
    field("problem").textContent = problem;
    field("test").hidden = test === null;
    if (test !== null) this.#zoom([0, test.duration]);
    this.#changed();
  }

  #listen() {
    const drop = field("drop");
    for (const name of ["dragenter", "dragover", "dragleave", "drop"]) {
      document.addEventListener(name, (event) => {
        event.preventDefault();
        drop.classList.toggle("over", name === "dragenter" || name === "dragover");
        if (name === "drop" && event.dataTransfer.files.length) this.read(event.dataTransfer.files[0]);
      });
    }
    field("file").addEventListener("change", () => { if (field("file").files.length) this.read(field("file").files[0]); });
    for (const id of ["from", "to"]) field(id).addEventListener("change", () => this.#zoom(["from", "to"].map((name) => Number(field(name).value))));
    field("whole").addEventListener("click", () => this.#zoom([0, this.test.duration]));
    field("copy").addEventListener("click", () => this.#copy());
    this.#listenToDrags(field("motion"));
  }

  // Copy the command; selected, too, where the browser does not let a page write to the clipboard.
  #copy() {
    getSelection().selectAllChildren(field("command"));
    navigator.clipboard?.writeText(field("command").textContent).catch(() => {});
  }

  // Dragging across the histories shows that part of them.
  #listenToDrags(svg) {
    let begin = null;
    const timeAt = (event) => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      return this.frame.valuesAt(at.x, at.y)[0];
    };
    svg.addEventListener("pointerdown", (event) => { begin = timeAt(event); });
    svg.addEventListener("pointerup", (event) => {
      if (begin === null) return;
      const ends = [begin, timeAt(event)].sort((p, q) => p - q);
      begin = null;
      if (ends[1] - ends[0] > 0.01 * this.test.duration) this.#zoom(ends);
    });
  }

  #zoom([from, to]) {
    const ends = [Math.max(from, 0), Math.min(to, this.test.duration)];
    if (!(ends[1] - ends[0] > 8 * this.test.step)) return;
    this.frame = drawHistories(field("motion"), this.test, ends);
    [field("from").value, field("to").value] = ends.map((value) => value.toFixed(2));
  }

  #write(rows) {
    field("test-name").textContent = this.test.name;
    field("numbers").replaceChildren(...rows.map(([name, value]) => {
      const head = node("th", "", name);
      head.scope = "row";
      return node("tr", "", head, node("td", "", value));
    }));
  }
}
