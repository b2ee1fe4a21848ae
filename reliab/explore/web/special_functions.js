// Functions of probability that JavaScript lacks: normal, Owen's T and Student's t.

const HALF_LOG_TWO_PI = 0.5 * Math.log(2 * Math.PI);
const CONTINUED = 400; // terms of a series or continued fraction
const NODES = legendreNodes(48);

// Probability that a standard normal variable is below x.
export function normalCumulative(x) {
  return x < 0 ? normalTail(-x) : 1 - normalTail(x);
}

// Probability that a standard normal variable is above x >= 0.
function normalTail(x) {
  if (x > 38) return 0;
  const density = Math.exp(-0.5 * x * x - HALF_LOG_TWO_PI);
  if (x < 3) {
    let term = x, sum = x;
    for (let n = 1; Math.abs(term) > 1e-17 * sum && n < CONTINUED; n += 1) {
      term *= (x * x) / (2 * n + 1);
      sum += term;
    }
    return 0.5 - density * sum;
  }
  let fraction = 0;
  for (let n = 80; n > 0; n -= 1) fraction = n / (x + fraction);
  return density / (x + fraction);
}

// Normal variable below which lies the probability p in (0, 1), found by Newton's and Halley's steps.
export function normalQuantile(p) {
  if (p > 0.5) return -normalQuantile(1 - p);
  const t = Math.sqrt(-2 * Math.log(p));
  let x = -(t - (2.515517 + 0.802853 * t + 0.010328 * t * t) /
    (1 + 1.432788 * t + 0.189269 * t * t + 0.001308 * t * t * t));
  for (let step = 0; step < 4; step += 1) {
    const excess = (normalCumulative(x) - p) * Math.exp(0.5 * x * x + HALF_LOG_TWO_PI);
    if (!Number.isFinite(excess)) break;
    x -= excess / (1 + 0.5 * x * excess);
  }
  return x;
}

// Owen's T(h, a) = 1/(2 pi) times the integral of exp(-h^2 (1 + x^2)/2)/(1 + x^2) from 0 to a.
export function owensT(h, a) {
  if (a < 0) return -owensT(h, -a);
  if (a > 1) {
    const ha = Math.abs(h) * a, p = normalCumulative(Math.abs(h)), q = normalCumulative(ha);
    return 0.5 * (p + q) - p * q - owensT(ha, 1 / a);
  }
  let sum = 0;
  for (const [node, weight] of NODES) {
    const x = 0.5 * a * (1 + node);
    sum += weight * Math.exp(-0.5 * h * h * (1 + x * x)) / (1 + x * x);
  }
  return (0.5 * a * sum) / (2 * Math.PI);
}

// Probability that Student's t with so many degrees of freedom, any positive number, is below x.
export function studentCumulative(x, degrees) {
  const tail = 0.5 * betaShare(degrees / (degrees + x * x), 0.5 * degrees, 0.5);
  return x > 0 ? 1 - tail : tail;
}

// Regularised incomplete beta function, by its continued fraction (Lentz).
function betaShare(x, p, q) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  if (x > (p + 1) / (p + q + 2)) return 1 - betaShare(1 - x, q, p);
  const front = Math.exp(logGamma(p + q) - logGamma(p) - logGamma(q) +
    p * Math.log(x) + q * Math.log1p(-x)) / p;
  let c = 1, d = 1 / (1 - ((p + q) * x) / (p + 1)), result = d;
  for (let m = 1; m < CONTINUED; m += 1) {
    const even = (m * (q - m) * x) / ((p + 2 * m - 1) * (p + 2 * m));
    d = 1 / (1 + even * d); c = 1 + even / c; result *= c * d;
    const odd = -((p + m) * (p + q + m) * x) / ((p + 2 * m) * (p + 2 * m + 1));
    d = 1 / (1 + odd * d); c = 1 + odd / c; result *= c * d;
    if (Math.abs(c * d - 1) < 1e-16) break;
  }
  return front * result;
}

// Logarithm of the gamma function, by Stirling's series beyond 10.
function logGamma(x) {
  let shift = 0, z = x;
  for (; z < 10; z += 1) shift += Math.log(z);
  const r = 1 / (z * z);
  const series = (1 / 12 - r * (1 / 360 - r * (1 / 1260 - r * (1 / 1680 - r / 1188)))) / z;
  return (z - 0.5) * Math.log(z) - z + HALF_LOG_TWO_PI + series - shift;
}

// Nodes and weights of the Gauss-Legendre rule on (-1, 1).
function legendreNodes(count) {
  const rule = [];
  for (let i = 0; i < count; i += 1) {
    let x = Math.cos((Math.PI * (i + 0.75)) / (count + 0.5)), slope = 1;
    for (let step = 0; step < 8; step += 1) {
      let before = 1, value = x;
      for (let n = 2; n <= count; n += 1) {
        [before, value] = [value, ((2 * n - 1) * x * value - (n - 1) * before) / n];
      }
      slope = (count * (x * value - before)) / (x * x - 1);
      x -= value / slope;
    }
    rule.push([x, 2 / ((1 - x * x) * slope * slope)]);
  }
  return rule;
}
