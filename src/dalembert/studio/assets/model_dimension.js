// Dimension of the mechanism of a file, as the program derives it.

/** @import { Document } from "./types.d.ts" */

/** Whether a file describes a spatial mechanism: by its dimension, or three components of gravity. @param {Document | null} document */
export function isSpatialMechanism(document) {
  const { kind, gravity, dimension } = /** @type {any} */ (document ?? {});
  return kind !== "structure" && (dimension === undefined ? Array.isArray(gravity) && gravity.length === 3 && gravity.every((part) => typeof part !== "object") : dimension === 3);
}
