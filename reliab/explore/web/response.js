// What the displacement of a test says of the structure's response, as reliab/tracking/boundary/first_order.py computes it.

// Effective duration [s], frequency of the error over that of the structure, and error for an amplitude error as
// large as the damping ratio.
export function responseMeasures(displacement, step, { frequency, dampingRatio, share }) {
  const w = 2 * Math.PI * frequency, length = (displacement.length - 1) * step;
  const filtered = oscillator(displacement, step, w, dampingRatio);
  const ofGain = displacement.map((value, i) => value - share * w * w * filtered[i]);
  const peak = displacement.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  const [energy, gain, delay] = [displacement, ofGain, rate(ofGain, step)].map((history) => squares(history, step) / peak ** 2);
  return {
    effective_duration: energy,
    frequency_ratio: Math.sqrt(delay / gain) / w,
    sensitivity: dampingRatio * Math.sqrt(gain / length),
  };
}

// y of y'' + 2 xi w y' + w^2 y = u from rest, exact where u is straight between samples.
function oscillator(u, step, w, xi) {
  const damped = w * Math.sqrt(1 - xi * xi), decay = Math.exp(-xi * w * step);
  const cosine = decay * Math.cos(damped * step), sine = (decay * Math.sin(damped * step)) / damped;
  const result = new Float64Array(u.length);
  let y = 0, velocity = 0;
  for (let i = 1; i < u.length; i += 1) {
    const slope = (u[i] - u[i - 1]) / step, lag = (2 * xi * slope) / w ** 3;
    const offset = y - u[i - 1] / w ** 2 + lag, speed = velocity - slope / w ** 2;
    y = offset * (cosine + xi * w * sine) + speed * sine + u[i] / w ** 2 - lag;
    velocity = speed * (cosine - xi * w * sine) - offset * w ** 2 * sine + slope / w ** 2;
    result[i] = y;
  }
  return result;
}

// Rate of change, central between the ends.
function rate(values, step) {
  const last = values.length - 1;
  return values.map((_, i) => {
    const before = Math.max(i - 1, 0), after = Math.min(i + 1, last);
    return (values[after] - values[before]) / ((after - before) * step);
  });
}

// Integral of the square, by trapezia.
function squares(values, step) {
  const ends = values[0] ** 2 + values[values.length - 1] ** 2;
  return step * (values.reduce((sum, value) => sum + value * value, 0) - ends / 2);
}
