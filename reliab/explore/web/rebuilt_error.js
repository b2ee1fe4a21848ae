// The error of one test, rebuilt from its command and measured displacement, with its interval: as reliab/assessment/rebuilt_error/.
//
//     e'' + 2 xi w0 e' + w0^2 e = alpha w0^2 (x_c - x_m),      x_m - x_I = e - (x_c - x_m)

import { examineStart } from "./beginning.js";
import { drawDifferences, thinned } from "./difference_draws.js";
import { largest, median } from "./fourier.js";
import { gradient } from "./least_squares.js";
import { evenNormalNumbers, uniformNumbers } from "./random.js";
import { estimateNoise, slowNoise, withoutNoiseAbove } from "./sensor_noise.js";
import { estimate, probabilityBelow, weightsOf } from "./spread.js";

const DRAWS = 256;
const PER_PERIOD = 64; // samples of a period while draws are swept
const IN_PERIOD_OF_BAND = 0.25; // of the period of the highest frequency of the motion that a step may be
const MOST_SAMPLES = 4096; // that are swept for the sake of the motion's band
const LEAST = 0.05; // of a stated value: a draw goes no lower

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
  return { command, measured, step, noise, smoothed, white: Math.sqrt(noise.weights[0]), slow: slowNoise(noise), drawn: null };
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
  return { prepared, command, measured, step, noise: prepared.noise, structure, start, smoothed, reference, error, peak: largest(reference) };
}

// RMS and largest error over the peak of the exact response, with 90 % intervals and the probability of staying below
// a threshold. A generator: each `yield` is a place where the page may pause.
export function* conclude(rebuilt, deviations = {}) {
  const every = thinning(rebuilt), histories = yield* drawnOnce(rebuilt, every);
  const stated = yield* sweep(rebuilt, {}, histories.filter((_, k) => k % 2 === 0), every, false);
  const spread = yield* sweep(rebuilt, deviations, histories, every, true), weights = weightsOf(spread.rms);
  return {
    rms: estimate(median(stated.rms), spread.rms, weights),
    mte: estimate(median(stated.mte), spread.mte, weights),
    probability: (metric, threshold) => probabilityBelow(spread[metric], weights, threshold),
  };
}

// Draws of x_c - x_m, kept until frequency or offset change.
function* drawnOnce({ prepared, command, measured, noise, start, structure: { frequency } }, every) {
  const { drawn } = prepared;
  if (drawn?.frequency === frequency && drawn.offset === start.offset) return drawn.histories;
  const read = measured.map((value) => value - start.offset);
  const histories = yield* drawDifferences({ command, read, noise, frequency, every, draws: DRAWS });
  prepared.drawn = { frequency, offset: start.offset, histories };
  return histories;
}

// Errors for draws of everything that is not known, or of the noise alone, on thinned histories.
function* sweep({ command, smoothed, structure, start, step, reference }, deviations, histories, every, open) {
  const difference = thinned(smoothed, every), x = thinned(command, every), w0 = 2 * Math.PI * structure.frequency;
  const measured = x.map((value, i) => value - difference[i]);
  const relative = Math.sqrt(meanSquare(command.map((value, i) => value - reference[i])) / meanSquare(command));
  const initial = open && !start.atRest ? relative * start.amplitude : 0;
  const sizes = [deviations.frequency, deviations.dampingRatio, deviations.share, open ? start.deviation : 0, deviations.scale, initial, initial * w0];
  const normal = evenNormalNumbers(sizes.length, histories.length, uniformNumbers(2));
  const drawn = (shifts, history) => {
    const [frequency, dampingRatio, share, offset, scale, place, rate] = shifts;
    const factor = (shift) => Math.max(1 + shift, LEAST), changed = { ...structure, frequency: structure.frequency * factor(frequency) };
    changed.dampingRatio *= factor(dampingRatio);
    changed.share *= factor(share);
    const begin = [place, rate].map((value) => value / (structure.share * w0 * w0));
    begin[0] -= start.standing / (2 * Math.PI * changed.frequency) ** 2;
    const input = history.map((value, i) => value + offset + scale * measured[i]);
    return statistics(x, input, respond(recursionOf(changed, every * step), input, begin));
  };
  const exact = drawn(sizes.map(() => 0), difference), fine = fineStatistics({ command, smoothed, structure, start, step });
  const scales = fine.map((value, k) => (exact[k] > 0 ? value / exact[k] : 1)); // what lies between the swept samples
  const all = [];
  for (const [k, history] of histories.entries()) {
    all.push(drawn(sizes.map((size = 0, j) => size * normal[j][k]), history).map((value, j) => value * scales[j]));
    yield;
  }
  return { rms: all.map(([square, , ideal]) => Math.sqrt(square) / ideal), mte: all.map(([, top, ideal]) => top / ideal) };
}

function fineStatistics({ command, smoothed, structure, start, step }) {
  const standing = -start.standing / (2 * Math.PI * structure.frequency) ** 2;
  return statistics(command, smoothed, respond(recursionOf(structure, step), smoothed, [standing, 0]));
}

// Mean square and peak of x_m - x_I, and the peak of x_I.
function statistics(command, difference, response) {
  const strayed = response.map((value, i) => value - difference[i]);
  return [meanSquare(strayed), largest(strayed), largest(command.map((value, i) => value - response[i]))];
}

// Number of samples of which one is enough while draws are swept.
function thinning({ structure: { frequency }, noise, step, command }) {
  const ofStructure = Math.max(Math.floor(1 / (PER_PERIOD * frequency * step)), 1);
  const ofBand = Math.max(Math.floor(IN_PERIOD_OF_BAND / (noise.band * step)), 1);
  return Math.min(ofStructure, Math.max(ofBand, Math.ceil(command.length / MOST_SAMPLES)));
}
