// Page of modes of a planar mechanism.

import { buildModes } from "./modes.js";
import { buildPage } from "./page.js";
import { PlanarMotion } from "./planar_motion.js";
import { PlanarPainter } from "./planar_painter.js";
import { PlanarView } from "./planar_view.js";
import { Swing } from "./swing.js";

const dimension = { Motion: PlanarMotion, View: PlanarView, Painter: PlanarPainter, Swing }, page = buildPage(dimension);
buildModes(page);
