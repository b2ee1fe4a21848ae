// From motions' ellipses to the tolerable region of a structure, as `reliab assess` derives it.
//
// A test is accepted where (A - 1)^2/a + d^2/b <= 1. The limits a [-] and b [ms^2] hold together for the stated
// share of motions of further earthquakes (method "dirichlet", reliab/criterion/methods/joint.py). Between the
// structures that were simulated, a/xi^2 and b w0^2/xi^2 are interpolated in ln f and ln xi.

import { isMeaningless, motionsAt, neighbours } from "./ellipses.js";
import { learn, quantile } from "./further_motion.js";

// Limits for a = 1, b = 1 in dimensionless form: xi^2 [-] and (xi/w0)^2 [ms^2].
export function scales(frequency, dampingRatio) {
  return [dampingRatio ** 2, 1e6 * (dampingRatio / (2 * Math.PI * frequency)) ** 2];
}

// Limits [a, b] of a structure; zeros where the motions cannot carry the confidence, or the threshold has no
// meaning. `without` leaves one earthquake out.
export function limits(ellipses, question, without = null) {
  if (thresholdIsMeaningless(ellipses, question)) return [0, 0];
  return interpolated(ellipses, question, (row, column) => limitsAtNode(ellipses, question, row, column, without));
}

// Every motion's own limits [a, b] at a structure, interpolated between nodes like those of the criterion.
export function motionLimits(ellipses, question) {
  const nodes = nodesAround(ellipses, question).map((node) => ({ ...node, ...nodeMotions(ellipses, question, node.row, node.column) }));
  const own = scales(question.frequency, question.dampingRatio);
  return ellipses.motions.map((_, i) => [0, 1].map((k) => nodes.reduce((product, { weight, scale, logA, logB }) =>
    product + weight * ((k === 0 ? logA : logB)[i] - Math.log(scale[k])), Math.log(own[k]))).map(Math.exp));
}

// Whether an actuator that does not move would pass at the structure under more than one motion in twenty.
export function thresholdIsMeaningless(ellipses, question) {
  const rows = neighbours(ellipses.frequencies, question.frequency).slice(0, 2);
  const columns = neighbours(ellipses.dampingRatios, question.dampingRatio).slice(0, 2);
  return rows.some((row) => columns.some((column) => isMeaningless(ellipses, question, row, column)));
}

// Nodes of the grid on either side of a structure, with their weights and scales.
function nodesAround(ellipses, { frequency, dampingRatio }) {
  const [top, bottom, down] = neighbours(ellipses.frequencies, frequency);
  const [left, right, across] = neighbours(ellipses.dampingRatios, dampingRatio);
  const nodes = [[top, 1 - down], [bottom, down]].flatMap(([row, rowWeight]) =>
    [[left, 1 - across], [right, across]].map(([column, columnWeight]) => ({ row, column, weight: rowWeight * columnWeight })));
  return nodes.filter(({ weight }) => weight > 0)
    .map((node) => ({ ...node, scale: scales(ellipses.frequencies[node.row], ellipses.dampingRatios[node.column]) }));
}

function interpolated(ellipses, question, atNode) {
  const sums = [0, 0];
  for (const { row, column, weight, scale } of nodesAround(ellipses, question)) {
    atNode(row, column).forEach((limit, k) => { sums[k] += weight * Math.log(limit / scale[k]); });
  }
  return scales(question.frequency, question.dampingRatio).map((scale, k) => scale * Math.exp(sums[k]));
}

const kept = new Map(); // what was computed before, by question and node
const MOST_KEPT = 4000;

// Return what was computed for a key, or compute it.
function once(key, compute) {
  if (kept.size > MOST_KEPT) kept.clear();
  if (!kept.has(key)) kept.set(key, compute());
  return kept.get(key);
}

function nodeMotions(ellipses, question, row, column) {
  const { metric, side, threshold, duration } = question;
  const key = [ellipses.name, metric, side, threshold, duration, row, column].join();
  return once(key, () => motionsAt(ellipses, question, row, column));
}

function limitsAtNode(ellipses, question, row, column, without) {
  const { metric, side, threshold, duration, confidence } = question;
  const key = [ellipses.name, metric, side, threshold, duration, confidence, without, row, column].join();
  return once(key, () => {
    const { logA, logB } = nodeMotions(ellipses, question, row, column);
    const chosen = ellipses.events.map((event, i) => [event, logA[i], logB[i]])
      .filter(([event, a, b]) => event !== without && Number.isFinite(a) && Number.isFinite(b));
    return jointLimits(chosen, confidence);
  });
}

// Limits of rows of earthquake, ln a and ln b that hold together at a confidence.
export function jointLimits(rows, confidence) {
  const events = rows.map(([event]) => event);
  if (rows.length < 3 || confidence > carriedConfidence(new Set(events).size)) return [0, 0];
  const columns = [1, 2].map((k) => rows.map((row) => row[k]));
  const means = columns.map((column) => column.reduce((sum, value) => sum + value, 0) / rows.length);
  const spreads = columns.map((column, k) =>
    Math.sqrt(column.reduce((sum, value) => sum + (value - means[k]) ** 2, 0) / rows.length));
  const worse = rows.map((_, i) =>
    Math.min(...columns.map((column, k) => (column[i] - means[k]) / spreads[k])));
  const depth = quantile(learn(worse, events), 1 - confidence);
  return means.map((mean, k) => Math.exp(mean + spreads[k] * depth));
}

// Highest confidence that a number of earthquakes supports.
export function carriedConfidence(earthquakes) {
  return (1 - (2 / (earthquakes + 1)) ** 2) * (1 + 1e-12);
}

// Smallest and largest limits when each earthquake is left out in turn.
export function band(ellipses, question) {
  const all = [...new Set(ellipses.events)].map((event) => limits(ellipses, question, event));
  return [0, 1].map((k) => [Math.min(...all.map((pair) => pair[k])), Math.max(...all.map((pair) => pair[k]))]);
}

// Limits by equation (18) of Guo and others (2017), as printed; null where it does not hold.
export function printedLimits({ frequency, dampingRatio, threshold, metric }) {
  const holds = metric === "rms" && Math.abs(threshold - 0.05) < 1e-9 &&
    frequency >= 0.25 && frequency <= 2 && dampingRatio >= 0.02 && dampingRatio <= 0.1;
  return holds ? [0.021 * dampingRatio, 6080 * dampingRatio * Math.exp(-6.6 * frequency)] : null;
}

// Index (A - 1)^2/a + d^2/b of amplitude A and delay d [s]; infinite where no test is accepted.
export function index([a, b], amplitude, delay) {
  if (!(a > 0 && b > 0)) return Infinity;
  return (amplitude - 1) ** 2 / a + (1e3 * delay) ** 2 / b;
}
