"""Keys of the fixed tables of model files, with texts for keys without a description."""

from __future__ import annotations

from dalembert.io import documents, orientations, schema, tables
from dalembert.io.decisions import design_tables, task_tables
from reference.markdown import table

ABOUT = "free text"
UNIT = "coherent unit of the formula, such as `m^3/s`"
FIXED = {
    "document": (
        documents.Document,
        {
            "schema_location": "address of a schema, for editors",
            "format": "version of the format: `1`",
            "description": ABOUT,
            "parameters": "name → number, or a table as below",
            "derived": "name → formula of parameters, or a table as below",
            "ground": "named points and frames, in `[ground.points]` and `[ground.frames]`",
            "bodies": "name → body; the type is `Body` by default",
            "beams": "name → beam; the type is `Beam` by default",
            "joints": "name → joint",
            "drivers": "name → driver",
            "forces": "name → force",
            "initial": "measure → its exact initial value; or tables of motions of nodes",
            "analysis": "analysis of `dalembert run`",
            "compare": "strategies of `dalembert compare`",
            "responses": "name → response",
            "cases": "name → another run for objectives and limits",
            "combined": "name → formula of responses, or a table as below",
            "robust": "name → mean and standard deviations of a response",
            "pareto": "objectives of `dalembert pareto`",
            "random": "list of random parameters",
            "reliability": "limit states of `dalembert reliability`",
            "tolerance": "tolerances of `dalembert tolerance`",
            "invert": "data of `dalembert invert`",
            "synthesis": "task of `dalembert synthesize`",
            "trajectory": "task of `dalembert trajectory`",
            "sensitivity": "gradients of `dalembert sensitivity`",
            "optimize": "objective, variables and limits of `dalembert optimize`",
            "identify": "data and unknowns of `dalembert identify`",
            "sweep": "designs of `dalembert sweep`",
            "report": "initial selection of the report",
        },
    ),
    "parameter": (
        schema.ParameterTable,
        {
            "value": 'nominal value in `unit`, or a text with its unit: `"45 mm"`',
            "unit": 'unit of value and bounds: `"mm"`, `"deg"`; SI by default',
            "bounds": "`[lower, upper]` for designs, in `unit`; `inf` for an open side",
            "description": ABOUT,
        },
    ),
    "derived": (
        schema.DerivedTable,
        {
            "formula": "formula of parameters and other derived ones",
            "unit": UNIT,
            "description": ABOUT,
        },
    ),
    "input": (
        schema.InputTable,
        {
            "value": "number in `unit`, text with its unit, or formula of `t`, parameters and "
            "tables in SI units",
            "unit": "unit of value and bounds; an SI unit for a formula",
            "bounds": "`[lower, upper]` in `unit`; of the deviation, for a formula",
            "description": ABOUT,
        },
    ),
    "output": (
        schema.OutputTable,
        {
            "formula": "measure, or formula of measures, parameters and `t`",
            "unit": UNIT,
            "description": ABOUT,
        },
    ),
    "inline": (
        tables.InlinePoint,
        {"body": "name of a body", "at": "coordinates in the body frame [m]"},
    ),
    "frame": (orientations.InlineFrame, {}),
    "geometry": (orientations.GeometryTable, {"type": "kind of the solid"}),
    "event": (
        tables.EventTable,
        {
            "measure": "measure or formula that crosses zero",
            "terminal": "the run ends at the event",
            "direction": "`1` rising, `-1` falling, `0` both",
        },
    ),
    "compare": (
        task_tables.CompareTable,
        {
            "formulations": "names, or tables with `type` and keys; by default "
            "[a few](formulations.md#comparison-on-your-mechanism)",
            "integrators": "the same",
            "stabilizations": "the same; `Projection` by default",
            "coordinates": "the same; `AbsoluteCoordinates` where formulations are named",
        },
    ),
    "sensitivity": (
        task_tables.SensitivityTable,
        {
            "method": '`"auto"`, `"adjoint"`, `"direct"` or `"finite-difference"`',
        },
    ),
    "sweep": (
        task_tables.SweepTable,
        {"type": '`"Grid"`, `"LatinHypercube"`, `"MonteCarlo"`, `"Sobol"` or `"Table"`'},
    ),
    "optimize": (
        design_tables.OptimizeTable,
        {
            "minimize": "name of the response to minimise; this or `maximize`",
            "maximize": "name of the response to maximise",
            "method": "optimiser, see [methods](optimization.md#methods)",
            "gradient": "method of the gradients",
            "max_iterations": "upper limit of iterations of the optimiser",
            "tolerance": "on the relative change of the objective",
        },
    ),
    "limit": (
        design_tables.LimitTable,
        {
            "response": "name of a response",
            "lower": "lower limit",
            "upper": "upper limit",
        },
    ),
    "identify": (
        task_tables.IdentifyTable,
        {
            "data": "file of measurements in the same folder, .csv or .parquet",
            "time": "column of the times; `time` or `t` by default",
            "loss": '`"linear"`, or against outliers `"soft_l1"`, `"huber"`, `"cauchy"`, '
            '`"arctan"`',
            "max_iterations": "upper limit of iterations of least squares",
        },
    ),
    "experiment": (
        task_tables.ExperimentTable,
        {
            "data": "file of measurements",
            "name": "name in results; its number by default",
        },
    ),
    "case": (documents.CaseTable, {}),
    "combined": (design_tables.CombinedTable, {}),
    "robust": (design_tables.RobustTable, {"response": "name of a response of this run"}),
    "pareto": (
        design_tables.ParetoTable,
        {
            "method": "method, see [several objectives](optimization.md#several-objectives)",
            "gradient": "method of the gradients",
            "max_iterations": "upper limit of iterations for each point",
            "tolerance": "on the relative change of the objective",
        },
    ),
    "reliability": (
        design_tables.ReliabilityTable,
        {
            "method": '`"sqp"`, `"improved-hlrf"` or `"hlrf"`',
            "tolerance": "on residual and distance of the design point",
            "max_iterations": "upper limit of iterations of each search",
        },
    ),
    "tolerance": (design_tables.ToleranceTable, {}),
    "allocate": (
        design_tables.AllocateTable,
        {
            "exponent": "exponent of the tolerance in its cost",
            "worst_case": "worst case of all tolerances; statistical by default",
        },
    ),
    "synthesis": (design_tables.SynthesisTable, {}),
    "trajectory": (
        task_tables.TrajectoryTable,
        {"method": "name, or a table with `type` and keys, see [trajectories](trajectories.md)"},
    ),
    "history": (task_tables.HistoryTable, {}),
    "invert": (
        task_tables.InvertTable,
        {"max_iterations": "upper limit of iterations of least squares"},
    ),
    "report": (task_tables.ReportTable, {}),
}


def section(model: type, texts: dict[str, str]) -> str:
    """Keys of a fixed table of the schema; every key needs a text here or in the schema."""
    rows = []
    for name, field in model.model_fields.items():
        default = "required" if field.is_required() else _plain_default(field)
        text = texts.get(name) or field.description or ""
        rows.append((f"`{field.alias or name}`", default, text))
    missing = [key for key, _, text in rows if not text]
    if missing:
        raise SystemExit(f"{model.__name__}: describe {', '.join(missing)}")
    return table(("key", "default", "meaning"), rows)


def _plain_default(field) -> str:
    default = field.get_default(call_default_factory=True)
    if default is None or default == "" or default == {} or default == []:
        return "none"
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    if isinstance(default, (int, float)):
        return f"`{default:g}`"
    return f'`"{default}"`' if isinstance(default, str) else "none"
