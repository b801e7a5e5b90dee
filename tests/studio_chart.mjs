// Chart of a function target on a canvas that records its labels; prints them, and values that pass through the scale.

const [folder] = process.argv.slice(2), { CHART, chartScale, drawChart } = await import(`${folder}/function_chart.js`);
const labels = [], ctx = { fillText: (text, x, y) => labels.push({ text, x, y, align: ctx.textAlign, font: ctx.font }) };
for (const name of ["clearRect", "strokeRect", "beginPath", "lineTo", "stroke", "arc", "fill"]) ctx[name] = () => {};
const outputs = [-3, 4, NaN], scale = chartScale(outputs);
drawChart(ctx, scale, [[1, -3], [2, 4], [3, NaN]], () => "");
process.stdout.write(JSON.stringify({ size: CHART, labels, pixels: [[0, scale.low], [2 * Math.PI, scale.high]].map(scale.pixel), same: scale.values(scale.pixel([2, 0.7])) }));
