const analysis = await loaded({{RUN}}, DATA);

/** Name of the model. */
export const name = DATA.name;

/** Name of a parameter → value, lower and upper bound (null without), unit and description; SI units. */
export const parameters = Object.fromEntries(DATA.parameters.map(({ name, ...about }) => [name, about]));

/** Name of an output over time → its unit. */
export const measures = Object.fromEntries(DATA.measures.map(([name, unit]) => [name, unit]));

/** Name of a response → its unit. */
export const responses = Object.fromEntries(DATA.responses.map(({ label, unit }) => [label, unit]));

/** Outputs over time for some parameters by name; the others have their initial values. */
export const simulate = (values = {}) => analysis.simulate(values);

/** Value of a response. */
export const evaluate = (response, values = {}) => analysis.reduce(response, values).value;

/** Exact derivatives of a response by all parameters. */
export const gradient = (response, values = {}) => analysis.gradient(response, values);
