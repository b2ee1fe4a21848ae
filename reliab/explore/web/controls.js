// The sliders and choices of the page, and the question that they ask.

import { node } from "./drawing.js";

const field = (id) => document.getElementById(id);
const percent = (value, digits = 1) => `${Number((100 * value).toFixed(digits))} %`;

// How each slider's value is written beside it.
const WRITTEN = {
  "frequency": (value) => `${Number(value).toFixed(2)} Hz`,
  "damping": (value) => percent(value),
  "share": (value) => Number(value).toFixed(2),
  "threshold": (value) => percent(value),
  "confidence": (value) => percent(value),
  "frequency-deviation": (value) => percent(value),
  "damping-deviation": (value) => percent(value),
};
const METRICS = { rms: "RMS error", mte: "largest error" };

// Give the controls the ranges of the ellipses and the settings with which the page opens.
export function prepareControls(ellipses, settings, changed) {
  range("frequency", ellipses.frequencies, 0.01, settings.frequency);
  range("damping", ellipses.dampingRatios, 0.001, settings.dampingRatio);
  range("threshold", ellipses.thresholds, 0.001, settings.threshold);
  field("confidence").value = settings.confidence;
  field("share").value = settings.share;
  choices("metric", ellipses.metrics.map((name) => [name, METRICS[name]]), settings.metric);
  choices("duration", [
    ...ellipses.windows.map((label) => [label, durationInWords(label)]),
  ]);
  for (const input of field("controls").querySelectorAll("input, select")) {
    input.addEventListener("input", () => { write(); changed(); });
  }
  field("controls").addEventListener("submit", (event) => event.preventDefault());
  write();
}

function durationInWords(label) {
  if (label === "record") return "the whole record";
  return label === "arias" ? "5 to 95 % of the Arias intensity" : `the first ${label} s of the record`;
}

function range(id, values, step, value) {
  const input = field(id), low = Math.min(...values), high = Math.max(...values);
  Object.assign(input, { min: low, max: high, step: low === high ? 1 : step, disabled: low === high });
  input.value = value;
}

function choices(id, options, value) {
  field(id).replaceChildren(...options.map(([key, text]) => Object.assign(node("option", "", text), { value: key })));
  if (value) field(id).value = value;
}

function write() {
  for (const [id, text] of Object.entries(WRITTEN)) {
    const written = text(field(id).value);
    field(`${id}-value`).textContent = written;
    field(id).setAttribute("aria-valuetext", written);
  }
}

// The question that the controls ask.
export function question() {
  const number = (id) => Number(field(id).value), chosen = field("duration").value;
  const seconds = Number(chosen);
  return {
    frequency: number("frequency"), dampingRatio: number("damping"), threshold: number("threshold"),
    confidence: number("confidence"), metric: field("metric").value, duration: seconds > 0 ? seconds : null,
  };
}

// The structure of the test, and how well it is known (relative standard deviations).
export function testedStructure() {
  const number = (id) => Number(field(id).value);
  return {
    structure: { frequency: number("frequency"), dampingRatio: number("damping"), share: number("share") },
    deviations: { frequency: number("frequency-deviation"), dampingRatio: number("damping-deviation") },
  };
}

// A question in words.
export function inWords({ frequency, dampingRatio, threshold, confidence, metric }) {
  return `${percent(threshold)} ${metric.toUpperCase()} for ${percent(confidence)} of motions, ` +
    `f = ${frequency.toFixed(2)} Hz, ξ = ${percent(dampingRatio)}`;
}
