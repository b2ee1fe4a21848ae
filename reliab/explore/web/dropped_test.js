// What the page says of a test: A, d and where they lie, as `reliab assess` computes them. It judges nothing.

import { drift, refusal, withoutSpikes } from "./faults.js";
import { track } from "./tracking.js";

// Everything of a test that does not depend on the criterion; throws where A and d mean nothing.
export function examine({ command, measured, step, notes }) {
  const bridged = [command, measured].map(withoutSpikes), [x, y] = bridged.map(({ values }) => values);
  const reason = refusal(x, y);
  if (reason) throw new RangeError(reason);
  const count = bridged[0].count + bridged[1].count;
  const spikes = count ? [`Spikes of ${count} samples were replaced by straight lines: no actuator moves like that.`] : [];
  const plain = track(x, y, step), rise = drift(x, y, step, plain);
  const straight = rise.added && track(x, y.map((value, i) => value - rise.added[i]), step);
  return { command: x, measured: y, step, duration: (x.length - 1) * step, notes: [...notes, ...spikes], plain, rise, straight };
}

// A [-] and d [s] of an examined test, without the drift where it is too large for a threshold; and sentences.
export function place({ notes, plain, rise, straight }, threshold) {
  if (rise.size < 0.1 * threshold) return { ...plain, notes };
  const sentence = `The measured displacement drifts by ${(100 * rise.size).toFixed(2)} % of the command's peak; the drift was subtracted.`;
  return { ...straight, notes: [...notes, sentence] };
}

const NAMES = {
  length: ["length of the record", " s"],
  effective_duration: ["effective duration of the response", " s"],
  frequency_ratio: ["frequency of the error over that of the structure", ""],
  sensitivity: ["error for an amplitude error as large as the damping ratio", ""],
};

// Where quantities of a test lie among those of the criterion's motions (least, 5 %, 95 %, greatest), as `reliab
// assess` says it: the least favourable of all, with its name, value and range; null where nothing is known of them.
export function among(quantities, ranges) {
  const order = ["inside", "at the edge", "outside"];
  const places = Object.keys(ranges).filter((name) => name in quantities && ranges[name]).map((name) => {
    const value = quantities[name], [least, low, high, greatest] = ranges[name];
    const beyond = value < least || value > greatest, near = value < low || value > high;
    const [words, unit] = NAMES[name];
    return { position: order[beyond ? 2 : Number(near)], words, unit, value, least, greatest };
  });
  const worst = (place) => order.indexOf(place.position);
  return places.reduce((found, place) => (found === null || worst(place) > worst(found) ? place : found), null);
}

// Ranges over the criterion's motions of what is known of a test: its length, and its response at the nearest structure.
export function rangesAt({ lengths, responses, frequencies, dampingRatios }, { frequency, dampingRatio }) {
  const nearest = (values, wanted) => values.reduce((best, value, i) =>
    (Math.abs(value - wanted) <= Math.abs(values[best] - wanted) ? i : best), 0);
  const row = nearest(frequencies, frequency), column = nearest(dampingRatios, dampingRatio);
  const of = Object.entries(responses ?? {}).map(([name, table]) => [name, table[row][column]]);
  return { length: lengths, ...Object.fromEntries(of) };
}

// The command that judges the test, to be copied; a name that a shell could misread is left to the user.
export function judgingCommand(name, { frequency, dampingRatio, share }, deviations, { threshold, confidence, metric }) {
  const stated = (value, deviation) => (deviation > 0 ? `${value}±${Number((value * deviation).toPrecision(3))}` : String(value));
  const options = [["f", stated(frequency, deviations.frequency)], ["xi", stated(dampingRatio, deviations.dampingRatio)]];
  if (share !== 1) options.push(["alpha", share]);
  if (threshold !== 0.05) options.push(["threshold", threshold]);
  if (confidence !== 0.95) options.push(["confidence", confidence]);
  if (metric !== "rms") options.push(["metric", metric]);
  return ["reliab assess", fileOf(name), ...options.map(([option, value]) => `--${option} ${value}`)].join(" ");
}

function fileOf(name) {
  if (!/^[\p{L}\p{N}_][\p{L}\p{N}\p{M}_ .,()+-]*$/u.test(name)) return "FILE";
  return /[ ,()]/.test(name) ? `"${name}"` : name;
}
