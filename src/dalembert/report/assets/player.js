// Time, and how fast it runs.

// 1 where a loop in real time takes 4 to 12 seconds, else a round factor which makes it so.
function automaticSpeed(span) {
  if (!(span > 0) || (span >= 4 && span <= 12)) return 1;
  let best = 1, miss = Infinity;
  const k0 = Math.floor(Math.log10(span / 7));
  for (const k of [k0 - 1, k0, k0 + 1]) {
    for (const m of [1, 2, 5]) {
      const speed = m * 10 ** k;
      const away = Math.abs(Math.log(span / speed / 7));
      if (away < miss) [best, miss] = [speed, away];
    }
  }
  return +best.toPrecision(3);
}

function speedChoices(automatic) {
  const all = [0.1, 0.2, 0.5, 1, 2, 5, 10].map((m) => +(m * automatic).toPrecision(3));
  return [...new Set([...all, 1])].sort((a, b) => a - b);
}

class Player {
  constructor(motion) {
    this.motion = motion;
    this.time = motion.start;
    this.playing = false;
    this.loop = true;
    this.automatic = automaticSpeed(motion.span);
    this.speed = this.automatic;
    this.onTime = new Signal();
    this.onState = new Signal();
    this.tick = this.tick.bind(this);
  }

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

  toggle() { this.playing ? this.pause() : this.play(); }

  setSpeed(speed) {
    if (!(speed > 0)) return;
    this.speed = speed;
    this.onState.emit();
  }

  setLoop(loop) {
    this.loop = loop;
    this.onState.emit();
  }

  // k frames on from the frame that is shown.
  step(k) {
    this.pause();
    const { n, time } = this.motion;
    const { i, f } = this.motion.locate(this.time);
    let frame = f > 1 - 1e-9 ? i + 1 : i;
    if (f > 1e-9 && f < 1 - 1e-9 && k < 0) frame += 1;
    this.seek(time[clamp(frame + k, 0, n - 1)]);
  }

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

// Play button, scrubber with event marks, clock, speed and loop.
function buildPlayer(root, player) {
  const { motion } = player;
  root.hidden = false;
  const play = iconButton("play", "Play (space)", () => player.toggle(), { class: "icon primary", id: "play" });
  const scrub = el("input", {
    type: "range", id: "scrub", min: "0", max: "1", step: "any", value: "0", "aria-label": "Time",
    oninput: () => player.seek(motion.start + scrub.valueAsNumber * motion.span),
    onpointerdown: () => player.pause(),
  });
  const marks = el("div", { class: "marks" });
  for (const event of motion.events) {
    const p = (event.time - motion.start) / motion.span;
    if (p < 0 || p > 1) continue;
    const label = `${event.name}, ${clock(event.time, motion.span)} s`;
    const mark = el("button", { type: "button", class: "mark", title: label, "aria-label": `Go to ${label}`, onclick: () => player.seek(event.time) });
    mark.style.setProperty("--p", p);
    marks.append(mark);
  }
  const now = el("output", { class: "now", id: "clock", for: "scrub", "aria-live": "off" });
  const spoken = el("span", { class: "unseen", id: "spoken", role: "status" });
  const speed = el("select", { id: "speed", "aria-label": "Speed", title: "Speed, as a multiple of real time", onchange: () => player.setSpeed(+speed.value) },
    speedChoices(player.automatic).map((s) => el("option", { value: String(s) }, s === 1 ? "Real time" : `${s}×`)));
  const loop = toggleButton(icon("loop"), player.loop, (on) => player.setLoop(on), { class: "icon", "aria-label": "Loop", title: "Loop", id: "loop" });
  root.append(
    el("div", { class: "buttons" }, play,
      iconButton("back", "Previous frame (←)", () => player.step(-1)),
      iconButton("next", "Next frame (→)", () => player.step(1))),
    el("div", { class: "track" }, scrub, marks),
    now, speed, loop, spoken);

  // The time is said where it comes to rest, not while it runs.
  let resting = null;
  const say = () => {
    clearTimeout(resting);
    resting = player.playing ? null : setTimeout(() => { spoken.textContent = now.textContent; }, 300);
  };
  player.onState.on(say);
  player.onTime.on((t) => {
    const p = (t - motion.start) / motion.span;
    scrub.value = String(p);
    scrub.style.setProperty("--p", p);
    now.textContent = `${clock(t, motion.span)} s`;
    scrub.setAttribute("aria-valuetext", now.textContent);
    say();
  });
  player.onState.on(() => {
    play.replaceChildren(icon(player.playing ? "pause" : "play"));
    play.title = player.playing ? "Pause (space)" : "Play (space)";
    play.setAttribute("aria-label", play.title);
    if (![...speed.options].some((o) => +o.value === player.speed)) {
      speed.append(el("option", { value: String(player.speed) }, `${player.speed}×`));
    }
    speed.value = String(player.speed);
    loop.setAttribute("aria-pressed", String(player.loop));
  });
  player.onState.emit();
}

// Space plays, arrows step, wherever no field or button wants these keys.
function bindKeys(player, scene) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const target = event.target;
    const range = target.id === "scrub";
    if (!range && target.closest("input, select, textarea")) return;
    if (event.key === " " && target.closest("button, a, summary")) return;
    const large = Math.max(2, Math.round(player.motion.n / 50));
    const actions = {
      " ": () => player.toggle(),
      ArrowRight: () => player.step(event.shiftKey ? large : 1),
      ArrowLeft: () => player.step(event.shiftKey ? -large : -1),
      Home: () => player.seek(player.motion.start),
      End: () => player.seek(player.motion.end),
    };
    const views = { "+": () => scene.zoom(1.25), "-": () => scene.zoom(0.8), 0: () => scene.fit(), f: () => scene.fit(), ...scene.keys };
    const action = (player.motion.moves && actions[event.key]) || views[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
