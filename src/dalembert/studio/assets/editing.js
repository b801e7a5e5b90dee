// Changes of the selected elements: moved, rotated, mirrored, copied, deleted, renamed.

/** @import { Page } from "./pictures.js" */
/** @import { Change, Operation } from "./operations.js" */
/** @import { Document } from "./types.d.ts" */
/** @import { Transform } from "./transforms.js" */

import { groupsOf } from "./contact_shapes.js";
import { beamLengths } from "./beam_ends.js";
import { isSame, linkLengths } from "./ends.js";
import { gearRadii } from "./gear_radii.js";
import { mappedContacts } from "./mapped_shapes.js";
import { anglesAfter, movedPoints } from "./operations.js";
import { bodiesAmong, group, sectionOf } from "./selection.js";
import { namedPlaces } from "./snapping.js";
import { applied, bodiesOf, mapped, mappedBody, references, renamed } from "./transforms.js";

/** Whether a joint places a body. @param {Document} document @param {string} name */
const isJoined = (document, name) => Object.values(document.joints ?? {}).some((joint) => bodiesOf(document, joint).includes(name));

/** Names of new elements: without the digits at the end. @param {string} name */
const baseOf = (name) => name.replace(/\d+$/, "") || name;

/** Operations that turn a value into another; keys that stay are not written.
 * @param {(string | number)[]} keys @param {any} before @param {any} after @returns {Operation[]} */
function differences(keys, before, after) {
  if (JSON.stringify(before) === JSON.stringify(after)) return [];
  const nested = (/** @type {any} */ value) => typeof value === "object" && value !== null;
  const same = nested(before) && nested(after) && Array.isArray(before) === Array.isArray(after) && Object.keys(before).every((key) => key in after);
  const list = same && Array.isArray(before) && before.length === after.length;
  if (same && (list || !Array.isArray(before))) return Object.keys(after).flatMap((key) => differences([...keys, list ? Number(key) : key], before[key], after[key]));
  return [{ op: "set", keys, value: after }];
}

/** Selected bodies in another place, with their joints; points of other bodies that are joined to them follow.
 * @param {Page} page @param {Document} document @param {Iterable<string>} selected @param {Transform} map @param {string} label @returns {Change | null} */
export function transform(page, document, selected, map, label) {
  const chosen = new Set(selected), bodies = new Set(bodiesAmong(document, chosen)), names = new Map([...bodies].map((name) => [name, name]));
  if (!bodies.size) return null;
  const context = { page, document, map, names };
  const operations = group(document, bodies).flatMap(({ section, name, entry }) => {
    const stays = section === "forces" && !map.turn && !map.mirrored && !chosen.has(name);
    const next = section === "bodies" ? mappedBody(context, name, entry, !isJoined(document, name)) : stays ? entry : mapped(context, name, entry);
    return differences([section, name], entry, next);
  });
  operations.push(...mappedContacts(document, map, bodies, chosen).flatMap(({ name, entry, next }) => differences(["forces", name], entry, next)));
  const followers = namedPlaces(page).filter(({ bodies: there }) => there.some((body) => bodies.has(body))).flatMap((place) => {
    const others = place.names.filter((_, k) => !bodies.has(place.bodies[k])), [x, y] = applied(map, [place.x, place.y]);
    return others.length ? [{ from: { ...place, names: others }, to: { x, y } }] : [];
  });
  /** @type {(place: { x: number, y: number }, body: string | null) => { x: number, y: number } | null | undefined} */
  const linked = (place, body) => {
    const [x, y] = applied(map, [place.x, place.y]);
    return body !== null && bodies.has(body) ? { x, y } : followers.find(({ from }) => isSame(page, from, place))?.to;
  };
  const done = new Set(group(document, bodies).map(({ name }) => name));
  const isOther = (/** @type {string} */ name) => !done.has(name), isRadius = (/** @type {Operation} */ { keys }) => Array.isArray(keys) && keys[0] === "joints" && /^radius_[ij]$/.test(String(keys[2]));
  const points = movedPoints(page, document, followers, new Set([...done, ...Object.keys(document.beams ?? {})])).filter((operation) => !isRadius(operation));  // radii need all centres
  const all = [...operations, ...points, ...linkLengths(page, document, linked, isOther), ...gearRadii(page, document, linked, isOther), ...beamLengths(page, document, linked, anglesAfter(page, [...operations, ...points]), isOther)];
  return all.length ? { label, operations: all } : null;
}

/** Copies of the selected bodies with the elements between them and the ground. @param {Page} page @param {Document} document @param {Iterable<string>} selected @param {Transform} map @param {string} [label] @returns {Change | null} */
export function copied(page, document, selected, map, label = "copy") {
  const parts = group(document, selected).filter(({ entry }) => entry.type !== "Collisions"), names = new Map(parts.map(({ name }) => [name, `$copy_${name}`])), context = { page, document, map, names };
  if (!parts.length) return null;
  const added = parts.map(({ section, name, entry }) => {
    const fields = section === "bodies" ? mappedBody(context, name, entry, true) : mapped(context, name, entry);
    if (section === "bodies" && !map.turn && !map.mirrored && entry.type !== "Particle" && !("angle" in entry)) fields.angle = mappedBody({ ...context, map: { ...map, turn: 2 * Math.PI } }, name, entry, true).angle - 2 * Math.PI;
    return { op: "add", section, base: section === "joints" && /^[A-Z]$/.test(name) ? "" : baseOf(name), as: `$copy_${name}`, fields };
  });
  return { label, operations: [...added, ...copiedShapes(document, names)] };
}

/** Shapes of contacts of copied bodies, in the same elements. @param {Document} document @param {Map<string, string>} names @returns {Operation[]} */
function copiedShapes(document, names) {
  const copied = [...names].filter(([name]) => document.bodies?.[name]);
  return Object.entries(document.forces ?? {}).filter(([, { type }]) => type === "Collisions").flatMap(([element, entry]) => {
    const shapes = Object.values(groupsOf(entry)).flat(), keys = ["forces", element, "shapes"];
    const groups = copied.map(([name, copy]) => ({ copy, own: shapes.filter((shape) => references(shape, (other) => other === name).size).map((shape) => renamed(shape, names)) })).filter(({ own }) => own.length);
    if (Array.isArray(entry.shapes)) return groups.length ? [{ op: "set list", keys, value: [...entry.shapes, ...groups.flatMap(({ own }) => own)] }] : [];
    return groups.map(({ copy, own }) => ({ op: "set", keys: [...keys, copy], value: own }));
  });
}

/** @param {Document} document @param {Iterable<string>} names @returns {Change | null} */
export function remove(document, names) {
  const rows = [...names].flatMap((name) => { const section = sectionOf(document, name); return section ? [{ op: "remove", section, name }] : []; });
  return rows.length ? { label: rows.length > 1 ? `delete ${rows.length} elements` : `delete ${rows[0].name}`, operations: rows.map((row) => ({ ...row, missing: true })) } : null;
}

/** @param {Document} document @param {string} name @param {string} to @returns {Change | null} */
export function rename(document, name, to) {
  const section = sectionOf(document, name);
  return section && to && to !== name ? { label: `rename ${name}`, operations: [{ op: "rename", section, name, to }] } : null;
}
