// What is taken away before A and d are computed (spikes, a drift), and recordings of which they say nothing.
// As reliab/recordings/spikes.py and reliab/assessment/faults.py.

import { largest, mean, quantileOf } from "./fourier.js";
import { spline } from "./spline.js";
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

// Drift of the measured displacement beside gain and delay: what it adds [m], and its size over the command's peak;
// none where it is not significant, or the test is too short to tell.
export function drift(command, measured, step, tracking) {
  const n = command.length, blocks = Math.min(Math.floor(((n - 1) * step * tracking.frequency) / 2), 40);
  if (blocks < 6) return { added: null, size: 0 };
  const expected = moved(spline(command), n, tracking.amplitude, tracking.delay / step);
  const means = blockMeans(measured.map((value, i) => value - expected[i]), blocks), offset = mean(means);
  const places = means.map((_, k) => (k + 0.5) / blocks - 0.5), sum = (terms) => terms.reduce((total, term) => total + term, 0);
  const square = sum(places.map((place) => place * place));
  const rise = sum(places.map((place, k) => place * means[k])) / square;
  const scatter = sum(means.map((value, k) => (value - offset - rise * places[k]) ** 2)) / (blocks - 2);
  if (Math.abs(rise) < 4 * Math.sqrt(scatter / square)) return { added: null, size: 0 };
  return { added: measured.map((_, i) => rise * (i / (n - 1) - 0.5)), size: Math.abs(rise) / largest(command) };
}

// Means of blocks of nearly equal length, the longer ones first.
function blockMeans(values, blocks) {
  const n = values.length, base = Math.floor(n / blocks), longer = n % blocks;
  const start = (k) => k * base + Math.min(k, longer);
  return Array.from({ length: blocks }, (_, k) => mean(values.subarray(start(k), start(k + 1))));
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

// Why A and d say nothing of a recording; an empty string where they do.
export function refusal(command, measured) {
  const peak = largest(command);
  const product = (p, q) => p.reduce((sum, value, i) => sum + value * q[i], 0);
  const [x, y] = [command, measured].map((values) => { const m = mean(values); return values.map((value) => value - m); });
  const sizes = [Math.sqrt(product(x, x)), Math.sqrt(product(y, y))];
  if (!(sizes[0] > 0 && sizes[1] > 0)) return "Command and measured displacement must move.";
  if (largest(command.map((value, i) => measured[i] - value)) <= 1e-6 * peak) {
    return "Command and measured displacement are identical, which sensor readings never are: was one channel exported twice?";
  }
  for (const [name, history, other] of [["measured displacement", measured, command], ["command", command, measured]]) {
    if (standsStill(history, other, peak)) return `The ${name} stands still while the other channel moves: use reliab assess.`;
  }
  const correlation = product(x, y) / (sizes[0] * sizes[1]);
  if (correlation < -0.8) return "The measured displacement must have the command's sign: reverse one channel.";
  const ratio = sizes[1] / sizes[0];
  const units = [1000, 100, 10, 39.3701, 25.4, 2.54, 3.28084, 12].flatMap((unit) => [unit, 1 / unit]);
  if (units.some((unit) => Math.abs(ratio / unit - 1) < 0.1)) {
    return `The measured displacement is ${ratio.toPrecision(3)} times the command: are they in the same unit?`;
  }
  return correlation < 0.2 ? "The measured displacement does not follow the command." : "";
}
