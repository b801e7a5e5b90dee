// Page of a spatial mechanism.

import "./vendor/three.js";
import { byId } from "./dom.js";
import { buildPage } from "./page.js";
import "./canvas.js";
import "./timeline.js";
import "./symbols.js";
import "./hull.js";
import "./space_motion.js";
import "./solids.js";
import "./space_symbols.js";
import "./space_view.js";
import "./space_painter.js";
import "./space_trace.js";
import "./space_overlay.js";
import "./space_assembly.js";
import "./space_scene.js";
import "./space_tools.js";

buildPage((data) => new SpatialMotion(data), (motion) => new SpatialScene(motion, byId("scene"), byId("tip")), buildSpaceTools);
