// Page of a planar mechanism.

import { byId } from "./dom.js";
import { buildPage } from "./page.js";
import "./canvas.js";
import "./timeline.js";
import "./hull.js";
import "./motion.js";
import "./symbols.js";
import "./looks.js";
import "./scene_camera.js";
import "./scene_painter.js";
import "./scene_marks.js";
import "./scene.js";

buildPage((data) => new Motion(data), (motion) => new Scene(motion, byId("scene"), byId("tip")));
