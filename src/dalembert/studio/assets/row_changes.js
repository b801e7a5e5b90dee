// Changes of lists of tables in the text, such as limits of responses: of one value, so that all others stay as they are written.

/** @import { Operation } from "./operations.js" */

/** Operations that give a key of a table in a list a value; null removes it, and a table with nothing else too.
 * @param {(string | number)[]} keys of the list @param {Record<string, unknown>[]} rows tables of the file @param {number} at number of the table; -1 for a new one @param {Record<string, unknown>} own what the table is about, such as its response @param {string} key @param {unknown} value @returns {Operation[]} */
export function rowChange(keys, rows, at, own, key, value) {
  if (at < 0) return value === null ? [] : [{ op: "append_item", keys, value: { ...own, [key]: value } }];
  if (value !== null) return [{ op: "set", keys: [...keys, at, key], value, written: true }];
  if (!(key in rows[at])) return [];
  if (Object.keys(rows[at]).some((other) => !(other in own) && other !== key)) return [{ op: "drop", keys: [...keys, at, key] }];
  return [rows.length > 1 ? { op: "remove_item", keys: [...keys, at] } : without(keys)];
}

/** Operation that removes a key of a section or an element. @param {(string | number)[]} keys @returns {Operation} */
const without = (keys) => (keys.length === 2 ? { op: "section", section: keys[0], fields: { [keys[1]]: null } } : { op: "drop", keys });

/** Operations that give a key of a table a value; null removes it. @param {(string | number)[]} keys of the table @param {Record<string, unknown>} table @param {string} key @param {unknown} value @returns {Operation[]} */
export const valueChange = (keys, table, key, value) => (value !== null ? [{ op: "set", keys: [...keys, key], value, written: true }] : key in table ? [{ op: "drop", keys: [...keys, key] }] : []);

/** Operations that add a name to a list of names, or remove it; a list without names is removed.
 * @param {(string | number)[]} keys of the list @param {unknown} names list of the file, a single name, or none @param {string} name @param {boolean} isIn @returns {Operation[]} */
export function nameChange(keys, names, name, isIn) {
  const list = Array.isArray(names) ? names : names === undefined || names === null ? [] : [names], at = list.indexOf(name);
  if (isIn === at >= 0) return [];
  if (isIn) return [Array.isArray(names) ? { op: "append_item", keys, value: name } : { op: "section", section: keys[0], fields: { [keys[1]]: [...list, name] } }];
  return [list.length > 1 ? { op: "remove_item", keys: [...keys, at] } : without(keys)];
}
