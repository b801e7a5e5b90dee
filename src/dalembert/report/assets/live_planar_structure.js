// Live page of a planar structure.

import { drawDiagram } from "./diagrams.js";
import { buildLive } from "./live.js";
import { Mesh } from "./mesh.js";
import { meshToggles } from "./mesh_controls.js";
import { MeshPainter } from "./mesh_painter.js";
import { buildPage } from "./page.js";
import { PlanarMotion } from "./planar_motion.js";
import { PlanarPainter } from "./planar_painter.js";
import { PlanarView } from "./planar_view.js";
import { buildStructure } from "./structure.js";

const structure = { Mesh, Picture: MeshPainter, drawDiagram, toggles: meshToggles, build: buildStructure };
const dimension = { Motion: PlanarMotion, View: PlanarView, Painter: PlanarPainter, structure };
buildLive(buildPage(dimension), dimension);
