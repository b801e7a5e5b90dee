/* Functional mock-up unit of a dalembert model, FMI 3.0. Compile this file alone. */

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"
#include "model.h"

#include "instance.h"
#include "closing.h"
#include "evaluation.h"
#include "running.h"

#define CHECKED(c, condition, call)                                                          \
  if (!(c)) return fmi3Error;                                                                \
  if (!(condition)) return fail(c, ERROR, "%s is not possible in this mode", call), fmi3Error

static void report3(Instance* c, Status status, const char* message) {
  const char* category = categories_of[status];
  fmi3LogMessageCallback log = (fmi3LogMessageCallback)c->logger;
  if (log) log(c->environment, (fmi3Status)status, category, message);
}

static fmi3Instance instantiate(const char* name, const char* token, const Problem* problem,
                                int exchange, void* environment,
                                fmi3LogMessageCallback log) {
  if (!token || strcmp(token, TOKEN) || !problem) {
    if (log)
      log(environment, fmi3Error, "logStatusError",
          problem ? "the instantiation token is not that of this unit"
                  : "the unit does not have this interface type");
    return NULL;
  }
  Instance* c = new_instance(name, problem, exchange);
  if (!c) {
    if (log) log(environment, fmi3Error, "logStatusError", "no memory for an instance");
    return NULL;
  }
  c->report = report3;
  c->environment = environment;
  c->logger = (void*)log;
  return c;
}

const char* fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(
    fmi3Instance instance, fmi3Boolean on, size_t count, const fmi3String categories[]) {
  if (!instance) return fmi3Error;
  set_logging(instance, on, count, categories);
  return fmi3OK;
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  (void)resources, (void)visible, (void)logging;
  return instantiate(name, token, EXCHANGE_PROBLEM, 1, environment, log);
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
    const fmi3ValueReference intermediate[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback update) {
  (void)resources, (void)visible, (void)logging, (void)early, (void)intermediate;
  (void)intermediate_count, (void)update;
  if (events) {
    if (log) log(environment, fmi3Error, "logStatusError", "the unit does not have an event mode");
    return NULL;
  }
  return instantiate(name, token, STEP_PROBLEM, 0, environment, log);
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
  (void)resources, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
  return instantiate(name, token, NULL, 0, environment, log);
}

void fmi3FreeInstance(fmi3Instance instance) { free_instance(instance); }

fmi3Status fmi3EnterInitializationMode(
    fmi3Instance instance, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
    fmi3Float64 start_time, fmi3Boolean stop_defined, fmi3Float64 stop) {
  Instance* c = instance;
  (void)tolerance_defined, (void)tolerance;
  CHECKED(c, c->mode == INSTANTIATED, "fmi3EnterInitializationMode");
  return (fmi3Status)enter_initialization(c, start_time, stop_defined, stop);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  Instance* c = instance;
  CHECKED(c, c->mode == INITIALIZATION, "fmi3ExitInitializationMode");
  return (fmi3Status)exit_initialization(c);
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  Instance* c = instance;
  CHECKED(c, c->mode == CONTINUOUS, "fmi3EnterEventMode");
  Status status = accept_position(c);
  if (status <= WARNING) c->mode = EVENT;
  return (fmi3Status)status;
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  Instance* c = instance;
  CHECKED(c, c->mode > INITIALIZATION && c->mode < TERMINATED, "fmi3Terminate");
  c->mode = TERMINATED;
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  Instance* c = instance;
  if (!c) return fmi3Error;
  rewind_instance(c);
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, fmi3Float64 values[], size_t value_count) {
  Instance* c = instance;
  CHECKED(c, count == value_count, "fmi3GetFloat64 with this number of values");
  return (fmi3Status)get(c, references, count, values);
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t count, const fmi3Float64 values[], size_t value_count) {
  Instance* c = instance;
  CHECKED(c, count == value_count && c->mode != TERMINATED, "fmi3SetFloat64");
  return (fmi3Status)set(c, references, count, values);
}

#define OTHER_TYPE(type)                                                                      \
  fmi3Status fmi3Get##type(fmi3Instance instance, const fmi3ValueReference references[],      \
                           size_t count, fmi3##type values[], size_t value_count) {           \
    (void)values, (void)value_count;                                                          \
    return count ? (fmi3Status)refuse_reference(instance, references[0]) : fmi3OK;            \
  }                                                                                           \
  fmi3Status fmi3Set##type(fmi3Instance instance, const fmi3ValueReference references[],      \
                           size_t count, const fmi3##type values[], size_t value_count) {     \
    (void)values, (void)value_count;                                                          \
    return count ? (fmi3Status)refuse_reference(instance, references[0]) : fmi3OK;            \
  }
OTHER_TYPE(Float32)
OTHER_TYPE(Int8)
OTHER_TYPE(UInt8)
OTHER_TYPE(Int16)
OTHER_TYPE(UInt16)
OTHER_TYPE(Int32)
OTHER_TYPE(UInt32)
OTHER_TYPE(Int64)
OTHER_TYPE(UInt64)
OTHER_TYPE(Boolean)
OTHER_TYPE(String)

static fmi3Status unsupported(fmi3Instance instance, const char* name) {
  Instance* c = instance;
  if (c) fail(c, ERROR, "%s is not supported by this unit", name);
  return fmi3Error;
}

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference references[],
                         size_t count, size_t sizes[], fmi3Binary values[], size_t value_count) {
  (void)references, (void)sizes, (void)values, (void)value_count;
  return count ? unsupported(instance, "fmi3GetBinary") : fmi3OK;
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference references[],
                         size_t count, const size_t sizes[], const fmi3Binary values[],
                         size_t value_count) {
  (void)references, (void)sizes, (void)values, (void)value_count;
  return count ? unsupported(instance, "fmi3SetBinary") : fmi3OK;
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference references[],
                        size_t count, fmi3Clock values[]) {
  (void)references, (void)values;
  return count ? unsupported(instance, "fmi3GetClock") : fmi3OK;
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[],
                        size_t count, const fmi3Clock values[]) {
  (void)references, (void)values;
  return count ? unsupported(instance, "fmi3SetClock") : fmi3OK;
}

fmi3Status fmi3GetNumberOfVariableDependencies(
    fmi3Instance instance, fmi3ValueReference reference, size_t* count) {
  (void)reference, (void)count;
  return unsupported(instance, "fmi3GetNumberOfVariableDependencies");
}

fmi3Status fmi3GetVariableDependencies(
    fmi3Instance instance, fmi3ValueReference dependent, size_t elements[],
    fmi3ValueReference independents[], size_t independent_elements[], fmi3DependencyKind kinds_[],
    size_t count) {
  (void)dependent, (void)elements, (void)independents, (void)independent_elements;
  (void)kinds_, (void)count;
  return unsupported(instance, "fmi3GetVariableDependencies");
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return instance ? (fmi3Status)save(instance, state) : fmi3Error;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  return instance ? (fmi3Status)restore(instance, state) : fmi3Error;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState* state) {
  (void)instance;
  if (state) {
    free(*state);
    *state = NULL;
  }
  return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t* size) {
  (void)state;
  if (!instance) return fmi3Error;
  *size = saved_size(instance);
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(
    fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  return instance ? (fmi3Status)serialize(instance, state, bytes, size) : fmi3Error;
}

fmi3Status fmi3DeserializeFMUState(
    fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState* state) {
  return instance ? (fmi3Status)deserialize(instance, bytes, size, state) : fmi3Error;
}

fmi3Status fmi3GetDirectionalDerivative(
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t unknown_count,
    const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
    size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count) {
  Instance* c = instance;
  CHECKED(c, known_count == seed_count && unknown_count == sensitivity_count,
          "fmi3GetDirectionalDerivative with these numbers of values");
  return (fmi3Status)directional(
      c, unknowns, unknown_count, knowns, known_count, seed, sensitivity);
}

fmi3Status fmi3GetAdjointDerivative(
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t unknown_count,
    const fmi3ValueReference knowns[], size_t known_count, const fmi3Float64 seed[],
    size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count) {
  Instance* c = instance;
  CHECKED(c, unknown_count == seed_count && known_count == sensitivity_count,
          "fmi3GetAdjointDerivative with these numbers of values");
  return (fmi3Status)adjoint(c, unknowns, unknown_count, knowns, known_count, seed, sensitivity);
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  return unsupported(instance, "fmi3EnterConfigurationMode");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  return unsupported(instance, "fmi3ExitConfigurationMode");
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance i, const fmi3ValueReference r[], size_t n,
                                  fmi3Float64 a[], fmi3IntervalQualifier q[]) {
  (void)r, (void)a, (void)q;
  return n ? unsupported(i, "fmi3GetIntervalDecimal") : fmi3OK;
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n,
                                   fmi3UInt64 a[], fmi3UInt64 b[], fmi3IntervalQualifier q[]) {
  (void)r, (void)a, (void)b, (void)q;
  return n ? unsupported(i, "fmi3GetIntervalFraction") : fmi3OK;
}

fmi3Status fmi3GetShiftDecimal(
    fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3Float64 a[]) {
  (void)r, (void)a;
  return n ? unsupported(i, "fmi3GetShiftDecimal") : fmi3OK;
}

fmi3Status fmi3GetShiftFraction(
    fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3UInt64 a[], fmi3UInt64 b[]) {
  (void)r, (void)a, (void)b;
  return n ? unsupported(i, "fmi3GetShiftFraction") : fmi3OK;
}

fmi3Status fmi3SetIntervalDecimal(
    fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Float64 a[]) {
  (void)r, (void)a;
  return n ? unsupported(i, "fmi3SetIntervalDecimal") : fmi3OK;
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n,
                                   const fmi3UInt64 a[], const fmi3UInt64 b[]) {
  (void)r, (void)a, (void)b;
  return n ? unsupported(i, "fmi3SetIntervalFraction") : fmi3OK;
}

fmi3Status fmi3SetShiftDecimal(
    fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3Float64 a[]) {
  (void)r, (void)a;
  return n ? unsupported(i, "fmi3SetShiftDecimal") : fmi3OK;
}

fmi3Status fmi3SetShiftFraction(fmi3Instance i, const fmi3ValueReference r[], size_t n,
                                const fmi3UInt64 a[], const fmi3UInt64 b[]) {
  (void)r, (void)a, (void)b;
  return n ? unsupported(i, "fmi3SetShiftFraction") : fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  Instance* c = instance;
  CHECKED(c, c->mode == EVENT || c->mode == INITIALIZATION, "fmi3EvaluateDiscreteStates");
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(
    fmi3Instance instance, fmi3Boolean* again, fmi3Boolean* terminate, fmi3Boolean* nominals,
    fmi3Boolean* values, fmi3Boolean* next_defined, fmi3Float64* next) {
  Instance* c = instance;
  int changed = 0;
  CHECKED(c, c->mode == EVENT, "fmi3UpdateDiscreteStates");
  Status status = update_branches(c, &changed);
  *again = changed;
  *terminate = *nominals = *values = *next_defined = fmi3False;
  *next = INFINITY;
  return (fmi3Status)status;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  Instance* c = instance;
  CHECKED(c, c->exchange && c->mode == EVENT, "fmi3EnterContinuousTimeMode");
  c->mode = CONTINUOUS;
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(
    fmi3Instance instance, fmi3Boolean no_earlier, fmi3Boolean* event, fmi3Boolean* terminate) {
  Instance* c = instance;
  (void)no_earlier;
  CHECKED(c, c->mode == CONTINUOUS, "fmi3CompletedIntegratorStep");
  *event = *terminate = fmi3False;
  return (fmi3Status)accept_position(c);
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  Instance* c = instance;
  CHECKED(c, c->exchange && continues(c), "fmi3SetTime");
  return (fmi3Status)set_time(c, time);
}

fmi3Status fmi3SetContinuousStates(
    fmi3Instance instance, const fmi3Float64 states[], size_t count) {
  Instance* c = instance;
  CHECKED(c, c->exchange && count == STATE_COUNT && continues(c),
          "fmi3SetContinuousStates");
  copy(c->x, states, STATE_COUNT);
  c->valid = STARTED;
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(
    fmi3Instance instance, fmi3Float64 derivatives[], size_t count) {
  Instance* c = instance;
  CHECKED(c, c->exchange && c->mode > INSTANTIATED && count == STATE_COUNT,
          "fmi3GetContinuousStateDerivatives");
  Status status = evaluate(c, RATES);
  if (status <= WARNING) copy(derivatives, c->rates, STATE_COUNT);
  return (fmi3Status)status;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 values[], size_t count) {
  Instance* c = instance;
  CHECKED(c, c->exchange && c->mode > INSTANTIATED && count == INDICATORS,
          "fmi3GetEventIndicators");
  return (fmi3Status)event_indicators(c, values);
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], size_t count) {
  Instance* c = instance;
  CHECKED(c, c->exchange && c->mode > INSTANTIATED && count == STATE_COUNT,
          "fmi3GetContinuousStates");
  Status status = start(c);
  if (status <= WARNING) copy(states, c->x, STATE_COUNT);
  return (fmi3Status)status;
}

fmi3Status fmi3GetNominalsOfContinuousStates(
    fmi3Instance instance, fmi3Float64 values[], size_t count) {
  Instance* c = instance;
  CHECKED(c, c->exchange && count == STATE_COUNT, "fmi3GetNominalsOfContinuousStates");
  copy(values, state_sizes, STATE_COUNT);
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t* count) {
  if (!instance) return fmi3Error;
  *count = INDICATORS;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t* count) {
  if (!instance) return fmi3Error;
  *count = STATE_COUNT;
  return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  Instance* c = instance;
  CHECKED(c, !c->exchange && c->mode == EVENT, "fmi3EnterStepMode");
  c->mode = STEP;
  return fmi3OK;
}

fmi3Status fmi3GetOutputDerivatives(
    fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Int32 orders[], fmi3Float64 values[], size_t value_count) {
  (void)references, (void)orders, (void)values, (void)value_count;
  return count ? unsupported(instance, "fmi3GetOutputDerivatives") : fmi3OK;
}

fmi3Status fmi3DoStep(
    fmi3Instance instance, fmi3Float64 time, fmi3Float64 length, fmi3Boolean no_earlier,
    fmi3Boolean* events, fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* last) {
  Instance* c = instance;
  (void)no_earlier;
  CHECKED(c, !c->exchange && c->mode == STEP, "fmi3DoStep");
  *events = *terminate = *early = fmi3False;
#if CO_SIMULATION
  Status status = length == 0.0 ? fail(c, ERROR, "a step of length zero is not possible")
                                : do_step(c, time, length);
  *last = *c->time;
  return (fmi3Status)status;
#else
  (void)time, (void)length, (void)last;
  return fmi3Error;
#endif
}

fmi3Status fmi3ActivateModelPartition(
    fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time) {
  (void)clock, (void)time;
  return unsupported(instance, "fmi3ActivateModelPartition");
}
