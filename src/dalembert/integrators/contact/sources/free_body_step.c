/* Parts of a step of free bodies that do not depend on the scheme */
/* the largest change of a normal speed by forces, and the largest speed, of the contacts in limits */
static void casadi_largest(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* limits) {
  const casadi_real* before = res[24];
  const casadi_real* free = res[25];
  casadi_int i, a, r, linear = iw[GROUPS]>0 ? ((const int*) arg[13])[1] : 1;
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
  for (r=0; r<rows; ++r) ((casadi_real*) arg[7])[r] = 0;
  casadi_mobilities(arg, res, iw);
  casadi_inertia_blocks(arg, res, iw);
  casadi_forget(w + iw[WORK] + rows + iw[MERITS], iw[CONTACTS]);
}
/* impulses within their cones, and velocities without offsets in res[5] */
static void casadi_velocities(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const int* row = (const int*) arg[9];
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r;
  casadi_shorten(arg, res[0], iw);
  casadi_respond(arg[1], (const int*) arg[11], (const int*) arg[12], res[0], rows, iw[SPEEDS], res[10]);
  for (r=0; r<rows; ++r) {
    res[5][r] = res[48][r]
      + casadi_row(arg[0], (const int*) arg[10], row[r], row[r+1], res[10]);
  }
}
/* impulses of all contacts with the offsets in res[26], and velocities without offsets in res[5]; the
   number of proximal problems, or -1 if they did not converge */
static casadi_int casadi_impulses(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w, casadi_real scale) {
  casadi_int rows = iw[CONTACTS]*iw[COMPONENTS], r, rounds;
  casadi_real allowed;
  for (r=0; r<rows; ++r) ((casadi_real*) arg[2])[r] = res[48][r] + res[26][r];
  rounds = casadi_solution(arg, res, iw, w, arg[LIMITS][TOLERANCE], scale);
  allowed = arg[LIMITS][TOLERANCE]*casadi_size(arg, iw, res[0], scale);
  if (!(res[11][1]<=allowed) || res[11][1]>arg[SHARES][JAMMED]*scale) return -1;
  casadi_velocities(arg, res, iw);
  return rounds;
}
/* record of the step: losses, residual, and keys, impulses and offsets of pressing contacts */
static void casadi_record(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real deepest, casadi_int rounds) {
  const casadi_int* key = (const casadi_int*) arg[43];
  casadi_int* last = (casadi_int*) arg[44];
  casadi_int* sizes = (casadi_int*) arg[47];
  casadi_int* keys = (casadi_int*) res[31];
  casadi_real* impulse = res[0];
  casadi_real* numbers = res[30] + 6*iw[RECORDED_STEPS];
  casadi_int i, a, r, width = iw[COMPONENTS], rows = iw[CONTACTS]*iw[COMPONENTS], pressing = 0;
  casadi_real loss = 0, friction = 0;
  for (i=0; i<iw[CONTACTS]; ++i) {
    r = i*width;
    for (a=0; a<width; ++a) {
      loss -= 0.5*impulse[r+a]*(res[5][r+a] + res[24][r+a]);
      if (a>0) friction -= 0.5*impulse[r+a]*(res[5][r+a] + res[24][r+a]);
    }
    if (!(impulse[r]>0)) continue;
    last[pressing] = key[i];
    keys[iw[RECORDED_CONTACTS]+pressing] = key[i];
    ((int*) res[46])[iw[RECORDED_CONTACTS]+pressing] = ((const int*) res[45])[i];
    for (a=0; a<width; ++a) {
      res[29][pressing*width+a] = impulse[r+a];
      res[32][(iw[RECORDED_CONTACTS]+pressing)*width+a] = impulse[r+a];
      res[33][(iw[RECORDED_CONTACTS]+pressing)*width+a] = res[26][r+a];
    }
    ++pressing;
  }
  numbers[0] = deepest;
  numbers[1] = loss;
  numbers[2] = friction;
  numbers[3] = rows>0 ? res[11][1] : 0.0;
  numbers[4] = rounds;
  numbers[5] = pressing;
  sizes[LAST_IMPULSES] = pressing;
  sizes[BEFORE] = iw[CONTACTS];
  for (i=0; i<iw[CONTACTS]; ++i) {
    ((casadi_int*) arg[57])[i] = key[i];
    for (a=0; a<6; ++a) ((int*) arg[58])[6*i+a] = ((const int*) arg[51])[6*i+a];
  }
  iw[RECORDED_CONTACTS] += pressing;
  ++iw[RECORDED_STEPS];
}
/* other forces of the same step: its responses, and the velocities at its end without impulses */
static void casadi_other_forces(const casadi_real** arg, casadi_real** res, const casadi_int* iw) {
  const int* contact = (const int*) arg[51];
  const int* row = (const int*) arg[9];
  casadi_int i, j, r;
  for (j=0; j<iw[SPEEDS]; ++j) res[10][j] = res[19][j] - res[49][j];
  for (i=0; i<iw[CONTACTS]; ++i, contact+=6) casadi_response_rows(arg, res, iw, i, contact[1], contact[3]);
  for (r=0; r<iw[CONTACTS]*iw[COMPONENTS]; ++r) {
    res[48][r] = res[25][r]
      + casadi_row(arg[0], (const int*) arg[10], row[r], row[r+1], res[10]);
  }
}
/* speeds at the end without impulses, in res[19]; 1 if the inertia is singular */
static int casadi_free_speeds(const casadi_real** arg, casadi_real** res, const casadi_int* iw,
    casadi_real* w) {
  casadi_int j;
  if (casadi_invert(arg, res, iw, w)) return 1;
  for (j=0; j<iw[SPEEDS]; ++j) res[19][j] = arg[22][j];
  casadi_accelerate(res[20], (const int*) arg[30], iw[BODIES], iw[BLOCK_SIZE], arg[LIMITS][LENGTH], arg[23],
    res[19]);
  return 0;
}
/* contacts of a step, with the velocities that it has without impulses, also in res[48], and the speeds
   in res[49], if the list contains all within a multiple of the reach; the outcome */
static casadi_int casadi_prepare(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real multiple, casadi_real* deepest) {
  casadi_real h = arg[LIMITS][LENGTH], reach[2];
  casadi_int j, r;
  reach[0] = 0;
  reach[1] = 0;
  casadi_fastest(arg, iw, arg[22], reach);
  casadi_fastest(arg, iw, res[19], reach);
  for (j=0; j<2; ++j) reach[j] = arg[SHARES][REACH]*h*reach[j];
  res[11][3] = multiple*(reach[0]>reach[1] ? reach[0] : reach[1]);
  if (!casadi_listed(arg, iw, res[11][3])) return 2;
  deepest[0] = casadi_contacts(arg, res, iw, reach);
  if (iw[CONTACTS]>iw[MAX_CONTACTS]) return 7;
  casadi_take_middle(arg, res, iw);
  for (r=0; r<iw[CONTACTS]*iw[COMPONENTS]; ++r) res[48][r] = res[25][r];
  for (j=0; j<iw[SPEEDS]; ++j) res[49][j] = res[19][j];
  return 0;
}
/* speeds and displacement of a step by its impulses, if they are finite, and its record; 1 if they are
   not */
static int casadi_finish(const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real deepest, casadi_int rounds) {
  casadi_real* v = (casadi_real*) arg[22];
  casadi_real* free = res[19];
  casadi_real theta = arg[LIMITS][THETA];
  casadi_int j;
  for (j=0; j<iw[SPEEDS]; ++j) {
    free[j] += res[10][j];
    if (!(fabs(free[j])<1e300)) return 1;
  }
  casadi_record(arg, res, iw, deepest, rounds);
  for (j=0; j<iw[SPEEDS]; ++j) {
    res[28][j] = arg[LIMITS][LENGTH]*(theta*free[j] + (1 - theta)*v[j]);
    v[j] = free[j];
  }
  return 0;
}
