// Operations that connect two bars by a universal joint, without a browser.

const [folder] = process.argv.slice(2), { bar, joint } = await import(`${folder}/space_shapes.js`);
const spot = (p, body) => ({ p, names: [], body, joint: null, normal: null, how: "" });
const [a, b, c] = [[-0.4, 0, 0], [0, 0, 0], [0.3, 0.2, 0]], angle = Math.atan2(2, 3);
const bodies = { bar1: { p: [-0.2, 0, 0], q: [1, 0, 0, 0] }, bar2: { p: [0.15, 0.1, 0], q: [Math.cos(angle / 2), 0, 0, Math.sin(angle / 2)] }, ground: { p: b, q: [1, 0, 0, 0] } };
const poses = { of: (name) => bodies[name] };
const changes = [bar([spot(a), spot(b)]), bar([spot(b), spot(c)]),
  joint([spot(b, "bar1"), spot(b, "bar2")], poses, "Universal", [0, 0, 1]),
  joint([spot(a, "bar1"), spot(a, null)], poses, "Revolute", [1, 0, 0]),
  joint([spot(c, "bar2"), spot(c, null)], poses, "Cylindrical", [3, 2, 0])];
process.stdout.write(JSON.stringify(changes.map(({ operations }) => operations)));
