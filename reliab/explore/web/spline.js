// A cubic spline.

// Function that interpolates samples at places 0, 1, 2 ... by a cubic spline ("not a knot" at its ends).
export function spline(values) {
  const n = values.length, slope = splineSlopes(values);
  return (place) => {
    const i = Math.min(Math.max(Math.floor(place), 0), n - 2), u = place - i;
    const rise = values[i + 1] - values[i];
    const bend = slope[i] + slope[i + 1] - 2 * rise;
    return values[i] + u * (slope[i] + u * (rise - slope[i] - bend + u * bend));
  };
}

function splineSlopes(values) {
  const n = values.length, last = n - 1;
  const rise = Float64Array.from({ length: last }, (_, i) => values[i + 1] - values[i]);
  const above = new Float64Array(n), right = new Float64Array(n), slope = new Float64Array(n);
  above[0] = 2;
  right[0] = 0.5 * (5 * rise[0] + rise[1]);
  for (let i = 1; i < last; i += 1) {
    const pivot = 4 - above[i - 1];
    above[i] = 1 / pivot;
    right[i] = (3 * (rise[i - 1] + rise[i]) - right[i - 1]) / pivot;
  }
  const end = 0.5 * (rise[last - 2] + 5 * rise[last - 1]);
  slope[last] = (end - 2 * right[last - 1]) / (1 - 2 * above[last - 1]);
  for (let i = last - 1; i >= 0; i -= 1) slope[i] = right[i] - above[i] * slope[i + 1];
  return slope;
}
