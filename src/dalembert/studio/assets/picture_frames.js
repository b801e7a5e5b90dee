// Frames of pictures: pages without data, which are loaded before they are needed.

import { el } from "./dom.js";

/** Time after a picture at which the frame of the next one is loaded [ms]. */
const PAUSE = 300;
/** Number of frames that are kept: of a still picture and of a live one. */
const KEPT = 2;

/** Time between checks of a frame that loads, and their number [ms]. */
const POLL = 2, ATTEMPTS = 30_000;

/** A page without data. @typedef {Window & { receiveData?: (text: string) => void }} Inner */

export class PictureFrames {
  /** @param {HTMLElement} stage */
  constructor(stage) {
    this.stage = stage;
    /** Address of a frame → one that waits for data. @type {Map<string, HTMLIFrameElement>} */
    this.spare = new Map();
    /** Frames that have loaded, some of them an error. @type {WeakSet<HTMLIFrameElement>} */
    this.loaded = new WeakSet();
  }

  /** A frame, which may still load. @param {string} address */
  take(address) {
    const frame = this.spare.get(address);
    this.spare.delete(address);
    if (frame && (!this.loaded.has(frame) || receives(frame))) return frame;
    frame?.remove();
    return this.load(address);
  }

  /** @param {string} address */
  load(address) {
    const frame = el("iframe", { src: address, class: "loading", title: "Picture of the model" });
    frame.addEventListener("load", () => this.loaded.add(frame));
    this.stage.append(frame);
    return frame;
  }

  /** Load the frame of the next picture of a kind. @param {string} address */
  prepare(address) {
    setTimeout(() => {
      const frame = this.spare.get(address) ?? this.load(address);
      this.spare.delete(address);  // the oldest one is first
      this.spare.set(address, frame);
      const [oldest] = this.spare.keys();
      if (this.spare.size <= KEPT) return;
      this.spare.get(oldest)?.remove();
      this.spare.delete(oldest);
    }, PAUSE);
  }
}

/** Window of a frame; null for that of an error. @param {HTMLIFrameElement} frame */
const innerOf = (frame) => /** @type {Inner | null} */ (frame.contentDocument && frame.contentWindow);

/** Whether a frame waits for data. @param {HTMLIFrameElement} frame */
const receives = (frame) => Boolean(innerOf(frame)?.receiveData);

/** Show data in a frame once it has loaded; the promise is settled before the frame draws. @param {HTMLIFrameElement} frame @param {string} text @param {string} theme */
export async function fill(frame, text, theme) {
  for (let k = 0; k < ATTEMPTS && frame.isConnected && !receives(frame); k++) await pause(POLL);
  const inner = innerOf(frame);
  if (!inner?.receiveData) return;
  inner.document.documentElement.dataset.theme = theme;
  const built = new Promise((resolve) => { inner.addEventListener("built", resolve, { once: true }); });
  inner.receiveData(text);
  await Promise.race([built, pause(POLL * ATTEMPTS)]);
}

/** @param {number} time [ms] */
const pause = (time) => new Promise((resolve) => { setTimeout(resolve, time); });
