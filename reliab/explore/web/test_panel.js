// The part of the page about a test: reading a dropped file, numbers, verdict and histories.

import { examine, judge, verdictOf } from "./assessment.js";
import { testedStructure } from "./controls.js";
import { index } from "./criterion.js";
import { node } from "./drawing.js";
import { drawHistories } from "./histories.js";
import { readTest, ReadingError } from "./reading.js";

const field = (id) => document.getElementById(id);
const percent = (value) => `${(100 * value).toFixed(2)} %`;
const LARGEST_FILE = 200e6; // bytes

// Panel of one test at a time; `changed` is called when another test was read.
export class TestPanel {
  test = null;

  #reading = 0;

  #span = null;

  #changed;

  #words;

  constructor(words, changed) {
    this.#words = words;
    this.#changed = changed;
    this.#listen();
  }

  // Judge the test by the question and write its numbers; returns A and d, or null without a test.
  show(asked, limits) {
    if (this.test === null) return null;
    const { structure } = testedStructure();
    try {
      this.judged = judge(this.test, structure, asked);
    } catch (error) {
      if (!(error instanceof RangeError)) throw error;
      this.#refuse(error.message);
      return null;
    }
    field("problem").textContent = "";
    field("test").hidden = false;
    this.#draw();
    const { tracking } = this.judged, side = tracking.delay < 0 && limits.lead ? limits.lead : limits.lag;
    this.index = index(side, tracking.amplitude, tracking.delay);
    return tracking;
  }

  // Draw the intervals and write the verdict; slower than a slider moves, and given up when one does.
  async conclude(pause, current) {
    if (this.test === null || field("test").hidden) return;
    const steps = verdictOf(this.test, this.judged, testedStructure().deviations);
    let step = steps.next();
    while (!step.done) {
      await pause();
      if (!current()) return;
      step = steps.next();
    }
    this.verdict = step.value;
    this.#write();
  }

  // Take away what was said of the test, until its verdict is computed anew.
  wait() {
    this.verdict = null;
    field("word").textContent = "";
    field("notes").replaceChildren();
    field("test").ariaBusy = "true";
    if (this.test !== null && !field("test").hidden) this.#writeNumbers();
  }

  // Read another test; nothing of the one before stays, and of several files the last one counts.
  async read(file) {
    this.#reading += 1;
    const reading = this.#reading;
    this.test = null;
    this.#refuse("");
    field("reading").textContent = `Reading ${file.name} …`;
    this.#changed();
    await new Promise((resume) => { setTimeout(resume, 0); }); // the browser shows it
    let test = null, problem = "";
    try {
      if (file.size > LARGEST_FILE) throw new ReadingError("The file is larger than 200 MB; use reliab assess.");
      const text = await file.text();
      if (reading !== this.#reading) return;
      test = examine(readTest(text, this.#words));
    } catch (error) {
      if (!(error instanceof ReadingError || error instanceof RangeError)) throw error;
      problem = `${file.name}: ${error.message}`;
    }
    if (reading !== this.#reading) return;
    this.test = test;
    this.#span = test && [0, test.duration];
    field("test-name").textContent = file.name;
    field("reading").textContent = "";
    if (test === null) this.#refuse(problem);
    this.#changed();
  }

  #refuse(sentence) {
    field("problem").textContent = sentence;
    field("test").hidden = true;
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
    for (const id of ["motion", "error"]) this.#listenToDrags(field(id));
  }

  // Dragging across a history shows that part of it.
  #listenToDrags(svg) {
    let begin = null;
    const timeAt = (event) => {
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      return this.frames.upper.valuesAt(place.x, place.y)[0];
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
    this.#span = ends;
    this.#draw();
  }

  #draw() {
    const { rebuilt, threshold } = this.judged, { command, measured, reference, error, step, peak, start } = rebuilt;
    const shown = measured.map((value) => value - start.offset);
    this.frames = drawHistories({ motion: field("motion"), error: field("error") },
      { command, measured: shown, reference, strayed: error, step, bound: threshold * peak }, this.#span);
    [field("from").value, field("to").value] = this.#span.map((value) => value.toFixed(2));
  }

  // The numbers of the test, with dots for those that follow with the verdict.
  #writeNumbers() {
    const { tracking, rebuilt, metric, threshold } = this.judged, { verdict } = this;
    const later = (write) => (verdict === null ? "…" : write(verdict));
    const interval = ({ value, low, high }) => `${percent(value)}, 90 % interval ${percent(low)} to ${percent(high)}`;
    const bounded = (probability) => (probability > 0.99 ? "above 0.99" : probability < 0.01 ? "below 0.01" : probability.toFixed(2));
    const alone = this.test.unused.length ? ", by displacements alone" : "";
    const rows = [
      [`Probability that the ${metric.toUpperCase()} error is below ${percent(threshold)}${alone}`, later(({ probability }) => bounded(probability))],
      ["RMS error of this test, rebuilt", later(({ rms }) => interval(rms))],
      ["Largest error of this test, rebuilt", later(({ mte }) => interval(mte))],
      ["Amplitude A", tracking.amplitude.toFixed(5)],
      ["Equivalent delay d", `${(1e3 * tracking.delay).toFixed(4)} ms`],
      ["Index by the criterion", `${this.index.toPrecision(4)}: ${this.index <= 1 ? "inside" : "outside"}`],
      ["Sensor offset without effect on the loop", `${(1e3 * rebuilt.start.offset).toPrecision(3)} mm`],
      ["Length and sampling rate", `${this.test.duration.toFixed(2)} s at ${(1 / this.test.step).toPrecision(5)} Hz`],
    ];
    field("numbers").replaceChildren(...rows.map(([name, value]) => {
      const head = node("th", "", name);
      head.scope = "row";
      return node("tr", "", head, node("td", "", value));
    }));
  }

  #write() {
    const { faults } = this.judged, { verdict } = this, word = field("word");
    word.textContent = verdict.word;
    word.className = verdict.word.split(" ")[0];
    field("test").ariaBusy = "false";
    this.#writeNumbers();
    const felt = { true: "the loop felt it", false: "the loop did not feel it, and it was taken away", null: "whether the loop felt it is not known" };
    const found = faults.map((fault) => `The measured displacement has an ${fault.kind === "offset" ? "offset" : "upward or downward drift"} of ${percent(Math.abs(fault.size))} of the command's peak: ${felt[fault.felt]}.`);
    field("notes").replaceChildren(
      ...verdict.doubts.map((text) => node("li", "doubt", text)),
      ...[...found, ...this.test.notes].map((text) => node("li", "", text)));
  }
}
