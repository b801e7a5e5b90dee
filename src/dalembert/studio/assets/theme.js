// Theme of the page and of its pictures: light or dark.

export class Theme {
  /** @param {(name: string) => void} onChange */
  constructor(onChange) {
    this.onChange = onChange;
    this.set(localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
  }

  /** @param {string} name */
  set(name) {
    document.documentElement.dataset.theme = name;
    localStorage.setItem("theme", name);
    this.onChange(name);
  }

  turn() { this.set(document.documentElement.dataset.theme === "dark" ? "light" : "dark"); }
}
