// A sensor that reads in steps: how large they are, and what noise they make, as reliab/assessment/rebuilt_error/rounding.py.

const LAYINGS = 8;

// Step [m] in which a sensor reads; zero where no steps are seen.
export function roundingStep(measured) {
  const ordered = Float64Array.from(measured).sort(), levels = ordered.filter((value, i) => i === 0 || value > ordered[i - 1]);
  const range = levels[levels.length - 1] - levels[0];
  let least = Infinity, many = 0;
  for (let i = 1; i < levels.length; i += 1) {
    const distance = levels[i] - levels[i - 1];
    if (distance > 1e-9 * range) { many += 1; least = Math.min(least, distance); }
  }
  if (!(many > 0 && many <= 0.125 * measured.length)) return 0;
  const count = Math.max(Math.round(range / least), 1), step = range / count;
  const near = 1e-3 * Math.max(1, count * 1e-9);
  const whole = levels.every((level) => { const place = (level - levels[0]) / step; return Math.abs(place - Math.round(place)) < near; });
  return whole ? step : 0;
}

// Noise [m] of rounding a motion on shifted grids of steps.
export function* roundedDifferently(motion, step) {
  for (let k = 0; k < LAYINGS; k += 1) {
    const laid = (k + 0.5) / LAYINGS;
    yield motion.map((value) => { const shifted = value / step + laid; return step * (Math.round(shifted) - shifted); });
  }
}
