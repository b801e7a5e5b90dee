// Draw a parallelogram with a redundant third crank at odd places, on pictures with few digits; prints the changes of the file.

const [folder] = process.argv.slice(2), { typedAt } = await import(`${folder}/snapping.js`), { bar, pin } = await import(`${folder}/operations.js`);
const view = { s: 40 }, document = { bodies: {} }, changes = [];
const shown = (value) => Number(value.toFixed(7));  // digits of a packed picture
const motion = {
  joints: [], ground: { name: "ground", fixed: true }, byName: new Map(),
  get bodies() { return Object.entries(document.bodies).map(([name, { length }]) => ({ name, length, shapes: [] })); },
  get points() { return this.bodies.flatMap((body) => ["start", "end"].map((end) => ({ name: `${body.name}.${end}`, body, point: [(end === "end" ? 0.5 : -0.5) * body.length, 0] }))); },
  pose(body) {
    if (body.fixed) return { x: 0, y: 0, a: 0, c: 1, s: 0 };
    const { position, angle } = document.bodies[body.name], a = shown(angle);
    return { x: shown(position[0]), y: shown(position[1]), a, c: Math.cos(a), s: Math.sin(a) };
  },
  placed: ({ x, y, c, s }, [u, v]) => [x + c * u - s * v, y + s * u + c * v],
};
const page = { motion, scene: { view }, document };

function carry({ operations }) {
  changes.push(operations);
  for (const { section, base, fields } of operations) if (section === "bodies") document.bodies[`${base}${Object.keys(document.bodies).length + 1}`] = fields;
}

const from = ([x, y], length, angle) => [x + length * Math.cos(angle), y + length * Math.sin(angle)], at = ([x, y]) => typedAt(page, { x, y });
const pivots = [[0.1234567, 0.0765432], null, null], way = 0.377;
pivots[1] = from(pivots[0], 0.4, way);
pivots[2] = from(pivots[0], 0.7, way);
const tips = pivots.map((pivot) => from(pivot, 0.3, 1.234));
for (const [k, pivot] of pivots.entries()) carry(bar(at(pivot), at(tips[k])));
carry(bar(at(tips[0]), at(tips[1])));
carry(bar(at(tips[1]), at(tips[2])));
for (const pivot of pivots) carry(pin(page, at(pivot)));
process.stdout.write(JSON.stringify(changes));
