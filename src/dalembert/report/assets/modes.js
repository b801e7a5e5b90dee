// Parts of the page of modes of a mechanism: choice of the mode, amplitude, eigenvalues.

/** @import { Motion } from "./motion.js" */
/** @import { Scene } from "./scene.js" */

import { byId, el, toggleButton } from "./dom.js";
import { spectrumCards } from "./spectrum.js";
import { scaleSlider, stateChooser } from "./state_controls.js";

/** Fill the page of modes. @param {{ motion: Motion, scene: Scene }} page */
export function buildModes({ motion, scene }) {
  if (!motion.swing) return;
  const rest = toggleButton("At rest", true, (on) => { scene.show.rest = on; scene.invalidate(); }, { id: "show-rest", title: "The mechanism at rest, pale" });
  byId("toolbar").querySelector(".chips")?.prepend(rest);
  byId("toolbar").prepend(el("div", { class: "chips" }, stateChooser(motion)));
  byId("board").hidden = false;
  document.body.classList.remove("single");
  const modal = motion.states.kind === "mode";
  byId("board").setAttribute("aria-label", modal ? "Eigenvalues" : "Frequency response");
  if (modal) byId("board").append(spectrumCards(motion));
  const { swing } = motion;
  byId("player").append(scaleSlider(motion, () => motion.swing ?? swing));
}
