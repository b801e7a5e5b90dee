// Responses in words, as the sheet of design tasks lists them.

/** Reductions of measures that are no words of everyday language. */
const WORDS = /** @type {Record<string, string>} */ ({ Maximum: "maximum of", Minimum: "minimum of", Mean: "mean of", RMS: "RMS of", RandomRMS: "RMS in random excitation of", Integral: "integral of", Total: "sum of", Final: "final value of" });

/** What a response is. @param {any} entry of the file @param {any} file whose analysis says what the number of `At` is */
export function inWords(entry, file) {
  const { type = "Final", measure, formula } = entry ?? {}, what = measure ?? formula ?? "…", analysis = file?.analysis?.type;
  const isStatic = file?.kind === "structure" && [undefined, "Statics", "Equilibrium"].includes(analysis), isMotion = (!analysis && file?.kind !== "structure") || ["Dynamics", "Kinematics", "InverseDynamics", "Nonsmooth", "Transient"].includes(analysis);
  if (type === "At") return `${what} ${isStatic ? `in load case ${entry.time ?? 0}` : analysis === "Modal" ? `of mode ${entry.time ?? 0}` : isMotion ? `at t = ${entry.time ?? 0} s` : `at ${entry.time ?? 0}`}`;
  if (type === "AtEvent") return `${what} at event ${entry.event ?? "…"}${(entry.occurrence ?? 1) > 1 ? `, occurrence ${entry.occurrence}` : ""}`;
  if (type === "Peak") return `peak ${entry.number ?? 1} of ${what}`;
  return isStatic && type === "Final" ? what : `${WORDS[type] ?? `${type} of`} ${what}`;
}
