/* Functional mock-up unit of a dalembert model, FMI 2.0. Compile this file alone. */

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"
#include "model.h"

#include "instance.h"
#include "closing.h"
#include "evaluation.h"
#include "running.h"

#define CHECKED(c, condition, call)                                                          \
  if (!(c)) return fmi2Error;                                                                \
  if (!(condition)) return fail(c, ERROR, "%s is not possible in this mode", call), fmi2Error

/* The message is a format of printf, in which % is doubled: not all loggers take arguments. */
static void report2(Instance* c, Status status, const char* message) {
  const char* category = categories_of[status];
  fmi2CallbackLogger log = (fmi2CallbackLogger)c->logger;
  char text[2048], *end = text;
  for (; *message && end < text + sizeof text - 2; ++message) {
    *end++ = *message;
    if (*message == '%') *end++ = '%';
  }
  *end = 0;
  if (log) log(c->environment, c->name, (fmi2Status)status, category, text);
}

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char* fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(
    fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[]) {
  if (!component) return fmi2Error;
  set_logging(component, on, count, categories);
  return fmi2OK;
}

fmi2Component fmi2Instantiate(
    fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
    const fmi2CallbackFunctions* functions, fmi2Boolean visible, fmi2Boolean logging) {
  const Problem* problem = type == fmi2ModelExchange ? EXCHANGE_PROBLEM : STEP_PROBLEM;
  (void)resources, (void)visible, (void)logging;
  if (!token || strcmp(token, TOKEN) || !problem) {
    if (functions && functions->logger)
      functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError",
                        problem ? "the GUID is not that of this unit"
                                : "the unit does not have this interface type");
    return NULL;
  }
  Instance* c = new_instance(name, problem, type == fmi2ModelExchange);
  if (!c) return NULL;
  c->report = report2;
  if (functions) {
    c->environment = functions->componentEnvironment;
    c->logger = (void*)functions->logger;
  }
  return c;
}

void fmi2FreeInstance(fmi2Component component) { free_instance(component); }

fmi2Status fmi2SetupExperiment(
    fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
    fmi2Real start_time, fmi2Boolean stop_defined, fmi2Real stop) {
  Instance* c = component;
  (void)tolerance_defined, (void)tolerance;
  CHECKED(c, c->mode == INSTANTIATED, "fmi2SetupExperiment");
  *c->time = start_time;
  *c->stop = stop_defined ? stop : INFINITY;
  c->valid = 0;
  return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  Instance* c = component;
  CHECKED(c, c->mode == INSTANTIATED, "fmi2EnterInitializationMode");
  return (fmi2Status)enter_initialization(c, *c->time, 1, *c->stop);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  Instance* c = component;
  CHECKED(c, c->mode == INITIALIZATION, "fmi2ExitInitializationMode");
  return (fmi2Status)exit_initialization(c);
}

fmi2Status fmi2Terminate(fmi2Component component) {
  Instance* c = component;
  CHECKED(c, c->mode > INITIALIZATION && c->mode < TERMINATED, "fmi2Terminate");
  c->mode = TERMINATED;
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component) {
  Instance* c = component;
  if (!c) return fmi2Error;
  rewind_instance(c);
  return fmi2OK;
}

fmi2Status fmi2GetReal(
    fmi2Component component, const fmi2ValueReference references[], size_t count,
    fmi2Real values[]) {
  return component ? (fmi2Status)get(component, references, count, values) : fmi2Error;
}

fmi2Status fmi2SetReal(
    fmi2Component component, const fmi2ValueReference references[], size_t count,
    const fmi2Real values[]) {
  Instance* c = component;
  CHECKED(c, c->mode != TERMINATED, "fmi2SetReal");
  return (fmi2Status)set(c, references, count, values);
}

#define OTHER_TYPE(type)                                                                      \
  fmi2Status fmi2Get##type(fmi2Component component, const fmi2ValueReference references[],    \
                           size_t count, fmi2##type values[]) {                               \
    (void)values;                                                                             \
    return count ? (fmi2Status)refuse_reference(component, references[0]) : fmi2OK;           \
  }                                                                                           \
  fmi2Status fmi2Set##type(fmi2Component component, const fmi2ValueReference references[],    \
                           size_t count, const fmi2##type values[]) {                         \
    (void)values;                                                                             \
    return count ? (fmi2Status)refuse_reference(component, references[0]) : fmi2OK;           \
  }
OTHER_TYPE(Integer)
OTHER_TYPE(Boolean)
OTHER_TYPE(String)

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return component ? (fmi2Status)save(component, state) : fmi2Error;
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return component ? (fmi2Status)restore(component, state) : fmi2Error;
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  (void)component;
  if (state) {
    free(*state);
    *state = NULL;
  }
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t* size) {
  (void)state;
  if (!component) return fmi2Error;
  *size = saved_size(component);
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(
    fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return component ? (fmi2Status)serialize(component, state, bytes, size) : fmi2Error;
}

fmi2Status fmi2DeSerializeFMUstate(
    fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  return component ? (fmi2Status)deserialize(component, bytes, size, state) : fmi2Error;
}

fmi2Status fmi2GetDirectionalDerivative(
    fmi2Component component, const fmi2ValueReference unknowns[], size_t unknown_count,
    const fmi2ValueReference knowns[], size_t known_count, const fmi2Real seed[],
    fmi2Real result[]) {
  Instance* c = component;
  if (!c) return fmi2Error;
  return (fmi2Status)directional(c, unknowns, unknown_count, knowns, known_count, seed, result);
}

/* model exchange -------------------------------------------------------------------------- */
fmi2Status fmi2EnterEventMode(fmi2Component component) {
  Instance* c = component;
  CHECKED(c, c->exchange && continues(c), "fmi2EnterEventMode");
  Status status = accept_position(c);
  if (status <= WARNING) c->mode = EVENT;
  return (fmi2Status)status;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo* info) {
  Instance* c = component;
  int changed = 0;
  CHECKED(c, c->exchange && c->mode == EVENT, "fmi2NewDiscreteStates");
  Status status = update_branches(c, &changed);
  memset(info, 0, sizeof *info);
  info->newDiscreteStatesNeeded = changed;
  return (fmi2Status)status;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  Instance* c = component;
  CHECKED(c, c->exchange && c->mode == EVENT, "fmi2EnterContinuousTimeMode");
  c->mode = CONTINUOUS;
  return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(
    fmi2Component component, fmi2Boolean no_earlier, fmi2Boolean* event, fmi2Boolean* terminate) {
  Instance* c = component;
  (void)no_earlier;
  CHECKED(c, c->mode == CONTINUOUS, "fmi2CompletedIntegratorStep");
  *event = *terminate = fmi2False;
  return (fmi2Status)accept_position(c);
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time) {
  Instance* c = component;
  CHECKED(c, c->exchange && continues(c), "fmi2SetTime");
  return (fmi2Status)set_time(c, time);
}

fmi2Status fmi2SetContinuousStates(
    fmi2Component component, const fmi2Real states[], size_t count) {
  Instance* c = component;
  CHECKED(c, c->exchange && count == STATE_COUNT && continues(c),
          "fmi2SetContinuousStates");
  copy(c->x, states, STATE_COUNT);
  c->valid = STARTED;
  return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real derivatives[], size_t count) {
  Instance* c = component;
  CHECKED(c, c->exchange && c->mode > INSTANTIATED && count == STATE_COUNT,
          "fmi2GetDerivatives");
  Status status = evaluate(c, RATES);
  if (status <= WARNING) copy(derivatives, c->rates, STATE_COUNT);
  return (fmi2Status)status;
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real values[], size_t count) {
  Instance* c = component;
  CHECKED(c, c->exchange && c->mode > INSTANTIATED && count == INDICATORS,
          "fmi2GetEventIndicators");
  return (fmi2Status)event_indicators(c, values);
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], size_t count) {
  Instance* c = component;
  CHECKED(c, c->exchange && c->mode > INSTANTIATED && count == STATE_COUNT,
          "fmi2GetContinuousStates");
  Status status = start(c);
  if (status <= WARNING) copy(states, c->x, STATE_COUNT);
  return (fmi2Status)status;
}

fmi2Status fmi2GetNominalsOfContinuousStates(
    fmi2Component component, fmi2Real values[], size_t count) {
  Instance* c = component;
  CHECKED(c, c->exchange && count == STATE_COUNT, "fmi2GetNominalsOfContinuousStates");
  copy(values, state_sizes, STATE_COUNT);
  return fmi2OK;
}

/* co-simulation --------------------------------------------------------------------------- */
fmi2Status fmi2SetRealInputDerivatives(
    fmi2Component component, const fmi2ValueReference references[], size_t count,
    const fmi2Integer orders[], const fmi2Real values[]) {
  Instance* c = component;
  (void)references, (void)orders, (void)values;
  CHECKED(c, !count, "fmi2SetRealInputDerivatives");
  return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(
    fmi2Component component, const fmi2ValueReference references[], size_t count,
    const fmi2Integer orders[], fmi2Real values[]) {
  Instance* c = component;
  (void)references, (void)orders, (void)values;
  CHECKED(c, !count, "fmi2GetRealOutputDerivatives");
  return fmi2OK;
}

fmi2Status fmi2DoStep(
    fmi2Component component, fmi2Real time, fmi2Real length, fmi2Boolean no_earlier) {
  Instance* c = component;
  (void)no_earlier;
  CHECKED(c, !c->exchange && c->mode == STEP, "fmi2DoStep");
#if CO_SIMULATION
  return (fmi2Status)do_step(c, time, length);
#else
  (void)time, (void)length;
  return fmi2Error;
#endif
}

fmi2Status fmi2CancelStep(fmi2Component component) {
  (void)component;
  return fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status* value) {
  (void)kind;
  *value = fmi2OK;
  return component ? fmi2OK : fmi2Error;
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real* value) {
  Instance* c = component;
  if (!c || kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = *c->time;
  return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(
    fmi2Component component, const fmi2StatusKind kind, fmi2Integer* value) {
  (void)component, (void)kind, (void)value;
  return fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(
    fmi2Component component, const fmi2StatusKind kind, fmi2Boolean* value) {
  (void)component;
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2GetStringStatus(
    fmi2Component component, const fmi2StatusKind kind, fmi2String* value) {
  (void)component, (void)kind, (void)value;
  return fmi2Discard;
}
