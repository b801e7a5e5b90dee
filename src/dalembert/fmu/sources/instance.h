/* Instance of a functional mock-up unit: its numbers, its functions and its messages.

   Included after model.h, which defines sizes, names and functions of the model. All functions are
   static, as the unit is compiled as one text; an instance has no memory in common with others and
   allocates none after its creation. */

#ifndef DALEMBERT_INSTANCE_H
#define DALEMBERT_INSTANCE_H

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status; /* numbers of FMI 2.0 and 3.0 */
typedef enum { INSTANTIATED, INITIALIZATION, EVENT, CONTINUOUS, STEP, TERMINATED } Mode;

enum { /* results that are up to date */
  STARTED = 1,  /* assembly, and the states at the start */
  CLOSED = 2,   /* the position that belongs to the states */
  RATES = 4,
  OUTPUTS = 8,
  TERMS = 16    /* terms of steps that depend on parameters alone */
};

typedef struct Instance Instance;
struct Instance {
  const Problem* problem;
  void (*report)(Instance*, Status, const char* message);
  void *environment, *logger;
  char* name;
  int exchange, saved_count, accepting, muted;

  /* saved by the state of the unit: mode, valid, and numbers from time to held */
  Mode mode;
  int valid;
  double *numbers, *time, *stop, *p, *y0, *x, *counts, *at, *held;

  /* results and workspace */
  double *now, *rates, *outputs, *terms, *trial, *residual, *path, *goal, *saved, *next;
  double *change, *by_p, *weights, *combined, *own_x, *own_held;
  const double** arg;
  double** res;
  casadi_int* iw;
  double* w;
};

static const char* const categories_of[] = {"", "logStatusWarning", "logStatusDiscard",
                                            "logStatusError", "logStatusFatal"};

/* Report a status. Errors are always reported, other messages unless their category is muted. */
static Status fail(Instance* c, Status status, const char* format, ...) {
  char message[1024];
  if (!c) return ERROR;
  if (status < ERROR && c->muted & 1 << status) return status;
  va_list values;
  va_start(values, format);
  vsnprintf(message, sizeof message, format, values);
  va_end(values);
  c->report(c, status, message);
  return status;
}

/* Call a function of the model; arguments and results that are null are zero, or left out. */
static int call(Instance* c, Function f, int in, const double* const* from, int out, double** to) {
  memcpy(c->arg, from, (size_t)in * sizeof *from);
  memcpy(c->res, to, (size_t)out * sizeof *to);
  return !f(c->arg, c->res, c->iw, c->w, 0);
}

#define CALL(c, f, in, out)                                                                  \
  call(c, f, (int)(sizeof(in) / sizeof *(in)), in, (int)(sizeof(out) / sizeof *(out)), out)

/* Index of the first number that is not finite, or -1. */
static int unbounded(const double* values, int count) {
  for (int k = 0; k < count; ++k)
    if (!isfinite(values[k])) return k;
  return -1;
}

static void copy(double* to, const double* from, int count) {
  if (count) memcpy(to, from, (size_t)count * sizeof *to);
}

static void zero(double* to, int count) {
  if (count) memset(to, 0, (size_t)count * sizeof *to);
}

static void* refuse_memory(void* memory, int* missing) {
  if (!memory) *missing = 1;
  return memory;
}

/* Categories of messages that are reported; all of them if none is named. */
static void set_logging(Instance* c, int on, size_t count, const char* const* names) {
  int enabled = !count && on ? ~0 : 0;
  for (size_t k = 0; on && k < count; ++k)
    for (int status = WARNING; status <= FATAL; ++status)
      if (names[k] && !strcmp(names[k], categories_of[status])) enabled |= 1 << status;
  c->muted = ~enabled;
}

/* Status of a position or a value that does not exist: an importer can retry a trial step. */
static Status no_value(const Instance* c) {
  return c->mode == CONTINUOUS && !c->accepting ? DISCARD : ERROR;
}

/* Values of the start: nominal parameters, time zero. */
static void rewind_instance(Instance* c) {
  zero(c->numbers, c->saved_count);
  copy(c->p, nominal, PARAMETERS);
  *c->stop = INFINITY;
  c->valid = 0;
  c->mode = INSTANTIATED;
}

static void free_instance(Instance* c) {
  if (!c) return;
  free(c->numbers);
  free((void*)c->arg);
  free(c->res);
  free(c->iw);
  free(c->w);
  free(c->name);
  free(c);
}

/* A new instance, or null without memory. */
static Instance* new_instance(const char* name, const Problem* problem, int exchange) {
  Instance* c = calloc(1, sizeof *c);
  int missing = 0;
  if (!c) return NULL;
  c->problem = problem;
  c->exchange = exchange;
  size_t length = strlen(name ? name : "") + 1;
  int nx = problem->states + problem->memory, path = 1 + MOST_STATES + PARAMETERS;
  int sizes[] = {1, 1, PARAMETERS, START_COORDINATES, nx, SAMPLE_RATES, path, MOST_HELD, MOST_HELD,
                 MOST_STATES,
                 OUTPUT_COUNT, TERM_COUNT, MOST_HELD, MOST_ROWS, path, path, MOST_HELD, MOST_NEXT,
                 MOST_STATES, PARAMETERS, MOST_STATES + MOST_HELD, MOST_STATES + OUTPUT_COUNT,
                 MOST_STATES + MOST_HELD, MOST_HELD};
  double** parts[] = {&c->time, &c->stop, &c->p, &c->y0, &c->x, &c->counts, &c->at, &c->held, &c->now,
                      &c->rates, &c->outputs, &c->terms, &c->trial, &c->residual, &c->path,
                      &c->goal, &c->saved, &c->next, &c->change, &c->by_p, &c->weights,
                      &c->combined, &c->own_x, &c->own_held};
  size_t total = 1;
  int count = (int)(sizeof sizes / sizeof *sizes);
  for (int k = 0; k < count; ++k) total += (size_t)sizes[k];
  c->numbers = refuse_memory(calloc(total, sizeof(double)), &missing);
  c->arg = refuse_memory(calloc(WORK_ARG, sizeof *c->arg), &missing);
  c->res = refuse_memory(calloc(WORK_RES, sizeof *c->res), &missing);
  c->iw = refuse_memory(calloc(WORK_IW, sizeof *c->iw), &missing);
  c->w = refuse_memory(calloc(WORK_W, sizeof *c->w), &missing);
  c->name = refuse_memory(malloc(length), &missing);
  if (missing) {
    free_instance(c);
    return NULL;
  }
  memcpy(c->name, name ? name : "", length);
  double* place = c->numbers;
  for (int k = 0; k < count; ++k) {
    *parts[k] = place;
    place += sizes[k];
    if (parts[k] == &c->held) c->saved_count = (int)(place - c->numbers);
  }
  rewind_instance(c);
  return c;
}

#endif
