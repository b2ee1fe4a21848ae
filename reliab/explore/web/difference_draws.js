// Histories of x_c - x_m that are compatible with the noisy sensor reading, as reliab/assessment/rebuilt_error/difference_draws.py,
// which explains and derives them. The functions are generators: each `yield` is a place where the page may pause.

import { gainOfFilter } from "./filters.js";
import { analyse, synthesise } from "./lapped_transform.js";
import { gradient, jacobi } from "./least_squares.js";
import { normalNumbers, uniformNumbers } from "./random.js";
import { roundedDifferently, roundingStep } from "./rounding.js";
import { densityAt, narrowed, whiteFloor, withoutNoiseAbove } from "./sensor_noise.js";

const PERIODS_OF_HOP = 4, FEWEST_FRAMES = 4, BANDS_IN_OCTAVE = 6;
const FIRST_LEVEL = 1e-3, DRAWS_OF_FOLLOWING = 16;
const GRID = 0.3, FIRST = Math.log(1e-8), LAST = Math.log(1e3); // of the logarithm of the level q
const LEVELS = Float64Array.from({ length: Math.ceil((LAST - FIRST) / GRID) }, (_, k) => FIRST + GRID * k);
const SIZES = LEVELS.map(Math.exp);
const STEP = 0.5, JUMP = 0.02, FACTORS = [0, 0.1, 0.2, 0.35, 0.6, 1, 1.7, 2.8, 5], FACTOR_STEP = 0.5;
const LEAST_COMMAND = 0.01, SINGULAR = 1e-13, ROUNDING = 1e-20, DITHERED = 0.9;

// Draws of x_c - x_m at each `every`-th sample; every second one assumes that there is no slow noise.
export function* drawDifferences({ command, read, noise, frequency, every, draws }) {
  const uniform = uniformNumbers(1), random = { uniform, normal: normalNumbers(uniform) };
  const reading = yield* readingOf({ command, read, noise, frequency, every });
  const size = Math.ceil(command.length / every), histories = [];
  const kinds = [{ ...reading, noise: reading.noise.slice(0, 1) }, reading], { hop } = reading;
  const rows = (values) => Array.from({ length: values.length / hop }, (_, frame) => values.subarray(frame * hop, (frame + 1) * hop));
  for (const [k, kind] of kinds.entries()) {
    const largest = kind.noise[kind.noise.length - 1];
    const first = leastSquares(kind, largest.map((variance, j) => variance + FIRST_LEVEL * kind.power[j])).mean;
    const begun = yield* drawn(kind, yield* filtered(kind, first), DRAWS_OF_FOLLOWING, random);
    const follows = first.map((_, row) => begun.reduce((sum, draw) => sum + draw.follows[row], 0) / begun.length);
    const probabilities = yield* filtered(kind, follows);
    for (const [i, draw] of (yield* drawn(kind, probabilities, draws / 2, random)).entries()) {
      histories[2 * i + k] = synthesise(rows(draw.coefficients), size);
      yield;
    }
  }
  return histories;
}

function* readingOf({ command, read, noise, frequency, every }) {
  const step = every * noise.step, thin = narrowed(noise, 0.27 / step), size = Math.ceil(command.length / every);
  const periods = Math.max(frequency * step * size, 1);
  const half = Math.min(Math.round((PERIODS_OF_HOP * size) / (2 * periods)), Math.floor(size / (2 * FEWEST_FRAMES)));
  const hop = 2 * Math.max(half, 1), smooth = (values) => analyse(withoutNoiseAbove(thin, values, every), hop);
  const observed = smooth(command.map((value, i) => value - read[i])), coefficients = (values) => analyse(thinned(values, every), hop);
  yield;
  const power = overNeighbours(squares(coefficients(command)));
  yield;
  const { rows, weights } = yield* roundingOf(command, read, thin, smooth);
  yield;
  const least = ROUNDING * power.reduce((most, row) => row.reduce((top, value) => Math.max(top, value), most), 0);
  const gain = gainOfFilter(thin.filter, (k) => (Math.PI * (k + 0.5)) / (hop * every), hop);
  const spectrum = Array.from(gain, (squared, k) => {
    const { whole, white } = densityAt({ step: noise.step, weights }, (k + 0.5) / (2 * hop * step));
    return { white: (squared * white) / every, slow: Math.max((squared * (whole - white)) / every, 0) };
  });
  const factors = spectrum.some(({ slow }) => slow > 0) ? FACTORS : [1];
  const base = flat(observed.map((row, frame) => row.map((_, k) => (rows ? rows[frame][k] : 0) + spectrum[k].white + least)));
  const variances = factors.map((factor) => base.map((value, j) => value + factor * spectrum[j % hop].slow));
  yield;
  return {
    hop, bands: bandsOf(hop, observed.length), observed: flat(observed), power: flat(power),
    noise: variances, following: yield* followingOf(command, coefficients),
  };
}

// Coefficients of what follows the command, each of mean square one.
function* followingOf(command, coefficients) {
  const velocity = gradient(command), last = command.length - 1, following = [];
  const times = (row, of) => row.map((value, i) => value * of((2 * i) / last - 1));
  const powers = [() => 1, (t) => t, (t) => 1.5 * t * t - 0.5];
  for (const row of [gradient(velocity), ...[command, velocity].flatMap((basis) => powers.map((of) => times(basis, of)))]) {
    const analysed = flat(coefficients(row)), size = Math.sqrt(dot(analysed, analysed) / analysed.length);
    following.push(analysed.map((value) => value / size));
    yield;
  }
  return following;
}

// Rows of the same length as one array.
function flat(rows) {
  const values = new Float64Array(rows.length * rows[0].length);
  rows.forEach((row, i) => values.set(row, i * row.length));
  return values;
}

// Variance of rounding in each coefficient (null where there is none), and the weights of the noise beside it.
function* roundingOf(command, read, noise, smooth) {
  const step = roundingStep(read);
  if (step === 0 || noise.weights[0] >= (DITHERED * step ** 2) / 12) return { rows: null, weights: noise.weights };
  let power = null, floor = 0, count = 0;
  for (const rounded of roundedDifferently(command, step)) {
    const rows = squares(smooth(rounded));
    power = power ? power.map((row, i) => row.map((value, k) => value + rows[i][k])) : rows;
    floor += whiteFloor(rounded);
    count += 1;
    yield;
  }
  const weights = noise.weights.map((weight, k) => (k === 0 ? Math.max(weight - floor / count, 0) : 0));
  return { rows: overNeighbours(power.map((row) => row.map((value) => value / count))), weights };
}

// Each `every`-th sample.
export function thinned(values, every) {
  return values.filter((_, i) => i % every === 0);
}

function squares(rows) {
  return rows.map((row) => row.map((value) => value * value));
}

// Average over each coefficient and its neighbours in time and frequency.
function overNeighbours(rows) {
  const last = rows.length - 1;
  const along = rows.map((row, i) => row.map((value, k) => 0.5 * value + 0.25 * (rows[Math.max(i - 1, 0)][k] + rows[Math.min(i + 1, last)][k])));
  return along.map((row) => row.map((value, k) => 0.5 * value + 0.25 * (row[Math.max(k - 1, 0)] + row[Math.min(k + 1, row.length - 1)])));
}

// Places of the coefficients of each band of frequencies; bands are equally wide on a logarithmic axis.
function bandsOf(hop, frames) {
  const bands = [];
  let before = null;
  for (let k = 0; k < hop; k += 1) {
    const octave = Math.floor(BANDS_IN_OCTAVE * Math.log2(2 * k + 1));
    if (octave !== before) bands.push([]);
    for (let frame = 0; frame < frames; frame += 1) bands[bands.length - 1].push(frame * hop + k);
    before = octave;
  }
  return bands.map((places) => Int32Array.from(places));
}

// Mean and root of the covariance of the coefficients of what follows the command.
function leastSquares({ observed, following }, variance) {
  const count = following.length, right = new Float64Array(count), weighted = new Float64Array(observed.length);
  const normal = following.map(() => new Float64Array(count));
  for (let p = 0; p < count; p += 1) {
    const row = following[p];
    for (let j = 0; j < weighted.length; j += 1) weighted[j] = row[j] / variance[j];
    right[p] = dot(weighted, observed);
    for (let q = p; q < count; q += 1) normal[p][q] = normal[q][p] = dot(weighted, following[q]);
  }
  const { eigenvalues, vectors } = jacobi(normal), limit = SINGULAR * Math.max(...eigenvalues.map(Math.abs));
  const kept = eigenvalues.map((_, j) => j).filter((j) => eigenvalues[j] > limit);
  const mean = new Float64Array(count);
  for (const j of kept) {
    const share = right.reduce((sum, value, p) => sum + vectors[p][j] * value, 0) / eigenvalues[j];
    for (let p = 0; p < count; p += 1) mean[p] += share * vectors[p][j];
  }
  return { mean, root: kept.map((j) => vectors.map((row) => row[j] / Math.sqrt(eigenvalues[j]))) };
}

function dot(values, others) {
  let sum = 0;
  for (let j = 0; j < values.length; j += 1) sum += values[j] * others[j];
  return sum;
}

// Probability of a state after another one.
function steps(places, scale) {
  return places.map((from) => {
    const laplace = places.map((to) => Math.exp(-Math.abs(from - to) / scale)), sum = laplace.reduce((p, q) => p + q, 0);
    return Float64Array.from(laplace, (value) => ((1 - JUMP) * value) / sum + JUMP / places.length);
  });
}

function chain({ noise }) {
  return { ofLevel: steps([...LEVELS], STEP), ofFactor: steps(noise.map((_, k) => k), FACTOR_STEP) };
}

// Probabilities of levels and factors by the bands so far; a row of levels times factors for each band.
function* filtered(reading, follows) {
  const { observed, following, noise, bands } = reading, factors = noise.length, { ofLevel, ofFactor } = chain(reading);
  const rest = observed.map((value, j) => follows.reduce((sum, size, p) => sum - size * following[p][j], value));
  let before = new Float64Array(LEVELS.length * factors).fill(1 / (LEVELS.length * factors));
  const answer = [];
  for (const band of bands) {
    const likelihood = new Float64Array(before.length);
    for (let factor = 0; factor < factors; factor += 1) {
      addLikelihood(reading, rest, band, factor, likelihood);
      yield;
    }
    const top = likelihood.reduce((most, value) => Math.max(most, value), -Infinity);
    const joint = before.map((value, k) => value * Math.exp(likelihood[k] - top)), sum = joint.reduce((p, q) => p + q, 0);
    answer.push(joint.map((value) => value / sum));
    before = moved(answer[answer.length - 1], ofLevel, ofFactor);
  }
  return answer;
}

// Logarithm of the likelihood of each level in a band for one factor of the slow noise.
function addLikelihood({ power, noise }, rest, band, factor, likelihood) {
  const factors = noise.length;
  for (const j of band) {
    const variance = noise[factor][j], size = Math.max(power[j], LEAST_COMMAND * variance), square = rest[j] * rest[j];
    for (let level = 0; level < SIZES.length; level += 1) {
      const total = size * SIZES[level] + variance;
      likelihood[level * factors + factor] -= 0.5 * (Math.log(total) + square / total);
    }
  }
}

// One step of the chain of levels and factors.
function moved(joint, ofLevel, ofFactor) {
  const factors = ofFactor.length, between = new Float64Array(joint.length), answer = new Float64Array(joint.length);
  for (let from = 0; from < ofLevel.length; from += 1) {
    for (let to = 0; to < ofLevel.length; to += 1) {
      for (let k = 0; k < factors; k += 1) between[to * factors + k] += ofLevel[from][to] * joint[from * factors + k];
    }
  }
  for (let level = 0; level < ofLevel.length; level += 1) {
    for (let from = 0; from < factors; from += 1) {
      for (let to = 0; to < factors; to += 1) answer[level * factors + to] += between[level * factors + from] * ofFactor[from][to];
    }
  }
  return answer;
}

// Draw levels and factors, then what follows the command, then the rest.
function* drawn(reading, probabilities, draws, random) {
  const transitions = chain(reading), answer = [];
  for (let k = 0; k < draws; k += 1) {
    answer.push(drawCoefficients(reading, drawLevels(reading, probabilities, transitions, random), random));
    yield;
  }
  return answer;
}

// Level and factor of each band, from the last band to the first.
function drawLevels({ bands, noise }, probabilities, { ofLevel, ofFactor }, { uniform }) {
  const factors = noise.length, levels = new Float64Array(bands.length), places = new Int32Array(bands.length);
  let weights = probabilities[bands.length - 1];
  for (let band = bands.length - 1; band >= 0; band -= 1) {
    const place = chosen(weights, uniform), level = Math.floor(place / factors), factor = place % factors;
    levels[band] = Math.exp(LEVELS[level] + GRID * (uniform() - 0.5));
    places[band] = factor;
    if (band > 0) weights = stepped(probabilities[band - 1], (from) => ofLevel[from][level], ofFactor.map((row) => row[factor]));
  }
  return { levels, places };
}

// Probabilities of a band where level and factor of the next one are known.
function stepped(probabilities, ofLevel, ofFactor) {
  const factors = ofFactor.length, answer = new Float64Array(probabilities.length);
  for (let level = 0; level < LEVELS.length; level += 1) {
    const step = ofLevel(level);
    for (let k = 0; k < factors; k += 1) answer[level * factors + k] = probabilities[level * factors + k] * step * ofFactor[k];
  }
  return answer;
}

function chosen(weights, uniform) {
  const drawnSum = uniform() * weights.reduce((sum, value) => sum + value, 0);
  let sum = 0;
  for (let k = 0; k < weights.length; k += 1) {
    sum += weights[k];
    if (sum >= drawnSum) return k;
  }
  return weights.length - 1;
}

function drawCoefficients(reading, { levels, places }, { normal }) {
  const { observed, following, noise, power, bands } = reading, whole = new Float64Array(observed.length);
  const variance = new Float64Array(observed.length), coefficients = new Float64Array(observed.length);
  bands.forEach((band, b) => {
    for (const j of band) {
      variance[j] = noise[places[b]][j];
      whole[j] = variance[j] + levels[b] * Math.max(power[j], LEAST_COMMAND * variance[j]);
    }
  });
  const { mean, root } = leastSquares(reading, whole), follows = mean.slice();
  for (const column of root) {
    const size = normal();
    for (let p = 0; p < follows.length; p += 1) follows[p] += size * column[p];
  }
  for (let p = 0; p < follows.length; p += 1) {
    for (let j = 0; j < whole.length; j += 1) coefficients[j] += follows[p] * following[p][j];
  }
  for (let j = 0; j < whole.length; j += 1) {
    const share = 1 - variance[j] / whole[j];
    coefficients[j] += share * (observed[j] - coefficients[j]) + Math.sqrt(share * variance[j]) * normal();
  }
  return { coefficients, follows };
}
