// Pictures and films of the drawing, saved as files.

/** @import { Scene } from "./scene.js" */
/** @import { Player } from "./player.js" */

import { contextOf } from "./canvas.js";
import { download, el, fileName, icon, menu } from "./dom.js";
import { clamp } from "./numbers.js";
import { SvgContext } from "./svg.js";
import { Theme } from "./theme.js";

/** Limit of the frames of a film, frames per second, limit of the width in pixels. */
const FILM = { maxFrames: 150, rate: 20, maxWidth: 800 };

/** The drawing with its overlays on one canvas. @param {Scene} scene @param {number} maxWidth */
function snapshot({ canvas }, maxWidth = canvas.width) {
  const layers = [...canvas.parentElement?.querySelectorAll("canvas") ?? []].filter((layer) => layer.width > 1 && layer.clientWidth === canvas.clientWidth);
  const { width: w, height: h } = canvas, scale = Math.min(1, maxWidth / w);
  const copy = el("canvas", { width: Math.round(scale * w), height: Math.round(scale * h) }), ctx = contextOf(copy);
  ctx.fillStyle = Theme.surface;
  ctx.fillRect(0, 0, copy.width, copy.height);
  for (const layer of layers) ctx.drawImage(layer, 0, 0, copy.width, copy.height);
  return copy;
}

/** @param {HTMLCanvasElement} canvas @returns {Promise<Uint8Array<ArrayBuffer>>} */
export const pngOf = (canvas) => new Promise((resolve) => canvas.toBlob(async (blob) => resolve(new Uint8Array(await /** @type {Blob} */ (blob).arrayBuffer())), "image/png"));

/** Chunks of a PNG file. @param {Uint8Array<ArrayBuffer>} png */
function chunksOf(png) {
  const view = new DataView(png.buffer), chunks = [];
  for (let at = 8; at < png.length;) {
    const size = view.getUint32(at);
    chunks.push({ name: String.fromCharCode(...png.subarray(at + 4, at + 8)), data: png.subarray(at + 8, at + 8 + size) });
    at += 12 + size;
  }
  return chunks;
}

const CRC = Uint32Array.from({ length: 256 }, (_, n) => { for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1; return n >>> 0; });

/** @param {string} name @param {Uint8Array} data */
function chunk(name, data) {
  const bytes = new Uint8Array(12 + data.length), view = new DataView(bytes.buffer);
  view.setUint32(0, data.length);
  bytes.set([...name].map((c) => c.charCodeAt(0)), 4);
  bytes.set(data, 8);
  let crc = 0xffffffff;
  for (let k = 4; k < 8 + data.length; k++) crc = CRC[(crc ^ bytes[k]) & 255] ^ (crc >>> 8);
  view.setUint32(8 + data.length, (crc ^ 0xffffffff) >>> 0);
  return bytes;
}

/** Integers as bytes. @param {...[number, 1 | 2 | 4]} integers with their sizes */
function bytesOfIntegers(...integers) {
  return Uint8Array.from(integers.flatMap(([value, size]) => Array.from({ length: size }, (_, k) => value >>> (8 * (size - 1 - k)))));
}

/** Animated PNG of pictures of one size. @param {Uint8Array<ArrayBuffer>[]} pictures @param {number} rate */
function animated(pictures, rate) {
  const parts = [Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10)];
  let order = 0;
  pictures.map(chunksOf).forEach((chunks, k) => {
    const { data: head } = chunks[0], size = new DataView(head.buffer, head.byteOffset);  // the first one is IHDR
    if (!k) parts.push(chunk("IHDR", head), chunk("acTL", bytesOfIntegers([pictures.length, 4], [0, 4])));
    parts.push(chunk("fcTL", bytesOfIntegers([order++, 4], [size.getUint32(0), 4], [size.getUint32(4), 4], [0, 4], [0, 4], [1, 2], [rate, 2], [0, 1], [0, 1])));
    for (const { data } of chunks.filter(({ name }) => name === "IDAT")) {
      parts.push(k ? chunk("fdAT", Uint8Array.from([...bytesOfIntegers([order++, 4]), ...data])) : chunk("IDAT", data));
    }
  });
  parts.push(chunk("IEND", new Uint8Array(0)));
  return new Blob(parts, { type: "image/png" });
}

/** Film of the whole motion at the speed of the player. @param {Player} player @param {Scene} scene @param {(text: string) => void} report */
async function film(player, scene, report) {
  const { start, span } = player.motion, count = clamp(Math.round((FILM.rate * span) / player.speed), 2, FILM.maxFrames);
  const pictures = [], { time } = player;
  player.pause();
  for (let k = 0; k < count; k++) {
    player.seek(start + (k / (count - 1)) * span);
    scene.draw();
    pictures.push(await pngOf(snapshot(scene, FILM.maxWidth)));
    report(`Film: ${Math.round((100 * (k + 1)) / count)} %`);
  }
  player.seek(time);
  return animated(pictures, FILM.rate);
}

/** The drawing as SVG. @param {Scene} scene */
function drawingOf(scene) {
  const { clientWidth: w, clientHeight: h } = scene.canvas, svg = new SvgContext(w, h);
  svg.fillStyle = Theme.surface;
  svg.fillRect(0, 0, w, h);
  scene.draw(svg);
  scene.invalidate();
  return String(svg);
}

/** Menu that saves the drawing. @param {Scene} scene @param {string} title of the page @param {Player} [player] of a motion */
export function shareMenu(scene, title, player) {
  const name = fileName(title), status = el("span", { class: "status", role: "status", "aria-live": "polite" });
  const item = (/** @type {string} */ text, /** @type {string} */ id, /** @type {() => void} */ onclick) => el("button", { type: "button", class: "menu-item", id, onclick }, text);
  const rows = [item("Picture (PNG)", "save-png", async () => download(`${name}.png`, await pngOf(snapshot(scene)), "image/png"))];
  rows.push(item("Drawing (SVG)", "save-svg", () => download(`${name}.svg`, drawingOf(scene), "image/svg+xml")));
  if (player?.motion.moves) {
    const button = item("Film (animated PNG)", "save-film", async () => {
      button.disabled = true;
      download(`${name}-film.png`, await film(player, scene, (text) => { status.textContent = text; }), "image/png");
      status.textContent = "";
      button.disabled = false;
    });
    rows.push(button);
  }
  return menu(icon("save"), [...rows, status], { class: "icon", id: "save", title: "Save as a file", "aria-label": "Save as a file" });
}
