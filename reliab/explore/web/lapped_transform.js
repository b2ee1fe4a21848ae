// A history as orthonormal coefficients over time and frequency, and back, as reliab/assessment/rebuilt_error/lapped_transform.py.

import { transform } from "./fourier.js";

// Coefficients of a history, a row of `hop` for each frame; beyond its ends it is continued point-symmetrically.
export function analyse(values, hop) {
  const n = values.length, frames = Math.ceil(n / hop) + 1, half = hop >> 1, long = new Float64Array((frames + 1) * hop);
  for (let i = 0; i < hop; i += 1) long[i] = 2 * values[0] - values[hop - i];
  long.set(values, hop);
  for (let i = hop + n, k = n - 2; i < long.length; i += 1, k -= 1) long[i] = k >= 0 ? 2 * values[n - 1] - values[k] : values[n - 1];
  const taper = taperOf(hop), turned = cosineTransform(hop);
  return Array.from({ length: frames }, (_, frame) => {
    const folded = new Float64Array(hop), begin = frame * hop;
    const at = (i) => long[begin + i] * taper[i];
    for (let i = 0; i < half; i += 1) {
      folded[i] = -at(hop + half - 1 - i) - at(hop + half + i);
      folded[half + i] = at(i) - at(hop - 1 - i);
    }
    return turned(folded);
  });
}

// The first `size` samples of the history with these coefficients.
export function synthesise(rows, size) {
  const hop = rows[0].length, half = hop >> 1, taper = taperOf(hop), turned = cosineTransform(hop);
  const values = new Float64Array((rows.length - 1) * hop);
  rows.forEach((row, frame) => {
    const folded = turned(row), begin = (frame - 1) * hop; // the first half of the first frame lies before the history
    for (let i = 0; i < half; i += 1) {
      if (frame > 0) {
        values[begin + i] += folded[half + i] * taper[i];
        values[begin + half + i] -= folded[hop - 1 - i] * taper[half + i];
      }
      if (frame < rows.length - 1) {
        values[begin + hop + i] -= folded[half - 1 - i] * taper[hop + i];
        values[begin + hop + half + i] -= folded[i] * taper[hop + half + i];
      }
    }
  });
  return values.subarray(0, size);
}

// Taper of two hops that conserves power.
function taperOf(hop) {
  return Float64Array.from({ length: 2 * hop }, (_, i) => Math.sin(0.5 * Math.PI * Math.sin((Math.PI * (i + 0.5)) / (2 * hop)) ** 2));
}

// Orthonormal cosine transform of type IV of `size` values, by a complex transform of half the length.
function cosineTransform(size) {
  const half = size >> 1, scale = Math.sqrt(2 / size);
  const angle = (k) => (-Math.PI * (8 * k + 1)) / (8 * size);
  const c = Float64Array.from({ length: half }, (_, k) => Math.cos(angle(k))), s = c.map((_, k) => Math.sin(angle(k)));
  return (values) => {
    const re = new Float64Array(half), im = new Float64Array(half), answer = new Float64Array(size);
    for (let k = 0; k < half; k += 1) {
      const p = values[2 * k], q = values[size - 1 - 2 * k];
      re[k] = p * c[k] - q * s[k];
      im[k] = p * s[k] + q * c[k];
    }
    transform(re, im);
    for (let k = 0; k < half; k += 1) {
      answer[2 * k] = scale * (re[k] * c[k] - im[k] * s[k]);
      answer[size - 1 - 2 * k] = -scale * (re[k] * s[k] + im[k] * c[k]);
    }
    return answer;
  };
}
