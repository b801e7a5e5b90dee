// Symbols of joints, links and loads in space, made of solids; `u` is half the width of a bar.

const Z = [0, 0, 1];
const flange = (h, u) => [[0, 0, h * u - 0.15 * u], [0, 0, h * u + 0.15 * u]];

// On a joint's point, its axis along z: parts as [geometry, role of the colour].
const JOINT_SOLIDS = {
  pin: (u) => [[tube([0, 0, -2.1 * u], [0, 0, 2.1 * u], 1.3 * u), "steel"], ...[-2.1, 2.1].map((h) => [tube(...flange(h, u), 1.55 * u), "dark"])],
  socket: (u) => [[ball([0, 0, 0], 1.7 * u), "steel"], [new THREE.TorusGeometry(1.75 * u, 0.28 * u, 12, 40), "dark"]],
  slider: (u) => [[new THREE.BoxGeometry(3.6 * u, 3.6 * u, 5.2 * u), "steel"]],
  collar: (u) => [[tube([0, 0, -2.6 * u], [0, 0, 2.6 * u], 1.75 * u), "steel"], ...[-2.6, 2.6].map((h) => [tube(...flange(h, u), 2 * u), "dark"])],
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

// Turns of wire about z, from −length/2 to length/2.
function coil(turns, radius, length, wire) {
  class Helix extends THREE.Curve {
    getPoint(s, target = new THREE.Vector3()) {
      const lead = 0.08, k = clamp((s - lead) / (1 - 2 * lead), 0, 1), r = radius * Math.min(1, s / lead, (1 - s) / lead);
      return target.set(r * Math.cos(k * turns * TAU), r * Math.sin(k * turns * TAU), (s - 0.5) * length);
    }
  }
  return new THREE.TubeGeometry(new Helix(), 28 * turns, wire, 8);
}

// Between two points, along z from 0 on: parts as [geometry, role, how it follows the length].
// "stretch" scales with the length; "head" stays at the first end, "tail" at the second.
const LINK_SOLIDS = {
  coil: (u, rest) => [[coil(9, 1.9 * u, rest, 0.32 * u).translate(0, 0, rest / 2), "spring", "stretch"]],
  dashpot: (u, rest) => [
    [tube([0, 0, 0], [0, 0, 0.62 * rest], 1.05 * u), "pale", "head"], [tube([0, 0, -0.6 * rest], [0, 0, 0], 0.45 * u, 16), "steel", "tail"]],
  cylinder: (u, rest) => [
    [tube([0, 0, 0], [0, 0, 0.6 * rest], 1.25 * u), "drive", "head"], [tube([0, 0, -0.62 * rest], [0, 0, 0], 0.6 * u, 16), "steel", "tail"]],
  sleeve: (u, rest) => [[ball([0, 0, 0.5], 1).scale(1.8 * u, 1.8 * u, rest || u), "drive", "stretch"]],
  strand: (u, rest) => [[tube([0, 0, -0.1 * rest], [0, 0, 1.1 * rest], 0.9 * u, 16), "drive", "stretch"]],
  tie: (u, rest) => [[tube([0, 0, 0], [0, 0, rest], 0.28 * u, 12), "dark", "stretch"]],
  rod: (u, rest) => [[tube([0, 0, 0], [0, 0, rest], 0.7 * u, 20), "steel", "stretch"]],
};

// About an axis, or at a point: drivers and springs that turn.
const SYMBOL_SOLIDS = {
  motor: (u) => [[tube([0, 0, -3.4 * u], [0, 0, -1.6 * u], 2.2 * u), "drive"]],
  brake: (u) => [[tube([0, 0, 1.4 * u], [0, 0, 2 * u], 2.4 * u), "pale"]],
  spiral: (u) => [[coil(3, 2.3 * u, 3 * u, 0.25 * u), "spring"]],
  limit: (u) => [[new THREE.BoxGeometry(0.8 * u, 4 * u, 1.6 * u).translate(2.4 * u, 0, 0), "ground"]],
  travel: (u) => [[tube([0, 0, -3 * u], [0, 0, 3 * u], 0.3 * u), "drive"], [new THREE.ConeGeometry(u, 2.4 * u, 20).rotateX(Math.PI / 2).translate(0, 0, 4 * u), "drive"]],
};

// A wall at which a straight way ends; z points to the free side.
const wall = (u) => [[new THREE.BoxGeometry(7 * u, 7 * u, 0.7 * u).translate(0, 0, -0.35 * u), "ground"], [new THREE.BoxGeometry(7 * u, 7 * u, 0.25 * u), "drive"]];

// What stands on the ground under a joint: a block on a foot; −z is where the ground is.
const pedestal = (u) => [
  [faceted(new THREE.CylinderGeometry(0.9 * u, 2.3 * u, 4 * u, 4, 1)).rotateX(Math.PI / 2).rotateZ(Math.PI / 4).translate(0, 0, -2.6 * u), "ground"],
  [new THREE.BoxGeometry(6 * u, 6 * u, 0.6 * u).translate(0, 0, -4.9 * u), "ground"]];

// An arrow along z, one metre long but for its head; a moment has two heads.
class Arrow {
  constructor(u, heads, material) {
    const [shaft, cone] = [new THREE.CylinderGeometry(0.3 * u, 0.3 * u, 1, 16), new THREE.ConeGeometry(0.9 * u, 3 * u, 24)];
    this.size = 3 * u;
    this.shaft = new THREE.Mesh(shaft.rotateX(Math.PI / 2).translate(0, 0, 0.5), material);
    this.heads = Array.from({ length: heads }, () => new THREE.Mesh(cone.clone().rotateX(Math.PI / 2).translate(0, 0, -this.size / 2), material));
    this.group = new THREE.Group().add(this.shaft, ...this.heads);
    for (const part of this.group.children) part.renderOrder = 10;
  }

  // From a place, so long and that way.
  show(place, way) {
    const length = way ? way.length() : NaN;
    this.group.visible = length > 0.05 * this.size;
    if (!this.group.visible) return;
    const head = Math.min(this.size, 0.6 * length / this.heads.length);
    this.group.position.copy(place);
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(...Z), way.clone().normalize());
    this.shaft.scale.z = Math.max(1e-9, length - head);
    this.heads.forEach((mesh, k) => { mesh.scale.setScalar(head / this.size); mesh.position.z = length - 0.75 * k * head; });
  }
}
