// The motions' ellipses, as the page carries them: 16-bit codes, unpacked, and interpolated as Python does.

// Unpack what reliab/explore/page.py packed; asynchronous, since the browser inflates it.
export async function unpack(packed) {
  const signs = atob(packed.codes), bytes = new Uint8Array(signs.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = signs.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const half = planes.length / 2, codes = new Uint16Array(half);
  for (let i = 0; i < half; i += 1) codes[i] = planes[i] | (planes[half + i] << 8);
  const size = half / packed.windows.length;
  for (let i = size; i < half; i += 1) codes[i] = (codes[i] + codes[i % size]) & 0xffff;
  return { ...packed, codes, size };
}

const WORD = new DataView(new ArrayBuffer(4));

// Natural logarithm of the parameter that stands at a place of a window; NaN where a motion has no ellipse.
function logarithmAt({ codes, offsets, size }, window, place) {
  const code = codes[window * size + place];
  WORD.setUint32(0, (code + offsets[place < size / 2 ? 0 : 1]) * 4096);
  return code === 0 ? NaN : Math.log(WORD.getFloat32(0));
}

// Logarithms of a and of b of all motions at a node of the grid, at any threshold, share and length of test.
export function motionsAt(ellipses, { metric, side, threshold, duration }, row, column) {
  const { thresholds, frequencies, dampingRatios, motions } = ellipses;
  const [below, above, weight] = neighbours(thresholds, threshold);
  const windows = windowsFor(ellipses, duration);
  const metricPlace = ellipses.metrics.indexOf(metric), sidePlace = ellipses.sides.indexOf(side);
  const cells = frequencies.length * dampingRatios.length, half = ellipses.size / 2;
  const start = (t) => (((t * ellipses.metrics.length + metricPlace) * ellipses.sides.length + sidePlace) * cells +
    row * dampingRatios.length + column) * motions.length;
  const atThreshold = (t, i) => mix(windows.weight,
    () => logarithmAt(ellipses, windows.below, start(t) + i),
    () => logarithmAt(ellipses, windows.above, start(t) + i));
  const logs = [0, half].map((shift) => Float64Array.from(motions, (_, i) =>
    mix(weight, () => atThreshold(below, shift + i), () => atThreshold(above, shift + i))));
  return { logA: logs[0], logB: logs[1] };
}

// Whether an actuator at rest keeps the threshold at a node under more than one motion in twenty, so that A and d
// say nothing of a test's error.
export function isMeaningless(ellipses, { metric, threshold, duration }, row, column) {
  const table = ellipses.meaningless[windowsFor(ellipses, duration).above];
  return table !== null && threshold >= table[ellipses.metrics.indexOf(metric)][row][column];
}

// Weighted mean of two values; the second is not computed where its weight is zero.
function mix(weight, first, second) {
  return weight === 0 ? first() : (1 - weight) * first() + weight * second();
}

// Places of the values on either side of a value, and the weight of the second in the logarithm.
export function neighbours(values, wanted) {
  const last = values.length - 1, same = (value) => Math.abs(value / wanted - 1) < 1e-9;
  const equal = values.findIndex(same);
  if (equal >= 0) return [equal, equal, 0];
  if (wanted <= values[0]) return [0, 0, 0];
  if (wanted >= values[last]) return [last, last, 0];
  const above = values.findIndex((value) => value > wanted);
  const weight = Math.log(wanted / values[above - 1]) / Math.log(values[above] / values[above - 1]);
  return [above - 1, above, weight];
}

// Windows between which ellipses are interpolated for tests of a length [s]; null stands for whole records.
function windowsFor({ windows }, duration) {
  const lengths = windows.map(Number).filter((length) => length > 0).sort((p, q) => p - q);
  const place = (length) => windows.indexOf(String(length));
  if (duration === null || lengths.length === 0) return { below: 0, above: 0, weight: 0 };
  const above = lengths.find((length) => length >= duration) ?? lengths[lengths.length - 1];
  const below = [...lengths].reverse().find((length) => length <= duration) ?? lengths[0];
  const weight = below === above ? 0 : Math.log(duration / below) / Math.log(above / below);
  return { below: place(below), above: place(above), weight };
}
