// Movement of the solids of a spatial scene to an instant.

/** @import { Item, Point } from "./scene_types.d.ts" */
/** @import { SpatialMotion, SpatialPose } from "./spatial_motion.js" */
/** @import { SpatialPainter } from "./spatial_painter.js" */

import "./vendor/three.js";
import { clamp } from "./numbers.js";
import { apart } from "./solids.js";
import { AXES, vector } from "./spatial_motion.js";

/** @param {THREE.Group} group @param {SpatialPose | null} pose */
function place(group, pose) {
  group.visible = Boolean(pose);
  if (!pose) return;
  group.position.copy(pose.p);
  group.quaternion.copy(pose.q);
}

/** Place an object whose z axis leads along a vector. @param {THREE.Object3D} object @param {Point} at @param {THREE.Vector3} way */
function lead(object, at, way) {
  object.position.set(...at);
  if (way.length() > 0) object.quaternion.setFromUnitVectors(vector(AXES.z), way.clone().normalize());
}

/** Move all parts of a scene to the present instant. @param {SpatialPainter} painter */
export function moveParts(painter) {
  const { motion, scene } = painter;
  for (const [body, group] of painter.groups) place(group, motion.pose(body));
  const pale = new Set(scene.pale);
  for (const { ghost, group } of painter.ghosts) place(group, pale.has(ghost) ? motion.pose(ghost) : null);
  for (const { link: { i, j }, group, parts, rest } of painter.links) {
    const p = motion.at(i.body, i.point), q = motion.at(j.body, j.point);
    group.visible = Boolean(p && q);
    if (!p || !q) continue;
    lead(group, p, vector(q).sub(vector(p)));
    for (const { mesh, follows } of parts) {
      if (follows === "stretch") mesh.scale.z = Math.max(1e-9, apart(p, q) / rest);
      if (follows === "tail") mesh.position.z = apart(p, q);
    }
  }
  for (const { joint, strands } of painter.belts) moveStrands(motion, joint, strands);
  for (const { symbol, group } of painter.walls) {
    const at = motion.placeOf(symbol), normal = vector(motion.vectorOf(symbol.normal) ?? []);
    group.visible = Boolean(at) && normal.length() > 0;
    if (at && group.visible) lead(group, at, normal);
  }
  for (const trace of painter.traces) trace.show(motion, scene.canvas);
  painter.mesh?.move();
  painter.view.grid.visible = scene.show.grid;
}

/** Strands touch both wheels, in the plane across the axis of the first one. @param {SpatialMotion} motion @param {Item} joint @param {{ side: number, mesh: THREE.Mesh }[]} strands */
function moveStrands(motion, { wheels: [one, two], crossed }, strands) {
  const p = motion.at(one.body, one.point), q = motion.at(two.body, two.point), pose = motion.pose(one.body);
  for (const { mesh } of strands) mesh.visible = Boolean(p && q && pose);
  if (!p || !q || !pose) return;
  const axis = vector(one.axis ?? AXES.z).applyQuaternion(pose.q).normalize(), way = vector(q).sub(vector(p)), along = way.clone().normalize();
  const across = new THREE.Vector3().crossVectors(axis, along).normalize(), r = crossed ? -two.radius : two.radius, open = Math.acos(clamp((one.radius - r) / way.length(), -1, 1));
  for (const { side, mesh } of strands) {
    const out = along.clone().multiplyScalar(Math.cos(open)).addScaledVector(across, side * Math.sin(open));
    const from = vector(p).addScaledVector(out, one.radius), strand = vector(q).addScaledVector(out, r).sub(from);
    lead(mesh, from.toArray(), strand);
    mesh.scale.z = strand.length();
  }
}
