/* Life of many instances of a unit, compiled with sanitizers by test_fmu.py. */

#include "fmi3.c"

static void ignore(fmi3InstanceEnvironment e, fmi3Status s, fmi3String c, fmi3String m) {}

static void differentiate(fmi3Instance i) {
  unsigned outputs[OUTPUT_COUNT + 1], parameters[PARAMETERS + 1];
  double seed[OUTPUT_COUNT + PARAMETERS + 1], result[OUTPUT_COUNT + PARAMETERS + 1];
  for (int k = 0; k < OUTPUT_COUNT; ++k) outputs[k] = FIRST_OUTPUT + k;
  for (int k = 0; k < PARAMETERS; ++k) parameters[k] = 1 + k;
  for (int k = 0; k < OUTPUT_COUNT + PARAMETERS; ++k) seed[k] = 1.0;
  fmi3GetAdjointDerivative(i, outputs, OUTPUT_COUNT, parameters, PARAMETERS, seed, OUTPUT_COUNT,
                           result, PARAMETERS);
  fmi3GetDirectionalDerivative(i, outputs, OUTPUT_COUNT, parameters, PARAMETERS, seed, PARAMETERS,
                               result, OUTPUT_COUNT);
}

static void exchange(fmi3Instance i) {
  bool flags[5];
  double next, x[STATE_COUNT + 1], rates[STATE_COUNT + 1], indicators[INDICATORS + 1];
  do
    fmi3UpdateDiscreteStates(i, flags, flags + 1, flags + 2, flags + 3, flags + 4, &next);
  while (flags[0]);
  fmi3EnterContinuousTimeMode(i);
  for (int k = 0; k < 20; ++k) {
    fmi3SetTime(i, k * 1e-3);
    fmi3GetContinuousStates(i, x, STATE_COUNT);
    fmi3GetContinuousStateDerivatives(i, rates, STATE_COUNT);
    fmi3GetEventIndicators(i, indicators, INDICATORS);
    for (int m = 0; m < STATE_COUNT; ++m) x[m] += 1e-3 * rates[m];
    fmi3SetContinuousStates(i, x, STATE_COUNT);
    fmi3CompletedIntegratorStep(i, true, flags, flags + 1);
  }
}

static void run(fmi3Instance i) {
  bool flags[3];
  double last;
  for (int k = 0; k < 20; ++k)
    fmi3DoStep(i, k * 7e-3, 7e-3, true, flags, flags + 1, flags + 2, &last);
}

static void live(int number) {
  int exchanging = number % 2, failing = number % 10 == 9;
  fmi3Instance i =
      exchanging ? fmi3InstantiateModelExchange("a", TOKEN, 0, false, false, 0, ignore)
                 : fmi3InstantiateCoSimulation("a", TOKEN, 0, false, false, false, false, 0, 0, 0,
                                               ignore, 0);
  unsigned every[REFERENCES + 1], first = 1;
  double values[REFERENCES + 1], wrong = 1e3;
  fmi3FMUState state = 0, copied = 0;
  size_t size;
  fmi3EnterInitializationMode(i, false, 0, 0, false, 0);
  if (failing) fmi3SetFloat64(i, &first, 1, &wrong, 1);
  differentiate(i);
  if (fmi3ExitInitializationMode(i) == fmi3OK) {
    fmi3GetFMUState(i, &state);
    fmi3SerializedFMUStateSize(i, state, &size);
    unsigned char* bytes = malloc(size);
    fmi3SerializeFMUState(i, state, bytes, size);
    fmi3DeserializeFMUState(i, bytes, size, &copied);
    free(bytes);
    exchanging ? exchange(i) : run(i);
    differentiate(i);
    for (unsigned k = 0; k <= REFERENCES; ++k) every[k] = k;
    fmi3GetFloat64(i, every, REFERENCES + 1, values, REFERENCES + 1);
    fmi3SetFMUState(i, copied);
    fmi3FreeFMUState(i, &state);
    fmi3FreeFMUState(i, &copied);
    fmi3Reset(i);
  }
  fmi3FreeInstance(i);
}

int main(void) {
  for (int number = 0; number < 200; ++number) live(number);
  puts("done");
  return 0;
}
