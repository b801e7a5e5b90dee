// A mechanism in the plane: its motion and its drawing.

const readMotion = (payload) => new Motion(payload);
const drawScene = (motion) => new Scene(motion, byId("scene"), byId("tip"));
const moreTools = () => {};
