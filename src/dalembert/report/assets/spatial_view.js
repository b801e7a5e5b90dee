// View of a spatial scene: camera, light, shadows, the grid on the ground.

/** @import { Point } from "./types.d.ts" */
/** @import { Axis, Pixel } from "./scene_types.d.ts" */

import "./vendor/three.js";
import { FlatPainter } from "./flat_painter.js";
import { TAU, clamp, extent, niceAbove } from "./numbers.js";
import { discard, polyline } from "./solids.js";
import { AXES, vector } from "./spatial_motion.js";
import { Theme, mix } from "./theme.js";

/** Vertical fields of view in degrees: narrow, so that parallels stay nearly parallel; and so narrow that they are parallel in the drawing. */
const FIELD = 28, PARALLEL = 0.4;
/** Tangent of half a field of view. @param {number} field */
const tangentOf = (field) => Math.tan((field * TAU) / 720);

/** Corners of the view of an empty scene [m]. @type {Point[]} */
const EMPTY = [[-0.4, -0.4, 0], [0.4, 0.4, 0.3]];

/** Size of another scene, relative to the present one, above which light and grid are built again. */
const SLACK = 1.1;

/** Duration of a frame above which frames are drawn at a lower resolution and without shadows while a pointer is held [ms], and that share of the resolution. */
const SLOW_FRAME = 45;
const COARSE = 0.5;

export class SpatialView {
  hint = "Wheel zooms, drag rotates, right-button drag pans.";
  /** @type {Record<string, () => void>} */
  keys = { 1: () => this.lookAlong("x"), 2: () => this.lookAlong("y"), 3: () => this.lookAlong("z"), 4: () => this.lookAlong(null) };

  /** @param {HTMLCanvasElement} canvas @param {() => void} onChange */
  constructor(canvas, onChange) {
    this.canvas = canvas;
    this.onChange = onChange;
    this.fitted = true;
    this.world = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, 0.01, 100);
    this.tangent = tangentOf(FIELD);
    this.renderer = rendererOf(canvas);
    this.up = vector(AXES.z);
    this.controls = this.orbit();
    this.surroundings = new THREE.Group();
    this.world.add(this.surroundings);
    this.world.fog = new THREE.Fog("#ffffff", 1, 2);
    this.radius = 0;
    this.centre = vector([0, 0, 0]);
    /** @type {THREE.Vector3[]} */
    this.cloud = [];
    this.step = 1;
    /** Share of the canvas of a fitted view, and its margins that stay free [px]. */
    this.share = 0.84;
    this.free = { left: 0, top: 0 };
    /** Duration of the last frame in full quality [ms]; whether the last one was coarse, and a pointer is held. */
    this.duration = 0;
    this.coarse = this.held = false;
    addEventListener("pointerdown", () => { this.held = true; }, true);
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => { this.held = false; if (this.coarse) this.onChange(); }, true);
  }

  /** Controls about the vertical axis. */
  orbit() {
    this.controls?.dispose();
    const { canvas } = this, controls = new THREE.OrbitControls(this.camera, canvas);
    Object.assign(controls, { rotateSpeed: 0.8, zoomToCursor: true });
    controls.addEventListener("start", () => canvas.classList.add("grabbing"));
    controls.addEventListener("end", () => canvas.classList.remove("grabbing"));
    controls.addEventListener("change", () => { this.fitted = false; this.onChange(); });
    return controls;
  }

  /** @param {Point[]} cloud @param {Point | null} gravity */
  enclose(cloud, gravity) {
    const before = this.radius, up = upward(gravity), points = withExtent(cloud).map(vector), sphere = sphereAbout(points);
    if (before && this.up.equals(up) && sphere.centre.distanceTo(this.centre) + sphere.radius < SLACK * before) {  // another design of the same size
      this.cloud = points;
      return;
    }
    this.cloud = points;
    Object.assign(this, sphere);
    this.up = up;
    if (!this.camera.up.equals(this.up)) {
      this.camera.up.copy(this.up);
      this.controls = this.orbit();
    }
    this.limit();
    discard(this.surroundings);
    this.surroundings.clear();
    this.light();
    this.ground();
    if (!before) this.look(this.oblique());
  }

  /** Direction from the front, from the right and from above. */
  oblique() {
    const [u, v] = this.sides();
    return u.clone().multiplyScalar(0.55).addScaledVector(v, -1).addScaledVector(this.up, 0.5);
  }

  /** Two horizontal axes, right-handed with the vertical one. */
  sides() {
    const u = Math.abs(this.up.x) < 0.5 ? vector(AXES.x) : vector(AXES.y);
    return [u, new THREE.Vector3().crossVectors(this.up, u)];
  }

  light() {
    const [u, v] = this.sides(), { centre, radius: r, up } = this;
    this.sky = new THREE.HemisphereLight("#ffffff", "#8892a0", 1.9);
    this.sky.position.copy(up);
    this.sun = new THREE.DirectionalLight("#fffaf0", 2.1);
    this.sun.position.copy(centre).addScaledVector(up, 4 * r).addScaledVector(u, -1.6 * r).addScaledVector(v, -2 * r);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    Object.assign(this.sun.shadow.camera, { left: -1.8 * r, right: 1.8 * r, top: 1.8 * r, bottom: -1.8 * r, near: 0.5 * r, far: 12 * r });
    this.sun.shadow.normalBias = 0.004 * r;
    this.sun.shadow.radius = 4;
    const fill = new THREE.DirectionalLight("#dfe9ff", 0.55);
    fill.position.copy(centre).addScaledVector(u, 3 * r).addScaledVector(v, 2 * r).addScaledVector(up, r);
    for (const { target } of [this.sun, fill]) target.position.copy(centre);
    this.surroundings.add(this.sky, this.sun, this.sun.target, fill, fill.target);
  }

  /** Grid below everything, through the origin if that is lowest; shadows fall on it. */
  ground() {
    const { centre, radius, up } = this, [u, v] = this.sides();
    const low = Math.min(...extent([this.cloud.map((p) => p.dot(up))]) ?? [0]), height = Math.abs(low) < 0.12 * radius ? Math.min(0, low) : low - 0.05 * radius;
    const step = niceAbove(radius / 2.5), many = Math.ceil((8 * radius) / step);
    const middle = [u, v].map((axis) => Math.round(centre.dot(axis) / step) * step);
    /** @type {number[][][]} */
    const lines = [[], []];
    for (let k = -5 * many; k <= 5 * many; k++) {
      // In pieces, because not every driver clips a line behind the camera well.
      for (let piece = -many; piece < many; piece += 8) {
        const s = (k * step) / 5, [from, to] = [piece * step, Math.min(many, piece + 8) * step];
        for (const [p, q] of [[s, from], [s, to], [from, s], [to, s]]) {
          lines[k % 5 ? 0 : 1].push(u.clone().multiplyScalar(middle[0] + p).addScaledVector(v, middle[1] + q).toArray());
        }
      }
    }
    this.floor = new THREE.Mesh(new THREE.PlaneGeometry(40 * radius, 40 * radius), new THREE.ShadowMaterial({ depthWrite: false }));
    this.floor.quaternion.setFromUnitVectors(vector(AXES.z), up);
    this.floor.position.copy(u).multiplyScalar(middle[0]).addScaledVector(v, middle[1]).addScaledVector(up, -0.002 * radius);
    this.floor.receiveShadow = true;
    this.grid = new THREE.Group().add(...lines.map((layer) => new THREE.LineSegments(polyline(layer), new THREE.LineBasicMaterial())), this.floor);
    this.grid.position.copy(up).multiplyScalar(height);
    this.step = step;
    this.surroundings.add(this.grid);
  }

  restyle() {
    const { surface, ink, grid, name } = Theme, dark = name === "dark";
    this.world.background = new THREE.Color(mix(surface, ink, dark ? 0.02 : 0.012));
    this.world.fog.color.copy(this.world.background);
    const [fine, coarse] = this.grid.children;
    fine.material.color.set(mix(surface, grid, 0.55));
    coarse.material.color.set(mix(grid, ink, dark ? 0.12 : 0.1));
    this.floor.material.opacity = dark ? 0.5 : 0.2;
    [this.sky.intensity, this.sun.intensity] = dark ? [1.5, 1.9] : [1.9, 2.1];
  }

  // Camera -------------------------------------------------------------------------------------

  /** Limits of the distance from the target. */
  limit() {
    const away = this.radius * (tangentOf(FIELD) / this.tangent);
    Object.assign(this.controls, { minDistance: 0.02 * away, maxDistance: 60 * away });
  }

  get parallel() { return this.tangent === tangentOf(PARALLEL); }

  /** Parallel projection, or perspective; what is in the middle keeps its size. @param {boolean} on */
  setParallel(on) {
    const before = this.tangent, { camera, controls, fitted } = this;
    camera.fov = on ? PARALLEL : FIELD;
    this.tangent = tangentOf(camera.fov);
    this.limit();
    camera.position.sub(controls.target).multiplyScalar(before / this.tangent).add(controls.target);
    controls.update();
    this.fitted = fitted;
    document.getElementById("parallel")?.setAttribute("aria-pressed", String(on));
    this.onChange();
  }

  /** Look from where another view looks. @param {SpatialView} other */
  adopt(other) {
    if (this.parallel !== other.parallel) this.setParallel(other.parallel);
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.controls.update();
    this.aim(this.canvas.clientWidth, this.canvas.clientHeight);
    this.fitted = false;
    this.onChange();
  }

  /** Look along an axis; obliquely from above without one. @param {Axis | null} axis */
  lookAlong(axis) { this.look(axis ? vector(AXES[axis]).multiplyScalar(axis === "y" ? -1 : 1) : this.oblique()); }

  /** Look from a direction at the whole scene. @param {THREE.Vector3} direction */
  look(direction) {
    const { camera, controls, centre, radius } = this;
    camera.position.copy(centre).addScaledVector(direction.clone().normalize(), 6 * radius);
    controls.target.copy(centre);
    controls.update();
    this.frame();
  }

  /** @param {Point[]} cloud @param {{ side: number, left: number, top: number, bottom: number }} margins [px] */
  fit(cloud, { side, left, top, bottom }) {
    this.free = { left, top: Math.max(0, top - bottom) };
    this.share = clamp(1 - (1.5 * side) / Math.min(this.canvas.clientWidth, this.canvas.clientHeight), 0.5, 0.9);
    this.cloud = withExtent(cloud).map(vector);
    this.centre = sphereAbout(this.cloud).centre;
    this.frame();
  }

  /** Move so near that the points are just in view, without turning. */
  frame() {
    this.camera.updateMatrixWorld();
    const { camera, canvas: { clientWidth: w, clientHeight: h }, centre, cloud, controls, free: { left, top } } = this;
    const [wide, high] = [(w - left) / h, (h - top) / h].map((share) => Math.max(0.1, share || 1) * this.share * this.tangent);
    const [x, y, z] = [0, 1, 2].map((k) => new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, k));
    const spots = cloud.map((p) => p.clone().sub(centre)).map((p) => [p.dot(x), p.dot(y), p.dot(z)]);
    const middle = [0, 1].map((k) => { const [lo, hi] = extent([spots.map((s) => s[k])]) ?? [0, 0]; return (lo + hi) / 2; });
    let away = 0.2 * this.radius;
    for (const [a, b, c] of spots) away = Math.max(away, c + Math.abs(a - middle[0]) / wide, c + Math.abs(b - middle[1]) / high);
    const [dx, dy] = [left, top].map((margin) => (margin * away * this.tangent) / (h || 1));
    controls.target.copy(centre).addScaledVector(x, middle[0] - dx).addScaledVector(y, middle[1] + dy);
    camera.position.copy(controls.target).addScaledVector(z, away);
    controls.update();
    this.fitted = true;
    this.onChange();
  }

  /** @param {number} factor */
  zoom(factor) {
    const { camera, controls } = this, way = camera.position.clone().sub(controls.target);
    camera.position.copy(controls.target).addScaledVector(way, clamp(1 / factor, controls.minDistance / way.length(), controls.maxDistance / way.length()));
    controls.update();
  }

  /** @param {number[]} shift [m] */
  carry(shift) { for (const place of [this.camera.position, this.controls.target, this.centre]) place.add(vector(shift)); }

  /** Render on the canvas. Where frames take long, as without a graphics processor, those of a drag have a lower quality. @param {number | undefined} ratio of a picture, always in full quality */
  render(ratio) {
    const { canvas: { clientWidth: w, clientHeight: h }, renderer } = this, begin = performance.now();
    const coarse = !ratio && this.held && this.duration > SLOW_FRAME;
    this.coarse = coarse;
    this.sun.castShadow = !coarse;
    renderer.setPixelRatio((ratio || window.devicePixelRatio || 1) * (coarse ? COARSE : 1));
    renderer.setSize(w, h, false);
    this.aim(w, h);
    renderer.render(this.world, this.camera);
    if (!coarse) requestAnimationFrame((end) => { this.duration = end - begin; });
  }

  /** Depths of the camera and of the fog. @param {number} w @param {number} h */
  aim(w, h) {
    const { camera, radius, world: { fog } } = this, away = camera.position.distanceTo(this.centre);
    camera.aspect = w / h;
    [camera.near, camera.far] = [Math.max(away - 12 * radius, away / 100, radius / 300), away + 30 * radius];
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    [fog.near, fog.far] = [away + 1.5 * radius, away + 8.5 * radius];
  }

  // Positions on the canvas ------------------------------------------------------------------------

  /** Position in the axes of the camera. @param {Point} place */
  seen(place) { return vector(place).applyMatrix4(this.camera.matrixWorldInverse); }

  /** @param {Point} place @returns {Pixel | null} */
  screen(place) {
    const p = this.seen(place), { clientWidth: w, clientHeight: h } = this.canvas, scale = h / 2 / this.tangent / -p.z;
    return p.z > -1e-9 ? null : [w / 2 + p.x * scale, h / 2 - p.y * scale];
  }

  /** @param {Float64Array} places */
  project(places) {
    const { clientWidth: w, clientHeight: h } = this.canvas, e = this.camera.matrixWorldInverse.elements, seen = new Float64Array(places.length);
    for (let k = 0; k < places.length; k += 3) {
      const [x, y, z] = [0, 1, 2].map((row) => e[row] * places[k] + e[row + 4] * places[k + 1] + e[row + 8] * places[k + 2] + e[row + 12]), scale = h / 2 / this.tangent / -z;
      seen.set(z > -1e-9 ? [NaN, NaN, -Infinity] : [w / 2 + x * scale, h / 2 - y * scale, z], k);
    }
    return seen;
  }

  /** @param {Point} place */
  scaleAt(place) { return this.canvas.clientHeight / 2 / this.tangent / Math.max(1e-9, -this.seen(place).z); }

  /** @param {number[]} v @returns {[number, number, number]} */
  direction(v) {
    const { x, y, z } = vector(v).applyMatrix4(new THREE.Matrix4().extractRotation(this.camera.matrixWorldInverse));
    return [x, -y, z];
  }
}

/** Axis that points up: against gravity, else z. @param {Point | null} gravity @returns {THREE.Vector3} */
function upward(gravity) {
  if (!gravity) return vector(AXES.z);
  const k = [0, 1, 2].sort((a, b) => Math.abs(gravity[b]) - Math.abs(gravity[a]))[0];
  return vector([0, 1, 2].map((i) => (i === k ? -Math.sign(gravity[k]) : 0)));
}

/** Points, or corners about a single one. @param {Point[]} cloud @returns {Point[]} */
function withExtent(cloud) {
  const [first] = cloud, isPoint = cloud.every((p) => p.every((v, k) => v === first[k]));
  return isPoint ? EMPTY.map((p) => /** @type {Point} */ (p.map((v, k) => v + (first?.[k] ?? 0)))) : cloud;
}

/** Sphere about points. @param {THREE.Vector3[]} cloud */
function sphereAbout(cloud) {
  const { center, radius } = new THREE.Box3().setFromPoints(cloud).getBoundingSphere(new THREE.Sphere());
  return { centre: center, radius: radius || 0.5 };
}

/** WebGL; without it, a painter on the same canvas. @param {HTMLCanvasElement} canvas */
function rendererOf(canvas) {
  try {
    if (!document.createElement("canvas").getContext("webgl2")) return new FlatPainter(canvas);
    const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    renderer.localClippingEnabled = true;
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFShadowMap;
    return renderer;
  } catch {
    return new FlatPainter(canvas);
  }
}
