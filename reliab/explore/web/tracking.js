// Amplitude A and equivalent delay d of a test: Guo and others (2017), equations (1) to (5).
//
// As reliab/assessment/tracking_index.py: histories in the band of the motion, the noise of the
// command taken off, and A and d refined so that a pure gain and delay gives exactly itself.

import { butterworth, filterBothWays, gainOf } from "./filters.js";
import { hann, mean, median, periodogram, realTransform } from "./fourier.js";
import { spline } from "./spline.js";

const REFINEMENTS = 3;

// Amplitude A [-], delay d [s] and equivalent frequency [Hz] of command and measured displacement.
export function track(command, measured, step) {
  const band = inBand(centred(command), centred(measured));
  const plain = withoutNoise(evaluate(band.command, band.measured, step), band, step);
  const path = spline(band.command);
  let amplitude = plain.amplitude, delay = plain.delay;
  for (let round = 0; round < REFINEMENTS; round += 1) {
    const reference = evaluate(band.command, centred(moved(path, band.command.length, amplitude, delay / step)), step);
    amplitude += plain.amplitude - reference.amplitude;
    delay += plain.delay - reference.delay;
  }
  return { amplitude, delay, frequency: plain.frequency };
}

// Equations (1) to (5) of tapered histories.
export function evaluate(command, measured, step) {
  let points = 1;
  while (points < command.length) points *= 2;
  const taper = hann(command.length), tapered = (values) => values.map((value, i) => value * taper[i]);
  const [re, im] = realTransform(tapered(command), points);
  const [outRe, outIm] = realTransform(tapered(measured), points);
  let total = 0, first = 0, crossRe = 0, crossIm = 0;
  for (let k = 1; k < re.length; k += 1) {
    const power = re[k] * re[k] + im[k] * im[k];
    total += power;
    first += (power * k) / (points * step);
    crossRe += outRe[k] * re[k] + outIm[k] * im[k];
    crossIm += outIm[k] * re[k] - outRe[k] * im[k];
  }
  const frequency = first / total, phase = Math.atan2(crossIm, crossRe);
  return { amplitude: Math.hypot(crossRe, crossIm) / total, phase, frequency, delay: -phase / (2 * Math.PI * frequency) };
}

// Samples of a path times a gain and later by a delay in samples; the ends stand for what lies beyond.
export function moved(path, count, gain, delay) {
  return Float64Array.from({ length: count }, (_, i) => gain * path(Math.min(Math.max(i - delay, 0), count - 1)));
}

// Level of the upper half of a periodogram, as of an exponential distribution.
export function noiseFloor(power) {
  return median(power.subarray(power.length >> 1)) / Math.LN2;
}

// Filter both histories alike at twice the highest frequency at which the command rises above its noise.
function inBand(command, measured) {
  const taper = hann(command.length), power = periodogram(command, taper), floor = noiseFloor(power);
  const smoothed = runningMean(power);
  const limit = Math.min(10 * floor, smoothed.reduce((most, value) => Math.max(most, value), 0));
  const bins = smoothed.findLastIndex((value) => value >= limit) + 1;
  if (2 * bins >= 0.9 * power.length) return { command, measured, ...noise(power, floor, null) };
  const sections = butterworth((2 * bins) / power.length);
  const filtered = filterBothWays(sections, command);
  return {
    command: filtered,
    measured: filterBothWays(sections, measured),
    ...noise(periodogram(filtered, taper), floor, sections),
  };
}

// Share of noise in the power of the filtered command, and the sum of its bins times their number.
function noise(power, floor, sections) {
  const total = power.reduce((sum, value) => sum + value, 0);
  let share = 0, moment = 0;
  for (let k = 0; k < power.length; k += 1) {
    const passed = sections ? gainOf(sections, (Math.PI * k) / power.length) ** 4 : 1;
    share += (floor * passed) / total;
    moment += ((k + 1) * floor * passed) / total;
  }
  return { share, moment };
}

// Mean over sixteen bins, as numpy.convolve(mode="same") places them.
function runningMean(power) {
  const sums = new Float64Array(power.length + 1);
  for (let k = 0; k < power.length; k += 1) sums[k + 1] = sums[k] + power[k];
  return power.map((_, k) => (sums[Math.min(k + 8, power.length)] - sums[Math.max(k - 8, 0)]) / 16);
}

// Take the noise off the command's power in equations (1) and (4).
function withoutNoise(plain, band, step) {
  const signal = 1 - band.share;
  const frequency = (plain.frequency - band.moment / (band.command.length * step)) / signal;
  return { amplitude: plain.amplitude / signal, frequency, delay: -plain.phase / (2 * Math.PI * frequency) };
}

function centred(values) {
  const average = mean(values);
  return values.map((value) => value - average);
}
