// {{NAME}}: types of the module. All values are in SI units.

export interface Parameters {
{{PARAMETERS}}
}

export interface Outputs {
  /** Instants of the outputs [s]. */
  time: Float64Array;
{{MEASURES}}
  /** "completed", or the outcome of a run that failed or violates the model's own equations. */
  status: string;
  /** The end of the run, or the reason of the failure. */
  message: string;
}

export type Response = {{RESPONSES}};

export interface Parameter { value: number; lower: number | null; upper: number | null; unit: string; description: string }

/** Name of the model. */
export const name: string;

/** Initial values, bounds, units and descriptions. */
export const parameters: Record<keyof Parameters, Parameter>;

/** Units of the outputs. */
export const measures: Record<string, string>;

/** Units of the responses. */
export const responses: Record<Response, string>;

/** Outputs over time; parameters that are not named have their initial values. */
export function simulate(values?: Partial<Parameters>): Outputs;

/** Value of a response; throws if the design cannot be simulated. */
export function evaluate(response: Response, values?: Partial<Parameters>): number;

/** Exact derivatives of a response by all parameters; throws if the design cannot be simulated. */
export function gradient(response: Response, values?: Partial<Parameters>): Parameters;
