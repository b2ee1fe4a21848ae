// What is known before the first sample: the sensor's offset, and whether the test begins at rest.
// As reliab/assessment/rebuilt_error/initial.py.

import { hann, realTransform } from "./fourier.js";
import { fitRows, gradient } from "./least_squares.js";

const FEWEST = 4;
const SIGNIFICANT = 4; // standard deviations
const STANDS = 0.1; // share of the offset's answer by which a command under it may stand off

// Offset [m] that the loop did not feel, its standard deviation, the amplitude of the first motion [m], and the
// offset under which the loop had come to rest before (`standing`).
export function examineStart(command, measured, step, structure, noise) {
  const n = command.length, { frequency, share } = structure, { white, slow } = noise;
  const peak = command.reduce((most, value) => Math.max(most, Math.abs(value - command[0])), 0);
  const top = command.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  const still = lengthOfRest(command, peak), rest = { atRest: true, amplitude: 0, standing: 0 };
  let offset = 0, motion = 0, place = 0;
  for (let i = 0; i < still; i += 1) {
    offset += (measured[i] - command[i]) / still;
    place += command[i] / still;
    motion = Math.max(motion, Math.abs(command[i] - command[0]));
  }
  const deviation = Math.hypot(white / Math.sqrt(still), slow), answered = share * Math.abs(offset);
  const stands = Math.abs(offset) > SIGNIFICANT * deviation && Math.abs(place + share * offset) <= STANDS * answered;
  const amplitude = firstAmplitude(stands ? command.map((value) => value + share * offset) : command, step, frequency);
  if (amplitude > (stands ? STANDS * answered : 1e-3 * Math.max(peak, top))) {
    const constant = constantOf(command, measured), known = Math.hypot(white / Math.sqrt(n), slow);
    const felt = answerOf(command, measured, constant, share) === "felt";
    return { ...rest, atRest: false, amplitude, offset: 0, deviation: felt ? known : Math.hypot(constant, known) };
  }
  if (stands) return { ...rest, offset: 0, deviation, standing: offset };
  if (Math.abs(offset) <= SIGNIFICANT * deviation + motion) return { ...rest, offset: 0, deviation };
  const turned = Math.min(2 * Math.PI * frequency * still * step, Math.PI);
  const answer = share * Math.abs(offset) * (1 - Math.cos(turned));
  if (answer > SIGNIFICANT * Math.max(motion, 2e-3 * peak)) return { ...rest, offset, deviation };
  const told = answerOf(command, measured, offset, share);
  if (told === "felt") return { ...rest, offset: 0, deviation };
  return { ...rest, offset, deviation: told === "open" ? Math.hypot(deviation, offset) : deviation };
}

function lengthOfRest(command, peak) {
  const moved = command.findIndex((value) => Math.abs(value - command[0]) > 2e-3 * peak);
  const still = moved < 0 ? command.length : moved;
  return Math.max(Math.min(still, Math.floor(0.25 * command.length)), FEWEST);
}

// Amplitude of the motion at the first sample [m], by the parabola through the first eight.
function firstAmplitude(command, step, frequency) {
  const first = command.slice(0, 2 * FEWEST), place = first.map((_, i) => i);
  const [, slope, begin] = fitRows([place.map((i) => i * i), place, place.map(() => 1)], first);
  return Math.hypot(begin, slope / (2 * Math.PI * frequency * step));
}

// What measured displacement and command differ by beside a gain and a delay [m].
function constantOf(command, measured) {
  const rows = [command, gradient(command), command.map(() => 1)];
  return fitRows(rows, measured.map((value, i) => value - command[i]), 1e-12)[2];
}

// Whether the loop felt an offset, by the place about which the command moved.
function answerOf(command, measured, offset, share) {
  const taper = hann(command.length, true), mass = taper.reduce((sum, value) => sum + value, 0);
  const tapered = command.map((value, i) => taper[i] * (value + share * (measured[i] - value)));
  const [re, im] = realTransform(tapered);
  let power = 0;
  for (let k = 2; k < 6; k += 1) power += (re[k] ** 2 + im[k] ** 2) / (4 * mass * mass);
  const average = re[0] / mass, ratio = 0.5 * ((average - share * offset) ** 2 - average ** 2);
  if (Math.abs(ratio) <= 3 * power) return "open";
  return ratio > 0 ? "felt" : "not felt";
}
