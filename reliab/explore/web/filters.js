// The low-pass filter of the Python package: Butterworth, forwards and backwards.

// Sections of a Butterworth filter of fourth order; `edge` is the share of half the sampling rate.
export function butterworth(edge) {
  const warped = 4 * Math.tan((Math.PI * edge) / 2); // bilinear transform at a rate of 2
  return [1, 3].map((k) => {
    const angle = Math.PI * (0.5 + k / 8), re = warped * Math.cos(angle), im = warped * Math.sin(angle);
    const below = (4 - re) ** 2 + im * im; // |4 - pole|^2
    const gain = (re * re + im * im) / below;
    return { b: [gain, 2 * gain, gain], a: [1, (-2 * (16 - re * re - im * im)) / below, ((4 + re) ** 2 + im * im) / below] };
  });
}

// Gain of the sections at a frequency [rad per sample].
export function gainOf(sections, angle) {
  return sections.reduce((gain, { b, a }) => gain * (size(b, angle) / size(a, angle)), 1);
}

function size(coefficients, angle) {
  const part = (turn) => coefficients.reduce((sum, value, k) => sum + value * turn(k * angle), 0);
  return Math.hypot(part(Math.cos), part(Math.sin));
}

// Filter a history forwards and backwards, its ends continued point-symmetrically, as scipy's sosfiltfilt.
export function filterBothWays(sections, values) {
  const n = values.length, reach = 3 * (2 * sections.length + 1);
  const long = new Float64Array(n + 2 * reach);
  long.set(values, reach);
  for (let i = 0; i < reach; i += 1) {
    long[i] = 2 * values[0] - values[reach - i];
    long[n + reach + i] = 2 * values[n - 1] - values[n - 2 - i];
  }
  const forwards = cascade(sections, long).reverse();
  return cascade(sections, forwards).reverse().slice(reach, reach + n);
}

// Filter by one section after the other, each begun as if the first value had always stood.
function cascade(sections, values) {
  let history = Float64Array.from(values);
  for (const { b, a } of sections) {
    const steady = (b[0] + b[1] + b[2]) / (a[0] + a[1] + a[2]);
    let second = history[0] * (b[2] - a[2] * steady);
    let first = history[0] * (b[1] - a[1] * steady) + second;
    history = history.map((value) => {
      const out = b[0] * value + first;
      first = b[1] * value - a[1] * out + second;
      second = b[2] * value - a[2] * out;
      return out;
    });
  }
  return history;
}
