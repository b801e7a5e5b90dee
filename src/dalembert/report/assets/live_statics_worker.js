// Worker of a live page of statics.

import { LiveStatics } from "./live_structures.js";
import { serve } from "./live_worker.js";

serve(LiveStatics);
