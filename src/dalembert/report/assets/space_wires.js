// A still life in lines where there is no WebGL: the edges of all that is shown.
class Wires {
  constructor(canvas) {
    this.canvas = canvas;
    this.edges = new Map();
  }

  setPixelRatio(ratio) { this.ratio = ratio; }
  setSize() {}

  render(world, camera) {
    const { ctx, w, h } = fitCanvas(this.canvas, this.ratio);
    ctx.fillStyle = `#${world.background.getHexString()}`;
    ctx.fillRect(0, 0, w, h);
    world.updateMatrixWorld();
    const seen = new THREE.Matrix4();
    world.traverseVisible((item) => {
      const edges = this.edgesOf(item);
      if (!edges) return;
      seen.multiplyMatrices(camera.matrixWorldInverse, item.matrixWorld);
      ctx.beginPath();
      const p = new THREE.Vector3(), from = new THREE.Vector3();
      for (let k = 0; k < edges.count; k++) {
        p.fromBufferAttribute(edges, k).applyMatrix4(seen);
        if (k % 2 === 0) { from.copy(p); continue; }
        if (from.z > -camera.near || p.z > -camera.near) continue;
        for (const [q, move] of [[from, "moveTo"], [p, "lineTo"]]) {
          q.applyMatrix4(camera.projectionMatrix);
          ctx[move]((1 + q.x) * w / 2, (1 - q.y) * h / 2);
        }
      }
      stroke(ctx, `#${item.material.color.getHexString()}`, 1.2);
    });
  }

  edgesOf(item) {
    if (item.visible === false || item.isLineSegments2 || item.material?.isShadowMaterial || !item.geometry) return null;
    if (item.isLineSegments) return item.geometry.attributes.position;
    if (!this.edges.has(item)) this.edges.set(item, new THREE.EdgesGeometry(item.geometry, 12).attributes.position);
    return this.edges.get(item);
  }
}
