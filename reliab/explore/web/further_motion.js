// The value that a further motion exceeds with a stated probability: the recommended method "dirichlet".
//
// The same as reliab/criterion/motion_predictive.py: the motions themselves, weighted by how many independent
// motions their earthquakes amount to, and a skew-normal shape of their first three moments, which counts
// twenty.

import { normalCumulative, normalQuantile, owensT, studentCumulative } from "./special_functions.js";

const CONCENTRATION = 20;
const STEEPEST_SKEWNESS = 0.99;
const TAIL = 6;
const EXTREME = 1e-300;

// Learn from values and the number of each value's earthquake; returns what `cumulative` needs.
export function learn(values, events) {
  const base = skewNormal(values);
  const predictive = {
    ...base,
    ordered: Float64Array.from(values).sort(),
    effective: effectiveNumber(values, events),
  };
  const n = values.length;
  predictive.below = Math.max(shares(predictive, predictive.ordered[0])[0], EXTREME);
  predictive.above = Math.max(shares(predictive, predictive.ordered[n - 1])[1], EXTREME);
  return predictive;
}

// Probability that a further motion's value is at most x.
export function cumulative(predictive, x) {
  const [below, above] = shares(predictive, x);
  const weight = predictive.effective / (predictive.effective + CONCENTRATION);
  return weight * empirical(predictive, x, below, above) + (1 - weight) * below;
}

// Value that a further motion stays below with the given probability.
export function quantile(predictive, probability) {
  const { ordered, scale } = predictive;
  const excess = (x) => cumulative(predictive, x) - probability;
  let low = ordered[0] - scale, high = ordered[ordered.length - 1] + scale, step = scale;
  while (excess(low) > 0) { low -= step; step *= 2; }
  for (step = scale; excess(high) < 0; step *= 2) high += step;
  return root(excess, low, high);
}

// Root of a rising function between two places, by the Illinois variant of the false position.
function root(excess, left, right) {
  let low = left, high = right, atLow = excess(low), atHigh = excess(high);
  for (let step = 0; step < 200 && high - low > 1e-14 * (1 + Math.abs(low)); step += 1) {
    let middle = step % 3 === 2 ? 0.5 * (low + high) : (low * atHigh - high * atLow) / (atHigh - atLow);
    if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
    const value = excess(middle);
    if (value === 0) return middle;
    if (value < 0) { low = middle; atLow = value; atHigh *= 0.5; } else { high = middle; atHigh = value; atLow *= 0.5; }
  }
  return 0.5 * (low + high);
}

// Share of the skew-normal base below x, and above it.
function shares({ location, scale, shape, effective }, x) {
  const degrees = effective - 1;
  const student = normalScore((x - location) / scale, shape) / Math.sqrt((effective + 1) / degrees);
  return [studentCumulative(student, degrees), studentCumulative(-student, degrees)];
}

// Ranks over n + 1, linear between motions and in proportion to the base beyond them.
function empirical({ ordered, below, above }, x, baseBelow, baseAbove) {
  const n = ordered.length;
  let rank = 0;
  for (let high = n; rank < high;) {
    const middle = (rank + high) >> 1;
    if (ordered[middle] <= x) rank = middle + 1; else high = middle;
  }
  if (rank === 0) return Math.min(baseBelow / below, 1) / (n + 1);
  if (rank === n) return (n + 1 - Math.min(baseAbove / above, 1)) / (n + 1);
  const gap = ordered[rank] - ordered[rank - 1];
  return (rank + (gap > 0 ? (x - ordered[rank - 1]) / gap : 0)) / (n + 1);
}

// Normal value below which lies as much as below a standard skew-normal x; asymptotes beyond six spreads.
function normalScore(x, shape) {
  const short = Math.hypot(1, Math.max(shape, 0)), long = Math.hypot(1, Math.max(-shape, 0));
  const low = -TAIL / short, high = TAIL / long;
  const inner = Math.min(Math.max(x, low), high);
  const turn = 2 * owensT(inner, shape);
  const below = normalCumulative(inner) - turn, above = normalCumulative(-inner) + turn;
  const score = below < above ? normalQuantile(Math.min(below, 0.5)) : -normalQuantile(Math.min(above, 0.5));
  return score + short * Math.min(x - low, 0) + long * Math.max(x - high, 0);
}

// Location, scale and shape of the skew-normal distribution with the values' first three moments.
function skewNormal(values) {
  const n = values.length;
  let mean = 0, square = 0, cube = 0;
  for (const value of values) mean += value / n;
  for (const value of values) square += (value - mean) ** 2 / n;
  const spread = Math.max(Math.sqrt(square), 1e-9);
  for (const value of values) cube += ((value - mean) / spread) ** 3 / n;
  const skewness = Math.min(Math.max(cube, -STEEPEST_SKEWNESS), STEEPEST_SKEWNESS);
  const ratio = ((2 * Math.abs(skewness)) / (4 - Math.PI)) ** (2 / 3);
  const delta = Math.sign(skewness) * Math.sqrt((Math.PI / 2) * (ratio / (1 + ratio)));
  const scale = spread / Math.sqrt(1 - (2 * delta * delta) / Math.PI);
  const location = mean - scale * delta * Math.sqrt(2 / Math.PI);
  return { location, scale, shape: delta / Math.sqrt(1 - delta * delta) };
}

// Number of independent motions that would leave the mean as uncertain, by analysis of variance.
function effectiveNumber(values, events) {
  const n = values.length, sums = new Map();
  let mean = 0, total = 0;
  for (const value of values) mean += value / n;
  values.forEach((value, i) => {
    const group = sums.get(events[i]) ?? { sum: 0, size: 0 };
    group.sum += value - mean;
    group.size += 1;
    sums.set(events[i], group);
    total += (value - mean) ** 2;
  });
  const k = sums.size;
  if (k === 1 || k === n) return n;
  let explained = 0, sizes = 0;
  for (const { sum, size } of sums.values()) { explained += (sum * sum) / size; sizes += size * size; }
  let within = (total - explained) / (n - k);
  const meanSize = (n - sizes / n) / (k - 1);
  const between = Math.max((explained / (k - 1) - within) / meanSize, 0);
  if (between === 0) within = total / (n - 1);
  const ofMean = (between * sizes) / (n * n) + within / n;
  return Math.max(ofMean > 0 ? (between + within) / ofMean : n, 2);
}
