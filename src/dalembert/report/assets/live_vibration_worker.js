// Worker of a live page of vibrations of structures.

import { LiveVibration } from "./live_structures.js";
import { serve } from "./live_worker.js";

serve(LiveVibration);
