// Errors of many draws, their intervals and probabilities, as reliab/assessment/rebuilt_error/spread.py: each draw has a weight
// inverse to its RMS error, so that before a test no size of its error is likelier than another.

import { median } from "./fourier.js";

const SMALLEST = 0.01; // of the median RMS error

// Weight of each draw; their mean is one.
export function weightsOf(rms) {
  const least = SMALLEST * median(rms);
  if (!(least > 0)) return rms.map(() => 1);
  const weights = rms.map((value) => 1 / Math.max(value, least));
  const mean = weights.reduce((sum, weight) => sum + weight, 0) / weights.length;
  return weights.map((weight) => weight / mean);
}

// A value with its 90 % interval, which holds the value.
export function estimate(value, errors, weights) {
  const order = Array.from(errors, (_, k) => k).sort((p, q) => errors[p] - errors[q]);
  const whole = weights.reduce((sum, weight) => sum + weight, 0);
  let sum = 0;
  const places = order.map((k) => { sum += weights[k]; return (sum - 0.5 * weights[k]) / whole; });
  const at = (share) => {
    const above = places.findIndex((place) => place >= share);
    if (above === 0) return errors[order[0]];
    if (above < 0) return errors[order[order.length - 1]];
    const [low, high] = [errors[order[above - 1]], errors[order[above]]];
    return low + ((high - low) * (share - places[above - 1])) / (places[above] - places[above - 1]);
  };
  return { value, low: Math.min(at(0.05), value), high: Math.max(at(0.95), value), draws: errors };
}

// Probability of an error below a threshold, no nearer to 0 and 1 than half of a mean draw.
export function probabilityBelow(errors, weights, threshold) {
  let below = 0;
  errors.forEach((error, k) => { if (error < threshold) below += weights[k]; });
  return (below + 0.5) / (weights.length + 1);
}
