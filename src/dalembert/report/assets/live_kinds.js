// Kinds of analyses that scripts run.

import { LiveEquilibrium } from "./live_equilibrium.js";
import { LiveKinematics } from "./live_kinematics.js";
import { LiveModes } from "./live_modes.js";
import { LiveRun } from "./live_run.js";

/** Kind of an analysis → class of its runs. @type {Record<string, typeof LiveRun>} */
export const RUNS = { dynamics: LiveRun, kinematics: LiveKinematics, equilibrium: LiveEquilibrium, modes: LiveModes };
