// Responses of live pages: reductions of the samples of a row, and their derivatives.

/** @import { LiveResponse } from "./types.d.ts" */

/** Weights of an integral over the samples: straight lines between them. @param {ArrayLike<number>} times */
function integral(times) {
  const weights = new Float64Array(times.length);
  for (let i = 1; i < times.length; i++) {
    const half = (times[i] - times[i - 1]) / 2;
    weights[i - 1] += half;
    weights[i] += half;
  }
  return weights;
}

/** Index of the largest of `sign` times the samples. @param {ArrayLike<number>} samples @param {number} sign */
function peak(samples, sign) {
  let most = 0;
  for (let i = 1; i < samples.length; i++) if (sign * samples[i] > sign * samples[most]) most = i;
  return most;
}

/** @param {LiveResponse} response @param {ArrayLike<number>} times @param {Float64Array} samples */
export function valueOf({ kind }, times, samples) {
  const n = samples.length;
  if (kind === "maximum" || kind === "minimum") return samples[peak(samples, kind === "maximum" ? 1 : -1)];
  if (kind === "final") return samples[n - 1];
  const weights = integral(times), span = kind === "integral" ? 1 : times[n - 1] - times[0];
  let sum = 0;
  for (let i = 0; i < n; i++) sum += weights[i] * (kind === "rms" ? samples[i] ** 2 : samples[i]);
  return kind === "rms" ? Math.sqrt(sum / span) : sum / span;
}

/** Derivatives of the value by the samples. @param {LiveResponse} response @param {ArrayLike<number>} times @param {Float64Array} samples */
export function samplesWeights(response, times, samples) {
  const { kind } = response, n = samples.length, weights = new Float64Array(n);
  if (kind === "maximum" || kind === "minimum") weights[peak(samples, kind === "maximum" ? 1 : -1)] = 1;
  else if (kind === "final") weights[n - 1] = 1;
  else {
    const span = kind === "integral" ? 1 : times[n - 1] - times[0], size = kind === "rms" ? valueOf(response, times, samples) : 1;
    integral(times).forEach((w, i) => { weights[i] = (w / span) * (kind === "rms" ? samples[i] / (size || 1) : 1); });
  }
  return weights;
}
