// Worker of a live page of modes.

import { LiveModes } from "./live_modes.js";
import { serve } from "./live_worker.js";

serve(LiveModes);
