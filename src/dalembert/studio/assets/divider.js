// Divider between the drawing and the text, which is moved by the pointer or by arrow keys.

/** @param {HTMLElement} divider @param {HTMLElement} desk @param {HTMLElement} writing */
export function bindDivider(divider, desk, writing) {
  const setWidth = (/** @type {number} */ share) => {
    const width = Math.min(75, Math.max(15, share));
    desk.style.setProperty("--text-width", `${width}%`);
    divider.setAttribute("aria-valuenow", String(Math.round(width)));
  };
  divider.addEventListener("pointerdown", (event) => {
    divider.setPointerCapture(event.pointerId);
    desk.classList.add("moving");
  });
  divider.addEventListener("pointermove", (event) => {
    if (divider.hasPointerCapture(event.pointerId)) setWidth((1 - event.clientX / innerWidth) * 100);
  });
  divider.addEventListener("keydown", ({ key }) => {
    const share = (writing.clientWidth / innerWidth) * 100;
    if (key === "ArrowLeft") setWidth(share + 3);
    if (key === "ArrowRight") setWidth(share - 3);
  });
}
