/* Parts of a step of free bodies that do not depend on the scheme */
/* the largest change of a normal speed by forces, and the largest speed, of the contacts in limits */
static void casadi_largest(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* limits) {
  const casadi_real* before = res[VELOCITY_BEFORE];
  const casadi_real* free = res[VELOCITY_FREE];
  casadi_int i, a, r, linear = iw[GROUPS]>0 ? ((const int*) arg[GROUP_STARTS])[1] : 1;
  limits[0] = 0;
  limits[1] = 0;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*iw[COMPONENTS];
    if (!(fabs(free[r] - before[r])<=limits[0])) limits[0] = fabs(free[r] - before[r]);
    for (a=0; a<linear; ++a) {
      if (!(fabs(before[r+a])<=limits[1])) limits[1] = fabs(before[r+a]);
      if (!(fabs(free[r+a])<=limits[1])) limits[1] = fabs(free[r+a]);
    }
  }
}
/* begin to solve for the impulses of the contacts */
static void casadi_begin_impulses(const casadi_real** arg, casadi_real** res,
    const casadi_int* iw, casadi_real* w) {
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  for (r=0; r<rows; ++r) ((casadi_real*) arg[SHIFT])[r] = 0;
  casadi_mobilities(arg, res, iw);
  casadi_inertia_blocks(arg, res, iw);
  casadi_forget(w + iw[WORK] + rows + iw[MERITS], iw[CONTACTS]);
}
/* impulses within their cones, and velocities without offsets in res[VELOCITY] */
static void casadi_velocities(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const int* row = (const int*) arg[DIRECTION_ROWS];
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  casadi_shorten(arg, res[IMPULSE], iw);
  casadi_respond(arg[RESPONSES], (const int*) arg[RESPONSE_ROWS], (const int*) arg[RESPONSE_COLUMNS],
    res[IMPULSE], rows, iw[SPEEDS], res[SPEED_CHANGES]);
  for (r=0; r<rows; ++r) {
    res[VELOCITY][r] = res[VELOCITY_APPLIED][r]
      + casadi_row(arg[DIRECTIONS], (const int*) arg[DIRECTION_COLUMNS], row[r], row[r+1],
      res[SPEED_CHANGES]);
  }
}
/* impulses of all contacts with the offsets in res[OFFSETS], with a tolerance relative to a scale; the
   number of proximal problems */
static casadi_int casadi_offset_impulses(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real tolerance, casadi_real scale) {
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  for (r=0; r<rows; ++r) ((casadi_real*) arg[VELOCITY])[r] = res[VELOCITY_APPLIED][r] + res[OFFSETS][r];
  return casadi_solution(arg, res, iw, w, tolerance, scale);
}
/* impulses of all contacts with the offsets in res[OFFSETS], and velocities without offsets in res[VELOCITY];
   the number of proximal problems, or -1 if they did not converge */
static casadi_int casadi_impulses(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real scale) {
  casadi_int rounds = casadi_offset_impulses(arg, res, iw, w, arg[LIMITS][TOLERANCE], scale);
  casadi_real allowed = arg[LIMITS][TOLERANCE]*casadi_size(arg, iw, res[IMPULSE], scale);
  if (!(res[STATUS][RESIDUAL]<=allowed) || res[STATUS][RESIDUAL]>arg[SHARES][JAMMED]*scale) return -1;
  casadi_velocities(arg, res, iw);
  return rounds;
}
/* whether the impulses satisfy the conditions with the offsets in res[OFFSETS] within the tolerance;
   velocities without offsets are in res[VELOCITY] then */
static int casadi_satisfies(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real scale) {
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  casadi_real allowed = arg[LIMITS][TOLERANCE]*casadi_size(arg, iw, res[IMPULSE], scale);
  for (r=0; r<rows; ++r) ((casadi_real*) arg[VELOCITY])[r] = res[VELOCITY_APPLIED][r] + res[OFFSETS][r];
  casadi_state(arg, res, iw, w);
  if (!(res[STATUS][RESIDUAL]<=allowed)) return 0;
  casadi_velocities(arg, res, iw);
  return 1;
}
/* offsets of the contacts that slide throughout the step: friction in space opposes the mean of the
   slip */
static void casadi_sliding(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const casadi_real* before = res[VELOCITY_BEFORE];
  int* slides = (int*) res[SLIDING];
  casadi_int i, r;
  casadi_real slip, limit;
  for (i=0; i<iw[CONTACTS]; ++i) slides[i] = 0;
  if (iw[DIMENSION]==2 || iw[GROUPS]==0 || arg[LIMITS][THETA]!=0.5) return;
  casadi_changes(arg, res, iw);
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*iw[COMPONENTS];
    slip = before[r+1]*before[r+1] + before[r+2]*before[r+2];
    limit = arg[SHARES][SLIDES]*casadi_change(arg, res, i);
    slides[i] = slip>limit*limit && !(before[r]<0 && casadi_strikes(arg, res, iw, i));
    if (!slides[i]) continue;
    res[OFFSETS][r+1] = before[r+1];
    res[OFFSETS][r+2] = before[r+2];
  }
}
/* offsets of sliding contacts that stop or reverse; whether there are any */
static int casadi_stopping(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const int* law = (const int*) arg[LAW_OF_PAIR];
  const int* pair = (const int*) res[PAIRS];
  const casadi_real* before = res[VELOCITY_BEFORE];
  int* slides = (int*) res[SLIDING];
  int stops = 0;
  casadi_int i, a, r;
  casadi_real slip, change, share = arg[SHARES][STOPS];
  for (i=0; i<iw[CONTACTS]; ++i) {
    if (!slides[i]) continue;
    r = i*iw[COMPONENTS];
    slip = 0;
    change = 0;
    for (a=1; a<3; ++a) {
      slip += before[r+a]*before[r+a];
      change += (res[VELOCITY][r+a] - before[r+a])*(res[VELOCITY][r+a] - before[r+a]);
    }
    if (!(change>share*share*slip)) continue;
    slides[i] = 0;
    stops = 1;
    for (a=1; a<3; ++a) {
      res[OFFSETS][r+a] = arg[LAWS][law[pair[i]]*(2+iw[GROUPS])+1]*before[r+a];
    }
  }
  return stops;
}
/* record of the step: losses, residual, and keys, impulses and offsets of pressing contacts */
static void casadi_record(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real deepest, casadi_int rounds) {
  const casadi_int* key = (const casadi_int*) arg[KEYS];
  casadi_int* last = (casadi_int*) arg[LAST_KEYS];
  casadi_int* sizes = (casadi_int*) arg[SIZES];
  casadi_int* keys = (casadi_int*) res[RECORDED_KEYS];
  casadi_real* impulse = res[IMPULSE];
  casadi_real* numbers = res[RECORD] + 6*iw[RECORDED_STEPS];
  casadi_int i, a, r, width = iw[COMPONENTS], rows = iw[CONTACTS]*iw[COMPONENTS], pressing = 0;
  casadi_real loss = 0, friction = 0;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    for (a=0; a<width; ++a) {
      loss -= 0.5*impulse[r+a]*(res[VELOCITY][r+a] + res[VELOCITY_BEFORE][r+a]);
      if (a>0) friction -= 0.5*impulse[r+a]*(res[VELOCITY][r+a] + res[VELOCITY_BEFORE][r+a]);
    }
    if (!(impulse[r]>0)) continue;
    last[pressing] = key[i];
    keys[iw[RECORDED_CONTACTS]+pressing] = key[i];
    ((int*) res[RECORDED_DIRECTIONS])[iw[RECORDED_CONTACTS]+pressing] =
      ((const int*) res[START_DIRECTIONS])[i];
    for (a=0; a<width; ++a) {
      res[LAST_IMPULSES][pressing*width+a] = impulse[r+a];
      res[RECORDED_IMPULSES][(iw[RECORDED_CONTACTS]+pressing)*width+a] = impulse[r+a];
      res[RECORDED_OFFSETS][(iw[RECORDED_CONTACTS]+pressing)*width+a] = res[OFFSETS][r+a];
    }
    ++pressing;
  }
  numbers[DEPTH] = deepest;
  numbers[LOSS] = loss;
  numbers[FRICTION] = friction;
  numbers[RESIDUAL] = rows>0 ? res[STATUS][RESIDUAL] : 0.0;
  numbers[ROUNDS] = rounds;
  numbers[PRESSING] = pressing;
  sizes[LAST_IMPULSES] = pressing;
  sizes[BEFORE] = iw[CONTACTS];
  for (i=0; i<iw[CONTACTS]; ++i) {
    ((casadi_int*) arg[KEYS_BEFORE])[i] = key[i];
    for (a=0; a<6; ++a) ((int*) arg[DESCRIPTIONS_BEFORE])[6*i+a] = ((const int*) arg[DESCRIPTIONS])[6*i+a];
  }
  iw[RECORDED_CONTACTS] += pressing;
  ++iw[RECORDED_STEPS];
}
/* other forces of the same step: its responses, and the velocities at its end without impulses */
static void casadi_other_forces(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const int* contact = (const int*) arg[DESCRIPTIONS];
  const int* row = (const int*) arg[DIRECTION_ROWS];
  casadi_int i, j, r;
  for (j=0; j<iw[SPEEDS]; ++j) res[SPEED_CHANGES][j] = res[FREE_SPEEDS][j] - res[FIRST_SPEEDS][j];
  for (i=0; i<iw[CONTACTS]; ++i, contact+=6) casadi_response_rows(arg, res, iw, i, contact[SHAPE],
      contact[OTHER_SHAPE]);
  for (r=0; r<iw[CONTACTS]*iw[COMPONENTS]; ++r) {
    res[VELOCITY_APPLIED][r] = res[VELOCITY_FREE][r]
      + casadi_row(arg[DIRECTIONS], (const int*) arg[DIRECTION_COLUMNS], row[r], row[r+1],
      res[SPEED_CHANGES]);
  }
}
/* speeds at the end without impulses, in res[FREE_SPEEDS]; 1 if the inertia is singular */
static int casadi_free_speeds(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* w) {
  casadi_int j;
  if (casadi_invert(arg, res, iw, w)) return 1;
  for (j=0; j<iw[SPEEDS]; ++j) res[FREE_SPEEDS][j] = arg[SPEEDS][j];
  casadi_accelerate(res[INVERSES], (const int*) arg[BODY_STARTS], iw[BODIES], iw[BLOCK_SIZE],
    arg[LIMITS][LENGTH], arg[FORCES], res[FREE_SPEEDS]);
  return 0;
}
/* contacts of a step, with the velocities that it has without impulses, also in res[VELOCITY_APPLIED], and
   the speeds in res[FIRST_SPEEDS], if the list contains all within a multiple of the reach; the outcome */
static casadi_int casadi_prepare(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real multiple, casadi_real* deepest) {
  casadi_real h = arg[LIMITS][LENGTH], reach[2];
  casadi_int j, r;
  reach[0] = 0;
  reach[1] = 0;
  casadi_fastest(arg, iw, arg[SPEEDS], reach);
  casadi_fastest(arg, iw, res[FREE_SPEEDS], reach);
  for (j=0; j<2; ++j) reach[j] = arg[SHARES][REACH]*h*reach[j];
  res[STATUS][REACH] = multiple*(reach[0]>reach[1] ? reach[0] : reach[1]);
  if (!casadi_listed(arg, iw, res[STATUS][REACH])) return OUTDATED;
  deepest[0] = casadi_contacts(arg, res, iw, reach);
  if (iw[CONTACTS]>iw[MAX_CONTACTS]) return MORE;
  casadi_take_middle(arg, res, iw);
  for (r=0; r<iw[CONTACTS]*iw[COMPONENTS]; ++r) res[VELOCITY_APPLIED][r] = res[VELOCITY_FREE][r];
  for (j=0; j<iw[SPEEDS]; ++j) res[FIRST_SPEEDS][j] = res[FREE_SPEEDS][j];
  return DONE;
}
/* speeds and displacement of a step by its impulses, if they are finite, and its record; 1 if they are
   not */
static int casadi_finish(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real deepest, casadi_int rounds) {
  casadi_real* v = (casadi_real*) arg[SPEEDS];
  casadi_real* free = res[FREE_SPEEDS];
  casadi_real theta = arg[LIMITS][THETA];
  casadi_int j;
  for (j=0; j<iw[SPEEDS]; ++j) {
    free[j] += res[SPEED_CHANGES][j];
    if (!(fabs(free[j])<1e300)) return 1;
  }
  casadi_record(arg, res, iw, deepest, rounds);
  for (j=0; j<iw[SPEEDS]; ++j) {
    res[DISPLACEMENT][j] = arg[LIMITS][LENGTH]*(theta*free[j] + (1 - theta)*v[j]);
    v[j] = free[j];
  }
  return 0;
}
