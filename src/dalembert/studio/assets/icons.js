// Icons of the tools: lines on a square of 20 units.

/** @type {Record<string, string>} */
const PATHS = {
  select: "M5 3l11 7-5 1 3 5-2 1-3-5-4 4z",
  round: "M3 16L5 4l12 2-1 11zM10 10.5m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0",
  hole: "M3 16L5 4l12 2-1 11zM8 13l1-5 5 2z",
  roller: "M10 4l-4 7h8zM3 17h14M7 14m-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0M13 14m-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0",
  clamp: "M4 3v14M4 10h13M4 5l-3 2M4 9l-3 2M4 13l-3 2M4 17l-3 2",
  displacement: "M4 14h12M10 14V4M7 7l3-3 3 3M4 14l-2 3M8 14l-2 3M12 14l-2 3M16 14l-2 3",
  heat: "M8 12V5a2 2 0 0 1 4 0v7a3.500 3.500 0 1 1-4 0zM10 7v7M14 5h3M14 8h3",
  mirror: "M10 2v3M10 8v4M10 15v3M3 6l4 4-4 4zM17 6l-4 4 4 4z",
  bar: "M5 15L15 5M5 15m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0M15 5m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  plate: "M3 16L6 4l11 4-4 9z",
  mass: "M10 10m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0M10 10m-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0",
  beam: "M3 4v12M3 10c6 0 9-1 14 4M3 6l-2 2M3 10l-2 2M3 14l-2 2",
  point: "M10 10m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0M10 3v4M10 13v4M3 10h4M13 10h4",
  pin: "M10 7m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0M8 9.5l-4 6h12l-4-6M3 15.5h14",
  slider: "M2 6h16M2 14h16M10 10m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0",
  slot: "M5 7h10a3 3 0 0 1 0 6h-10a3 3 0 0 1 0-6zM12 10m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  guide: "M2 15h16M6 7h8v8h-8zM10 3v1M4 15l-2 3M9 15l-2 3M14 15l-2 3",
  weld: "M3 17L10 10L17 17M10 10V3M7 10l3-3 3 3-3 3z",
  link: "M5 15L15 5M5 15m-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0M15 5m-1.5 0a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0",
  gears: "M7 10m-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0-9 0M14.5 10m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0M7 4v1.5M7 14.5v1.5M1 10h1.5M2.800 5.800l1 1M2.800 14.2l1-1",
  rack: "M10 7m-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0-9 0M2 14l1.5-2h2l1.5 2h2l1.5-2h2l1.5 2h2l1.5-2M2 17h16",
  cam: "M9 17c-4 0-6-3-6-6c0-4 5-8 8-8c3 0 3 2 4 5c1 4-2 9-6 9zM8.5 11.5m-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0",
  force: "M3 17L15 5M9 5h6v6",
  torque: "M15.5 6a7 7 0 1 0 1.5 5M16 2v4.5h-4.5",
  spring: "M2 10h3l1.5-4 3 8 3-8 3 8 1-4h1.5",
  damper: "M2 10h6M8 7v6M6 5h8v10h-8M14 10h4",
  torsion: "M10 10c0-1 2-1 2 1c0 2-4 3-4-1c0-4 7-4 7 1c0 6-10 6-10-1c0-5 4-7 8-6",
  cylinder: "M2 13h10v-6h-10zM12 10h6M8 7v6",
  hydraulic: "M2 13h10v-6h-10zM12 10h6M8 7v6M4 7v-4M10 7v-4M4 3l-1.5 2M4 3l1.5 2",
  rope: "M3 15c0-8 5-12 7-12s7 4 7 12M10 6m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0",
  stop: "M3 10h9M9 7l3 3-3 3M14 4v12M14 5l3 2M14 9l3 2M14 13l3 2",
  contact: "M2 15h16M10 10m-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0M5 15l-2 3M10 15l-2 3M15 15l-2 3",
  circle: "M10 10m-6 0a6 6 0 1 0 12 0a6 6 0 1 0-12 0M10 10h6",
  capsule: "M6 6h8a4 4 0 0 1 0 8h-8a4 4 0 0 1 0-8zM6 10h8",
  polygon: "M10 2.5l7 5.200-2.700 8.300h-8.600L3 7.700z",
  halfplane: "M2 10h16M4 10l-2 3M8 10l-2 3M12 10l-2 3M16 10l-2 3M10 7V2M8 4l2-2 2 2",
  motor: "M10 10m-6 0a6 6 0 1 0 12 0a6 6 0 1 0-12 0M7 13v-6l3 4 3-4v6",
  drive: "M2 14h16M6 8h8v6h-8zM5 4h10M13 2l2 2-2 2M7 2L5 4l2 2",
  target: "M10 10m-6 0a6 6 0 1 0 12 0a6 6 0 1 0-12 0M10 10m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0M10 1v4M10 15v4M1 10h4M15 10h4",
  pose: "M4 16l9-9M8 6l6-1-1 6M4 16m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0",
  stroke: "M3 10h14M6 7l-3 3 3 3M14 7l3 3-3 3M3 4v12M17 4v12",
};

/** Icon of a tool. @param {string} name */
export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  svg.setAttribute("viewBox", "0 0 20 20");
  svg.setAttribute("class", "icon");
  svg.setAttribute("aria-hidden", "true");
  path.setAttribute("d", PATHS[name] ?? "M4 4h12v12H4z");
  svg.append(path);
  return svg;
}
