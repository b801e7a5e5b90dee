// Types of the scripts: the payload of a page, and what its parts require of each other.

import type { SceneData, Shape, States, Tables } from "./scene_types.d.ts";

/** Numbers over the instants of a page; null for numbers that are not finite. */
export type Column = ArrayLike<number | null> & Iterable<number | null>;

/** Point in the plane or in space. */
export type Point = [number, number] | [number, number, number];

/** Lower and upper end. */
export type Range = [number, number];

/** Position between the instants `i` and `i + 1`: the share `f` of the step. */
export interface Cursor { i: number; f: number }

// Payload ----------------------------------------------------------------------------------------

export interface Payload extends Tables {
  title?: string;
  subtitle?: string;
  time?: Column;
  series?: SeriesData[];
  scene?: SceneData;
  states?: States;
  /** Names of the series of each plot. */
  default_plots?: string[][];
  events?: Event[];
  trace?: string[];
  /** Name of the second run. */
  other?: string;
  ghost_name?: string;
  diagnosis?: Diagnosis;
  statistics?: Fact[];
  parameters?: Parameter[];
  /** SI unit → factor and name of the preferred unit. */
  units?: Record<string, [number, string]>;
  optimum?: Optimum;
  designs?: DesignsData;
  views?: View[];
  verdict?: { success: boolean; text: string };
  columns?: Packed;
  live?: LiveCode | { reason: string };
}

/** Columns of a page, packed by `report/packing.py`. */
export interface Packed { heads: Head[]; data: string }
export interface Head { n: number; low: string; step: string; planes: number; order: number; gaps?: [number, number][] }

export interface SeriesData { name?: string; unit?: string; group?: string; values?: Column; other?: Column }
export interface Event { name: string; time: number }
export interface Fact { label?: string; value?: string }
export interface Message { level?: string; text?: string }
export interface Diagnosis { summary?: string; messages?: Message[]; items?: Fact[] }
export interface Bounds { value: number; lower?: number | null; upper?: number | null }
export interface Parameter extends Bounds { name?: string; unit?: string; description?: string }

/** Variable or limit of an optimum. */
export interface Bounded extends Bounds { name: string; unit?: string; start: number; active?: "lower" | "upper" | ""; price?: number }
export interface Optimum {
  label: string;
  unit?: string;
  start: number;
  value: number;
  success: boolean;
  message: string;
  variables?: Bounded[];
  limits?: Bounded[];
  prices?: string[];
  history?: { objective: number; violation: number }[];
}

/** Table of designs; a failed design has a reason, an alternative the keys of the payload that differ. */
export interface DesignsData {
  columns: DesignColumn[];
  labels?: string[];
  reasons?: string[];
  alternatives?: Payload[];
  chosen: number;
}
export interface DesignColumn { name: string; unit: string; role: "aim" | "parameter"; values: number[] }

// Views: cards of a page, see `report/views.py` ---------------------------------------------------

interface Card { title: string; note?: string; wide?: boolean; place?: "board" }
export interface FactsView extends Card { kind: "facts"; items: Fact[] }
export interface RowsView extends Card { kind: "rows"; heads: string[]; rows: { name: string; cells: number[]; unit?: string }[] }
export interface NotesView extends Card { kind: "notes"; texts: string[] }
export interface BarsView extends Card { kind: "bars"; rows: { name: string; value: number }[]; unit: string; share: boolean }
export interface HistogramView extends Card {
  kind: "histogram";
  label: string;
  counts: number[];
  edges: number[];
  size: number;
  marks: { name: string; value: number }[];
  /** Mean and standard deviation. */
  normal: [number, number] | null;
}
export interface Line {
  name: string;
  x: number[];
  y: number[];
  style: "line" | "dashed" | "dots" | "band";
  /** Lower ends of a band. */
  low?: number[];
  design?: number;
  /** Designs that the dots select. */
  designs?: number[];
  /** Grey and without a name. */
  quiet?: boolean;
  /** Hollow dots. */
  open?: boolean;
}
export interface CurvesView extends Card {
  kind: "curves";
  x: string;
  y: string;
  lines: Line[];
  equal?: boolean;
  logarithmic?: string;
  levels?: number[];
  follows?: string;
}
export interface EllipsesView extends Card { kind: "ellipses"; names: string[]; units: string[]; centre: number[]; covariance: number[][] }
/** Decimal logarithms of amplitudes or densities over the frequency, and phases [rad]. */
export interface ResponseLine { name: string; unit: string; level: (number | null)[]; phase?: number[] }
/** The same in complex amplitudes, or in values `y` of a density. */
export interface ResponseCurve { name: string; unit: string; re: number[]; im: number[]; y?: number[] }
export interface ResponseLines { x: number[]; lines: ResponseLine[] }
/** Lines over the frequency `x` [Hz], or its decimal logarithm if `log`; `states` are the indices of the drawn states, `first` is shown first. */
export interface ResponseView extends Card { kind: "bode" | "nyquist"; log: boolean; x: number[]; y: string; lines: ResponseLine[]; states: number[]; first: number; /** Lines of another design, in a live page. */ other?: ResponseLines }
/** View of the table of designs; `x` and `y` are indices of its columns. */
export interface DesignView extends Card {
  kind: "front" | "parallel" | "matrix" | "table";
  x?: number;
  y?: number;
  choose?: boolean;
  better?: boolean;
  role?: string;
}
export type View = FactsView | RowsView | NotesView | BarsView | HistogramView | CurvesView | EllipsesView | ResponseView | DesignView;

// Live pages: functions of an analysis as a WebAssembly module, see `analysis/live` ------------------

/** Sizes of a function: entries of its arguments and results, lengths of its work vectors. */
export interface LiveFunction { inputs: number[]; outputs: number[]; work: [number, number, number, number] }
export interface LiveCode {
  kind: "dynamics" | "kinematics" | "equilibrium" | "modes" | "frequency" | "structure frequency" | "statics" | "vibration";
  /** Deflated module in base64. */
  code: string;
  /** JSON of `LiveData`, with all digits. */
  exact: string;
  functions: Record<string, LiveFunction>;
  /** First byte of memory that the module does not occupy. */
  memory: number;
}
/** Numbers with their limits, or conditions followed by the values of their message. */
export interface LiveLimit {
  entity: string;
  size: number;
  unit?: string;
  minimum?: number | null;
  above?: number | null;
  message?: string;
  count?: number;
}
export interface LiveData extends LiveCode {
  /** Start of the run and shortest distance of two instants [s]. */
  start: number;
  instant: number;
  /** Times of the outputs [s]. */
  times: number[] | null;
  /** Nominal parameters and the assembled position for them. */
  anchor: { p: number[]; y: number[] };
  /** Rows whose value at the start is subtracted. */
  relative: number[];
  /** Rows of which the module returns the square. */
  roots: number[];
  check?: LiveCheck;
  /** Prescribed steps. */
  steps?: { ends?: number[]; length?: number; count?: number; end?: number; uncorrected: number[] };
  /** Places of columns in the payload with the numbers of their rows. */
  columns: [(string | number)[], number][];
  /** Places of columns of states in the payload with the numbers of the rows of their entries; −1 for constant ones. */
  states?: [(string | number)[], number[]][];
  /** Places of values one after the other in the payload with the numbers of their rows; −1 for constant ones. */
  blocks?: [(string | number)[], number[]][];
  /** Places of numbers in the payload that follow from parameters. */
  numbers: (string | number)[][];
  /** Names of bodies and elements whose picture remains that of the initial parameters. */
  initial: string[];
  parameters: LiveParameter[];
  /** Instants of a driven motion, numbers of the outputs among them, rows without values, limits of steps. */
  path?: number[];
  places?: number[];
  undetermined?: number[];
  /** Rows with factors of the dissipated energy and of the energy input. */
  work?: [number, number, number][];
  limits?: { regular: number; tolerance: number; turn: number; small: [number, number]; fraction: number };
  /** Limits of quantities and conditions, in the order of the results of the function `quantities`. */
  quantities?: LiveLimit[];
  /** Message where Newton's method for the start has no solution. */
  unsolved?: string;
  /** Limits of the stiffness of a stable equilibrium, numbers of equations and displacements, natural force. */
  stable?: { curved: number; skew: number; rows: number; columns: number; force: number; unit: string };
  /** Natural sizes of the state and the equations of modes, and the name of their analysis. */
  sizes?: { states: number[]; rows: number[] };
  name?: string;
  /** Growth of small motions that counts as none, natural time, and waiting times after the samples of sets of blocks. */
  growing?: number;
  natural?: number;
  instants?: [number, number][] | null;
  /** Frequencies of a response: constants of the default ones, and others that are always evaluated [Hz]; whether the operating point rests. */
  grid?: LiveGrid;
  requested?: number[];
  steady?: boolean;
  /** Numbers of measures, of rates, of displacements with states; names and natural sizes of unknowns and equations; complex change of the parameters by each input. */
  measures?: number;
  rates?: number;
  moved?: number;
  names?: string[];
  unknowns?: number[];
  equations?: number[];
  columns_of?: [number, number][][];
  /** Numbers of free and prescribed displacements of a structure, its loss factor, complex amplitudes of the inputs in each column. */
  free_numbers?: number[];
  held_numbers?: number[];
  loss?: number;
  mix?: [number, number][][];
  /** Rows whose local maxima are located, with the sign of their values; those of amplitudes that are drawn; quantities that responses may have. */
  extremes?: [number, number][];
  amplitudes?: number[];
  measured?: { name: string; unit: string; group: string; row: number }[];
  /** Number of coordinates, and of modes that are computed; all by default. */
  coordinates?: number;
  count?: number | null;
  /** Responses that are shown first, those of the plots by default. */
  responses?: LiveResponse[];
  /** Parameters of the designs of the table. */
  designs?: number[][];
  /** Constraint equations in the order of `violation`. */
  joints?: JointRow[];
  /** Number of free displacements of a structure, and the message of its status. */
  free?: number;
  message?: string;
  /** Steps with error control. */
  adaptive?: { end: number; first: number; longest: number; memory: number[] };
}
/** Limits, sizes and names for the check of a result by the model's own equations. */
export interface LiveGrid {
  default: boolean; span: [number, number] | null; decade: number; across: number; widest: number; narrowest: number; gap: number; margin: number; many: number;
  close: number; reach: number; rounds: number; steps: number; undamped: number; rounding: number; near: number; far: number; growth: number; unstable: number; resonant: number; modes?: number; above?: number;
}
export interface LiveCheck {
  /** Level, limit, and whether residuals are compared with the largest terms. */
  levels: [number, number, boolean][];
  /** Names, units and sizes of the constraint equations. */
  rows: string[];
  units: string[];
  sizes: number[];
  /** Limit for the equations of motion, null where the result has no forces. */
  motion: number | null;
  speeds: string[];
  speed_sizes: number[];
  effort_units: string[];
  efforts: number[];
  /** Natural time [s] and energy [J]. */
  time: number;
  energy?: number;
  /** Upper limit of the number of instants of the complete check. */
  checked: number;
  /** Share of the natural speed below which a mechanism counts as at rest. */
  still: number;
  /** Limit of approximately enforced constraints. */
  drift?: number;
  /** Largest permitted energy error as a share. */
  balance?: number;
  /** Violation after the projection at which a run is lost [m]. */
  lost?: number;
}
/** Outcome, message, time and residual of a result, as `Status` in Python. */
export interface LiveStatus { outcome: string; message: string; time: number; residual: number; success: boolean; warning?: string }

/** Parameter in SI units; `factor` leads to the unit that is shown. */
export interface LiveParameter extends Bounds { name: string; unit: string; factor: number; description?: string; varies?: boolean; /** Keys of the number of a drawing for which it stands; it has no slider. */ drawn?: (string | number)[] }
/** Reduction of a row over time, multiplied by `weight`. */
export interface LiveTerm {
  kind: "final" | "at" | "maximum" | "minimum" | "mean" | "rms" | "integral" | "sum" | "smooth" | "peak" | "top";
  row: number;
  weight: number;
  /** Number of the instant of `at`, and the instant. */
  instant?: number;
  time?: number;
  /** Number of a local maximum, from 1; of `top` among the `count` highest ones. */
  number?: number;
  count?: number;
  /** Width of a smooth extreme, whether it is relative, and the sign of a maximum. */
  smooth?: number;
  relative?: boolean;
  sign?: number;
}
/** Sum of terms and a constant, in `unit`. */
export interface LiveResponse { label: string; unit: string; terms: LiveTerm[]; constant?: number }
/** Request to the worker: `gradients` are the numbers of the responses that are differentiated, `point` the rows of coordinates at an instant. */
export interface LiveRequest { number: number; parameters: ArrayLike<number>; responses: LiveResponse[]; gradients: number[]; point?: { instant: number; rows: number[] } | null; first?: boolean }
/** Result of a run; `first` where it is that of the first instant alone. */
export interface LiveResult { number: number; first?: boolean; times: Float64Array; table: Float64Array; rows: number; drawn?: Int32Array; peaks?: boolean[]; located?: Map<string, number[]>; values: number[]; numbers: Float64Array; status: LiveStatus; duration: number; parameters: ArrayLike<number> }
/** Gradients by the parameters, in SI units, null for responses that are not differentiated; and of the coordinates of a point. */
export interface LiveSlopes { number: number; slopes: (Float64Array | null)[]; jacobian: Float64Array[] | null }
/** Constraint equation of a joint: name, natural size and unit. */
export interface JointRow { name: string; size: number; unit: string }
export interface OpenJoint extends JointRow { gap: number }
export interface LiveFailure { number: number; failure: LiveStatus; open?: OpenJoint | null }
/** Answer to a request: the result with its gradients, or a failure. */
export type LiveAnswer = { result: LiveResult; slopes: LiveSlopes["slopes"] } | { failure: LiveFailure };

/** Exported module: parameters and measures of a model with their units, in SI units. */
export interface ModuleData {
  name: string;
  live: LiveData;
  parameters: { name: string; value: number }[];
  /** Name, unit and row. */
  measures: [string, string, number][];
  responses: LiveResponse[];
}

// Parts of a page -----------------------------------------------------------------------------------

export interface Series {
  name: string;
  unit: string;
  group: string;
  values: Float64Array;
  /** Values of the second run. */
  other: Float64Array | null;
  /** As in the payload, while `values` are in degrees. */
  original?: { unit: string; values: Float64Array; other: Float64Array | null };
}

/** Body; the columns of its pose depend on the dimension. */
export interface Body { name: string; index: number; label: string; node: boolean; of?: Body; fixed?: boolean; shapes: Shape[]; [column: string]: any }

/** Point whose path can be traced. */
export interface TracedPoint {
  name: string;
  body: Body;
  point: Point;
  traced: boolean;
  /** Names of all points at this position. */
  names: string[];
  /** First of several points at one position. */
  same?: TracedPoint;
  way: { t: number; p: Point | null }[];
  length: number;
  index: number;
  swatch?: HTMLElement;
  /** Path thinned for a scale. */
  thin?: { s: number; way: TracedPoint["way"]; points: TracedPoint["way"] };
}

export type LoadKind = "force" | "moment" | "load" | "twist";

/** Drawing instructions that a canvas and `SvgContext` share. */
export type Context = Pick<CanvasRenderingContext2D,
  | "save" | "restore" | "translate" | "rotate" | "setLineDash" | "measureText" | "beginPath" | "moveTo" | "lineTo" | "closePath" | "rect" | "clip"
  | "stroke" | "fill" | "fillRect" | "fillText" | "strokeText" | "fillStyle" | "strokeStyle" | "lineWidth" | "lineJoin" | "lineCap" | "globalAlpha"
  | "font" | "textAlign" | "textBaseline"> & {
  roundRect(x: number, y: number, w: number, h: number, radius: number): void;
  arc(x: number, y: number, r: number, from: number, to: number, back?: boolean): void;
};

/** Attributes of an element; handlers of events start with `on`. */
export interface Attributes { [name: string]: string | number | boolean | null | undefined | ((event: never) => void) }
export type Child = Node | string | null | undefined | false | Child[];
