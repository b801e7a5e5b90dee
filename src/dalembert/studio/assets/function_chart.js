// Chart of a function target: output over the crank angle of one revolution.

/** Size of the chart [units of its canvas]. */
export const CHART = { width: 640, height: 320 };
/** Space of the labels around the axes. */
const SPACE = { left: 44, right: 10, top: 10, bottom: 30 };
const TURN = 2 * Math.PI;

/** Axes of a chart: pixels of values, and values of pixels. @typedef {{ low: number, high: number, pixel: (values: number[]) => [number, number], values: (pixel: number[]) => number[] }} ChartScale */

/** Axes that show the outputs. @param {number[]} outputs @returns {ChartScale} */
export function chartScale(outputs) {
  const stated = outputs.filter(Number.isFinite), low = Math.min(-1, ...stated) - 0.2, high = Math.max(1, ...stated) + 0.2;
  const width = CHART.width - SPACE.left - SPACE.right, height = CHART.height - SPACE.top - SPACE.bottom, bottom = CHART.height - SPACE.bottom;
  return { low, high, pixel: ([x, y]) => [SPACE.left + (x / TURN) * width, bottom - ((y - low) / (high - low)) * height], values: ([u, v]) => [((u - SPACE.left) / width) * TURN, low + ((bottom - v) / height) * (high - low)] };
}

/** Draw the axes and the points. @param {CanvasRenderingContext2D} ctx @param {ChartScale} scale @param {number[][]} points crank angle and output of each; those that are no numbers are left out @param {(name: string) => string} colour */
export function drawChart(ctx, { low, high, pixel }, points, colour) {
  const rows = points.filter((row) => row.every(Number.isFinite)), right = CHART.width - SPACE.right;
  ctx.clearRect(0, 0, CHART.width, CHART.height);
  [ctx.strokeStyle, ctx.fillStyle, ctx.font, ctx.lineWidth] = [colour("line"), colour("muted"), "20px system-ui, sans-serif", 1];
  for (let k = 0; k <= 4; k++) {
    const [x, y] = pixel([(k * TURN) / 4, low]);
    ctx.strokeRect(x, SPACE.top, 0.01, y - SPACE.top);
    ctx.textAlign = k === 4 ? "right" : "center";
    ctx.fillText(`${90 * k}°`, k === 4 ? CHART.width - 4 : x, CHART.height - 4);
  }
  ctx.textAlign = "left";
  for (const value of [Math.ceil(low), 0, Math.floor(high)]) {
    const [x, y] = pixel([0, value]);
    ctx.strokeRect(x, y, right - x, 0.01);
    ctx.fillText(String(value), 8, y + 6);
  }
  [ctx.strokeStyle, ctx.fillStyle, ctx.lineWidth] = [colour("accent"), colour("accent"), 3];
  ctx.beginPath();
  for (const row of [...rows].sort(([a], [b]) => a - b)) ctx.lineTo(...pixel(row));
  ctx.stroke();
  for (const row of rows) {
    ctx.beginPath();
    ctx.arc(...pixel(row), 7, 0, TURN);
    ctx.fill();
  }
}
