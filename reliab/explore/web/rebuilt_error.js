// The error of one test, rebuilt from its command and measured displacement; histories as reliab/rebuilt_error/.
// The effect of noise is computed more simply than there, from noise histories that pass the same recursion.
//
//     e'' + 2 xi w0 e' + w0^2 e = alpha w0^2 (x_c - x_m),      x_m - x_I = e - (x_c - x_m)

import { examineStart } from "./beginning.js";
import { largest, transform } from "./fourier.js";
import { gradient } from "./least_squares.js";
import { densityAt, estimateNoise, slowNoise, withoutNoiseAbove } from "./sensor_noise.js";

const DRAWS = 256;
const NOISE_HISTORIES = 64;
const PER_PERIOD = 64; // samples of a period while draws are swept

// Recursion w+ = E w + f u + g u+ of the undisturbed structure, exact for inputs straight between samples.
export function recursionOf({ frequency, dampingRatio, share }, step) {
  const w0 = 2 * Math.PI * frequency, rows = 4;
  const joint = [
    [0, step, 0, 0],
    [-w0 * w0 * step, -2 * dampingRatio * w0 * step, step, 0],
    [0, 0, 0, 1],
    [0, 0, 0, 0],
  ];
  const e = exponential(joint, rows);
  return {
    decay: [e[0][0], e[0][1], e[1][0], e[1][1]],
    early: [e[0][2] - e[0][3], e[1][2] - e[1][3]],
    late: [e[0][3], e[1][3]],
    output: share * w0 * w0,
  };
}

function exponential(matrix, size) {
  const product = (p, q) => p.map((row) => row.map((_, j) => row.reduce((sum, value, k) => sum + value * q[k][j], 0)));
  const halvings = 6, small = matrix.map((row) => row.map((value) => value / 2 ** halvings));
  let sum = matrix.map((row, i) => row.map((_, j) => Number(i === j))), term = sum;
  for (let n = 1; n <= 3 * size; n += 1) {
    term = product(term, small).map((row) => row.map((value) => value / n));
    sum = sum.map((row, i) => row.map((value, j) => value + term[i][j]));
  }
  for (let k = 0; k < halvings; k += 1) sum = product(sum, sum);
  return sum;
}

// Response e to the input u from a state [z, z'] at the first sample.
export function respond({ decay, early, late, output }, values, state = [0, 0]) {
  const answer = new Float64Array(values.length), [p, q, r, s] = decay;
  let [z, rate] = state, before = values[0];
  answer[0] = output * z;
  for (let i = 1; i < values.length; i += 1) {
    const now = values[i];
    const moved = p * z + q * rate + early[0] * before + late[0] * now;
    rate = r * z + s * rate + early[1] * before + late[1] * now;
    z = moved;
    before = now;
    answer[i] = output * z;
  }
  return answer;
}

// Mean square over time by the trapezoidal rule.
export function meanSquare(values) {
  let sum = 0;
  for (const value of values) sum += value * value;
  const last = values[values.length - 1];
  return (sum - 0.5 * (values[0] ** 2 + last ** 2)) / (values.length - 1);
}

// What does not depend on the structure: the sensor's noise, and x_c - x_m without it.
export function prepare(command, measured, step) {
  const noise = estimateNoise(command, measured, step);
  const smoothed = withoutNoiseAbove(noise, command.map((value, i) => value - measured[i]));
  return { command, measured, step, noise, smoothed, white: Math.sqrt(noise.weights[0]), slow: slowNoise(noise) };
}

// Histories and errors of a test with a structure; `offset` states the sensor's offset where it is known.
export function rebuild(prepared, structure, offset = null) {
  const { command, measured, step } = prepared;
  const start = examineStart(command, measured, step, structure, prepared);
  if (offset !== null) Object.assign(start, { offset, deviation: 0 });
  const difference = command.map((value, i) => value - measured[i] + start.offset);
  const smoothed = prepared.smoothed.map((value) => value + start.offset);
  const recursion = recursionOf(structure, step);
  const standing = -start.standing / (2 * Math.PI * structure.frequency) ** 2;
  const reference = respond(recursion, difference, [standing, 0]).map((value, i) => command[i] - value);
  const error = reference.map((value, i) => command[i] - smoothed[i] - value);
  return { command, measured, step, noise: prepared.noise, structure, start, smoothed, reference, error, peak: largest(reference) };
}

// RMS and largest error over the peak of the exact response, with 90 % intervals and the draws behind them.
export function conclude(rebuilt, deviations = {}) {
  const random = generator(1);
  const noise = noiseShare(rebuilt, random);
  const draws = sweep(rebuilt, deviations, random);
  const of = (square, top, peak) => ({ rms: Math.sqrt(Math.max(square, 0)) / peak, mte: Math.max(top, 0) / peak });
  const value = of(meanSquare(rebuilt.error) - noise.white, largest(rebuilt.error) - noise.whiteInPeak, rebuilt.peak);
  const drawn = draws.map(({ square, top, peak }, i) => {
    const k = i % noise.inSquare.length;
    return of(square - noise.inSquare[k], top - noise.inPeak[k], peak);
  });
  const interval = (name) => {
    const ordered = drawn.map((draw) => draw[name]).sort((p, q) => p - q);
    const at = (share) => {
      const place = share * (ordered.length - 1), i = Math.floor(place);
      return ordered[i] + (place - i) * (ordered[Math.min(i + 1, ordered.length - 1)] - ordered[i]);
    };
    return { value: value[name], low: Math.min(at(0.05), value[name]), high: Math.max(at(0.95), value[name]), draws: ordered };
  };
  return { rms: interval("rms"), mte: interval("mte") };
}

// Probability of an error below a threshold, no nearer to 0 and 1 than the number of draws can tell.
export function probabilityBelow(draws, threshold) {
  return (draws.filter((value) => value < threshold).length + 0.5) / (draws.length + 1);
}

// What noise adds to mean square and peak, from noise histories that run through the same recursion.
function noiseShare({ noise, structure, error, step }, random) {
  const slowest = Math.max(Math.floor(0.3 / (noise.band * step)), 1);
  const every = Math.min(thinning(structure, step), slowest);
  const coarse = error.filter((_, i) => i % every === 0), recursion = recursionOf(structure, every * step);
  let points = 1;
  while (points < 2 * coarse.length) points *= 2;
  const lines = noiseLines(noise, structure, every, points);
  const square = meanSquare(coarse), top = largest(coarse), inSquare = [], inPeak = [];
  let power = 0;
  for (let k = 0; k < NOISE_HISTORIES; k += 1) {
    const sample = noiseHistory(lines.amplitude, points, random).subarray(0, coarse.length);
    const noisy = respond(recursion, sample).map((value, i) => value - sample[i]);
    power += meanSquare(noisy) / NOISE_HISTORIES;
    if (k === 0 && Math.sqrt(power * NOISE_HISTORIES) <= 1e-4 * Math.sqrt(square)) {
      return { white: 0, inSquare: [0], inPeak: [0], whiteInPeak: 0 };
    }
    const both = coarse.map((value, i) => value + noisy[i]);
    inSquare.push(meanSquare(both) - square);
    inPeak.push(largest(both) - top);
  }
  const white = power * lines.whiteShare, average = inPeak.reduce((sum, value) => sum + value, 0) / inPeak.length;
  const whiteInPeak = power > 0 ? (average * white) / power : 0;
  return { white, inSquare, inPeak: inPeak.map((value) => value - average + whiteInPeak), whiteInPeak };
}

// Amplitudes of the lines of noise that the filter lets pass, and the share of white noise in the error.
function noiseLines(noise, { frequency, dampingRatio, share }, every, points) {
  const passed = gainOfFilter(noise.filter, noise.step, every, points), amplitude = new Float64Array((points >> 1) + 1);
  const w0 = 2 * Math.PI * frequency;
  let whole = 0, white = 0;
  for (let k = 0; k < amplitude.length; k += 1) {
    const hertz = k / (points * every * noise.step), w = 2 * Math.PI * hertz;
    const density = densityAt(noise, hertz), level = (passed[k] * density.whole) / every;
    amplitude[k] = Math.sqrt(0.5 * points * level);
    const below = (w0 * w0 - w * w) ** 2 + (2 * dampingRatio * w0 * w) ** 2;
    const re = (share * w0 * w0 * (w0 * w0 - w * w)) / below - 1, im = (share * w0 * w0 * 2 * dampingRatio * w0 * w) / below;
    const gain = (re * re + im * im) * level;
    whole += gain;
    white += (gain * density.white) / density.whole;
  }
  return { amplitude, whiteShare: whole > 0 ? white / whole : 0 };
}

// Squared gain of a symmetric filter at the lines of a transform of thinned histories.
function gainOfFilter(filter, step, every, points) {
  const reach = filter.length >> 1;
  return Float64Array.from({ length: (points >> 1) + 1 }, (_, k) => {
    if (reach === 0) return 1;
    const turn = (2 * Math.PI * k) / (points * every), c = 2 * Math.cos(turn);
    let next = 0, second = 0; // Clenshaw's sum of the cosines
    for (let j = reach; j > 0; j -= 1) [next, second] = [2 * filter[reach + j] + c * next - second, next];
    return (filter[reach] + 0.5 * c * next - second) ** 2;
  });
}

function noiseHistory(amplitude, points, random) {
  const re = new Float64Array(points), im = new Float64Array(points);
  for (let k = 0; k < amplitude.length; k += 1) {
    const ends = k === 0 || k === points >> 1;
    re[k] = random() * amplitude[k];
    im[k] = ends ? 0 : random() * amplitude[k];
    if (!ends) { re[points - k] = re[k]; im[points - k] = -im[k]; }
  }
  transform(re, im, 1);
  return re.map((value) => value / points);
}

// Errors for draws of everything that is not known, on thinned histories.
function sweep({ command, smoothed, structure, start, step, reference, error, peak }, deviations, random) {
  const every = thinning(structure, step), thin = (values) => values.filter((_, i) => i % every === 0);
  const difference = thin(smoothed), x = thin(command), w0 = 2 * Math.PI * structure.frequency;
  const measured = x.map((value, i) => value - difference[i]), rate = gradient(measured);
  const relative = Math.sqrt(meanSquare(command.map((value, i) => value - reference[i])) / meanSquare(command));
  const initial = start.atRest ? 0 : relative * start.amplitude;
  const drawn = (one) => {
    const factor = (name) => Math.max(1 + one * random() * (deviations[name] ?? 0), 0.05);
    const frequency = structure.frequency * factor("frequency");
    const changed = { frequency, dampingRatio: structure.dampingRatio * factor("dampingRatio"), share: structure.share * factor("share") };
    const offset = one * random() * start.deviation, scale = one * random() * (deviations.scale ?? 0);
    const begin = [one * random() * initial, one * random() * initial * w0].map((value) => value / (structure.share * w0 * w0));
    begin[0] -= start.standing / (2 * Math.PI * frequency) ** 2;
    const input = difference.map((value, i) => value + offset + scale * measured[i]);
    const response = respond(recursionOf(changed, every * step), input, begin);
    let top = 0, ideal = 0;
    const strayed = response.map((value, i) => {
      ideal = Math.max(ideal, Math.abs(x[i] - value));
      top = Math.max(top, Math.abs(value - input[i]));
      return value - input[i];
    });
    return { square: meanSquare(strayed), top, peak: ideal };
  };
  const exact = drawn(0), fine = { square: meanSquare(error), top: largest(error), peak };
  return Array.from({ length: DRAWS }, () => {
    const draw = drawn(1);
    return Object.fromEntries(Object.keys(fine).map((name) => [name, exact[name] > 0 ? (draw[name] * fine[name]) / exact[name] : draw[name]]));
  });
}

function thinning({ frequency }, step) {
  return Math.max(Math.floor(1 / (PER_PERIOD * frequency * step)), 1);
}

// Standard normal numbers from a seed (mulberry32, Box and Muller).
function generator(seed) {
  let state = seed, spare = null;
  const uniform = () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
  return () => {
    if (spare !== null) { const value = spare; spare = null; return value; }
    const radius = Math.sqrt(-2 * Math.log(1 - uniform())), angle = 2 * Math.PI * uniform();
    spare = radius * Math.sin(angle);
    return radius * Math.cos(angle);
  };
}
