// Least squares of few unknowns, and a cubic spline.

// Coefficients of rows (each as long as the values) that fit the values best. Directions of the normal
// equations whose eigenvalue is below `cutoff` times the largest take no part, as in numpy.linalg.lstsq.
export function fitRows(rows, values, cutoff = 1e-15) {
  const dot = (p, q) => { let sum = 0; for (let i = 0; i < p.length; i += 1) sum += p[i] * q[i]; return sum; };
  const scale = rows.map((row) => row.reduce((most, value) => Math.max(most, Math.abs(value)), 0) || 1);
  const scaled = rows.map((row, k) => row.map((value) => value / scale[k]));
  const matrix = scaled.map((row) => scaled.map((column) => dot(row, column)));
  const right = scaled.map((row) => dot(row, values));
  const { eigenvalues, vectors } = jacobi(matrix);
  const limit = cutoff * Math.max(...eigenvalues.map(Math.abs));
  return scale.map((size, k) => eigenvalues.reduce((sum, eigenvalue, j) => {
    if (Math.abs(eigenvalue) <= limit) return sum;
    const share = right.reduce((total, value, i) => total + vectors[i][j] * value, 0);
    return sum + (vectors[k][j] * share) / eigenvalue;
  }, 0) / size);
}

// Eigenvalues and eigenvectors (in columns) of a symmetric matrix, by Jacobi's rotations.
export function jacobi(matrix) {
  const n = matrix.length, a = matrix.map((row) => [...row]);
  const v = a.map((_, i) => a.map((__, j) => Number(i === j)));
  for (let round = 0; round < 60; round += 1) {
    let off = 0, size = 0;
    for (let p = 0; p < n; p += 1) {
      size += a[p][p] ** 2;
      for (let q = p + 1; q < n; q += 1) off += a[p][q] ** 2;
    }
    if (off <= 1e-36 * size) break;
    for (let p = 0; p < n; p += 1) {
      for (let q = p + 1; q < n; q += 1) if (a[p][q] !== 0) rotate(a, v, p, q);
    }
  }
  return { eigenvalues: a.map((row, i) => row[i]), vectors: v };
}

function rotate(a, v, p, q) {
  const ratio = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const t = (ratio >= 0 ? 1 : -1) / (Math.abs(ratio) + Math.hypot(ratio, 1));
  const c = 1 / Math.hypot(t, 1), s = t * c;
  for (const row of a) [row[p], row[q]] = [c * row[p] - s * row[q], s * row[p] + c * row[q]];
  [a[p], a[q]] = [a[p].map((x, k) => c * x - s * a[q][k]), a[q].map((x, k) => s * a[p][k] + c * x)];
  for (const row of v) [row[p], row[q]] = [c * row[p] - s * row[q], s * row[p] + c * row[q]];
}

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

// Rate of change of samples per step: central differences, one-sided at both ends.
export function gradient(values) {
  const last = values.length - 1;
  return Float64Array.from(values, (value, i) => {
    if (i === 0) return values[1] - value;
    return i === last ? value - values[last - 1] : 0.5 * (values[i + 1] - values[i - 1]);
  });
}
