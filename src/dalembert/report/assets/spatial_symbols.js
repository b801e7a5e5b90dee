// Solid symbols of joints, links, drivers and supports; `u` is half the width of a bar.

import "./vendor/three.js";
import { TAU, clamp } from "./numbers.js";
import { ball, faceted, tube } from "./solids.js";

/** Geometry, role of its colour, and how it follows the length of a link.
 * @typedef {[THREE.BufferGeometry, string, string?]} SolidPart */

/** Flanges of a joint at heights along z. @param {number} u @param {number} radius @param {...number} heights @returns {SolidPart[]} */
const flanges = (u, radius, ...heights) => heights.map((h) => [tube([0, 0, (h - 0.15) * u], [0, 0, (h + 0.15) * u], radius * u), "dark"]);

/** At the point of a joint, with its axis along z. @type {Record<string, (u: number) => SolidPart[]>} */
export const JOINTS = {
  pin: (u) => [[tube([0, 0, -2.1 * u], [0, 0, 2.1 * u], 1.3 * u), "steel"], ...flanges(u, 1.55, -2.1, 2.1)],
  socket: (u) => [[ball([0, 0, 0], 1.7 * u), "steel"], [new THREE.TorusGeometry(1.75 * u, 0.28 * u, 12, 40), "dark"]],
  slider: (u) => [[new THREE.BoxGeometry(3.6 * u, 3.6 * u, 5.2 * u), "steel"]],
  collar: (u) => [[tube([0, 0, -2.6 * u], [0, 0, 2.6 * u], 1.75 * u), "steel"], ...flanges(u, 2, -2.6, 2.6)],
  nut: (u) => [[tube([0, 0, -2.2 * u], [0, 0, 2.2 * u], 1.9 * u, 6), "steel"], [coil(3, 1.95 * u, 4.4 * u, 0.16 * u), "dark"]],
  cross: (u) => [[tube([0, 0, -2.4 * u], [0, 0, 2.4 * u], 0.75 * u), "steel"], [ball([0, 0, 0], 1.1 * u), "dark"]],
  table: (u) => [[new THREE.BoxGeometry(16 * u, 16 * u, 0.3 * u), "pale"]],
  mark: (u) => [[new THREE.OctahedronGeometry(1.6 * u), "steel"]],
  slotpin: (u) => [[tube([0, 0, -1.6 * u], [0, 0, 1.6 * u], 1.1 * u), "dark"]],
  bead: (u) => [[ball([0, 0, 0], 1.5 * u), "steel"]],
  clamp: () => [],
  contact: () => [],
  mesh: () => [],
  belt: () => [],
};

/** Wire about z, from −length/2 to length/2. @param {number} turns @param {number} radius @param {number} length @param {number} wire */
function coil(turns, radius, length, wire) {
  class Helix extends THREE.Curve {
    /** @param {number} s */
    getPoint(s, target = new THREE.Vector3()) {
      const lead = 0.08, k = clamp((s - lead) / (1 - 2 * lead), 0, 1), r = radius * Math.min(1, s / lead, (1 - s) / lead);
      return target.set(r * Math.cos(k * turns * TAU), r * Math.sin(k * turns * TAU), (s - 0.5) * length);
    }
  }
  return new THREE.TubeGeometry(new Helix(), 28 * turns, wire, 8);
}

/** Along z from the first point of a link: "stretch" scales with its length, "tail" stays at the second point.
 * @type {Record<string, (u: number, rest: number) => SolidPart[]>} */
export const LINKS = {
  coil: (u, rest) => [[coil(9, 1.9 * u, rest, 0.32 * u).translate(0, 0, rest / 2), "spring", "stretch"]],
  dashpot: (u, rest) => [[tube([0, 0, 0], [0, 0, 0.62 * rest], 1.05 * u), "pale"], [tube([0, 0, -0.6 * rest], [0, 0, 0], 0.45 * u, 16), "steel", "tail"]],
  cylinder: (u, rest) => [[tube([0, 0, 0], [0, 0, 0.6 * rest], 1.25 * u), "drive"], [tube([0, 0, -0.62 * rest], [0, 0, 0], 0.6 * u, 16), "steel", "tail"]],
  sleeve: (u, rest) => [[ball([0, 0, 0.5], 1).scale(1.8 * u, 1.8 * u, rest || u), "drive", "stretch"]],
  strand: (u, rest) => [[tube([0, 0, -0.1 * rest], [0, 0, 1.1 * rest], 0.9 * u, 16), "drive", "stretch"]],
  tie: (u, rest) => [[tube([0, 0, 0], [0, 0, rest], 0.28 * u, 12), "dark", "stretch"]],
  rod: (u, rest) => [[tube([0, 0, 0], [0, 0, rest], 0.7 * u, 20), "steel", "stretch"]],
};

/** About an axis along z, or at a point. @type {Record<string, (u: number) => SolidPart[]>} */
export const SYMBOLS = {
  motor: (u) => [[tube([0, 0, -3.4 * u], [0, 0, -1.6 * u], 2.2 * u), "drive"]],
  brake: (u) => [[tube([0, 0, 1.4 * u], [0, 0, 2 * u], 2.4 * u), "pale"]],
  spiral: (u) => [[coil(3, 2.3 * u, 3 * u, 0.25 * u), "spring"]],
  limit: (u) => [[new THREE.BoxGeometry(0.8 * u, 4 * u, 1.6 * u).translate(2.4 * u, 0, 0), "ground"]],
  travel: (u) => [[tube([0, 0, -3 * u], [0, 0, 3 * u], 0.3 * u), "drive"], [new THREE.ConeGeometry(u, 2.4 * u, 20).rotateX(Math.PI / 2).translate(0, 0, 4 * u), "drive"]],
};

/** Wall that limits a straight motion; z points to its free side. @param {number} u @returns {SolidPart[]} */
export const wall = (u) => [[new THREE.BoxGeometry(7 * u, 7 * u, 0.7 * u).translate(0, 0, -0.35 * u), "ground"], [new THREE.BoxGeometry(7 * u, 7 * u, 0.25 * u), "drive"]];

/** Block on a foot below a joint, with the ground toward −z. @param {number} u @returns {SolidPart[]} */
export const pedestal = (u) => [[pyramid(0.9 * u, 2.3 * u, 4 * u).translate(0, 0, -2.6 * u), "ground"], [new THREE.BoxGeometry(6 * u, 6 * u, 0.6 * u).translate(0, 0, -4.9 * u), "ground"]];

/** @param {number} top @param {number} bottom half diagonals @param {number} height along z */
const pyramid = (top, bottom, height) => faceted(new THREE.CylinderGeometry(top, bottom, height, 4, 1)).rotateX(Math.PI / 2).rotateZ(Math.PI / 4);

/** Support of a node, with the ground toward −z: clamped, pinned, or rolling. @param {number} u @param {boolean} clamp @param {boolean} roller @returns {THREE.BufferGeometry[]} */
export function support(u, clamp, roller) {
  if (clamp) return [new THREE.BoxGeometry(4 * u, 4 * u, 1.6 * u).toNonIndexed().translate(0, 0, -0.8 * u)];
  const plate = new THREE.BoxGeometry(4.6 * u, 4.6 * u, 0.5 * u).toNonIndexed().translate(0, 0, (roller ? -4.4 : -3.4) * u);
  return [pyramid(0.05 * u, 2.2 * u, 3.2 * u).translate(0, 0, -1.6 * u), plate];
}
