// Draw a spatial frame by typed coordinates and clicks, without a browser; prints the changes of the file.

const [folder] = process.argv.slice(2), load = (name) => import(`${folder}/${name}`);
const { SpaceStructure } = await load("space_structure.js"), { SPACE_STRUCTURE_TOOLS } = await load("space_structure_tools.js");
const { SpacePlan } = await load("space_plan.js"), { answer } = await load("space_structure_keys.js"), { MATERIALS, SECTIONS } = await load("structure_stock.js");

const view = { screen: ([x, y, z]) => [100 * x + 30 * y, 400 - 100 * z - 20 * y], scaleAt: () => 100, fitted: true };
const page = { scene: { view, keys: {}, canvas: { style: {} }, invalidate() {}, painter: {} }, motion: { mesh: null, dimension: 3 }, player: {} };
const changes = [], refused = [], document = { kind: "structure", nodes: {}, elements: {} };
const structure = Object.assign(Object.create(SpaceStructure.prototype), {
  pictures: { page }, actions: { change, hint() {}, select() {}, refuse: (text) => refused.push(text), commands: { do: (act) => act() } }, tool: SPACE_STRUCTURE_TOOLS[0], boundPage: page, document, plan: new SpacePlan(document, page), claimed: new Map(),
  places: [], now: null, target: null, hover: null, selection: [], held: null, typed: "", properties: { show() {} },
  palette: { plane: { axis: "z", normal: [0, 0, 1], origin: [0, 0, 0] }, settings: { beam: "SpaceFrame", section: SECTIONS["Timber 100 × 200"], material: MATERIALS.Timber }, node: {}, show() {} },
});

function change({ operations }) {
  changes.push(operations);
  for (const { op, section, name, base, fields } of operations) if (op === "add") document[section][name ?? `${base}${Object.keys(document[section]).length + 1}`] = fields;
  structure.plan = new SpacePlan(document, page);
  structure.claimed.clear();
}

const type = (text) => {
  for (const key of [...text, "Enter"]) answer(structure, key);
};
const click = (p) => structure.put({ p, names: [], body: null, joint: null, normal: null, how: "" }, view.screen(p));

structure.choose("beam");
type("0, 0, 0");
type("2");  // along the normal of the plane
type("1, 0, 2");
structure.choose("clamp");
type("0, 0, 0");
structure.choose("force");
type("1, 0, 2");
structure.now = { p: [1, 0, 2], names: [] };
type("0, 1 kN, 0");
click([0.4, 0, 2]);  // on the arm
type("0, 0, -3 kN");
structure.choose("torque");
click([0, 0, 2]);
type("-2 kNm");
structure.choose("heat");
click([0, 0, 1]);
type("-30 K");
structure.choose("select");
structure.select([{ section: "points", name: "n3" }]);
const moved = structure.moved({ before: { p: [1, 0, 2] }, after: { p: [1.5, 0, 2] } });
process.stdout.write(JSON.stringify({ changes, refused, handles: structure.handles.length, moved }));
