// Materials of a spatial scene by their roles: of bodies and their insides, of symbols, of lines.

/** @import { Part } from "./scene_types.d.ts" */

import "./vendor/three.js";
import { Theme, mix } from "./theme.js";

/** Role of a material: of a body, of its ellipsoid of inertia, or a name.
 * @typedef {Part | string} Role */

/** Opacity of ellipsoids of inertia, of transparent bodies, and of ghosts. */
const FAINT = 0.4, CLEAR = 0.3, GHOST = 0.25;

export class Materials {
  constructor() {
    /** Plane of the section. */
    this.cut = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
    this.section = false;
    this.clear = false;
    this.inertia = true;
    /** Materials of each role: of surfaces, of their insides, of lines. @type {Record<string, Map<Role, THREE.Material>>} */
    this.roles = {};
    this.clearRoles();
  }

  clearRoles() { this.roles = { surface: new Map(), inside: new Map(), line: new Map() }; }

  /** Material of a role, created once. @param {string} kind @param {Role} role @param {() => THREE.Material} create @returns {THREE.Material} */
  material(kind, role, create) {
    if (!this.roles[kind].has(role)) this.roles[kind].set(role, create());
    return this.roles[kind].get(role);
  }

  /** @param {Role} role */
  surface(role) { return this.material("surface", role, () => new THREE.MeshStandardMaterial({ roughness: 0.55, metalness: 0.05, fog: false })); }

  /** Inside of a solid in a section, without shading, so that it seems filled. @param {Role} role */
  inside(role) { return this.material("inside", role, () => new THREE.MeshBasicMaterial({ side: THREE.BackSide, fog: false })); }

  /** @param {Role} role */
  line(role) { return this.material("line", role, () => new THREE.LineBasicMaterial({ fog: false })); }

  /** Materials with their roles. */
  get all() { return Object.values(this.roles).flatMap((materials) => [...materials]); }

  /** @param {(point: { index: number }) => string} pointColour */
  restyle(pointColour) {
    const { ink, surface, muted, name } = Theme, dark = name === "dark";
    /** @type {Record<string, string>} */
    const colours = {
      steel: mix(surface, ink, dark ? 0.72 : 0.16), dark: mix(surface, ink, dark ? 0.42 : 0.62), pale: mix(surface, ink, dark ? 0.5 : 0.1),
      ground: mix(surface, ink, 0.3), spring: Theme.colour(2), drive: mix(surface, Theme.colour(4), dark ? 0.75 : 0.6), ghost: muted,
    };
    for (const [role, material] of this.all) {
      const base = typeof role !== "string" ? mix(surface, Theme.colour(role.index), dark ? 0.82 : 0.72)
        : role.startsWith("point ") ? pointColour({ index: +role.slice(6) }) : colours[role];
      material.color.set(material.isLineBasicMaterial ? mix(base, dark ? surface : ink, 0.45) : material.isMeshBasicMaterial ? mix(base, dark ? surface : ink, 0.3) : base);
      if (role === "ghost") Object.assign(material, { transparent: true, opacity: GHOST, depthWrite: false });
      if (typeof role === "string") continue;
      const clear = this.clear || role.ellipsoid;
      if (material.isMeshStandardMaterial) Object.assign(material, { transparent: clear, opacity: this.clear ? CLEAR : role.ellipsoid ? FAINT : 1, depthWrite: !clear });
      Object.assign(material, { visible: this.inertia || !role.ellipsoid, clippingPlanes: this.section ? [this.cut] : null, clipShadows: true, needsUpdate: true });
    }
  }

  /** Highlight a body. @param {object | null} part */
  highlight(part) {
    for (const [role, material] of this.all) if (material.emissive && typeof role !== "string") material.emissive.set((role.of ?? role) === part ? mix("#000000", Theme.accent, 0.45) : "#000000");
  }
}
