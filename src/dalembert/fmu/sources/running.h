/* Modes, steps of co-simulation, and the saved state of an instance. */

#ifndef DALEMBERT_RUNNING_H
#define DALEMBERT_RUNNING_H

static Status enter_initialization(Instance* c, double time, int stop_defined, double stop) {
  if (!isfinite(time)) return fail(c, ERROR, "the start time is not a finite number");
  if (stop_defined && !(stop >= time))
    return fail(c, ERROR, "the stop time %.9g s is before the start, t = %.9g s", stop, time);
  *c->time = time;
  *c->stop = stop_defined ? stop : INFINITY;
  c->valid = 0;
  c->mode = INITIALIZATION;
  return OK;
}

/* Whether states and time of model exchange can be set. */
static int continues(const Instance* c) { return c->mode == EVENT || c->mode == CONTINUOUS; }

static Status set_time(Instance* c, double time) {
  if (!isfinite(time)) return fail(c, ERROR, "the time is not a finite number");
  if (time != *c->time) c->valid = STARTED;
  *c->time = time;
  return OK;
}

static Status exit_initialization(Instance* c) {
  Status status = accept_position(c);
  if (status <= WARNING) c->mode = c->exchange ? EVENT : STEP;
  return status;
}

/* Branches of formulas by the signs of their switching functions; whether one has changed. */
static Status update_branches(Instance* c, int* changed) {
  *changed = 0;
  Status status = accept_position(c);
#if INDICATORS
  if (status > WARNING) return status;
  double* sides = c->held + (c->problem->held - INDICATORS);
  status = event_indicators(c, c->weights);
  if (status > WARNING) return status;
  for (int k = 0; k < INDICATORS; ++k) {
    double side = c->weights[k] > 0.0;
    if ((sides[k] > 0.5) != (side > 0.5)) *changed = 1;
    sides[k] = side;
  }
  if (*changed) c->valid = STARTED;
#endif
  return status;
}

#if CO_SIMULATION
static int step_is_finite(Instance* c, double t, double h, int corrected) {
  double flag = corrected;
  const double* in[] = {c->x, &t, &h, &flag, c->terms};
  double* out[] = {c->next};
  int count = c->problem->states + c->problem->memory;
  return CALL(c, step, in, out) && unbounded(c->next, count) < 0;
}

/* Check the joints, and whether redundant equations still follow from those that are solved. */
static Status check_state(Instance* c) {
  const double* in[] = {c->time, NULL, c->x, c->p};
#if STEP_ROWS
  double* out[] = {c->residual};
  if (!CALL(c, step_violation, in, out)) return fail(c, ERROR, "the joints are undefined");
  for (int k = 0; k < STEP_ROWS; ++k)
    if (!(fabs(c->residual[k]) <= 1.0))
      return fail(c, ERROR, "%s is violated at t = %.9g s, %.3g times its limit; shorten the step",
                  step_rows[k], *c->time, fabs(c->residual[k]));
#endif
#if CONDITIONED
  double share, *to[] = {&share};
  if (!CALL(c, step_conditioning, in, to) || !(share <= 1.0))
    return fail(c, ERROR, "redundant joints need other equations at t = %.9g s than at the start",
                *c->time);
#endif
  (void)in;
  return OK;
}

/* Steps of equal length, at most STEP_LENGTH, to a time; inputs are constant. */
static Status advance(Instance* c, double end) {
  double first = *c->time, length = end - first;
  int total = c->problem->states + c->problem->memory;
  double count = ceil(length / STEP_LENGTH * (1.0 - 1e-9));
  if (!(count >= 1.0)) count = 1.0;
  if (count > 9e15) return fail(c, ERROR, "a step of length %.3g s is too long", length);
  for (double k = 0.0; k < count; k += 1.0) {
    double t = first + k * (length / count);
    double until = k + 1.0 == count ? end : first + (k + 1.0) * (length / count);
    double h = until - t, shortest = h / 1024.0;
    int corrected = k + 1.0 == count || fmod(k + 1.0, CORRECTION_PERIOD) == 0.0;
    while (t < until) {
      if (h > until - t) h = until - t;
      if (step_is_finite(c, t, h, corrected)) {
        copy(c->x, c->next, total);
        t = t + h >= until - 1e-12 * h ? until : t + h;
        *c->time = t;
        continue;
      }
      h /= 2.0;
      if (!HALVES || h < shortest) {
        Status status = check_state(c);
        return status > WARNING ? status
                                : fail(c, ERROR, "no step from t = %.9g s: " STEP_FAILURE, t);
      }
    }
  }
  *c->time = end;
  return OK;
}

/* Time of the next sample; the bits of the rates that are due then. */
static double next_sample(const Instance* c, int* due) {
  double next = INFINITY, shortest = INFINITY;
  *due = 0;
  for (int k = 0; k < SAMPLE_RATES; ++k) {
    next = fmin(next, first_sample[k] + sample_time[k] * c->counts[k]);
    shortest = fmin(shortest, sample_time[k]);
  }
  for (int k = 0; k < SAMPLE_RATES; ++k)
    *due |= (first_sample[k] + sample_time[k] * c->counts[k] <= next + 1e-9 * shortest) << k;
  return next;
}

/* Sample the blocks that are due. */
static Status sample(Instance* c, int due) {
  int total = c->problem->states + c->problem->memory;
  const double* in[] = {c->time, NULL, c->x, c->p};
  double* out[] = {c->next};
  if (!samples[due])
    return fail(c, ERROR, "blocks sampled at t = %.9g s depend on each other", *c->time);
  if (!CALL(c, samples[due], in, out) || unbounded(c->next, total) >= 0)
    return fail(c, ERROR, "the sample at t = %.9g s has no finite value", *c->time);
  copy(c->x, c->next, total);
  for (int k = 0; k < SAMPLE_RATES; ++k) c->counts[k] += due >> k & 1;
  return OK;
}

/* A communication step: samples at its start and inside of it, and steps between them. */
static Status do_step(Instance* c, double point, double step_length) {
  double first = *c->time, end = point + step_length, length = end - first, next = INFINITY;
  double slack = 1e-9 * (fabs(first) + step_length);
  int due;
  if (!isfinite(length) || !(step_length >= 0.0))
    return fail(c, ERROR, "a step of length %.3g s is not possible", step_length);
  if (fabs(point - first) > slack)
    return fail(c, ERROR, "the communication point is t = %.9g s, but %.9g s is reached", point,
                first);
  if (end > *c->stop + slack)
    return fail(c, ERROR, "the step to t = %.9g s passes the stop time, %.9g s", end, *c->stop);
  if (length <= 0.0) return OK;
  Status status = start(c);
  if (status > WARNING) return status;
  if (!(c->valid & TERMS)) {
    const double* in[] = {c->p};
    double* out[] = {c->terms};
    if (!CALL(c, step_terms, in, out)) return fail(c, ERROR, "the parameters have no valid terms");
  }
  c->valid = STARTED | TERMS;
  while (status <= WARNING && *c->time < end) {
    double near = 1e-9 * fmin(length, STEP_LENGTH) + 1e-15 * fabs(end);
    while (status <= WARNING && (next = next_sample(c, &due)) <= *c->time + near)
      status = sample(c, due);
    if (status <= WARNING) status = advance(c, next < end - near ? next : end);
  }
  return status > WARNING ? status : check_state(c);
}
#endif

/* state of the unit ----------------------------------------------------------------------- */
typedef struct {
  char token[40];
  int mode, valid, count, exchange;
} Saved;

static size_t saved_size(const Instance* c) {
  return sizeof(Saved) + (size_t)c->saved_count * sizeof(double);
}

static int belongs(const Instance* c, const Saved* saved) {
  return saved && !strncmp(saved->token, TOKEN, sizeof saved->token - 1) &&
         saved->count == c->saved_count && saved->exchange == c->exchange &&
         saved->mode >= INSTANTIATED && saved->mode <= TERMINATED;
}

/* Memory for a state: that of the state on entry, if there is one. */
static Status reserve(Instance* c, void** state) {
  if (*state && !belongs(c, *state))
    return fail(c, ERROR, "the state to be overwritten belongs to another unit");
  if (!*state) *state = calloc(1, saved_size(c));
  return *state ? OK : fail(c, ERROR, "no memory for the state of the unit");
}

static Status save(Instance* c, void** state) {
  Status status = reserve(c, state);
  if (status > WARNING) return status;
  Saved* saved = *state;
  strncpy(saved->token, TOKEN, sizeof saved->token - 1);
  saved->mode = c->mode;
  saved->valid = c->valid & STARTED;
  saved->count = c->saved_count;
  saved->exchange = c->exchange;
  memcpy(saved + 1, c->numbers, (size_t)c->saved_count * sizeof(double));
  return OK;
}

static Status restore(Instance* c, const void* state) {
  const Saved* saved = state;
  if (!belongs(c, saved)) return fail(c, ERROR, "the saved state belongs to another unit");
  c->mode = (Mode)saved->mode;
  c->valid = saved->valid & STARTED;
  memcpy(c->numbers, saved + 1, (size_t)c->saved_count * sizeof(double));
  return OK;
}

static Status serialize(Instance* c, const void* state, void* bytes, size_t size) {
  if (!belongs(c, state) || size < saved_size(c))
    return fail(c, ERROR, "a saved state needs %lu bytes", (unsigned long)saved_size(c));
  memcpy(bytes, state, saved_size(c));
  return OK;
}

static Status deserialize(Instance* c, const void* bytes, size_t size, void** state) {
  Saved head;
  if (size >= sizeof head) memcpy(&head, bytes, sizeof head);
  if (size < saved_size(c) || !belongs(c, &head))
    return fail(c, ERROR, "the serialized state belongs to another unit");
  Status status = reserve(c, state);
  if (status <= WARNING) memcpy(*state, bytes, saved_size(c));
  return status;
}

#endif
