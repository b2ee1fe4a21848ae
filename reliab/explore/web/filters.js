// The two low-pass filters of the Python package: Butterworth forwards and backwards, and Kaiser's window.

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

// Coefficients of a symmetric low-pass filter of 60 dB; `edge` is the share of half the sampling rate.
export function kaiserLowPass(edge) {
  const ripple = 60, width = 0.6 * edge;
  const beta = 0.1102 * (ripple - 8.7);
  const taps = Math.ceil((ripple - 7.95) / (2.285 * Math.PI * width) + 1) | 1, centre = (taps - 1) / 2;
  const taper = (i) => besselZero(beta * Math.sqrt(Math.max(1 - ((i - centre) / centre) ** 2, 0))) / besselZero(beta);
  const sinc = (x) => (x === 0 ? 1 : Math.sin(Math.PI * x) / (Math.PI * x));
  const raw = Float64Array.from({ length: taps }, (_, i) => edge * sinc(edge * (i - centre)) * taper(i));
  const sum = raw.reduce((total, value) => total + value, 0);
  return raw.map((value) => value / sum);
}

// Modified Bessel function of the first kind, order zero.
function besselZero(x) {
  let term = 1, sum = 1;
  for (let k = 1; term > 1e-17 * sum; k += 1) {
    term *= (x / (2 * k)) ** 2;
    sum += term;
  }
  return sum;
}

// Convolve with a symmetric filter without delay. Beyond its ends the history is continued point-symmetrically
// about the end of the straight line through the nearest samples. Each `every`-th sample is returned.
export function smooth(filter, values, every = 1) {
  const n = values.length, reach = filter.length >> 1;
  if (reach === 0 || reach > 0.2 * n) return every === 1 ? values : values.filter((_, i) => i % every === 0);
  const long = new Float64Array(n + 2 * reach);
  long.set(values, reach);
  const before = 2 * endOfLine(values.slice(0, reach + 1).reverse());
  const after = 2 * endOfLine(values.slice(n - reach - 1));
  for (let i = 0; i < reach; i += 1) {
    long[i] = before - values[reach - i];
    long[n + reach + i] = after - values[n - 2 - i];
  }
  return Float64Array.from({ length: Math.ceil(n / every) }, (_, place) => {
    const i = place * every;
    let sum = filter[reach] * long[i + reach];
    for (let k = 0; k < reach; k += 1) sum += filter[k] * (long[i + k] + long[i + 2 * reach - k]);
    return sum;
  });
}

// Last value of the straight line of least squares through values.
function endOfLine(values) {
  const n = values.length, half = 0.5 * (n - 1);
  let sum = 0, moment = 0, square = 0;
  values.forEach((value, i) => { sum += value; moment += (i - half) * value; square += (i - half) ** 2; });
  return sum / n + (moment / square) * half;
}

// Squared gain of a symmetric filter at `count` angles [rad per sample].
export function gainOfFilter(filter, angle, count) {
  const reach = filter.length >> 1;
  return Float64Array.from({ length: count }, (_, k) => {
    if (reach === 0) return 1;
    const c = 2 * Math.cos(angle(k));
    let next = 0, second = 0; // Clenshaw's sum of the cosines
    for (let j = reach; j > 0; j -= 1) [next, second] = [2 * filter[reach + j] + c * next - second, next];
    return (filter[reach] + 0.5 * c * next - second) ** 2;
  });
}
