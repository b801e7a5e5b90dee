// Worker of a live page of statics of structures.

import { LiveStatics } from "./live_structures.js";
import { serve } from "./live_worker.js";

serve(LiveStatics);
