// Scale a photo by two clicks; prints when the distance is requested.

const [folder] = process.argv.slice(2), { Photo } = await import(`${folder}/photo.js`);
const requested = [], photo = Object.assign(Object.create(Photo.prototype), { placed: {}, mode: "scale", marks: [], pictures: {}, scale: () => requested.push(at) });
let at = "";
for (const [kind, place] of [["pointerdown", [0, 0]], ["pointerup", [0, 0]], ["pointermove", [1, 0]], ["pointerdown", [3, 4]], ["pointerup", [3, 4]]]) {
  at = `${kind} ${place}`;
  photo.point(kind, place, 1);
}
process.stdout.write(JSON.stringify({ requested, marks: photo.marks }));
