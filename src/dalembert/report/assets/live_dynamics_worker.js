// Worker of a live page of runs of dynamics.

import { LiveRun } from "./live_run.js";
import { serve } from "./live_worker.js";

serve(LiveRun);
