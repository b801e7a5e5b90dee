// Frame of every page: subtitle, tools, footer, theme, printing.

/** @import { Child } from "./types.d.ts" */
/** @import { Scene } from "./scene.js" */
/** @import { Board } from "./plot_board.js" */
/** @import { Player } from "./player.js" */

import { byId, el, iconButton } from "./dom.js";
import { payload } from "./payload.js";
import { Theme } from "./theme.js";

/** Resolution on paper, relative to CSS pixels. */
const PAPER_RATIO = 3;

/** Fill heading and footer, and follow the theme; on paper the page is light, sharp and at rest.
 * @param {{ units: string, tools?: Child[], keys?: [string, string][], scene?: Scene, board?: Board | null, player?: Player }} parts */
export function buildFrame({ units, tools = [], keys = [], scene, board, player }) {
  byId("subtitle").textContent = payload.subtitle || "";
  byId("subtitle").hidden = !payload.subtitle;
  byId("tools").append(...el("div", {}, tools,
    iconButton("theme", "Light or dark", () => Theme.set(Theme.name === "dark" ? "light" : "dark"), { id: "theme" }),
    iconButton("print", "Print", () => window.print())).children);
  const { reason } = /** @type {{ reason?: string }} */ (payload.live ?? {});
  byId("footer").append(el("span", {}, `Made with dalembert. ${units}${reason ? ` The page has no sliders: ${reason}.` : ""}`),
    keys.length ? el("span", { class: "keys" }, keys.map(([key, action]) => [el("kbd", {}, key), ` ${action} `])) : "");
  Theme.listeners.on(() => { scene?.restyle(); board?.redraw(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", (e) => Theme.set(e.matches ? "dark" : "light"));

  let before = Theme.name;
  const redraw = (/** @type {boolean} */ paper) => {
    document.documentElement.classList.toggle("paper", paper);
    for (const part of [scene, board]) if (part) part.ratio = paper ? PAPER_RATIO : undefined;
    Theme.set(paper ? "light" : before);
    scene?.resize();
    scene?.draw();
  };
  window.addEventListener("beforeprint", () => {
    if (document.documentElement.classList.contains("paper")) return;
    before = Theme.name;
    player?.pause();
    redraw(true);
  });
  window.addEventListener("afterprint", () => redraw(false));
}

/** Buttons that zoom a drawing. @param {Scene} scene @param {string} fit label of the button that fits it */
export function buildZoom(scene, fit) {
  byId("zoom").append(
    iconButton("plus", "Zoom in (+)", () => scene.zoom(1.25)),
    iconButton("minus", "Zoom out (−)", () => scene.zoom(0.8)),
    iconButton("fit", fit, () => scene.fit(), { id: "fit" }));
}
