// A live page in a notebook: its sliders and the parameters of the widget stay in step.

/** Pause without a change after which values of sliders are sent [ms]. */
const REST = 60;
/** Time between looks whether the page is ready [ms]. */
const LOOK = 50;

/** @typedef {{ get: (key: string) => any, set: (key: string, value: unknown) => void, save_changes: () => void, on: (event: string, act: () => void) => void, off: (event: string, act: () => void) => void }} WidgetModel */

/** Display the widget; returns what ends it. @param {{ model: WidgetModel, el: HTMLElement }} part */
function render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.title = "Live page";
  frame.style.cssText = `width: 100%; height: ${model.get("height")}px; border: 0`;
  frame.srcdoc = model.get("page");
  el.append(frame);
  /** @type {any} */
  let design = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let waiting;
  const values = () => design.parameters.map((/** @type {{ name: string }} */ { name }, /** @type {number} */ k) => model.get("parameters")[name] ?? design.values[k]);
  const toPage = () => {
    if (design && values().some((/** @type {number} */ value, /** @type {number} */ k) => value !== design.values[k])) design.replace(values(), "notebook");
  };
  const toPython = () => {
    const changed = Object.fromEntries(design.parameters.map((/** @type {{ name: string }} */ { name }, /** @type {number} */ k) => [name, design.values[k]]));
    model.set("parameters", { ...model.get("parameters"), ...changed });
    model.save_changes();
  };
  const timer = setInterval(() => {
    design = /** @type {any} */ (frame.contentWindow)?.dalembert?.design ?? null;
    if (!design) return;
    clearInterval(timer);
    design.onChange.on((/** @type {string} */ origin) => {
      clearTimeout(waiting);
      if (origin !== "notebook") waiting = setTimeout(toPython, REST);
    });
    toPage();
  }, LOOK);
  model.on("change:parameters", toPage);
  return () => {
    clearInterval(timer);
    clearTimeout(waiting);
    model.off("change:parameters", toPage);
  };
}

export default { render };
