// Other designs of a live page: pale bodies behind the drawing, dashed curves in the plots.

/** @import { Column, ResponseLines, ResponseView, View } from "./types.d.ts" */
/** @import { BodyData, MeshData } from "./scene_types.d.ts" */

import { list } from "./numbers.js";
import { payload } from "./payload.js";

/** Bodies and curves of a design.
 * @typedef {{ name: string, bodies: BodyData[], curves: (Column | undefined)[], lines: (ResponseLines | undefined)[], mesh?: MeshData }} Snapshot */

/** Lines of a view over the frequency. @param {View} view @returns {ResponseLines | undefined} */
const linesOf = (view) => (view.kind === "bode" || view.kind === "nyquist" ? { x: view.x, lines: view.lines.map((line) => ({ ...line })) } : undefined);

/** Bodies and curves that the payload contains at present. @param {string} name @returns {Snapshot} */
export function designSnapshot(name) {
  const { mesh } = payload.scene ?? {};
  const oscillates = payload.states?.kind === "frequency";  // its shapes are those of other frequencies
  return { name, lines: list(payload.views).map(linesOf), bodies: oscillates ? [] : list(payload.scene?.bodies).map((body) => ({ ...body, shapes: structuredClone(body.shapes) })), curves: list(payload.series).map(({ values }) => values), mesh: oscillates ? undefined : mesh && { ...mesh, rest: list(mesh.rest).slice() } };
}

export class Ghosts {
  constructor() {
    this.initial = designSnapshot("initial design");
    /** Whether the initial design is drawn while the present one differs from it. */
    this.compares = true;
    /** Designs that are drawn besides. @type {Snapshot[]} */
    this.kept = [];
  }

  /** Put the other designs into the payload. @param {boolean} changed whether the present design differs from the initial one */
  put(changed) {
    const others = [...changed && this.compares ? [this.initial] : [], ...this.kept], [dashed] = others;
    if (payload.scene) payload.scene.ghosts = others.flatMap(({ bodies, mesh }) => (mesh ? [{ mesh }] : bodies));
    list(payload.series).forEach((series, k) => { series.other = dashed?.curves[k]; });
    list(payload.views).forEach((view, k) => { if (linesOf(view)) /** @type {ResponseView} */ (view).other = dashed?.lines[k]; });
    payload.other = dashed?.name ?? "";
    return others;
  }
}
