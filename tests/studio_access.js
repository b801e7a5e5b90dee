// Checks of a page: contrast of texts, names of operable parts, and its width.
({
  // Visible texts whose contrast is below that of WCAG AA.
  contrast: () => {
    const channel = (v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
    const context = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d", { willReadFrequently: true });
    const rgba = (text) => { context.clearRect(0, 0, 1, 1); context.fillStyle = text; context.fillRect(0, 0, 1, 1); return [...context.getImageData(0, 0, 1, 1).data]; };
    const over = ([r, g, b, a], under) => [r, g, b].map((v, k) => v * a / 255 + under[k] * (1 - a / 255));
    const ground = (node) => {
        if (!node) return [255, 255, 255];
        const colour = rgba(getComputedStyle(node).backgroundColor);
        return colour[3] === 255 ? colour.slice(0, 3) : over(colour, ground(node.parentElement));
    };
    const light = (c) => 0.2126 * channel(c[0]) + 0.7152 * channel(c[1]) + 0.0722 * channel(c[2]);
    const poor = [];
    for (const node of document.querySelectorAll("body *")) {
        const own = [...node.childNodes].some((c) => c.nodeType === 3 && c.textContent.trim());
        if (!own || node.closest(":disabled, .unseen") || !node.checkVisibility({ checkVisibilityCSS: true })) continue;
        const back = ground(node), ink = over(rgba(getComputedStyle(node).color), back);
        const [a, b] = [light(ink), light(back)].sort((x, y) => y - x), ratio = (a + 0.05) / (b + 0.05);
        if (ratio < 4.5) poor.push(`${node.className || node.tagName} ${node.textContent.slice(0, 30)} ${ratio.toFixed(2)}`);
    }
    return poor;
},
  // Operable parts without a name.
  nameless: () => [...document.querySelectorAll("button, input, select, a, [role], [tabindex], iframe, dialog[open]")]
    .filter((node) => node.checkVisibility() && !node.closest(".cm-editor"))
    .filter((node) => !(node.textContent.trim() || node.getAttribute("aria-label") || node.title || document.getElementById(node.getAttribute("aria-labelledby") ?? "")?.textContent || node.labels?.length || ["status", "none"].includes(node.getAttribute("role"))))
    .map((node) => node.outerHTML.slice(0, 80)),
  // Parts beyond the right edge.
  wide: () => [...document.querySelectorAll("body *")].filter((e) => {
    for (let p = e.parentElement; p; p = p.parentElement) if (getComputedStyle(p).overflowX !== "visible" && p !== document.body) return false;
    return e.getBoundingClientRect().right > innerWidth + 1;
}).map((e) => e.outerHTML.slice(0, 60)),
})
