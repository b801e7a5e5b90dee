// A spring between typed places, one of them the centre of a sphere, and a place typed at a point, without a browser.

const [folder] = process.argv.slice(2), { joinedPlace, typedSpacePlace } = await import(`${folder}/space_places.js`), { connection } = await import(`${folder}/space_shapes.js`);
const vector = (p) => ({ toArray: () => p }), bob = { name: "bob", centre: [0.3, 0, 0.4] }, plate = { name: "plate", centre: [1, 0, 0] };
const motion = {
  bodies: [bob, plate], joints: [{ name: "pin", at: [1, 0, 0.2] }], points: [{ body: plate, point: [1, 0, 0.2], name: "plate.top" }],
  at: (_, point) => point, placeOf: ({ at }) => at, pose: ({ centre }) => ({ p: vector(centre), q: null }),
};
const page = { motion, scene: { view: { scaleAt: () => 500 } } }, poses = { of: (name) => ({ p: name === "bob" ? bob.centre : [0, 0, 0], q: [1, 0, 0, 0] }) };
const typed = (text) => joinedPlace(page, typedSpacePlace(text, { axis: "z" }, null));
const places = ["0, 0, 0.5", "0.3, 0, 0.4", "1, 0, 0.2"].map(typed);
process.stdout.write(JSON.stringify({ places, spring: connection(places, poses, "Spring").operations[0].fields }));
