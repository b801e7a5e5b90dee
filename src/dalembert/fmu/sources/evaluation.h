/* Values of variables, and their directional and adjoint derivatives.

   Value references: 0 time; parameters; outputs; states; their derivatives; event indicators. */

#ifndef DALEMBERT_EVALUATION_H
#define DALEMBERT_EVALUATION_H

enum {
  FIRST_OUTPUT = 1 + PARAMETERS,
  FIRST_STATE = FIRST_OUTPUT + OUTPUT_COUNT,
  FIRST_RATE = FIRST_STATE + STATE_COUNT,
  FIRST_INDICATOR = FIRST_RATE + STATE_COUNT,
  REFERENCES = FIRST_INDICATOR + INDICATORS
};

static Status refuse_reference(Instance* c, unsigned reference) {
  return fail(c, ERROR, "no variable with the value reference %u is available here", reference);
}

/* Rates or outputs at the closed position. */
static Status evaluate(Instance* c, int what) {
  const Problem* m = c->problem;
  Status status = close_position(c);
  if (status > WARNING || c->valid & what) return status;
  const double* in[] = {c->time, c->now, c->x, c->p};
  double* out[] = {what == RATES ? c->rates : c->outputs};
  int count = what == RATES ? m->rate_count : OUTPUT_COUNT, bad = 0;
  Function function = what == RATES ? m->rates : m->outputs;
  if (count && function && (!CALL(c, function, in, out) || (bad = unbounded(*out, count)) >= 0))
    return fail(c, no_value(c),
                "%s has no finite value at t = %.9g s: singular position, or a formula undefined",
                what == RATES ? state_names[bad] : output_names[bad], *c->time);
  c->valid |= what;
  return OK;
}

/* States of model exchange, and their rates, of an instance of co-simulation. */
static Status states_of_step(Instance* c, int rates) {
#if MODEL_EXCHANGE && CO_SIMULATION
  Status status = close_position(c);
  if (status > WARNING) return status;
  const double* in[] = {c->time, NULL, c->x, c->p};
  double* out[] = {c->own_x, c->own_held};
  if (!CALL(c, step_states, in, out)) return fail(c, ERROR, "the states have no value");
  if (rates) {
    const double* at[] = {c->time, c->own_held, c->own_x, c->p};
    double* to[] = {c->rates};
    if (!CALL(c, exchange_problem.rates, at, to) || unbounded(c->rates, STATE_COUNT) >= 0)
      return fail(c, ERROR, "the rates of the states have no value at t = %.9g s", *c->time);
  }
  return OK;
#else
  (void)rates;
  return fail(c, ERROR, "the unit has no states of model exchange");
#endif
}

static Status event_indicators(Instance* c, double* values) {
#if INDICATORS
  Status status = c->exchange ? close_position(c) : states_of_step(c, 0);
  if (status > WARNING) return status;
  const double* in[] = {c->time, c->exchange ? c->now : c->own_held,
                        c->exchange ? c->x : c->own_x, c->p};
  double* out[] = {values};
  if (!CALL(c, exchange_indicators, in, out) || unbounded(values, INDICATORS) >= 0)
    return fail(c, no_value(c), "an event indicator has no value at t = %.9g s", *c->time);
#else
  (void)c, (void)values;
#endif
  return OK;
}

static Status get(Instance* c, const unsigned* references, size_t count, double* values) {
  Status status = OK;
  int own[2] = {0, 0};
  for (size_t k = 0; k < count && status <= WARNING; ++k) {
    unsigned r = references[k];
    if (r == 0)
      values[k] = *c->time;
    else if (r < FIRST_OUTPUT)
      values[k] = c->p[r - 1];
    else if (r < FIRST_STATE) {
      status = evaluate(c, OUTPUTS);
      values[k] = c->outputs[r - FIRST_OUTPUT];
    } else if (r < FIRST_INDICATOR) {
      int rate = r >= FIRST_RATE;
      unsigned number = rate ? r - FIRST_RATE : r - FIRST_STATE;
      if (c->exchange)
        status = rate ? evaluate(c, RATES) : start(c);
      else if (!own[rate]) {
        status = states_of_step(c, rate);
        own[0] = 1;
        own[1] |= rate;
      }
      values[k] = rate ? c->rates[number] : c->exchange ? c->x[number] : c->own_x[number];
    } else if (r < REFERENCES) {
      status = event_indicators(c, c->weights);
      values[k] = c->weights[r - FIRST_INDICATOR];
    } else
      status = refuse_reference(c, r);
  }
  return status;
}

/* Whether a variable can take a value now. */
static Status check_value(Instance* c, unsigned r, double value) {
  int begun = c->mode > INITIALIZATION;
  if (r > 0 && r < FIRST_OUTPUT) {
    const char* name = parameter_names[r - 1];
    if (!isfinite(value)) return fail(c, ERROR, "%s: the value is not a finite number", name);
    if (begun && kinds[r - 1] == 'f')
      return fail(c, ERROR, "%s is fixed after initialization: it changes the joints", name);
    if (c->mode == CONTINUOUS && kinds[r - 1] == 't')
      return fail(c, ERROR, "%s is tunable: set it in event mode", name);
    return OK;
  }
  if (!begun || !c->exchange || r < FIRST_STATE || r >= FIRST_RATE) {
    return fail(c, ERROR, "the variable with the value reference %u cannot be set here", r);
  }
  if (!isfinite(value))
    return fail(c, ERROR, "%s: the value is not a finite number", state_names[r - FIRST_STATE]);
  return OK;
}

/* Set variables: all of them, or none after an error. */
static Status set(Instance* c, const unsigned* references, size_t count, const double* values) {
  int begun = c->mode > INITIALIZATION, parameters = 0, states = 0;
  for (size_t k = 0; k < count; ++k) {
    Status status = check_value(c, references[k], values[k]);
    if (status > WARNING) return status;
  }
  copy(c->by_p, c->p, PARAMETERS);
  for (size_t k = 0; k < count; ++k) {
    unsigned r = references[k];
    double* place = r < FIRST_OUTPUT ? c->p + (r - 1) : c->x + (r - FIRST_STATE);
    if (*place == values[k]) continue;
    *(r < FIRST_OUTPUT ? &parameters : &states) = 1;
    if (r < FIRST_OUTPUT) *place = values[k];
  }
  if (begun && parameters) {
    Status status = check_limits(c);
    if (status > WARNING) {
      copy(c->p, c->by_p, PARAMETERS);
      return status;
    }
  }
  for (size_t k = 0; k < count; ++k)
    if (references[k] >= FIRST_OUTPUT) c->x[references[k] - FIRST_STATE] = values[k];
  if (parameters || states) c->valid = begun ? STARTED : 0;
  return OK;
}

/* Derivatives exist where there are values: from the initialization on. */
static Status refuse_unstarted(Instance* c) {
  return c->mode == INSTANTIATED ? fail(c, ERROR, "derivatives exist after the start of the "
                                                  "initialization only") : OK;
}

/* Changes of unknowns by changes of knowns: tangent of the motion, and of the start before it. */
static Status directional(Instance* c, const unsigned* unknowns, size_t unknown_count,
                          const unsigned* knowns, size_t known_count, const double* seed,
                          double* result) {
  const Problem* m = c->problem;
  int starting = c->mode <= INITIALIZATION;
  double dt = 0.0;
  Status status = refuse_unstarted(c);
  if (status <= WARNING) status = close_position(c);
  if (status > WARNING) return status;
  zero(c->change, m->states);
  zero(c->by_p, PARAMETERS);
  for (size_t k = 0; k < known_count; ++k) {
    unsigned r = knowns[k];
    if (r == 0)
      dt += seed[k];
    else if (r < FIRST_OUTPUT)
      c->by_p[r - 1] += seed[k];
    else if (r >= FIRST_STATE && r < FIRST_RATE && c->exchange && !starting)
      c->change[r - FIRST_STATE] += seed[k];
    else
      return refuse_reference(c, r);
  }
  if (starting) {
    const double* in[] = {c->time, c->y0, c->p, &dt, NULL, c->by_p};
    double* out[] = {c->weights};
    if (!CALL(c, m->start_tangent, in, out)) return fail(c, ERROR, "the start is singular");
    copy(c->change, c->weights, m->states);
  }
  const double* in[] = {c->time, c->now, c->x, c->p, &dt, NULL, c->change, c->by_p};
  double* out[] = {c->combined};
  if (!CALL(c, m->tangent, in, out)) return fail(c, ERROR, "the derivatives have no value");
  for (size_t k = 0; k < unknown_count; ++k) {
    unsigned r = unknowns[k];
    if (r >= FIRST_OUTPUT && r < FIRST_STATE)
      result[k] = c->combined[m->rate_count + (int)(r - FIRST_OUTPUT)];
    else if (r >= FIRST_RATE && r < FIRST_INDICATOR && c->exchange)
      result[k] = c->combined[r - FIRST_RATE];
    else if (r >= FIRST_STATE && r < FIRST_RATE && c->exchange && starting)
      result[k] = c->change[r - FIRST_STATE];
    else
      return refuse_reference(c, r);
    if (!isfinite(result[k])) return fail(c, ERROR, "a derivative is not finite");
  }
  return OK;
}

/* Weights of knowns by weights of unknowns: adjoint of the motion, and of the start before it. */
static Status adjoint(Instance* c, const unsigned* unknowns, size_t unknown_count,
                      const unsigned* knowns, size_t known_count, const double* seed,
                      double* result) {
  const Problem* m = c->problem;
  int starting = c->mode <= INITIALIZATION;
  double by_time = 0.0, earlier = 0.0;
  Status status = refuse_unstarted(c);
  if (status <= WARNING) status = close_position(c);
  if (status > WARNING) return status;
  zero(c->combined, m->rate_count + OUTPUT_COUNT);
  zero(c->weights, m->states + m->held);
  for (size_t k = 0; k < unknown_count; ++k) {
    unsigned r = unknowns[k];
    if (r >= FIRST_OUTPUT && r < FIRST_STATE)
      c->combined[m->rate_count + (int)(r - FIRST_OUTPUT)] += seed[k];
    else if (r >= FIRST_RATE && r < FIRST_INDICATOR && c->exchange)
      c->combined[r - FIRST_RATE] += seed[k];
    else if (r >= FIRST_STATE && r < FIRST_RATE && c->exchange && starting)
      c->weights[r - FIRST_STATE] += seed[k];
    else
      return refuse_reference(c, r);
  }
  const double* in[] = {c->time, c->now, c->x, c->p, c->combined};
  double* out[] = {&by_time, NULL, c->change, c->by_p};
  if (!CALL(c, m->adjoint, in, out)) return fail(c, ERROR, "the derivatives have no value");
  if (starting) {
    for (int k = 0; k < m->states; ++k) c->weights[k] += c->change[k];
    const double* at[] = {c->time, c->y0, c->p, c->weights};
    double* to[] = {&earlier, NULL, c->path};
    if (!CALL(c, m->start_adjoint, at, to)) return fail(c, ERROR, "the start is singular");
    for (int k = 0; k < PARAMETERS; ++k) c->by_p[k] += c->path[k];
  }
  for (size_t k = 0; k < known_count; ++k) {
    unsigned r = knowns[k];
    if (r == 0)
      result[k] = by_time + earlier;
    else if (r < FIRST_OUTPUT)
      result[k] = c->by_p[r - 1];
    else if (r >= FIRST_STATE && r < FIRST_RATE && c->exchange && !starting)
      result[k] = c->change[r - FIRST_STATE];
    else
      return refuse_reference(c, r);
    if (!isfinite(result[k])) return fail(c, ERROR, "a derivative is not finite");
  }
  return OK;
}

#endif
