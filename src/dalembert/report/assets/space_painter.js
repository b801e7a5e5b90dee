// Without WebGL: the same world on a flat canvas, painted from the farthest piece to the nearest.

class Painter {
  constructor(canvas) { this.canvas = canvas; }

  setPixelRatio(ratio) { this.ratio = ratio; }
  setSize() {}

  render(world, camera) {
    Object.assign(this, fitCanvas(this.canvas, this.ratio), { camera, pieces: [] });
    this.ctx.fillStyle = `#${world.background.getHexString()}`;
    this.ctx.fillRect(0, 0, this.w, this.h);
    world.updateMatrixWorld();
    world.traverseVisible((item) => {
      const { material, geometry } = item;
      if (item.isLineSegments2) this.addLines(item, geometry.attributes.instanceStart.data.array, material.linewidth);
      else if (item.isLineSegments) this.addLines(item, geometry.attributes.position.array, material.fog ? 0.6 : 1, material.fog);
      else if (item.isMesh && material.isMeshStandardMaterial) this.addFaces(item);
    });
    this.ctx.lineJoin = this.ctx.lineCap = "round";
    for (const piece of this.pieces.sort((a, b) => b.depth - a.depth)) this.paint(piece);
    this.ctx.globalAlpha = 1;
  }

  // Places in the camera's axes, and on the canvas.
  seen(item, array) {
    const view = new THREE.Matrix4().multiplyMatrices(this.camera.matrixWorldInverse, item.matrixWorld);
    const { elements: e } = this.camera.projectionMatrix, p = new THREE.Vector3(), out = [];
    for (let k = 0; k + 2 < array.length; k += 3) {
      p.set(array[k], array[k + 1], array[k + 2]).applyMatrix4(view);
      const near = p.z > -this.camera.near;
      out.push({ x: p.x, y: p.y, z: p.z, u: near ? NaN : (1 - (e[0] * p.x) / p.z) * this.w / 2, v: near ? NaN : (1 + (e[5] * p.y) / p.z) * this.h / 2 });
    }
    return out;
  }

  addLines(item, array, width, behind = false) {
    const places = this.seen(item, array), colour = `#${item.material.color.getHexString()}`, alpha = item.material.opacity;
    const bias = 0.004 * this.camera.position.length();  // lines lie on faces
    for (let k = 0; k + 1 < places.length; k += 2) {
      const ends = [places[k], places[k + 1]];
      this.pieces.push({ ends, depth: behind ? Infinity : -(ends[0].z + ends[1].z) / 2 - bias, colour, alpha, width });
    }
  }

  addFaces(item) {
    const { geometry, material } = item, places = this.seen(item, geometry.attributes.position.array), index = geometry.index?.array;
    const count = index ? index.length : places.length, cut = material.clippingPlanes?.[0], spot = new THREE.Vector3();
    const base = `#${material.color.getHexString()}`, front = material.depthTest ? 0 : Infinity;
    for (let k = 0; k + 2 < count; k += 3) {
      const ends = [0, 1, 2].map((i) => places[index ? index[k + i] : k + i]), [a, b, c] = ends;
      const [ux, uy, uz, vx, vy, vz] = [b.x - a.x, b.y - a.y, b.z - a.z, c.x - a.x, c.y - a.y, c.z - a.z];
      const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], size = Math.hypot(nx, ny, nz);
      if (!size || nx * a.x + ny * a.y + nz * a.z >= 0) continue;
      if (cut && cut.distanceToPoint(spot.set((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3).applyMatrix4(this.camera.matrixWorld)) < 0) continue;
      const lit = (0.3 * nx + 0.75 * ny + 0.6 * nz) / size;
      this.pieces.push({ ends, depth: -(a.z + b.z + c.z) / 3 - front, colour: lit > 0 ? mix(base, "#ffffff", 0.25 * lit) : mix(base, "#000000", -0.45 * lit), alpha: material.opacity });
    }
  }

  paint({ ends, colour, alpha, width }) {
    const { ctx } = this;
    if (ends.some(({ u }) => u !== u)) return;
    ctx.globalAlpha = alpha;
    ctx.beginPath();
    ends.forEach(({ u, v }, i) => (i ? ctx.lineTo(u, v) : ctx.moveTo(u, v)));
    if (width) return stroke(ctx, colour, width);
    ctx.closePath();
    ctx.fillStyle = colour;
    ctx.fill();
    if (alpha === 1) stroke(ctx, colour, 0.7);
  }
}
