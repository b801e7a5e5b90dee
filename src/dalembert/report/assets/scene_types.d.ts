// Types of the scene: its payload, the parts it is read into, and what views and painters have in common.

import type { Body, Child, Column, Context, Cursor, LoadKind, Payload, Point } from "./types.d.ts";
import type { Marks } from "./marks.js";
import type { Mesh } from "./mesh.js";
import type { Motion } from "./motion.js";
import type { Scene } from "./scene.js";
import type { Swing } from "./swing.js";

/** Point on the canvas [px]. */
export type Pixel = [number, number];

export type Axis = "x" | "y" | "z";

// Payload ----------------------------------------------------------------------------------------

export interface EndData { body?: string; point?: number[]; axis?: number[] | null; radius?: number }

/** Joint, symbol, support or load; columns are over the instants or states. */
export interface ItemData extends EndData {
  name?: string;
  description?: string;
  symbol?: string;
  base?: EndData;
  grounded?: boolean;
  on?: string;
  i?: string;
  j?: string;
  mesh?: EndData[];
  wheels?: EndData[];
  internal?: boolean;
  crossed?: boolean;
  node?: number;
  nodes?: number[];
  roller?: boolean;
  clamp?: boolean;
  inward?: Column;
  [column: string]: unknown;
}

export interface BodyData { name?: string; of?: string; node?: boolean; shapes?: Partial<Shape>[]; [column: string]: unknown }
export interface LinkData { name?: string; description?: string; symbol?: string; i: EndData; j: EndData }
export interface CellsData { size: number; vertices: number[]; elements: number[] }
export interface FieldData { name: string; unit?: string; values: Column[] }

/** Diagram of a section force: fields at the ends of lines, and directions across them (x, y, z). */
export interface DiagramData { name: string; start: string; end: string; sign: number; elements: number[]; across: number[] }

/** Mesh of a structure: positions at rest and displacements of each state, lines, faces and points of its vertices. */
export interface MeshData {
  rest: Column;
  vertex_displacements: Column[];
  lines: CellsData[];
  faces: CellsData[];
  points: CellsData[];
  outline: number[];
  nodes: string[];
  elements: string[];
  scales: number[];
  drop: number;
}

export interface SceneData {
  dimension?: number;
  gravity?: number[] | null;
  bodies?: BodyData[];
  ground?: { shapes?: Partial<Shape>[] };
  joints?: ItemData[];
  links?: LinkData[];
  symbols?: ItemData[];
  points?: { name?: string; body: string; point: number[] }[];
  ghosts?: (BodyData & { mesh?: MeshData })[];
  gaps?: { from: number[]; to: number[]; text?: string }[];
  mesh?: MeshData;
  fields?: FieldData[];
  diagrams?: DiagramData[];
}

/** States of a model: load cases, modes, or instants at `times`; modes have values and damping ratios. */
export interface States { kind: string; names: string[]; times?: Column; relative?: boolean; numbers?: Column; values?: Column; unit?: string; damping?: Column }

/** Tables of a structure. */
export interface Tables {
  directions?: string[];
  numbers?: number[];
  displacements?: Column[];
  reactions?: { node: string; name: string; unit: string; values: Column }[];
}

// Parts of a scene ---------------------------------------------------------------------------------

/** Shape of a body; which fields it has depends on its kind. */
export interface Shape {
  kind: string;
  from: Point;
  to: Point;
  center: Point;
  radius: number;
  points: Point[];
  closed: boolean;
  width: number;
  height: number;
  angle: number;
  axis: Point;
  size: number[];
  turn: number[];
  vertices: number[];
  faces: number[];
  teeth?: Teeth;
}

/** Teeth of a gear; `toward` points to the mesh, in the axes of the body. */
export interface Teeth { count: number; toward: number[]; gap: boolean; ring: boolean }

export type Part = Body;

export interface End { body: Part; point: Point; axis: Point | null }
export interface Wheel extends End { radius: number }

export interface Item extends End {
  name: string;
  description: string;
  symbol: string;
  base: End | null;
  grounded: boolean;
  on: Part | null;
  i: Part;
  j: Part;
  mesh: Wheel[];
  wheels: Wheel[];
  internal: boolean;
  crossed: boolean;
  force: Float64Array[] | null;
  moment: Float64Array[] | null;
  /** Position that varies, and the normal of a wall. */
  at: Float64Array[] | null;
  normal: Float64Array[] | null;
  /** Node of a mesh, or nodes of a support. */
  node: number | null;
  nodes: number[];
  roller: boolean;
  clamp: boolean;
  /** Whether the head of the arrow is at the node. */
  inward: Float64Array | null;
  /** Number of the present position of its label. */
  side?: number;
}

/** Primitive between two points; `rest` is its mean length, `offset` its distance from links between the same points. */
export interface Link { name: string; description: string; symbol: string; i: End; j: End; rest: number; offset: number }

/** Body of another design or run. */
export interface Ghost { shapes: Shape[]; [column: string]: any }

export interface Gap { from: Point; to: Point; text: string }

/** Object under the pointer. */
export interface Hit { kind: "body" | "joint" | "link" | "point" | "symbol" | "node" | "element"; item: any }

/** Text with the positions it may have, best first; a text that is not `required` is left out where none is free. */
export interface Label { text: string; font: string; colour: string; places: Pixel[]; required: boolean; owner: { side?: number; [key: string]: any } }

/** Arrow of a load in its last drawing. */
export interface DrawnArrow { item: Item; role: LoadKind; from: Pixel; way: Pixel; value: number; inward?: boolean }

// Views and painters ---------------------------------------------------------------------------------

/** Camera: position of the scene on the canvas. */
export interface View {
  /** Whether the whole scene is in view. */
  fitted: boolean;
  hint: string;
  keys: Record<string, () => void>;
  /** Prepare for a scene of these points. */
  enclose(cloud: Point[], gravity: Point | null): void;
  /** Show these points. */
  fit(cloud: Point[], margins: { side: number; top: number; bottom: number; left: number }): void;
  zoom(factor: number): void;
  /** Move with the scene. */
  carry(shift: number[]): void;
  /** Position on the canvas; null behind the camera. */
  screen(place: Point): Pixel | null;
  /** Positions on the canvas of vertices (x, y, z), and their depths, larger for nearer ones. */
  project(places: Float64Array): Float64Array;
  /** Pixels per metre at a position. */
  scaleAt(place: Point): number;
  /** Direction on the canvas, with y down, and toward the viewer. */
  direction(vector: number[]): [number, number, number];
}

export interface Painter {
  /** Half the width of a bar [px]. */
  half: number;
  /** Read the parts of the scene. */
  build(): void;
  /** Take the dimensions of the same parts in another design. */
  refit(): void;
  restyle(): void;
  /** Draw the scene, on paper instead of the canvas if given; returns the context of the marks. */
  paint(paper: Paper | null): Paper;
  /** Object at a pixel. */
  hit(pixel: Pixel): Hit | null;
  /** Highlight a part. */
  highlight(item: object | null): void;
  /** Labels of bodies and joints. */
  labels(): Label[];
}

/** Context and its size. */
export interface Paper { ctx: Context; w: number; h: number }

/** Parts that only pages of structures, or of modes of mechanisms, have. */
export interface Parts { structure?: Structure | null; Swing?: typeof Swing }

/** Classes of the views of one dimension. */
export interface Dimension extends Parts {
  Motion: new (payload: Payload, parts?: Parts) => Motion;
  View: new (canvas: HTMLCanvasElement, onChange: () => void) => View;
  Painter: new (scene: Scene) => Painter;
}

/** Parts that only pages of structures have. */
export interface Structure {
  Mesh: typeof Mesh;
  Picture: new (painter: any, mesh: Mesh, other: Mesh | null) => any;
  drawDiagram(marks: Marks, mesh: Mesh): void;
  /** Controls of the toolbar; the rest of the page. */
  toggles(motion: Motion, scene: Scene, show: (key: string) => (on: boolean) => void): Child;
  build(motion: Motion, mesh: Mesh): void;
}

export type { Cursor, Point };
