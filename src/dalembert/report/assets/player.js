// Time of the page and the speed at which it runs.

/** @import { Scene } from "./scene.js" */
/** @import { Motion } from "./motion.js" */

import { el, icon, iconButton, targetOf, toggleButton } from "./dom.js";
import { clamp, clock, isNum } from "./numbers.js";
import { Signal } from "./theme.js";

/** Real time where a loop takes 4 to 12 seconds, else a round factor that makes it so. @param {number} span */
function automaticSpeed(span) {
  if (!(span > 0) || (span >= 4 && span <= 12)) return 1;
  const exponent = Math.floor(Math.log10(span / 7));
  const speeds = [exponent - 1, exponent, exponent + 1].flatMap((k) => [1, 2, 5].map((m) => m * 10 ** k));
  const miss = (/** @type {number} */ speed) => Math.abs(Math.log(span / speed / 7));
  return +speeds.reduce((best, speed) => (miss(speed) < miss(best) ? speed : best)).toPrecision(3);
}

/** Speeds around the automatic one, and real time. @param {Player} player */
function speedChoices({ automatic, motion }) {
  const speeds = [0.1, 0.2, 0.5, 1, 2, 5, 10].map((factor) => +(factor * automatic).toPrecision(3));
  return [...new Set(motion.inTime ? [...speeds, 1] : speeds)].sort((a, b) => a - b);
}

/** Name of a speed: a multiple of real time, or of the automatic speed of states that are not in time.
 * @param {Player} player @param {number} speed */
function speedName({ automatic, motion }, speed) {
  if (motion.inTime) return speed === 1 ? "Real time" : `${speed}×`;
  return `${+(speed / automatic).toPrecision(3)}×`;
}

export class Player {
  /** @param {Motion} motion */
  constructor(motion) {
    this.motion = motion;
    this.time = motion.start;
    this.playing = false;
    this.loop = true;
    this.automatic = motion.swings ? 1 : automaticSpeed(motion.span);
    this.speed = this.automatic;
    /** @type {Signal<number>} */
    this.onTime = new Signal();
    /** @type {Signal} */
    this.onState = new Signal();
    /** Time of the last frame [ms]. @type {number | null} */
    this.last = null;
    this.tick = this.tick.bind(this);
  }

  /** @param {number} t */
  seek(t) {
    if (!isNum(t)) return;
    this.time = clamp(t, this.motion.start, this.motion.end);
    this.onTime.emit(this.time);
  }

  play() {
    if (this.playing || !this.motion.moves) return;
    if (this.time >= this.motion.end) this.seek(this.motion.start);
    this.playing = true;
    this.last = null;
    requestAnimationFrame(this.tick);
    this.onState.emit();
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.onState.emit();
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  /** @param {number} speed */
  setSpeed(speed) {
    if (!(speed > 0)) return;
    this.speed = speed;
    this.onState.emit();
  }

  /** @param {boolean} loop */
  setLoop(loop) {
    this.loop = loop;
    this.onState.emit();
  }

  /** Seek the k-th instant, or choose the k-th state, from the present one. @param {number} k */
  step(k) {
    this.pause();
    if (this.motion.swings) { this.motion.choose(clamp(this.motion.chosen + k, 0, this.motion.n - 1)); return; }
    const { n, time } = this.motion, { i, f } = this.motion.locate(this.time);
    const between = f > 1e-9 && f < 1 - 1e-9, instant = f > 1 - 1e-9 || (between && k < 0) ? i + 1 : i;
    this.seek(time[clamp(instant + k, 0, n - 1)]);
  }

  /** @param {number} now [ms] */
  tick(now) {
    if (!this.playing) return;
    const { start, end, span } = this.motion;
    const passed = this.last === null ? 0 : Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    let t = this.time + passed * this.speed;
    if (t >= end && this.loop) t = start + ((t - start) % span);
    this.seek(t);
    if (t >= end) this.pause(); else requestAnimationFrame(this.tick);
  }
}

/** Fill the bar below the drawing: play button, and the controls of time. @param {HTMLElement} root @param {Player} player */
export function buildPlayer(root, player) {
  root.hidden = false;
  const { swings } = player.motion, play = iconButton("play", "", () => player.toggle(), { class: "icon primary", id: "play" });
  player.onState.on(() => {
    play.replaceChildren(icon(player.playing ? "pause" : "play"));
    play.title = player.playing ? "Pause (space)" : swings ? "Animate (space)" : "Play (space)";
    play.setAttribute("aria-label", play.title);
  });
  root.append(...swings ? [play] : timeControls(player, play));
  player.onState.emit();
}

/** Steps, slider with event marks, clock, speed and loop. @param {Player} player @param {HTMLElement} play */
function timeControls(player, play) {
  const { motion } = player;
  const slider = el("input", {
    type: "range", id: "scrub", min: "0", max: "1", step: "any", value: "0", "aria-label": motion.inTime ? "Time" : "State",
    oninput: () => player.seek(motion.start + slider.valueAsNumber * motion.span),
    onpointerdown: () => player.pause(),
  });
  const now = el("output", { class: "now", id: "clock", for: "scrub", "aria-live": "off" });
  const spoken = el("span", { class: "unseen", id: "spoken", role: "status" });
  const options = speedChoices(player).map((factor) => el("option", { value: String(factor) }, speedName(player, factor)));
  const title = `Speed, as a multiple of ${motion.inTime ? "real time" : "the usual one"}`;
  const speed = el("select", { id: "speed", "aria-label": "Speed", title, onchange: () => player.setSpeed(+speed.value) }, options);
  const loop = toggleButton(icon("loop"), player.loop, (on) => player.setLoop(on), { class: "icon", "aria-label": "Loop", title: "Loop", id: "loop" });
  // Screen readers report the time at rest, not while it runs.
  let resting = 0;
  const speak = () => {
    clearTimeout(resting);
    if (!player.playing) resting = window.setTimeout(() => { spoken.textContent = now.textContent; }, 300);
  };
  player.onTime.on((t) => {
    const share = String((t - motion.start) / motion.span);
    slider.value = share;
    slider.style.setProperty("--p", share);
    now.textContent = motion.timeText(t);
    slider.setAttribute("aria-valuetext", now.textContent);
    speak();
  });
  player.onState.on(() => {
    speak();
    if (![...speed.options].some(({ value }) => +value === player.speed)) speed.append(el("option", { value: String(player.speed) }, speedName(player, player.speed)));
    speed.value = String(player.speed);
    loop.setAttribute("aria-pressed", String(player.loop));
  });
  const steps = [iconButton("back", "Previous frame (←)", () => player.step(-1)), iconButton("next", "Next frame (→)", () => player.step(1))];
  return [el("div", { class: "buttons" }, play, steps), el("div", { class: "track" }, slider, eventMarks(player)), now, speed, loop, spoken];
}

/** Marks of the events on the slider. @param {Player} player */
function eventMarks(player) {
  const { events, start, end, span } = player.motion;
  return el("div", { class: "marks" }, events.filter(({ time }) => time >= start && time <= end).map(({ name, time }) => {
    const label = `${name}, ${clock(time, span)} s`;
    const mark = el("button", { type: "button", class: "mark", title: label, "aria-label": `Go to ${label}`, onclick: () => player.seek(time) });
    mark.style.setProperty("--p", String((time - start) / span));
    return mark;
  }));
}

/** Keys of the page: space plays, arrows step, except in fields and on buttons.
 * @param {Player} player @param {Scene} scene */
export function bindKeys(player, scene) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const target = targetOf(event);
    if (target.id !== "scrub" && target.closest("input, select, textarea")) return;
    if (event.key === " " && target.closest("button, a, summary")) return;
    const { n, start, end, moves } = player.motion, stride = event.shiftKey ? Math.max(2, Math.round(n / 50)) : 1;
    /** @type {Record<string, () => void>} */
    const times = {
      " ": () => player.toggle(),
      ArrowRight: () => player.step(stride),
      ArrowLeft: () => player.step(-stride),
      Home: () => player.seek(start),
      End: () => player.seek(end),
    };
    /** @type {Record<string, () => void>} */
    const views = { "+": () => scene.zoom(1.25), "-": () => scene.zoom(0.8), 0: () => scene.fit(), f: () => scene.fit(), ...scene.keys };
    const action = (moves && times[event.key]) || views[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
