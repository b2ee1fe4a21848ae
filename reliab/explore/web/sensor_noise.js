// The noise of the displacement sensor and the band of the motion, as reliab/assessment/rebuilt_error/noise.py.

import { kaiserLowPass, smooth } from "./filters.js";
import { hann, mean, median, periodogram } from "./fourier.js";
import { fitRows, gradient } from "./least_squares.js";

const CORNERS = [0.3, 1, 3, 10, 30]; // corner frequencies of the slow parts [Hz]
const BINS = 100;
const UPDATES = 400;

// Levels of white and slow noise [m^2], and the filter that passes the motion.
export function estimateNoise(command, measured, step) {
  const n = command.length, spectrum = spectrumOf(n);
  const frequency = Float64Array.from({ length: n >> 1 }, (_, k) => (k + 1) / (n * step));
  const raw = spectrum(subtracted(measured, followed(command, measured)));
  const floor = floorOf(raw);
  const residual = binned(frequency, withoutLines(raw)), motion = binned(frequency, spectrum(command));
  const top = motion.means.indexOf(Math.max(...motion.means));
  const ratio = residual.means[top] / motion.means[top];
  const quiet = residual.means.map((value, k) => ratio * motion.means[k] < 0.1 * Math.max(value, floor));
  const chosen = (values) => values.filter((_, k) => quiet[k]);
  let weights = [floor, 0, 0, 0, 0, 0];
  if (quiet.filter(Boolean).length > CORNERS.length) {
    weights = fitted(shapes(chosen(residual.centres), step), chosen(residual.means), chosen(residual.counts));
  }
  const average = mean(command), moving = [subtracted(command, measured), command.map((value) => value - average)];
  const band = Math.max(...moving.map((values) => highestMotion(binned(frequency, spectrum(values)), weights[0])));
  return { step, weights, band, filter: filterOf(band, step) };
}

// The same noise with a filter that passes no more than a band [Hz].
export function narrowed(noise, band) {
  return noise.band <= band ? noise : { ...noise, band, filter: filterOf(band, noise.step) };
}

// Level of the spectrum above half of the Nyquist frequency [m^2]: of white noise its mean square.
export function whiteFloor(values) {
  return floorOf(spectrumOf(values.length)(values));
}

function floorOf(spectrum) {
  return median(spectrum.subarray(spectrum.length >> 1)) / Math.LN2;
}

// Squared magnitudes over the mean square of the taper, for histories of n samples.
function spectrumOf(n) {
  const taper = hann(n, true), mass = taper.reduce((sum, value) => sum + value * value, 0);
  return (values) => periodogram(values, taper).map((value) => value / mass);
}

// Density of the noise at a frequency [Hz], and its white part.
export function densityAt(noise, frequency) {
  const values = shapes([frequency], noise.step).map(([value]) => value);
  const whole = values.reduce((sum, value, k) => sum + value * noise.weights[k], 0);
  return { whole, white: noise.weights[0] };
}

// Root mean square of the slow parts [m].
export function slowNoise(noise) {
  const count = 8193, top = 0.5 / noise.step;
  let sum = 0;
  for (let k = 0; k < count; k += 1) {
    const { whole, white } = densityAt(noise, (top * k) / (count - 1));
    sum += (k === 0 || k === count - 1 ? 0.5 : 1) * (whole - white);
  }
  return Math.sqrt((sum * top / (count - 1)) * 2 * noise.step);
}

// A history without the noise above the band, each `every`-th sample.
export function withoutNoiseAbove(noise, values, every = 1) {
  return smooth(noise.filter, values, every);
}

function filterOf(band, step) {
  const nyquist = 0.5 / step, edge = 1.3 * band;
  return edge < 0.9 * nyquist ? kaiserLowPass(edge / nyquist) : Float64Array.of(1);
}

function subtracted(values, others) {
  return values.map((value, i) => value - others[i]);
}

// Command as an actuator of slowly changing gain, delay and lag follows it, by least squares.
function followed(command, measured) {
  const n = command.length, velocity = gradient(command), place = (i) => (2 * i) / (n - 1) - 1;
  const basis = [command, velocity, gradient(velocity)];
  const rows = [
    ...basis,
    ...basis.slice(0, 2).map((row) => row.map((value, i) => value * place(i))),
    new Float64Array(n).fill(1),
  ];
  const coefficients = fitRows(rows, measured, 1e-12);
  return command.map((_, i) => rows.reduce((sum, row, k) => sum + coefficients[k] * row[i], 0));
}

// Limit each bin to eight times the level of its surroundings, so that a narrow line is no noise of the band.
function withoutLines(power) {
  const width = Math.max(Math.floor(power.length / 400), 8), levels = [];
  for (let start = 0; start + width <= power.length; start += width) {
    levels.push(median(power.subarray(start, start + width)));
  }
  const level = (k) => levels[Math.min(Math.floor(k / width), levels.length - 1)];
  return power.map((value, k) => (k > Math.floor(power.length / 50) ? Math.min(value, 8 * level(k)) : value));
}

// Average over bins of about equal width on a logarithmic axis.
function binned(frequency, power) {
  const first = Math.log(frequency[0] * 0.999), last = Math.log(frequency[frequency.length - 1] * 1.001);
  const edges = Array.from({ length: BINS + 1 }, (_, k) => Math.exp(first + ((last - first) * k) / BINS));
  const bins = Array.from({ length: BINS }, () => ({ count: 0, centre: 0, mean: 0 }));
  let place = 0;
  frequency.forEach((value, k) => {
    while (value >= edges[place + 1]) place += 1;
    bins[place].count += 1;
    bins[place].centre += value;
    bins[place].mean += power[k];
  });
  const used = bins.filter((bin) => bin.count > 0);
  return {
    centres: used.map((bin) => bin.centre / bin.count),
    means: used.map((bin) => bin.mean / bin.count),
    counts: used.map((bin) => bin.count),
  };
}

// Spectra of which the noise is a sum: white, then slow, one row each.
function shapes(frequency, step) {
  const slow = CORNERS.map((corner) => {
    const rho = Math.exp(-2 * Math.PI * step * corner);
    return frequency.map((value) => (1 - rho) ** 2 / (1 - 2 * rho * Math.cos(2 * Math.PI * step * value) + rho * rho));
  });
  return [frequency.map(() => 1), ...slow];
}

// Levels of highest Whittle likelihood, by multiplicative updates.
function fitted(rows, means, counts) {
  const tiny = 1e-12 * Math.max(...means) + 2.2250738585072014e-308;
  const weighted = means.reduce((sum, value, k) => sum + value * counts[k], 0);
  const weights = rows.map(() => weighted / mean(counts) / counts.length / rows.length + tiny);
  for (let update = 0; update < UPDATES; update += 1) {
    const density = means.map((_, k) => rows.reduce((sum, row, j) => sum + weights[j] * row[k], tiny));
    const factors = rows.map((row) => {
      let up = 0, down = 0;
      row.forEach((shape, k) => {
        up += (shape * counts[k] * means[k]) / (density[k] * density[k]);
        down += (shape * counts[k]) / density[k];
      });
      return up / down;
    });
    factors.forEach((factor, j) => { weights[j] *= factor; });
  }
  return weights;
}

// Highest frequency [Hz] at which a history rises above the white noise in two bins side by side.
function highestMotion({ centres, means, counts }, white) {
  const last = centres.length - 1;
  const above = means.map((value, k) => value > (1 + 4 * Math.max(1 / Math.sqrt(counts[k]), 0.25)) * white);
  const motion = centres.filter((_, k) => k < last && above[k] &&
    (above[(k + last) % (last + 1)] || above[(k + 1) % (last + 1)]));
  return motion.length ? Math.max(...motion) : centres[0];
}
