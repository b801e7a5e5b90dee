// Live page of a spatial structure.

import { drawDiagram } from "./diagrams.js";
import { buildLive } from "./live.js";
import { Mesh } from "./mesh.js";
import { meshToggles } from "./mesh_controls.js";
import { MeshSolids } from "./mesh_solids.js";
import { buildPage } from "./page.js";
import { SpatialMotion } from "./spatial_motion.js";
import { SpatialPainter } from "./spatial_painter.js";
import { buildSpatialTools } from "./spatial_tools.js";
import { SpatialView } from "./spatial_view.js";
import { buildStructure } from "./structure.js";

const structure = { Mesh, Picture: MeshSolids, drawDiagram, toggles: meshToggles, build: buildStructure };
const dimension = { Motion: SpatialMotion, View: SpatialView, Painter: SpatialPainter, structure };
buildLive(buildPage(dimension, buildSpatialTools), dimension);
