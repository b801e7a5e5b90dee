// Page of modes of a spatial mechanism.

import { buildModes } from "./modes.js";
import { buildPage } from "./page.js";
import { SpatialMotion } from "./spatial_motion.js";
import { SpatialPainter } from "./spatial_painter.js";
import { buildSpatialTools } from "./spatial_tools.js";
import { SpatialView } from "./spatial_view.js";
import { Swing } from "./swing.js";

const dimension = { Motion: SpatialMotion, View: SpatialView, Painter: SpatialPainter, Swing }, page = buildPage(dimension, buildSpatialTools);
buildModes(page);
