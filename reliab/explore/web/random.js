// Random numbers from a seed, so that the same test always has the same interval.

import { normalQuantile } from "./special_functions.js";

// Uniform numbers between 0 and 1 (mulberry32).
export function uniformNumbers(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

// Standard normal numbers (Box and Muller).
export function normalNumbers(uniform) {
  let spare = null;
  return () => {
    if (spare !== null) { const value = spare; spare = null; return value; }
    const radius = Math.sqrt(-2 * Math.log(1 - uniform())), angle = 2 * Math.PI * uniform();
    spare = radius * Math.sin(angle);
    return radius * Math.cos(angle);
  };
}

// Standard normal numbers that fill the distribution evenly: one in each of `count` equally likely intervals,
// in random order (Latin hypercube); a row for each dimension.
export function evenNormalNumbers(dimensions, count, uniform) {
  return Array.from({ length: dimensions }, () => {
    const row = Float64Array.from({ length: count }, (_, k) => normalQuantile((k + 0.5 + 0.98 * (uniform() - 0.5)) / count));
    for (let k = count - 1; k > 0; k -= 1) {
      const place = Math.floor(uniform() * (k + 1));
      [row[k], row[place]] = [row[place], row[k]];
    }
    return row;
  });
}
