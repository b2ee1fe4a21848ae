// Discrete Fourier transforms of any length, with the signs and scales of numpy.fft.

// Real and imaginary parts of the transform of a real history at frequencies 0 ... n/2.
export function realTransform(values, points = values.length) {
  const real = new Float64Array(points), imaginary = new Float64Array(points);
  real.set(values);
  if ((points & (points - 1)) === 0) radixTwo(real, imaginary, -1);
  else chirp(real, imaginary);
  const count = (points >> 1) + 1;
  return [real.subarray(0, count), imaginary.subarray(0, count)];
}

// Squared magnitudes of the transform of a tapered history without its mean, at frequencies above zero.
export function periodogram(values, taper) {
  const average = mean(values);
  const [real, imaginary] = realTransform(values.map((value, i) => (value - average) * taper[i]));
  return real.map((value, i) => value * value + imaginary[i] * imaginary[i]).subarray(1);
}

// Hann taper of n samples, as a period of it.
export function hann(n) {
  return Float64Array.from({ length: n }, (_, i) => 0.5 - 0.5 * Math.cos((2 * Math.PI * i) / n));
}

export function mean(values) {
  let sum = 0;
  for (const value of values) sum += value;
  return sum / values.length;
}

export function median(values) {
  const ordered = Float64Array.from(values).sort(), half = ordered.length >> 1;
  return ordered.length % 2 ? ordered[half] : 0.5 * (ordered[half - 1] + ordered[half]);
}

// Quantile with linear interpolation between values, as numpy's.
export function quantileOf(values, share) {
  const ordered = Float64Array.from(values).sort(), place = share * (ordered.length - 1);
  const below = Math.floor(place), above = Math.min(below + 1, ordered.length - 1);
  return ordered[below] + (place - below) * (ordered[above] - ordered[below]);
}

export function largest(values) {
  let most = 0;
  for (const value of values) most = Math.max(most, Math.abs(value));
  return most;
}

// Transform in place a length that is a power of two; `sign` is -1 forwards and 1 backwards (without 1/n).
function radixTwo(real, imaginary, sign) {
  const n = real.length;
  for (let i = 1, j = 0; i < n; i += 1) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [real[i], real[j]] = [real[j], real[i]];
      [imaginary[i], imaginary[j]] = [imaginary[j], imaginary[i]];
    }
  }
  const [cosine, sine] = [Math.cos, Math.sin].map((turn) => Float64Array.from({ length: n >> 1 }, (_, k) => turn((2 * Math.PI * k) / n)));
  for (let length = 2; length <= n; length *= 2) {
    const half = length >> 1, stride = n / length;
    for (let start = 0; start < n; start += length) {
      for (let k = 0; k < half; k += 1) {
        const p = start + k, q = p + half, c = cosine[k * stride], s = sign * sine[k * stride];
        const re = real[q] * c - imaginary[q] * s, im = real[q] * s + imaginary[q] * c;
        real[q] = real[p] - re; imaginary[q] = imaginary[p] - im;
        real[p] += re; imaginary[p] += im;
      }
    }
  }
}

// Bluestein's algorithm: a transform of any length as a convolution of a length that is a power of two.
function chirp(real, imaginary) {
  const n = real.length;
  let points = 1;
  while (points < 2 * n - 1) points *= 2;
  const [c, s] = [Math.cos, Math.sin].map((turn) => Float64Array.from({ length: n }, (_, k) => turn((Math.PI * ((k * k) % (2 * n))) / n)));
  const [re, im, filterRe, filterIm] = Array.from({ length: 4 }, () => new Float64Array(points));
  for (let k = 0; k < n; k += 1) {
    re[k] = real[k] * c[k] + imaginary[k] * s[k];
    im[k] = imaginary[k] * c[k] - real[k] * s[k];
    filterRe[k] = filterRe[(points - k) % points] = c[k];
    filterIm[k] = filterIm[(points - k) % points] = s[k];
  }
  radixTwo(re, im, -1);
  radixTwo(filterRe, filterIm, -1);
  for (let k = 0; k < points; k += 1) {
    const product = re[k] * filterRe[k] - im[k] * filterIm[k];
    im[k] = re[k] * filterIm[k] + im[k] * filterRe[k];
    re[k] = product;
  }
  radixTwo(re, im, 1);
  for (let k = 0; k < n; k += 1) {
    real[k] = (re[k] * c[k] + im[k] * s[k]) / points;
    imaginary[k] = (im[k] * c[k] - re[k] * s[k]) / points;
  }
}
