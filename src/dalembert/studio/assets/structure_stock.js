// Cross-sections, materials and element types of structures, and the fields that an element of a type has.

/** @import { Operation } from "./operations.js" */

/** Properties of a cross-section, see `elements/sections.py`: area, second moments about its y and z axes, torsion constant, shear areas.
 * @typedef {{ area: number, y: number, z: number, torsion: number, shearY: number, shearZ: number }} Section */
/** @typedef {{ modulus: number, poisson: number, density: number, expansion: number }} Material */

/** Rectangle of a width and a height [m]. @param {number} width @param {number} height @returns {Section} */
const rectangle = (width, height) => {
  const [long, short] = [Math.max(width, height), Math.min(width, height)], slender = short / long, area = width * height;
  return { area, y: (height * width ** 3) / 12, z: (width * height ** 3) / 12, torsion: long * short ** 3 * (1 / 3 - 0.21 * slender * (1 - slender ** 4 / 12)), shearY: (5 / 6) * area, shearZ: (5 / 6) * area };
};
/** Circular tube; a wall of half the diameter is a solid. @param {number} diameter @param {number} wall @returns {Section} */
const tube = (diameter, wall) => {
  const inner = diameter - 2 * wall, area = (Math.PI / 4) * (diameter ** 2 - inner ** 2), bend = (Math.PI / 64) * (diameter ** 4 - inner ** 4), shear = (inner > 0 ? 0.5 : 0.9) * area;
  return { area, y: bend, z: bend, torsion: 2 * bend, shearY: shear, shearZ: shear };
};

/** Cross-sections; those of IPE are nominal values of EN 10365 (the shear areas that of the web, and 5/6 of the flanges). @type {Record<string, Section>} */
export const SECTIONS = {
  "Tube 60 × 3": tube(0.06, 0.003), "Tube 100 × 5": tube(0.1, 0.005), "Round 20": tube(0.02, 0.01), "Square 50": rectangle(0.05, 0.05), "Timber 100 × 200": rectangle(0.1, 0.2),
  "IPE 100": { area: 10.3e-4, y: 15.9e-8, z: 171e-8, torsion: 1.2e-8, shearY: 4.1e-4, shearZ: (5 / 3) * 0.055 * 0.0057 },
  "IPE 200": { area: 28.5e-4, y: 142e-8, z: 1943e-8, torsion: 6.98e-8, shearY: 11.2e-4, shearZ: (5 / 3) * 0.1 * 0.0085 },
};
/** @type {Record<string, Material>} */
export const MATERIALS = {
  Steel: { modulus: 210e9, poisson: 0.3, density: 7850, expansion: 1.2e-5 }, Aluminium: { modulus: 70e9, poisson: 0.33, density: 2700, expansion: 2.3e-5 }, Titanium: { modulus: 110e9, poisson: 0.34, density: 4430, expansion: 8.6e-6 },
  Timber: { modulus: 11e9, poisson: 0.3, density: 450, expansion: 5e-6 }, Concrete: { modulus: 30e9, poisson: 0.2, density: 2400, expansion: 1e-5 },
};

/** Required fields of the types of members: planar, then spatial. @type {Record<string, string[]>} */
const FIELDS = {
  Truss: ["area", "modulus"],
  Frame: ["area", "second_moment", "modulus"], TimoshenkoFrame: ["area", "second_moment", "modulus", "shear_modulus", "shear_area"],
  SpaceFrame: ["area", "second_moment_y", "second_moment_z", "torsion_constant", "modulus", "shear_modulus"],
  TimoshenkoSpaceFrame: ["area", "second_moment_y", "second_moment_z", "torsion_constant", "modulus", "shear_modulus", "shear_area_y", "shear_area_z"],
};
/** Titles of the types of members. @type {Record<string, string>} */
export const MEMBERS = { Truss: "Bar (axial force)", Frame: "Beam, Euler–Bernoulli", TimoshenkoFrame: "Beam, Timoshenko", SpaceFrame: "Beam, Euler–Bernoulli", TimoshenkoSpaceFrame: "Beam, Timoshenko" };
/** Types of members of planar and of spatial structures. */
export const PLANE_MEMBERS = ["Truss", "Frame", "TimoshenkoFrame"], SPACE_MEMBERS = ["Truss", "SpaceFrame", "TimoshenkoSpaceFrame"];
/** Titles of the types of regions: those of polygons, then those of rectangles too. @type {Record<string, string>} */
export const CELLS = { Triangle6: "Triangles, quadratic", Triangle: "Triangles, linear", Quadrilateral8: "Quadrilaterals, quadratic", Quadrilateral: "Quadrilaterals, linear" };
/** Fields that follow from a cross-section or a material. */
const OWN = [...new Set(Object.values(FIELDS).flat())];

/** Number with the digits of tables. @param {number} value */
const rounded = (value) => Number(value.toPrecision(5));

/** Values of a cross-section by field. @param {Section} section @returns {Record<string, number>} */
const sectionValues = ({ area, y, z, torsion, shearY, shearZ }) => ({ area, second_moment: z, second_moment_y: y, second_moment_z: z, torsion_constant: torsion, shear_area: shearY, shear_area_y: shearY, shear_area_z: shearZ });

/** Values of a material by field. @param {Material} material @returns {Record<string, number>} */
const materialValues = ({ modulus, poisson, density, expansion }) => ({ modulus, poisson, density, expansion, shear_modulus: modulus / (2 * (1 + poisson)) });

/** Fields of a new member. @param {string} type @param {Section} section @param {Material} material @returns {Record<string, number>} */
export function memberFields(type, section, material) {
  const values = { ...sectionValues(section), ...materialValues(material) };
  return Object.fromEntries([...FIELDS[type], "density"].map((key) => [key, rounded(values[key])]));
}

/** Name of the cross-section or material of an entry; empty if it has another. @param {Record<string, any>} entry @param {"section" | "material"} kind */
export function stockOf(entry, kind) {
  const table = kind === "section" ? SECTIONS : MATERIALS;
  const fits = (/** @type {Record<string, number>} */ values) => Object.entries(values).every(([key, value]) => !(key in entry) || (kind === "material" && key === "expansion") || entry[key] === rounded(value));
  return Object.keys(table).find((name) => fits(kind === "section" ? sectionValues(SECTIONS[name]) : materialValues(MATERIALS[name]))) ?? "";
}

/** Operations that give an entry a cross-section or a material. @param {string[]} keys @param {Record<string, any>} entry @param {"section" | "material"} kind @param {string} name @returns {Operation[]} */
export function stocked(keys, entry, kind, name) {
  const values = kind === "section" ? sectionValues(SECTIONS[name]) : materialValues(MATERIALS[name]);
  return Object.entries(values).flatMap(([key, value]) => (key in entry ? [{ op: "set", keys: [...keys, key], value: rounded(value), written: true }] : []));
}

/** Operations that change the type of a member: fields that only the former type has are removed, those that it lacks are added.
 * Values that do not follow from a cross-section of the stock are those of a rectangle with 0.3 as Poisson's ratio. @param {string[]} keys @param {Record<string, any>} entry @param {string} type @returns {Operation[]} */
export function retyped(keys, entry, type) {
  const number = (/** @type {unknown} */ value, /** @type {number} */ factor, /** @type {string} */ text) => (typeof value === "number" ? rounded(value * factor) : `${text} * (${value})`);
  const section = SECTIONS[stockOf(entry, "section")] ?? null, material = MATERIALS[stockOf(entry, "material")] ?? null, bend = entry.second_moment ?? entry.second_moment_z ?? entry.second_moment_y;
  const known = { ...(section && sectionValues(section)), ...(material && materialValues(material)) };
  /** @type {Record<string, () => unknown>} */
  const otherwise = {
    shear_modulus: () => number(entry.modulus, 1 / 2.6, "1 / 2.6"), shear_area: () => number(entry.area, 5 / 6, "5 / 6"), shear_area_y: () => number(entry.area, 5 / 6, "5 / 6"), shear_area_z: () => number(entry.area, 5 / 6, "5 / 6"),
    second_moment: () => bend ?? squareMoment(entry.area, 1), second_moment_y: () => bend ?? squareMoment(entry.area, 1), second_moment_z: () => bend ?? squareMoment(entry.area, 1), torsion_constant: () => (bend === undefined ? squareMoment(entry.area, 1.69) : number(bend, 1.69, "1.69")),
  };
  const drops = OWN.filter((key) => key in entry && !FIELDS[type].includes(key)), adds = FIELDS[type].filter((key) => !(key in entry));
  return [
    { op: "set", keys: [...keys, "type"], value: type, written: true }, ...drops.map((key) => ({ op: "drop", keys: [...keys, key] })),
    ...(type === "Truss" ? ["temperature_gradient", "temperature_gradient_y", "temperature_gradient_z"].map((key) => ({ op: "drop", keys: [...keys, key] })) : []),
    ...adds.map((key) => ({ op: "set", keys: [...keys, key], value: known[key] === undefined ? otherwise[key]() : rounded(known[key]), written: true })),
  ];
}

/** Second moment of area of a square cross-section, times a factor. @param {unknown} area @param {number} factor */
const squareMoment = (area, factor) => (typeof area === "number" ? rounded((factor * area ** 2) / 12) : `${rounded(factor / 12)} * (${area})**2`);
