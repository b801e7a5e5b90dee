// Sheets beside the drawing: the text, and the panels of other parts, one of which is shown.

import { el } from "./dom.js";

/** A sheet; some are of mechanisms only. @typedef {{ name: string, title: string, node: HTMLElement, onShow?: () => void, mechanism?: boolean }} Sheet */

export class Sheets {
  /** @param {HTMLElement} list of the tabs @param {HTMLElement} frame of the sheets @param {Sheet[]} sheets */
  constructor(list, frame, sheets) {
    this.list = list;
    this.frame = frame;
    /** @type {Sheet[]} */
    this.sheets = [];
    /** @type {HTMLButtonElement[]} */
    this.tabs = [];
    this.shown = sheets[0].name;
    for (const sheet of sheets) this.add(sheet);
    list.addEventListener("keydown", ({ key }) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[key], names = this.sheets.flatMap(({ name }, k) => (this.tabs[k].hidden ? [] : [name]));
      if (!step) return;
      const next = names[(names.indexOf(this.shown) + step + names.length) % names.length];
      this.show(next);
      this.tabs[this.sheets.findIndex(({ name }) => name === next)].focus();
    });
  }

  /** Add a sheet; its node moves into the frame. @param {Sheet} sheet */
  add(sheet) {
    const { name, title, node } = sheet, tab = el("button", { type: "button", class: "tab", role: "tab", id: `tab-${name}`, onclick: () => this.show(name) }, title);
    node.setAttribute("role", "tabpanel");
    node.setAttribute("aria-labelledby", tab.id);
    if (node.parentElement !== this.frame) this.frame.insertBefore(node, this.frame.lastElementChild);
    this.sheets.push(sheet);
    this.tabs.push(tab);
    this.list.append(tab);
    this.list.hidden = this.sheets.length < 2;
    this.show(this.shown);
  }

  /** Offer the sheets of mechanisms, or only those of structures too. @param {boolean} mechanism */
  offer(mechanism) {
    this.sheets.forEach((sheet, k) => { this.tabs[k].hidden = !mechanism && Boolean(sheet.mechanism); });
    if (this.tabs[this.sheets.findIndex(({ name }) => name === this.shown)].hidden) this.show(this.sheets[0].name);
  }

  /** @param {string} name */
  show(name) {
    this.shown = name;
    this.sheets.forEach((sheet, k) => {
      const chosen = sheet.name === name;
      sheet.node.hidden = !chosen;
      this.tabs[k].setAttribute("aria-selected", String(chosen));
      this.tabs[k].tabIndex = chosen ? 0 : -1;
      if (chosen) sheet.onShow?.();
    });
  }
}
