// How one looks into space: camera, light, shadows, the grid on the ground, turning and zooming.

const FIELD = 28;  // degrees of the camera, upwards; narrow, so that parallels stay nearly parallel

// The axis that points up: against gravity, else z.
function upward(gravity) {
  if (!gravity) return vector(AXES.z);
  const k = [0, 1, 2].sort((a, b) => Math.abs(gravity[b]) - Math.abs(gravity[a]))[0];
  return vector([0, 1, 2].map((i) => (i === k ? -Math.sign(gravity[k]) : 0)));
}

function sphereAbout(cloud) {
  const sphere = new THREE.Box3().setFromPoints(cloud).getBoundingSphere(new THREE.Sphere());
  return { centre: sphere.center, radius: sphere.radius || 0.5 };
}

class View {
  constructor(canvas, cloud, up, onChange) {
    Object.assign(this, { canvas, cloud, up, onChange });
    Object.assign(this, sphereAbout(cloud));
    this.world = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, this.radius / 100, 100 * this.radius);
    this.camera.up.copy(up);
    this.renderer = rendererOf(canvas);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { rotateSpeed: 0.8, zoomToCursor: true, minDistance: 0.02 * this.radius, maxDistance: 60 * this.radius });
    this.controls.addEventListener("start", () => canvas.classList.add("grabbing"));
    this.controls.addEventListener("end", () => canvas.classList.remove("grabbing"));
    this.light();
    this.ground();
    this.look(this.oblique());
    this.controls.addEventListener("change", () => { this.fitted = false; onChange(); });
  }

  // From the front, from the right and from above.
  oblique() {
    const [u, v] = this.sides();
    return u.clone().multiplyScalar(0.55).addScaledVector(v, -1).addScaledVector(this.up, 0.5);
  }

  // Two horizontal axes; with the vertical one they are right-handed.
  sides() {
    const u = Math.abs(this.up.x) < 0.5 ? vector(AXES.x) : vector(AXES.y);
    return [u, new THREE.Vector3().crossVectors(this.up, u)];
  }

  light() {
    this.sky = new THREE.HemisphereLight("#ffffff", "#8892a0", 1.9);
    this.sky.position.copy(this.up);
    this.sun = new THREE.DirectionalLight("#fffaf0", 2.1);
    const [u, v] = this.sides(), r = this.radius;
    this.sun.position.copy(this.centre).addScaledVector(this.up, 4 * r).addScaledVector(u, -1.6 * r).addScaledVector(v, -2 * r);
    this.sun.target.position.copy(this.centre);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    Object.assign(this.sun.shadow.camera, { left: -1.8 * r, right: 1.8 * r, top: 1.8 * r, bottom: -1.8 * r, near: 0.5 * r, far: 12 * r });
    this.sun.shadow.normalBias = 0.004 * r;
    this.sun.shadow.radius = 4;
    this.fill = new THREE.DirectionalLight("#dfe9ff", 0.55);
    this.fill.position.copy(this.centre).addScaledVector(u, 3 * r).addScaledVector(v, 2 * r).addScaledVector(this.up, r);
    this.world.add(this.sky, this.sun, this.sun.target, this.fill, this.fill.target);
    this.fill.target.position.copy(this.centre);
  }

  // A grid under everything: through the origin where that is the lowest place.
  ground() {
    const heights = this.cloud.map((p) => p.dot(this.up)), low = Math.min(...extent([heights]));
    const height = Math.abs(low) < 0.12 * this.radius ? Math.min(0, low) : low - 0.05 * this.radius;
    const [u, v] = this.sides(), step = niceAbove(this.radius / 2.5), many = Math.ceil((8 * this.radius) / step);
    const middle = [u, v].map((axis) => Math.round(this.centre.dot(axis) / step) * step);
    const lines = [[], []];
    for (let k = -5 * many; k <= 5 * many; k++) {
      // In pieces, for not every machine cuts a line well that runs behind the camera.
      for (let piece = -many; piece < many; piece++) {
        const s = (k * step) / 5, [from, to] = [piece * step, (piece + 1) * step];
        for (const [p, q] of [[s, from], [s, to], [from, s], [to, s]]) {
          lines[k % 5 ? 0 : 1].push(u.clone().multiplyScalar(middle[0] + p).addScaledVector(v, middle[1] + q).toArray());
        }
      }
    }
    this.grid = new THREE.Group().add(...lines.map((layer) => new THREE.LineSegments(polyline(layer), new THREE.LineBasicMaterial())));
    const floor = new THREE.Mesh(new THREE.PlaneGeometry(40 * this.radius, 40 * this.radius), new THREE.ShadowMaterial({ depthWrite: false }));
    floor.quaternion.setFromUnitVectors(vector(AXES.z), this.up);
    floor.position.copy(u).multiplyScalar(middle[0]).addScaledVector(v, middle[1]).addScaledVector(this.up, -0.002 * this.radius);
    floor.receiveShadow = true;
    this.floor = floor;
    this.grid.add(floor);
    this.grid.position.copy(this.up).multiplyScalar(height);
    this.step = step;
    this.world.add(this.grid);
    this.world.fog = new THREE.Fog("#ffffff", 1, 2);
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

  // From a direction at the whole motion, as near as it fits.
  look(direction) {
    const { camera, controls } = this;
    camera.position.copy(this.centre).addScaledVector(direction.clone().normalize(), 6 * this.radius);
    controls.target.copy(this.centre);
    controls.update();
    this.fit();
  }

  fit() {
    this.camera.updateMatrixWorld();
    const { camera, canvas, controls } = this, aspect = (canvas.clientWidth || 1) / (canvas.clientHeight || 1);
    const [x, y, z] = [0, 1, 2].map((k) => new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, k));
    const tan = Math.tan((FIELD * TAU) / 720) * 0.84, spots = this.cloud.map((p) => p.clone().sub(this.centre)).map((p) => [p.dot(x), p.dot(y), p.dot(z)]);
    const middle = [0, 1].map((k) => { const [lo, hi] = extent([spots.map((s) => s[k])]); return (lo + hi) / 2; });
    let away = 0.2 * this.radius;
    for (const [a, b, c] of spots) away = Math.max(away, c + Math.abs(a - middle[0]) / (tan * aspect), c + Math.abs(b - middle[1]) / tan);
    controls.target.copy(this.centre).addScaledVector(x, middle[0]).addScaledVector(y, middle[1]);
    camera.position.copy(controls.target).addScaledVector(z, away);
    controls.update();
    this.fitted = true;
    this.onChange();
  }

  zoom(factor) {
    const { camera, controls } = this, way = camera.position.clone().sub(controls.target);
    camera.position.copy(controls.target).addScaledVector(way, clamp(1 / factor, controls.minDistance / way.length(), controls.maxDistance / way.length()));
    controls.update();
  }

  render(ratio) {
    const { camera, canvas, renderer, radius } = this, { clientWidth: w, clientHeight: h } = canvas;
    const away = camera.position.distanceTo(this.centre);
    camera.aspect = w / h;
    [camera.near, camera.far] = [Math.max(away - 12 * radius, away / 100, radius / 300), away + 30 * radius];
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    [this.world.fog.near, this.world.fog.far] = [away + 1.5 * radius, away + 8.5 * radius];
    renderer.setPixelRatio(ratio || window.devicePixelRatio || 1);
    renderer.setSize(w, h, false);
    renderer.render(this.world, camera);
  }

  // Where a place is on the canvas, and how many pixels a metre has there; null behind the camera.
  screen(place) {
    const p = place.clone().applyMatrix4(this.camera.matrixWorldInverse), { clientWidth: w, clientHeight: h } = this.canvas;
    if (p.z > -1e-9) return null;
    const scale = h / 2 / Math.tan((FIELD * TAU) / 720) / -p.z;
    return { x: w / 2 + p.x * scale, y: h / 2 - p.y * scale, depth: -p.z, scale };
  }
}

// WebGL; without it, a painter on the same canvas.
function rendererOf(canvas) {
  try {
    if (!document.createElement("canvas").getContext("webgl2")) return new Painter(canvas);
    const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    renderer.localClippingEnabled = true;
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFShadowMap;
    return renderer;
  } catch {
    return new Painter(canvas);
  }
}
