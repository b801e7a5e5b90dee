// Worker of a live page of driven motions.

import { LiveKinematics } from "./live_kinematics.js";
import { serve } from "./live_worker.js";

serve(LiveKinematics);
