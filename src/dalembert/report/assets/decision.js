// The page of a decision that has no mechanism or structure to show.

const byId = (id) => document.getElementById(id);
byId("subtitle").textContent = payload.subtitle || "";
byId("subtitle").hidden = !payload.subtitle;
Theme.read();

function setTheme(name) {
  document.documentElement.dataset.theme = name;
  Theme.read();
  Theme.listeners.emit();
}

function buildDecision() {
  byId("stage").hidden = byId("board").hidden = true;
  document.querySelector("main").hidden = true;
  byId("tools").append(
    iconButton("theme", "Light or dark", () => setTheme(Theme.name === "dark" ? "light" : "dark"), { id: "theme" }),
    iconButton("print", "Print", () => window.print()));
  const cards = [optimumPanel(payload.optimum), convergencePanel(payload.optimum), ...viewPanels(true), ...viewPanels(false)].filter(Boolean);
  byId("panels").classList.add("tiles");
  byId("panels").append(...cards);
  byId("footer").append(el("span", {}, "Made with dalembert. SI units throughout."));
  decisionVerdict(byId("verdict"));
}

buildDecision();
setTheme(Theme.name);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", (e) => setTheme(e.matches ? "dark" : "light"));
let before = null;
window.addEventListener("beforeprint", () => { before ??= Theme.name; document.documentElement.classList.add("paper"); setTheme("light"); });
window.addEventListener("afterprint", () => { document.documentElement.classList.remove("paper"); setTheme(before || Theme.name); before = null; });

window.dalembert = { choice: choosing };
