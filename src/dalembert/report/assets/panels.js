// The tables below the drawing.

const LEVELS = { info: "Note", warning: "Warning", error: "Error" };
const levelOf = (message) => (message.level in LEVELS ? message.level : "info");

function panel(title, id, ...children) {
  return el("section", { class: "card panel", id, "aria-labelledby": `${id}-title` }, el("h2", { id: `${id}-title` }, title), ...children);
}

const pairs = (items) => el("dl", { class: "pairs" }, list(items).map((item) => el("div", {},
  el("dt", {}, String(item.label ?? "")), el("dd", { class: String(item.value ?? "").length <= 22 ? "short" : "" }, raised(item.value ?? "–")))));

function diagnosisPanel(diagnosis) {
  if (!diagnosis) return null;
  const messages = list(diagnosis.messages).map((m) => el("li", { class: levelOf(m) },
    el("b", {}, LEVELS[levelOf(m)]), el("span", {}, String(m.text ?? ""))));
  return panel("Diagnosis", "diagnosis",
    diagnosis.summary && el("p", { class: "summary" }, String(diagnosis.summary)),
    messages.length > 0 && el("ul", { class: "messages" }, messages),
    list(diagnosis.items).length > 0 && pairs(diagnosis.items));
}

const worst = (diagnosis) => ["error", "warning"].find((level) => list(diagnosis.messages).some((m) => levelOf(m) === level)) || "info";

// The summary in one line at the top.
function verdict(node, diagnosis) {
  if (!diagnosis || !diagnosis.summary) return;
  const level = worst(diagnosis);
  const count = list(diagnosis.messages).filter((m) => levelOf(m) === level).length;
  node.classList.add(level);
  node.append(el("i", { class: "dot" }), el("span", {}, String(diagnosis.summary)));
  if (level !== "info") node.append(el("b", {}, `${count} ${LEVELS[level].toLowerCase()}${count > 1 ? "s" : ""}`));
  node.hidden = false;
}

function parameterPanel(parameters) {
  const rows = list(parameters);
  if (!rows.length) return null;
  return panel("Parameters", "parameters", el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Parameters" }, el("table", {},
    el("thead", {}, el("tr", {}, ["Name", "Value", "Unit", "Range", "Description"].map((t, k) => el("th", { scope: "col", class: k === 1 ? "right" : "" }, t)))),
    el("tbody", {}, rows.map((p) => el("tr", {},
      el("th", { scope: "row" }, String(p.name ?? "")),
      el("td", { class: "right" }, number(p.value, 6).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "")),
      el("td", { class: "unit" }, unitOf(p) === "1" ? "–" : raised(unitOf(p))),
      el("td", {}, rangeBar(p)),
      el("td", { class: "wide" }, String(p.description ?? ""))))))));
}

// Where the value lies between its bounds.
function rangeBar({ value, lower, upper }) {
  if (!isNum(lower) || !isNum(upper) || !(upper > lower)) return "–";
  const bar = el("span", { class: "bar" });
  bar.style.setProperty("--p", isNum(value) ? clamp((value - lower) / (upper - lower), 0, 1) : 0);
  const short = (x) => minus(String(+x.toPrecision(4)));
  return el("span", { class: "range" }, el("small", {}, short(lower)), bar, el("small", {}, short(upper)));
}

function eventPanel(motion, player) {
  if (!motion.events.length || !motion.moves) return null;
  return panel("Events", "events", el("div", { class: "event-list" }, motion.events.map((event) => el("button",
    { type: "button", class: "event", onclick: () => { player.pause(); player.seek(event.time); } },
    el("span", {}, event.name), el("span", { class: "value" }, `${clock(event.time, motion.span)} s`)))));
}

// Of a result without motion, the values themselves.
function valuePanel(motion) {
  if (motion.moves || !motion.series.length) return null;
  const groups = new Map();
  for (const s of motion.series) groups.set(s.group, [...(groups.get(s.group) || []), s]);
  return panel("Values", "values", el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Values" }, el("table", {},
    [...groups].map(([group, members]) => el("tbody", {},
      el("tr", { class: "group" }, el("th", { colspan: "3", scope: "colgroup" }, group)),
      members.map((s) => el("tr", {}, el("th", { scope: "row" }, s.name),
        el("td", { class: "right" }, number(motion.n ? s.values[0] : NaN, 6)), el("td", { class: "unit" }, s.unit === "1" ? "–" : raised(s.unit)))))))));
}
