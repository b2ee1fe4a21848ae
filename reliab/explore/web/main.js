// The page: from the controls to the drawings, the quick ones at once and the slow ones when a slider rests.

import { copyCommand, judgingCommand } from "./command.js";
import { inWords, prepareControls, question, testedStructure } from "./controls.js";
import { band, carriedConfidence, limits, motionLimits, printedLimits, thresholdIsMeaningless } from "./criterion.js";
import { unpack } from "./ellipses.js";
import { drawOverFrequency } from "./over_frequency.js";
import { describePlace, drawPlane, drawProbe } from "./plane.js";

const field = (id) => document.getElementById(id);
const REST = 120; // milliseconds without a change after which the slow drawings follow
const SLICE = 12; // milliseconds of computing between two looks at the controls

const data = JSON.parse(field("data").textContent);
const ellipses = await unpack(data.ellipses);
const state = { kept: null, drawn: null, probe: [1, 0], round: 0 };

prepareControls(ellipses, data.settings, () => refresh());
field("provenance").textContent = data.provenance;
field("share-hint").textContent = `The tolerable region is that of α = ${ellipses.share}: with a smaller share it is ` +
  "on the safe side. reliab assess takes the share set here.";
field("keep").addEventListener("click", keep);
field("copy").addEventListener("click", copyCommand);
field("compared").addEventListener("input", () => refresh());
listenToPlane(field("plane"));
refresh();
document.documentElement.dataset.ready = String(Math.round(performance.now()));

function asked() {
  return question();
}

function bySide(compute) {
  return Object.fromEntries(ellipses.sides.map((side) => [side, compute(side)]));
}

// Draw everything that follows a slider at once, and plan the rest.
function refresh() {
  const now = asked();
  const own = bySide((side) => limits(ellipses, { ...now, side }));
  const motions = bySide((side) => motionLimits(ellipses, { ...now, side }));
  state.drawn = { now, own, motions, compared: comparedLimits(now), band: null };
  const { structure, deviations } = testedStructure();
  field("command").textContent = judgingCommand(structure, deviations, now);
  draw();
  explain();
  state.round += 1;
  const { round } = state;
  setTimeout(() => { if (round === state.round) drawSlowly(round); }, REST);
}

function draw() {
  state.frame = drawPlane(field("plane"), state.drawn);
  if (document.activeElement === field("plane")) drawProbe(state.frame, ...state.probe);
}

// Limits of the second criterion by side; null where there is none.
function comparedLimits(now) {
  const choice = field("compared").value;
  const hint = field("compared-hint");
  hint.textContent = "";
  if (choice === "none") return null;
  if (choice === "printed") {
    const pair = printedLimits(now);
    if (pair === null) hint.textContent = "Equation (18) holds for 5 % RMS, 0.25 to 2 Hz and 2 to 10 % damping.";
    else hint.textContent = "As printed, for 95 % of ground motions like the paper’s hundred; a lead is treated like a lag of the same size.";
    return pair && bySide(() => pair);
  }
  if (state.kept === null) {
    hint.textContent = "Press the button below to keep the present criterion.";
    return null;
  }
  hint.textContent = `Kept: ${inWords(state.kept)}.`;
  return bySide((side) => limits(ellipses, { ...state.kept, side }));
}

function keep() {
  state.kept = asked();
  field("compared").value = "kept";
  refresh();
}

function explain() {
  const { now, own } = state.drawn, [a, b] = own.lag, carried = carriedConfidence(new Set(ellipses.events).size);
  const late = Math.sqrt(b).toPrecision(2), early = own.lead ? `, or ${Math.sqrt(own.lead[1]).toPrecision(2)} ms early` : "";
  field("answer").textContent = a > 0
    ? `Up to ${late} ms late${early}, or ${(100 * Math.sqrt(a)).toPrecision(2)} % of amplitude error, but not both at once.`
    : thresholdIsMeaningless(ellipses, now)
      ? "With this error limit, even an actuator that does not move would pass under more than one motion in twenty: choose a smaller limit."
      : `${new Set(ellipses.events).size} earthquakes support a confidence of at most ${(100 * carried).toFixed(1)} %: at the chosen one no test is accepted.`;
  field("meaning").textContent = `A test inside the region has an error below ${inWords(now).split(" for ")[0]} with a ` +
    `predictive probability of ${Number((100 * now.confidence).toFixed(1))} % for a motion of a further earthquake like ` +
    `these: ${ellipses.population}${lengthsInWords(now)}.`;
}

// What the criterion promises of lengths, as the end of a sentence.
function lengthsInWords(now) {
  if (now.duration !== null) return `, for records of ${Number(now.duration.toPrecision(3))} s`;
  return ellipses.protection && `, ${ellipses.protection}`;
}

// Band and charts over frequency, in slices between which the controls answer; given up when they change.
async function drawSlowly(round) {
  const pause = sliced(), current = () => round === state.round;
  await pause();
  if (!current()) return;
  const { now } = state.drawn;
  state.drawn.band = bySide((side) => band(ellipses, { ...now, side }));
  draw();
  const rows = [];
  for (const frequency of ellipses.frequencies) {
    await pause();
    if (!current()) return;
    rows.push(rowAt({ ...now, frequency, side: ellipses.sides[0] }));
  }
  chart(rows, now);
  for (const row of rows) {
    await pause();
    if (!current()) return;
    row.band = band(ellipses, { ...now, frequency: row.frequency, side: ellipses.sides[0] });
  }
  chart(rows, now);
  document.documentElement.dataset.settled = String(round);
}

function rowAt(asking) {
  const all = motionLimits(ellipses, asking), choice = field("compared").value;
  const finite = (k) => all.map((pair) => pair[k]).filter(Number.isFinite);
  const kept = choice === "kept" && state.kept ? limits(ellipses, { ...state.kept, frequency: asking.frequency, side: asking.side }) : null;
  return {
    frequency: asking.frequency,
    limits: limits(ellipses, asking),
    motions: [0, 1].map((k) => [0.05, 0.95].map((share) => quantileOf(finite(k), share))),
    compared: choice === "printed" ? printedLimits(asking) : kept,
  };
}

// Quantile with linear interpolation between values, as numpy's.
function quantileOf(values, share) {
  const ordered = Float64Array.from(values).sort(), place = share * (ordered.length - 1);
  const below = Math.floor(place), above = Math.min(below + 1, ordered.length - 1);
  return ordered[below] + (place - below) * (ordered[above] - ordered[below]);
}

function chart(rows, { frequency }) {
  drawOverFrequency(field("delay-law"), 1, rows, frequency);
  drawOverFrequency(field("amplitude-law"), 0, rows, frequency);
}

// A pause that lets the browser answer after each slice of computing.
function sliced() {
  let begin = performance.now();
  return async () => {
    if (performance.now() - begin < SLICE) return;
    await new Promise((resume) => { setTimeout(resume, 0); });
    begin = performance.now();
  };
}

// Pointer and arrow keys say what holds at a place of the plane.
function listenToPlane(svg) {
  const tell = (amplitude, delay) => {
    state.probe = [amplitude, delay];
    drawProbe(state.frame, amplitude, delay);
    field("probe").textContent = describePlace(state.drawn, amplitude, delay);
  };
  svg.addEventListener("pointermove", (event) => {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const [offset, delay] = state.frame.valuesAt(place.x, place.y);
    tell(1 + offset / 100, delay / 1e3);
  });
  svg.addEventListener("focus", () => tell(...state.probe));
  svg.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (!(event.key in moves)) return;
    event.preventDefault();
    const { x, y } = state.frame, [across, up] = moves[event.key], [amplitude, delay] = state.probe;
    const bounded = (value, { low, high }) => Math.min(Math.max(value, low), high);
    tell(1 + bounded(100 * (amplitude - 1) + (across * x.high) / 50, x) / 100, bounded(1e3 * delay + (up * y.high) / 50, y) / 1e3);
  });
}
