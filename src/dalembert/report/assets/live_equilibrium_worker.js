// Worker of a live page of equilibria.

import { LiveEquilibrium } from "./live_equilibrium.js";
import { serve } from "./live_worker.js";

serve(LiveEquilibrium);
