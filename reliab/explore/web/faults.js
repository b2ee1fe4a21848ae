// Faults of a recording: spikes, a copied channel, a channel that stands still, an offset, a drift.
// As reliab/recordings/spikes.py and faults.py.

import { largest, mean, quantileOf } from "./fourier.js";
import { fitRows, spline } from "./least_squares.js";
import { moved } from "./tracking.js";

// Bridge the spikes of a history by straight lines; `count` says how many samples they held.
export function withoutSpikes(values) {
  const marked = spikes(values), count = marked.reduce((sum, mark) => sum + mark, 0);
  if (count === 0) return { values, count };
  const bridged = Float64Array.from(values);
  for (let i = 0; i < values.length; i += 1) {
    if (!marked[i]) continue;
    let left = i, right = i;
    while (left >= 0 && marked[left]) left -= 1;
    while (right < values.length && marked[right]) right += 1;
    if (left < 0) bridged[i] = values[right];
    else if (right === values.length) bridged[i] = values[left];
    else bridged[i] = values[left] + ((values[right] - values[left]) * (i - left)) / (right - left);
  }
  return { values: bridged, count };
}

// Mark stretches of at most eight samples into which a jump leads, and out of which another leads back.
function spikes(values) {
  const steps = Float64Array.from({ length: values.length - 1 }, (_, i) => values[i + 1] - values[i]);
  const size = steps.map(Math.abs), marked = new Uint8Array(values.length);
  const least = Math.max(4 * quantileOf(size, 0.995), 0.01 * quantileOf(values.map(Math.abs), 0.995));
  const jumps = [];
  size.forEach((value, i) => { if (value > least) jumps.push(i); });
  jumps.forEach((begin, place) => {
    for (const end of jumps.slice(place + 1)) {
      if (end - begin > 8) break;
      const remaining = Math.abs(values[end + 1] - values[begin]);
      if (remaining <= 0.5 * size[begin] && steps[begin] * steps[end] < 0) {
        marked.fill(1, begin + 1, end + 1);
        break;
      }
    }
  });
  return marked;
}

// Mean and rise of the command, and of the measured displacement's residual after gain and delay; null for a test
// that is too short to tell.
export function slowLines(command, measured, step, tracking) {
  const n = command.length, blocks = Math.min(Math.floor(((n - 1) * step * tracking.frequency) / 2), 40);
  if (blocks < 6) return null;
  const expected = moved(spline(command), n, tracking.amplitude, tracking.delay / step);
  const line = lineOf(measured.map((value, i) => value - expected[i]), blocks);
  return { line, answered: lineOf(command, blocks), peak: largest(command) };
}

// Offset and drift that the recording shows: what each added to the measured displacement, and whether the
// loop felt it (null where the command does not tell).
export function slowFaults(lines, measured, { threshold, share }) {
  if (lines === null) return [];
  const { line, answered, peak } = lines, n = measured.length, least = 0.1 * threshold * peak;
  return ["offset", "drift"].flatMap((kind) => {
    const [size, error] = line[kind];
    if (Math.abs(size) < least || Math.abs(size) < 4 * error) return [];
    const shape = (i) => (kind === "offset" ? 1 : i / (n - 1) - 0.5);
    const added = measured.map((_, i) => size * shape(i));
    return [{ kind, size: size / peak, added, felt: feltBy(answered[kind], share * size) }];
  });
}

// Mean and rise over the length of a history, each with its standard error, from the means of blocks.
function lineOf(values, blocks) {
  const n = values.length, base = Math.floor(n / blocks), longer = n % blocks, means = [];
  for (let k = 0, start = 0; k < blocks; k += 1) {
    const end = start + base + (k < longer ? 1 : 0);
    means.push(mean(values.subarray(start, end)));
    start = end;
  }
  const places = means.map((_, k) => (k + 0.5) / blocks - 0.5);
  const [offset, drift] = fitRows([means.map(() => 1), places], means);
  const scatter = means.reduce((sum, value, k) => sum + (value - offset - drift * places[k]) ** 2, 0) / (blocks - 2);
  const square = places.reduce((sum, place) => sum + place * place, 0);
  return { offset: [offset, Math.sqrt(scatter / blocks)], drift: [drift, Math.sqrt(scatter / square)] };
}

function feltBy([size, error], force) {
  const answer = -size / force, spread = (2 * error) / Math.abs(force);
  if (spread < 0.3 && answer >= 0.7 && answer <= 1.3) return true;
  return spread < 0.3 && answer >= -0.3 && answer <= 0.3 ? false : null;
}

// Sentences about channels that are copies of one another or stand still while the other moves.
export function brokenChannels(command, measured) {
  const peak = largest(command), sentences = [];
  if (largest(command.map((value, i) => measured[i] - value)) <= 1e-6 * peak) {
    sentences.push("Command and measured displacement are identical, which no sensor reading is: was one channel exported twice?");
  }
  for (const [name, history, other] of [["measured displacement", measured, command], ["command", command, measured]]) {
    if (standsStill(history, other, peak)) {
      sentences.push(`The ${name} stands still while the other channel moves.`);
    }
  }
  return sentences;
}

function standsStill(history, other, peak) {
  let low = other[0], high = other[0];
  for (let i = 1; i < history.length; i += 1) {
    if (Math.abs(history[i] - history[i - 1]) > 1e-9 * peak) low = high = other[i];
    low = Math.min(low, other[i]);
    high = Math.max(high, other[i]);
    if (high - low > 0.05 * peak) return true;
  }
  return false;
}

// Why a recording cannot be judged; an empty string where it can.
export function refusal(command, measured) {
  const product = (p, q) => p.reduce((sum, value, i) => sum + value * q[i], 0);
  const [x, y] = [command, measured].map((values) => { const m = mean(values); return values.map((value) => value - m); });
  const sizes = [Math.sqrt(product(x, x)), Math.sqrt(product(y, y))];
  if (!(sizes[0] > 0 && sizes[1] > 0)) return "Command and measured displacement must move.";
  const correlation = product(x, y) / (sizes[0] * sizes[1]);
  if (correlation < -0.8) return "The measured displacement must have the command's sign: reverse one channel.";
  const ratio = sizes[1] / sizes[0];
  const units = [1000, 100, 10, 39.3701, 25.4, 2.54, 3.28084, 12].flatMap((unit) => [unit, 1 / unit]);
  if (units.some((unit) => Math.abs(ratio / unit - 1) < 0.1)) {
    return `The measured displacement is ${ratio.toPrecision(3)} times the command: are they in one unit?`;
  }
  return correlation < 0.2 ? "The measured displacement does not follow the command." : "";
}
