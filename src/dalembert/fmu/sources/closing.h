/* Positions by Newton's method, continued from a known one. */

#ifndef DALEMBERT_CLOSING_H
#define DALEMBERT_CLOSING_H

/* Newton's method at a = [t; x; p]; the number of the worst equation, or -1 after success. */
static int newton(Instance* c, const Closing* k, const double* a, double* y) {
  double smallest = INFINITY;
  int worst = 0;
  for (int iteration = 0; iteration <= 25; ++iteration) {
    const double* in[] = {a, y, a + 1, a + 1 + k->states};
    double *out[] = {c->next, c->residual}, size = 0.0;
    if (!CALL(c, k->function, in, out)) return worst;
    worst = 0;
    for (int i = 0; i < k->rows; ++i) {
      double value = fabs(c->residual[i]);
      if (!(value <= size)) size = value, worst = i;
      if (!isfinite(size)) return worst;
    }
    if (size <= 1e-14) return -1;
    if (size > 4.0 * smallest || unbounded(c->next, k->coordinates) >= 0) return worst;
    smallest = size < smallest ? size : smallest;
    copy(y, c->next, k->coordinates);
    if (size <= 1e-9) return -1; /* convergence is quadratic: y is exact to rounding */
  }
  return worst;
}

/* Continue a position to other arguments, in smaller steps if necessary.

   from, to: [t; x; p]; y: position of the first on entry, of the second after success */
static Status follow(
    Instance* c, const Closing* k, const double* from, const double* to, double* y) {
  int count = 1 + k->states + PARAMETERS, worst;
  double reached = 0.0, step = 1.0;
  while (reached < 1.0) {
    double target = reached + step < 1.0 ? reached + step : 1.0;
    for (int i = 0; i < count; ++i)
      c->path[i] = target == 1.0 ? to[i] : from[i] + target * (to[i] - from[i]);
    copy(c->saved, y, k->coordinates);
    worst = newton(c, k, c->path, y);
    if (worst < 0) {
      reached = target;
      step *= 2.0;
      continue;
    }
    double open = c->residual[worst];
    copy(y, c->saved, k->coordinates);
    step /= 2.0;
    if (step < 1e-3)
      return fail(c, no_value(c),
                  "%s: no position at t = %.9g s: %s is open by %.3g of its natural size (%s)",
                  k->subject, to[0], k->names[worst], open, k->cure);
  }
  return OK;
}

/* Check the quantities that depend on parameters against their limits. */
static Status check_limits(Instance* c) {
#if LIMITS
  double values[LIMITS];
  const double* in[] = {c->p};
  double* out[] = {values};
  if (!CALL(c, limits, in, out)) return fail(c, ERROR, "the limits cannot be evaluated");
  for (int k = 0; k < LIMITS; ++k)
    if (!isfinite(values[k]) || values[k] < minimum[k] || values[k] <= above[k])
      return fail(c, ERROR, "%s: its value is %.6g, which is not valid", limited[k], values[k]);
#endif
  return OK;
}

/* Assemble the mechanism and compute the states at the start. */
static Status start(Instance* c) {
  const Problem* m = c->problem;
  int bad;
  if (c->valid & STARTED) return OK;
  if ((bad = unbounded(c->p, PARAMETERS)) >= 0)
    return fail(c, ERROR, "parameter %s is not finite", parameter_names[bad]);
  Status status = check_limits(c);
  if (status > WARNING) return status;
  c->goal[0] = 0.0;
  copy(c->goal + 1, nominal, PARAMETERS);
  c->at[0] = *c->time;
  copy(c->at + 1, c->p, PARAMETERS);
  copy(c->y0, start_position, START_COORDINATES);
  status = follow(c, &assembly, c->goal, c->at, c->y0);
  if (status > WARNING) return status;
#if STEADY
  if (newton(c, &steady_states, c->at, c->y0) >= 0)
    return fail(c, ERROR, "no steady values of the states of first order; give their start");
#endif
  {
    const double* in[] = {c->time, c->y0, c->p};
    double *out[] = {c->weights}, *gaps[] = {c->residual};
    if (!CALL(c, start_violation, in, gaps)) return fail(c, ERROR, "the joints are undefined");
    for (int k = 0; k < VIOLATION_ROWS; ++k)
      if (!(fabs(c->residual[k]) <= 1e-9))
        return fail(c, ERROR, "the parameters do not fit: %s is open by %.3g of its natural size",
                    violation_names[k], c->residual[k]);
    if (!CALL(c, m->start, in, out) || unbounded(c->weights, m->states + m->held) >= 0)
      return fail(c, ERROR, "the start is singular (dead centre): speeds are not determined");
  }
  copy(c->x, c->weights, m->states);
  copy(c->held, c->weights + m->states, m->held);
  copy(c->at + 1, c->x, m->states);
  copy(c->at + 1 + m->states, c->p, PARAMETERS);
  if (m->memory) {
    const double* in[] = {c->time, NULL, c->x, c->p};
    double* out[] = {c->x + m->states};
    if (!CALL(c, m->begin, in, out)) return fail(c, ERROR, "the memory of steps has no value");
  }
  for (int k = 0; k < SAMPLE_RATES; ++k)
    c->counts[k] = fmax(0.0, ceil((*c->time - first_sample[k]) / sample_time[k] - 1e-9));
  c->valid = STARTED;
  return OK;
}

/* Whether the accepted position belongs to the states, so that restored runs repeat bit by bit. */
static int is_accepted(const Instance* c) {
  const Problem* m = c->problem;
  return c->at[0] == *c->time &&
         !memcmp(c->at + 1, c->x, (size_t)m->states * sizeof(double)) &&
         !memcmp(c->at + 1 + m->states, c->p, PARAMETERS * sizeof(double));
}

/* Solve the position that belongs to the states, near the last accepted one. */
static Status close_position(Instance* c) {
  const Problem* m = c->problem;
  Status status = start(c);
  if (status > WARNING || c->valid & CLOSED) return status;
  copy(c->now, c->held, m->held);
  if (m->closing && !is_accepted(c)) {
    c->goal[0] = *c->time;
    copy(c->goal + 1, c->x, m->states);
    copy(c->goal + 1 + m->states, c->p, PARAMETERS);
    status = follow(c, m->closing, c->at, c->goal, c->now);
    if (status > WARNING) return status;
  }
  c->valid |= CLOSED;
  return OK;
}

/* Accept the position, near which the next ones are solved. */
static Status accept_position(Instance* c) {
  const Problem* m = c->problem;
  c->accepting = 1;
  Status status = close_position(c);
  c->accepting = 0;
  if (status > WARNING) return status;
#if EXCHANGE_CONDITIONED
  if (c->exchange) {
    double ratio;
    const double* in[] = {c->time, c->now, c->x, c->p};
    double* out[] = {&ratio};
    if (!CALL(c, exchange_conditioning, in, out) || !(ratio <= 1e3))
      return fail(c, ERROR, "singular position of model exchange at t = %.9g s: the state %s does not determine "
                  "the others there; choose other ones by states=[...]", *c->time, state_names[0]);
  }
#endif
  copy(c->held, c->now, m->held);
  c->at[0] = *c->time;
  copy(c->at + 1, c->x, m->states);
  copy(c->at + 1 + m->states, c->p, PARAMETERS);
  return OK;
}

#endif
