// Parts of the page of a structure: choices of state and field, scale of the displacements, legend, tables.

/** @import { Mesh } from "./mesh.js" */
/** @import { Motion } from "./motion.js" */

import { byId } from "./dom.js";
import { fieldLegend, meshChoosers } from "./mesh_controls.js";
import { scaleSlider } from "./state_controls.js";
import { structureTables } from "./structure_tables.js";

/** Fill the page of a structure. @param {Motion} motion @param {Mesh} mesh */
export function buildStructure(motion, mesh) {
  byId("stage").setAttribute("aria-label", "Structure");
  byId("board").setAttribute("aria-label", "Tables");
  byId("toolbar").prepend(meshChoosers(motion, mesh));
  byId("board").append(structureTables(motion, mesh));
  byId("view").append(fieldLegend(motion, mesh));
  byId("player").append(scaleSlider(motion, () => motion.mesh ?? mesh));
}
