// Page of a decision without a drawing.

import { choice, viewPanels } from "./cards.js";
import { byId } from "./dom.js";
import { buildFrame } from "./frame.js";
import { convergencePanel, optimumPanel } from "./optimum.js";
import { verdict } from "./panels.js";
import { payload } from "./payload.js";
import { Theme } from "./theme.js";

Theme.read();
/** @type {HTMLElement} */ (document.querySelector("main")).hidden = true;
buildFrame({ units: "SI units throughout." });
const cards = [optimumPanel(payload.optimum), convergencePanel(payload.optimum, choice), ...viewPanels(true), ...viewPanels(false)];
byId("panels").classList.add("tiles");
byId("panels").append(...cards.filter((card) => card !== null));
verdict(byId("verdict"), payload.diagnosis, payload.verdict);
Theme.set(Theme.name);
Object.assign(window, { dalembert: { choice } });
