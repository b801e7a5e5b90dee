// Page of a planar mechanism.

import { buildPage } from "./page.js";
import { PlanarMotion } from "./planar_motion.js";
import { PlanarPainter } from "./planar_painter.js";
import { PlanarView } from "./planar_view.js";

buildPage({ Motion: PlanarMotion, View: PlanarView, Painter: PlanarPainter });
