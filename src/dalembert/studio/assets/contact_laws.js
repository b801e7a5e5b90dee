// Friction and restitution of two groups of contacts in the text.

import { rowChange } from "./row_changes.js";

/** Number of the pair of two groups in an element Collisions; -1 if they have no law of their own. @param {any} entry @param {string[]} groups */
export const pairAt = (entry, groups) => /** @type {any[]} */ (entry.pairs ?? []).findIndex((pair) => [...(pair.groups ?? [])].sort().join() === [...groups].sort().join());

/** Operations that give the pair of two groups a value; null removes it. @param {string} name of the element @param {any} entry @param {string[]} groups @param {string} key @param {unknown} value */
export const pairChange = (name, entry, groups, key, value) => rowChange(["forces", name, "pairs"], entry.pairs ?? [], pairAt(entry, groups), { groups }, key, value);
