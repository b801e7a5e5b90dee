// Worker of a live page of vibration.

import { LiveVibration } from "./live_structures.js";
import { serve } from "./live_worker.js";

serve(LiveVibration);
