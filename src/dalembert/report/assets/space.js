// A mechanism in space: its motion and its drawing.

const readMotion = (payload) => new SpatialMotion(payload);
const drawScene = (motion) => new SpatialScene(motion, byId("scene"), byId("tip"));
const moreTools = (scene, toolbar) => buildSpaceTools(scene, toolbar);
