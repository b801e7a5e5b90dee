// Pictures and films of the drawing, to be kept as files.

const fileName = (text) => text.replace(/[^\p{L}\p{N}._-]+/gu, "-").replace(/^-+|-+$/g, "").slice(0, 60) || "dalembert";

const FILM = { most: 150, rate: 20, wide: 800 };  // frames, frames a second, pixels

// The drawing and what is written over it, on one canvas of a width.
function snapshot(scene, wide) {
  const layers = [...scene.canvas.parentElement.querySelectorAll("canvas")], { width, height } = scene.canvas;
  const k = wide ? Math.min(1, wide / width) : 1;
  const canvas = Object.assign(document.createElement("canvas"), { width: Math.round(k * width), height: Math.round(k * height) });
  const ctx = canvas.getContext("2d");
  ctx.fillStyle = Theme.surface;
  ctx.fillRect(0, 0, canvas.width, canvas.height);
  for (const layer of layers) if (layer.width > 1 && layer.clientWidth === scene.canvas.clientWidth) ctx.drawImage(layer, 0, 0, canvas.width, canvas.height);
  return canvas;
}

const pngOf = (canvas) => new Promise((done) => canvas.toBlob(async (blob) => done(new Uint8Array(await blob.arrayBuffer())), "image/png"));

// The chunks of a PNG file: name and bytes.
function chunks(png) {
  const view = new DataView(png.buffer), found = [];
  for (let at = 8; at < png.length;) {
    const size = view.getUint32(at);
    found.push({ name: String.fromCharCode(...png.subarray(at + 4, at + 8)), data: png.subarray(at + 8, at + 8 + size) });
    at += 12 + size;
  }
  return found;
}

const CRC = Uint32Array.from({ length: 256 }, (_, n) => { for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1; return n >>> 0; });

function chunk(name, data) {
  const out = new Uint8Array(12 + data.length), view = new DataView(out.buffer);
  view.setUint32(0, data.length);
  out.set([...name].map((c) => c.charCodeAt(0)), 4);
  out.set(data, 8);
  let crc = 0xffffffff;
  for (let k = 4; k < 8 + data.length; k++) crc = CRC[(crc ^ out[k]) & 255] ^ (crc >>> 8);
  view.setUint32(8 + data.length, (crc ^ 0xffffffff) >>> 0);
  return out;
}

// Bytes of 32-bit and 16-bit numbers.
function words(...given) {
  const out = new Uint8Array(given.reduce((sum, [, size]) => sum + size, 0)), view = new DataView(out.buffer);
  let at = 0;
  for (const [value, size] of given) { if (size === 4) view.setUint32(at, value); else if (size === 2) view.setUint16(at, value); else out[at] = value; at += size; }
  return out;
}

// An animated PNG of pictures of one size.
function animated(pictures, rate) {
  const parts = [Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10)];
  let order = 0;
  pictures.map(chunks).forEach((found, k) => {
    const head = found.find(({ name }) => name === "IHDR").data, size = new DataView(head.buffer, head.byteOffset);
    if (!k) parts.push(chunk("IHDR", head), chunk("acTL", words([pictures.length, 4], [0, 4])));
    parts.push(chunk("fcTL", words([order++, 4], [size.getUint32(0), 4], [size.getUint32(4), 4], [0, 4], [0, 4], [1, 2], [rate, 2], [0, 1], [0, 1])));
    for (const { data } of found.filter(({ name }) => name === "IDAT")) {
      if (!k) { parts.push(chunk("IDAT", data)); continue; }
      const later = new Uint8Array(4 + data.length);
      later.set(words([order++, 4]));
      later.set(data, 4);
      parts.push(chunk("fdAT", later));
    }
  });
  parts.push(chunk("IEND", new Uint8Array(0)));
  return new Blob(parts, { type: "image/png" });
}

// The whole motion at the speed that is set; tells how far it is.
async function film(motion, player, scene, told) {
  const count = clamp(Math.round((FILM.rate * motion.span) / player.speed), 2, FILM.most), pictures = [], before = player.time;
  player.pause();
  for (let k = 0; k < count; k++) {
    player.seek(motion.start + (k / (count - 1)) * motion.span);
    scene.draw();
    pictures.push(await pngOf(snapshot(scene, FILM.wide)));
    told(`Film: ${Math.round((100 * (k + 1)) / count)} %`);
  }
  player.seek(before);
  return animated(pictures, FILM.rate);
}

// The drawing of a scene of the plane as SVG.
function drawingOf(scene) {
  const { clientWidth: w, clientHeight: h } = scene.canvas, ctx = new SvgContext(w, h);
  ctx.fillStyle = Theme.surface;
  ctx.fillRect(0, 0, w, h);
  scene.draw(ctx);
  scene.invalidate();
  return String(ctx);
}

// Files that are made of the drawing.
function shareMenu(scene, motion, player) {
  const name = fileName(motion.title), status = el("span", { class: "status", role: "status", "aria-live": "polite" });
  const item = (text, id, onclick) => el("button", { type: "button", class: "menu-item", id, onclick }, text);
  const rows = [item("Picture (PNG)", "save-png", async () => download(`${name}.png`, await pngOf(snapshot(scene)), "image/png"))];
  if (scene.vector) rows.push(item("Drawing (SVG)", "save-svg", () => download(`${name}.svg`, drawingOf(scene), "image/svg+xml")));
  if (player && motion.moves) {
    const button = item("Film (animated PNG)", "save-film", async () => {
      button.disabled = true;
      download(`${name}-film.png`, await film(motion, player, scene, (text) => { status.textContent = text; }), "image/png");
      status.textContent = "";
      button.disabled = false;
    });
    rows.push(button);
  }
  return menu(icon("save"), [...rows, status], { class: "icon", id: "save", title: "Save as a file", "aria-label": "Save as a file" });
}
